//! One rig for many objects: takes over the calibration of another set, or the directions of a light file.

use std::path::{Path, PathBuf};

use eframe::egui::Ui;
use firstbounce_capture::CaptureSet;
use firstbounce_capture::light_file::LightFile;
use firstbounce_capture::pipeline::{MemoryOptions, Preference, Work, calibrate, check_memory};
use firstbounce_capture::set::Calibration;

use crate::app::dialogs::Choose;
use crate::app::jobs::Task;
use crate::app::path_field::PathField;
use crate::app::session::Session;

/// The other set, and what came of it.
#[derive(Default)]
pub struct OtherRig {
    path: PathField,
    same_paint: bool,
    reading: Option<Task<(CaptureSet, Calibration)>>,
    report: Vec<String>,
}

/// A light file, and what came of it.
#[derive(Default)]
pub struct OtherLights {
    path: PathField,
    reading: Option<Task<(PathBuf, LightFile)>>,
    report: Vec<String>,
}

impl OtherRig {
    pub fn ui(&mut self, ui: &mut Ui, session: &mut Session) {
        ui.label(
            "Alpha, intensities and directions of a set that was photographed with the same lamps, by the names of lights \
             and colours. Its balls are measured if they have to be.",
        );
        ui.checkbox(&mut self.same_paint, "The same paint: beta too");
        let dialogs = session.dialogs();
        let chosen = self.path.ui(ui, "Set whose rig to use", Choose::Folder, &dialogs, &mut session.jobs);
        let typed = self.path.text.trim().to_owned();
        let pressed = ui.add_enabled(!typed.is_empty(), eframe::egui::Button::new("Use its rig")).clicked();
        if let Some(path) = chosen.into_iter().next().or(pressed.then(|| typed.into())) {
            self.reading = Some(session.jobs.start("Calibrate the other set", move |job| {
                let set = CaptureSet::open(path).map_err(|error| error.to_string())?;
                check_memory(&set, Work::Calibrate, &MemoryOptions::default())
                    .map_err(|shortage| shortage.to_string())?;
                let calibrated = calibrate(&set, Preference::File, job).map_err(|error| error.to_string())?;
                let values = calibrated.values(&set);
                Ok((set, values))
            }));
        }
        match self.reading.as_ref().and_then(Task::poll) {
            Some(Ok((other, values))) => {
                self.reading = None;
                self.take_over(session, &other, &values);
            }
            Some(Err(line)) => {
                self.reading = None;
                session.error(line);
            }
            None => {}
        }
        for line in &self.report {
            ui.label(line);
        }
    }

    fn take_over(&mut self, session: &mut Session, other: &CaptureSet, values: &Calibration) {
        let same_paint = self.same_paint;
        let mut lines = Vec::new();
        session.edit(&format!("Use the rig of {}", other.title()), |document| {
            lines = document.set.use_rig(other, values, same_paint).lines();
        });
        session.done(format!("The rig of {}: {}", other.title(), lines.first().map_or("", String::as_str)));
        self.report = lines;
    }
}

impl OtherLights {
    /// Directions that another program measured.
    pub fn ui(&mut self, ui: &mut Ui, session: &mut Session) {
        ui.label(
            "Directions of a light file (.lp) of RTI tools, by the names of its photos or else in the order of its lines. \
             They count as typed values.",
        );
        let dialogs = session.dialogs();
        let chosen = self.path.ui(ui, "Light file", Choose::LightFile, &dialogs, &mut session.jobs);
        let typed = self.path.text.trim().to_owned();
        let pressed = ui.add_enabled(!typed.is_empty(), eframe::egui::Button::new("Use its directions")).clicked();
        if let Some(path) = chosen.into_iter().next().or(pressed.then(|| typed.into())) {
            self.reading = Some(session.jobs.start("Read the light file", move |_| {
                let file = LightFile::read(&path).map_err(|error| error.to_string())?;
                Ok((path, file))
            }));
        }
        if let Some(read) = self.reading.as_ref().and_then(Task::poll) {
            self.reading = None;
            match read {
                Ok((path, file)) => self.take_over(session, &path, &file),
                Err(line) => session.error(line),
            }
        }
        for line in &self.report {
            ui.label(line);
        }
    }

    fn take_over(&mut self, session: &mut Session, path: &Path, file: &LightFile) {
        let mut set = session.document().set.clone();
        match file.put_into(&mut set, path) {
            Ok(carried) => {
                let name = path.file_name().unwrap_or_default().to_string_lossy();
                session.edit(&format!("Use the directions of {name}"), |document| document.set = set);
                self.report = carried.lines();
                session.done(format!("{name}: {}", self.report.first().map_or("", String::as_str)));
            }
            Err(error) => session.error(error.to_string()),
        }
    }
}
