//! Which photo is which: subject, light and colour of every file, how well each is exposed, and the object's mask.

mod camera;
mod in_order;
mod incoming;
mod mask;
mod names;
mod questions;
mod scale;
mod shot;
mod table;
mod thumbnails;
mod watching;

use std::path::PathBuf;

use eframe::egui::{Frame, RichText, Ui};
use firstbounce_capture::image_file::{Format, MAX_LOOKED_AT, MAX_PICTURES, pictures_in};
use firstbounce_capture::set::Location;

use incoming::Incoming;
use thiserror::Error;

use super::Panel;
use crate::app::base::dialogs::Choose;
use crate::app::base::drops;
use crate::app::base::jobs::Task;
use crate::app::state::layout::Shown;
use crate::app::state::results::{ShotName, StageState, Step};
use crate::app::state::session::Session;
use crate::app::views::Over;
use crate::app::widgets::advice::advice;
use crate::app::widgets::part::part;
use crate::app::widgets::path_field::PathField;
use crate::app::widgets::theme::Weight;

/// The panel.
#[derive(Default)]
pub struct Captures {
    add: PathField,
    /// Searches for pictures in what was dropped.
    searches: Vec<Task<Found>>,
    incoming: Option<Incoming>,
    table: table::Table,
    camera: camera::CameraPart,
    mask: mask::MaskPart,
    selected: Option<ShotName>,
    watching: watching::Watching,
}

/// A search that the user stopped.
#[derive(Debug, Error)]
#[error("the search for pictures was cancelled")]
struct SearchCancelled;

/// What a search found.
struct Found {
    pictures: Incoming,
    /// Files that were named and are none.
    others: Vec<PathBuf>,
    is_cut_off: bool,
}

impl Panel for Captures {
    fn ui(&mut self, ui: &mut Ui, session: &mut Session) {
        self.take_found(session);
        let document = session.document();
        if !document.set.shots.is_empty() || session.editor.path().is_file() {
            part(ui, "problems", |ui| problems(ui, session));
        }
        part(ui, "add", |ui| self.add_files(ui, session));
        part(ui, "watch", |ui| self.watching.ui(ui, session));
        if document.set.shots.is_empty() {
            if self.incoming.is_some() || !self.searches.is_empty() {
                return;
            }
            advice(
                ui,
                "This set has no photos yet. Name files or a folder above: photos of the \
                 object under every lamp in every colour, and the same of a grey ball and a ball of the object's paint, \
                 and one of a mirror ball under every lamp.",
            );
            return;
        }
        part(ui, "camera", |ui| self.camera.ui(ui, session));
        part(ui, "names", |ui| names::ui(ui, session));
        part(ui, "mask", |ui| ui.collapsing("Mask", |ui| self.mask.ui(ui, session)));
        part(ui, "chosen photo", |ui| {
            if let Some(name) = self.selected.clone() {
                shot::ui(ui, session, &name, &mut self.selected);
            }
        });
        part(ui, "warnings", |ui| warnings(ui, session));
    }

    fn primary_action(&mut self, ui: &mut Ui, session: &mut Session) -> bool {
        let Some(incoming) = &mut self.incoming else { return false };
        if incoming.buttons(ui, session) {
            self.incoming = None;
        }
        true
    }

    fn overlay(&mut self, ui: &mut Ui, over: &Over<'_>, session: &mut Session) {
        self.mask.overlay(ui, over, session);
        self.camera.overlay(ui, over);
    }

    fn wants_drag(&self, shown: &Shown, _: &Session) -> bool {
        self.mask.wants_drag(shown) || self.camera.wants_drag(shown)
    }
}

impl Captures {
    /// Takes photos that arrived in the folder that is watched. Once a frame.
    pub fn update(&mut self, session: &mut Session) {
        let open = self.watching.update(session);
        if !open.is_empty() {
            self.put(Incoming::new(open));
        }
        if let Some(incoming) = &mut self.incoming {
            incoming.update(&session.document().set);
        }
    }

    /// The files that are to be added, in place of the tiles; whether there are any.
    pub fn table_of_incoming(&mut self, ui: &mut Ui, session: &mut Session) -> bool {
        let Some(incoming) = &mut self.incoming else { return false };
        Frame::new().inner_margin(8.0).show(ui, |ui| incoming.table(ui, session));
        true
    }

    /// Every photo of the set, in a tile of its own.
    pub fn photos(&mut self, ui: &mut Ui, session: &mut Session) {
        self.table.ui(ui, session, &mut self.selected);
    }

    /// Files and folders that were dropped on the window, or chosen in a dialog: the pictures in them are looked for off this
    /// thread, for a folder may be a whole disk.
    pub fn dropped(&mut self, paths: Vec<PathBuf>, session: &mut Session) {
        self.searches.push(session.jobs.start("Look for pictures", move |job| {
            let found = pictures_in(&paths, job).ok_or(SearchCancelled)?;
            let (pictures, others) = found.files.into_iter().partition(|file| Format::of_name(file).is_some());
            Ok::<_, SearchCancelled>(Found { pictures: Incoming::new(pictures), others, is_cut_off: found.is_cut_off })
        }));
    }

    fn take_found(&mut self, session: &mut Session) {
        let ended: Vec<_> = self.searches.iter().map(Task::poll).collect();
        let mut is_open = ended.iter().map(Option::is_none);
        self.searches.retain(|_| is_open.next().unwrap_or_default());
        for outcome in ended.into_iter().flatten() {
            match outcome {
                Ok(found) => self.take(found, session),
                Err(error) => session.error(error.to_string()),
            }
        }
    }

    fn take(&mut self, found: Found, session: &mut Session) {
        let read = format!("{} files are read", Format::names());
        if found.is_cut_off {
            session.warn(format!(
                "There are more than {MAX_PICTURES} pictures, or more than {MAX_LOOKED_AT} files and folders, in what was \
                 dropped; the others are left out: drop less at a time"
            ));
        }
        if found.pictures.is_empty() {
            session.warn(format!("There is no picture in what was dropped: {read}"));
            return;
        }
        if let Some(first) = found.others.first() {
            let count = found.others.len();
            let more = if count > 1 { format!(" and {} more", count - 1) } else { String::new() };
            session.warn(format!("{}{more}: left out, {read}", first.display()));
        }
        self.put(found.pictures);
    }

    fn put(&mut self, pictures: Incoming) {
        match &mut self.incoming {
            Some(incoming) => incoming.take_more(pictures),
            None => self.incoming = Some(pictures),
        }
    }

    fn add_files(&mut self, ui: &mut Ui, session: &mut Session) {
        if let Some(incoming) = &mut self.incoming {
            incoming.ui(ui, session);
            ui.separator();
            return;
        }
        let dialogs = session.dialogs();
        let label = format!("Add photos, or a folder of them ({})", drops::words("them"));
        let chosen = self.add.ui(ui, &label, Choose::Pictures, &dialogs, &mut session.jobs);
        if !chosen.is_empty() {
            self.dropped(chosen, session);
        }
        ui.separator();
    }
}

/// What is wrong with the captures, the worst first.
fn warnings(ui: &mut Ui, session: &Session) {
    let captures = session.results.captures(&session.document());
    if captures.warnings.is_empty() {
        return;
    }
    ui.separator();
    ui.label(RichText::new("Capture warnings").semi_bold());
    for (place, line) in (1..).zip(captures.lines()) {
        ui.label(RichText::new(format!("{place}. {line}")).color(ui.visuals().warn_fg_color));
    }
}

/// Problems of the set that belong to no cell of the tables.
fn problems(ui: &mut Ui, session: &Session) {
    let document = session.document();
    let in_cells = |location| matches!(location, Location::Shot(_));
    for problem in session.problems().iter().filter(|problem| !in_cells(problem.location)) {
        ui.label(RichText::new(problem.to_string()).color(ui.visuals().error_fg_color));
    }
    if let StageState::Failed { line } = session.results.state(Step::Load, &document) {
        ui.label(RichText::new(line).color(ui.visuals().error_fg_color));
    }
}
