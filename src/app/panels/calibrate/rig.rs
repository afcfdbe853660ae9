//! One rig for many objects: takes over the calibration of another set, or the directions of a light file.

use std::path::{Path, PathBuf};

use eframe::egui::Ui;
use firstbounce_capture::CaptureSet;
use firstbounce_capture::light_file::LightFile;
use firstbounce_capture::pipeline::{MemoryOptions, PipelineError, Preference, Work, calibrate, check_memory};
use firstbounce_capture::set::Calibration;

use crate::app::base::dialogs::Choose;
use crate::app::base::keyed::Keyed;
use crate::app::state::session::Session;
use crate::app::widgets::path_field::PathField;

/// The other set, and what came of it.
#[derive(Default)]
pub struct OtherRig {
    path: PathField,
    same_paint: bool,
    reading: Keyed<(), (CaptureSet, Calibration)>,
    report: Vec<String>,
}

/// A light file, and what came of it.
#[derive(Default)]
pub struct OtherLights {
    path: PathField,
    reading: Keyed<PathBuf, LightFile>,
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
            let task = session.jobs.start("Calibrate the other set", move |job| {
                let set = CaptureSet::open(path)?;
                check_memory(&set, Work::Calibrate, &MemoryOptions::default())?;
                let calibrated = calibrate(&set, Preference::File, job)?;
                let values = calibrated.values(&set);
                Ok::<_, PipelineError>((set, values))
            });
            self.reading.start((), task);
        }
        match self.reading.take() {
            Some((_, Ok(read))) => self.take_over(session, &read.0, &read.1),
            Some((_, Err(error))) => session.error(error.to_string()),
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
            "Directions of a light file (.lp, .dome) of RTI tools, by the names of its photos or else in the order of its lines. \
             They count as typed values.",
        );
        let dialogs = session.dialogs();
        let chosen = self.path.ui(ui, "Light file", Choose::LightFile, &dialogs, &mut session.jobs);
        let typed = self.path.text.trim().to_owned();
        let pressed = ui.add_enabled(!typed.is_empty(), eframe::egui::Button::new("Use its directions")).clicked();
        if let Some(path) = chosen.into_iter().next().or(pressed.then(|| typed.into())) {
            let from = path.clone();
            self.reading.start(path, session.jobs.start("Read the light file", move |_| LightFile::read(&from)));
        }
        match self.reading.take() {
            Some((path, Ok(file))) => self.take_over(session, &path, &file),
            Some((_, Err(error))) => session.error(error.to_string()),
            None => {}
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
