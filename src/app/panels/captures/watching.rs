//! The set's folder while photos arrive in it: each is taken for what its name, or the order, says, and shown large.

use std::path::{Path, PathBuf};

use eframe::egui::{RichText, Ui};
use firstbounce_capture::CaptureSet;
use firstbounce_capture::image_file::time_taken;
use firstbounce_capture::set::{Arrivals, TakenFor, take_arrivals};
use firstbounce_capture::watch_folder::{Following, WatchEvent, WatchFolderOptions};

use crate::app::state::layout::Shown;
use crate::app::state::panel::PanelName;
use crate::app::state::results::ShotName;
use crate::app::state::session::Session;

/// Lines that are kept of what arrived.
const LINES: usize = 6;

/// The folder that is watched.
#[derive(Default)]
pub struct Watching {
    following: Option<Following>,
    /// Arrived, and not in the set: of lights that are not complete, or of names that say too little.
    waiting: Vec<PathBuf>,
    /// What arrived last, and what it was taken for.
    lines: Vec<String>,
}

impl Watching {
    pub fn ui(&mut self, ui: &mut Ui, session: &mut Session) {
        let mut watches = self.following.is_some();
        let hover = "Photos that a camera or another program writes into the folder of the set are taken as they come, and the \
                     set is solved anew when a light is complete";
        if ui.checkbox(&mut watches, "Watch this folder").on_hover_text(hover).changed() {
            if watches { self.start(session) } else { *self = Self::default() }
        }
        for line in &self.lines {
            ui.label(RichText::new(line).small());
        }
    }

    fn start(&mut self, session: &mut Session) {
        let wake = session.jobs.wake();
        let folder = session.document().set.folder.clone();
        match Following::start(&folder, WatchFolderOptions::default(), move || wake()) {
            Ok(following) => *self = Self { following: Some(following), ..Self::default() },
            Err(error) => session.error(error.to_string()),
        }
    }

    /// Takes what arrived; those files whose place the user has to say. Once a frame.
    pub fn update(&mut self, session: &mut Session) -> Vec<PathBuf> {
        let mut open = Vec::new();
        while let Some(event) = self.following.as_ref().and_then(Following::try_next) {
            match event {
                WatchEvent::Polled { .. } => {
                    session.done("This folder sends no news of its files: it is looked through every few seconds");
                }
                WatchEvent::Arrived(files) => open.extend(self.take(files, session)),
                WatchEvent::Ended(error) => {
                    *self = Self::default();
                    session.error(error.to_string());
                    break;
                }
            }
        }
        open
    }

    fn take(&mut self, files: Vec<PathBuf>, session: &mut Session) -> Vec<PathBuf> {
        let document = session.document();
        let fresh = |file: &PathBuf| !self.waiting.contains(file);
        let last = files.last().cloned();
        let new: Vec<PathBuf> = files.into_iter().filter(fresh).collect();
        self.waiting.extend(new);
        let Arrivals { set, taken } = take_arrivals(&document.set, &self.waiting, &Default::default(), time_taken);
        let is_named = |taken: &TakenFor| matches!(taken, TakenFor::Named(_));
        let changes_known = taken.iter().any(is_named);
        for (file, of) in self.waiting.iter().zip(&taken) {
            if Some(file) == last.as_ref() {
                self.lines.insert(0, format!("{}: {}", name_of(file), of.described(&set)));
            }
        }
        self.lines.truncate(LINES);
        let shown = self.waiting.iter().zip(&taken).filter(|(file, _)| Some(*file) == last.as_ref());
        let shown =
            shown.flat_map(|(_, of)| of.shots()).filter_map(|&shot| set.shots.get(shot)).map(ShotName::of).next();
        let open: Vec<PathBuf> = self
            .waiting
            .iter()
            .zip(&taken)
            .filter(|(_, of)| matches!(of, TakenFor::Unassigned(_)))
            .map(|(file, _)| file.clone())
            .collect();
        let next = with_complete_lights(&document.set, set);
        let is_in = |file: &PathBuf| {
            let path = next.resolve(&next.written(file));
            next.shots.iter().flat_map(|shot| &shot.files).chain(&next.mask).any(|name| next.resolve(name) == path)
        };
        self.waiting.retain(|file| !is_in(file) && !open.contains(file));
        if next != document.set {
            session.edit("Add photos that arrived", |document| document.set = next);
        } else if changes_known {
            session.results.look_again();
        }
        if let Some(name) = shown.filter(|_| session.panel == PanelName::Captures) {
            session.views.show(Shown::Photo(name));
            if let Some(view) = session.views.active_mut() {
                view.look.clip_zebra = true;
            }
        }
        open
    }
}

/// Lights join the set when they are complete: until then it stays one that can be solved. What the set has already stays in it,
/// also where its file is not there yet.
fn with_complete_lights(before: &CaptureSet, arrived: CaptureSet) -> CaptureSet {
    let complete = arrived.present().0;
    let keeps_shots = before.shots.iter().all(|shot| {
        complete
            .shots
            .iter()
            .any(|other| ShotName::of(other) == ShotName::of(shot) && other.files.len() >= shot.files.len())
    });
    let keeps_lights = before.lights.iter().all(|light| complete.light_index(&light.name).is_some());
    if keeps_shots && keeps_lights { complete } else { arrived }
}

fn name_of(file: &Path) -> String {
    file.file_name().unwrap_or(file.as_os_str()).to_string_lossy().into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn photos_that_the_set_names_and_that_are_not_there_yet_stay_in_it() {
        let demo = CaptureSet::open(Path::new("assets/demo")).unwrap();
        let mut named = demo.clone();
        named.shots[0].files = vec!["object/not-there-yet.png".into()];
        let kept = with_complete_lights(&named, named.clone());
        assert_eq!(kept, named);
        // Of photos that are new, those of a light in one of two colours wait.
        let mut arrived = demo.clone();
        arrived.shots.retain(|shot| shot.light.as_deref() != Some("top") || shot.colour.as_deref() != Some("green"));
        let mut before = demo.clone();
        before.shots.clear();
        before.lights.clear();
        let next = with_complete_lights(&before, arrived);
        assert!(next.light_index("top").is_none() && next.light_index("left").is_some());
    }
}
