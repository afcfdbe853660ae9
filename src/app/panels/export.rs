//! Files: the results as the command line writes them.

use std::path::PathBuf;

use eframe::egui::{Button, RichText, Ui};
use firstbounce_capture::image_file::GreenAxis;
use firstbounce_capture::pipeline::{OutputOptions, write_solved};
use firstbounce_capture::report::Report;

use super::Panel;
use crate::app::dialogs::Choose;
use crate::app::jobs::Task;
use crate::app::path_field::PathField;
use crate::app::results::{StageState, Step};
use crate::app::session::Session;
use crate::app::window::advice;

/// The panel.
#[derive(Default)]
pub struct Export {
    folder: PathField,
    green_down: bool,
    writing: Option<(PathBuf, Task<Report>)>,
    written: Option<(PathBuf, Report)>,
}

impl Panel for Export {
    fn ui(&mut self, ui: &mut Ui, session: &mut Session) {
        let document = session.document();
        if self.folder.text.is_empty() {
            self.folder.text = document.set.folder.join("out").display().to_string();
        }
        let dialogs = session.dialogs();
        self.folder.ui(ui, "Folder for the results", Choose::Folder, &dialogs, &mut session.jobs);
        ui.label("Direction of green in normals.png");
        ui.radio_value(&mut self.green_down, false, "Up, as OpenGL reads it");
        ui.radio_value(&mut self.green_down, true, "Down, as DirectX reads it");
        ui.label("Meshes: OBJ and PLY, x right, y up, z toward the camera, in mm where the camera's scale is known, else in pixels.");
        ui.add_space(6.0);
        self.button(ui, session);
        self.take_written(session);
        if let Some((folder, report)) = &self.written {
            contents(ui, folder, report);
        }
    }
}

impl Export {
    fn button(&mut self, ui: &mut Ui, session: &mut Session) {
        let document = session.document();
        let state = session.results.state(Step::Mesh, &document);
        let can_write = state == StageState::Ready && self.writing.is_none() && !self.folder.text.trim().is_empty();
        if ui.add_enabled(can_write, Button::new("Write all results")).clicked()
            && let Some(finished) = session.results.finished()
        {
            let folder = PathBuf::from(self.folder.text.trim());
            let green = if self.green_down { GreenAxis::Down } else { GreenAxis::Up };
            let (set, target) = (document.set.clone(), folder.clone());
            let task = session.jobs.start("Write results", move |job| {
                let mut solved = finished.solved()?;
                write_solved(&set, &mut solved, &target, OutputOptions { green }, job)
                    .map_err(|error| error.to_string())
            });
            self.writing = Some((folder, task));
        }
        match state {
            StageState::Ready => {}
            StageState::Stale | StageState::Running { .. } => advice(ui, "The results are being computed."),
            StageState::Failed { line } | StageState::Blocked { line } => {
                ui.colored_label(ui.visuals().error_fg_color, line);
            }
        }
    }

    fn take_written(&mut self, session: &mut Session) {
        let Some((folder, task)) = &self.writing else { return };
        let Some(outcome) = task.poll() else { return };
        match outcome {
            Ok(report) => {
                session.done(format!("Wrote {} files into {}", report.files.len(), folder.display()));
                self.written = Some((folder.clone(), report));
            }
            Err(line) => session.error(line),
        }
        self.writing = None;
    }
}

fn contents(ui: &mut Ui, folder: &std::path::Path, report: &Report) {
    ui.separator();
    ui.label(RichText::new(format!("Written into {}", folder.display())).strong());
    ui.label(format!("Normals: {}", report.conventions.normals));
    ui.label(format!("Unit of depth and mesh: {}", report.conventions.unit));
    for (name, what) in &report.files {
        ui.label(format!("{name}: {what}"));
    }
}
