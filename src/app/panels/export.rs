//! Files: the results as the command line writes them.

use std::path::{Path, PathBuf};

use eframe::egui::{CollapsingHeader, DragValue, OpenUrl, RichText, Role, Ui, WidgetInfo};
use firstbounce_capture::export::{OutputOptions, stage_results, write_solved};
use firstbounce_capture::image_file::{GreenAxis, GreyBits};
use firstbounce_capture::mesh_file::{Axes, OutputFormat};
use firstbounce_capture::pipeline::camera_of;
use firstbounce_capture::report::Report;
use firstbounce_core::mesh::decimate::DecimateOptions;

use super::Panel;
use crate::app::base::dialogs::Choose;
use crate::app::base::keyed::Keyed;
use crate::app::state::document::Document;
use crate::app::state::results::{StageState, SurfaceName, last_stage_of};
use crate::app::state::session::Session;
use crate::app::widgets::advice::{advice, sentence};
use crate::app::widgets::part::part;
use crate::app::widgets::path_field::PathField;
use crate::app::widgets::theme::{Weight, primary};

/// The panel.
#[derive(Default)]
pub struct Export {
    folder: PathField,
    /// What was chosen last.
    surface: Option<SurfaceName>,
    /// What the triangles were limited to before they were not.
    triangles: DecimateOptions,
    written: Keyed<PathBuf, Report>,
}

impl Panel for Export {
    fn ui(&mut self, ui: &mut Ui, session: &mut Session) {
        let document = session.document();
        let dialogs = session.dialogs();
        self.folder.ui(ui, "Folder for the results", Choose::Folder, &dialogs, &mut session.jobs);
        let mut options = document.settings.export.clone();
        part(ui, "meshes", |ui| self.meshes(ui, &mut options, &document, full_triangles(session)));
        part(ui, "pictures", |ui| pictures(ui, &mut options));
        part(ui, "lights", |ui| lights(ui, &mut options, &document));
        if options != document.settings.export {
            session.edit("Choose what to export", |document| document.settings.export = options);
        }
        part(ui, "surface", |ui| self.surface(ui, session, &document));
        part(ui, "state", |ui| state(ui, session, self.chosen(session, &document)));
        self.take_written(session);
        if let Some((folder, Ok(report))) = self.written.last() {
            contents(ui, folder, report);
        }
    }

    fn primary_action(&mut self, ui: &mut Ui, session: &mut Session) -> bool {
        let document = session.document();
        if self.folder.text.is_empty() {
            self.folder.text = document.set.folder.join("out").display().to_string();
        }
        let name = self.chosen(session, &document);
        let is_ready = session.results.state(last_stage_of(name), &document) == StageState::Ready;
        let can_write = is_ready && self.written.running().is_none() && !self.folder.text.trim().is_empty();
        let asked = std::mem::take(&mut session.export_asked) && can_write;
        let button = ui.add_enabled(can_write, primary(ui.visuals(), "Write all results"));
        if (asked || button.clicked())
            && let Some(finished) = session.results.finished(name, &document)
        {
            let folder = PathBuf::from(self.folder.text.trim());
            let (set, target, options) = (document.set.clone(), folder.clone(), document.settings.export.clone());
            let task = session.jobs.start("Write results", move |job| {
                let output = stage_results(&set, &target)?;
                write_solved(&set, &finished, output, &options, job)
            });
            self.written.start(folder, task);
        }
        true
    }
}

/// Why nothing can be written yet.
fn state(ui: &mut Ui, session: &Session, name: SurfaceName) {
    match session.results.state(last_stage_of(name), &session.document()) {
        StageState::Ready => {}
        StageState::Stale | StageState::Running { .. } => advice(ui, "The results are being computed."),
        StageState::Failed { line } | StageState::Blocked { line } | StageState::Cancelled { line } => {
            ui.colored_label(ui.visuals().error_fg_color, line);
        }
    }
}

/// Triangles of the mesh as it is, once there is one.
fn full_triangles(session: &Session) -> Option<usize> {
    session.results.meshes().map(|meshes| meshes.after.triangles.len())
}

fn heading(ui: &mut Ui, text: &str) {
    ui.add_space(6.0);
    ui.label(RichText::new(text).semi_bold());
}

impl Export {
    fn meshes(&mut self, ui: &mut Ui, options: &mut OutputOptions, document: &Document, full: Option<usize>) {
        heading(ui, "Meshes, before and after");
        let unit = camera_of(&document.set, (1, 1)).unit();
        for format in OutputFormat::ALL {
            let mut wanted = options.writes(format);
            if ui
                .checkbox(&mut wanted, format!("{format} (.{}), in {}", format.extension(), format.unit(unit)))
                .changed()
            {
                // In one order, however they were ticked.
                let chosen = |other: &OutputFormat| if *other == format { wanted } else { options.writes(*other) };
                options.formats = OutputFormat::ALL.into_iter().filter(chosen).collect();
            }
            ui.indent(format, |ui| ui.label(RichText::new(format.purpose()).small().weak()));
        }
        ui.add_space(4.0);
        ui.label("Axes of OBJ, PLY and STL");
        for (axes, name) in [(Axes::YUp, "y up"), (Axes::ZUp, "z up")] {
            ui.radio_value(&mut options.axes, axes, format!("{name}: {}", axes.words()));
        }
        ui.label(RichText::new(format!("glTF always has {}, as its standard says.", Axes::YUp.words())).small().weak());
        ui.add_space(4.0);
        ui.label("Albedo in OBJ and glTF");
        ui.radio_value(&mut options.texture, Some(GreyBits::Eight), "Texture of 8 bits, which every program reads");
        ui.radio_value(&mut options.texture, Some(GreyBits::Sixteen), "Texture of 16 bits in OBJ (glTF keeps 8)");
        ui.radio_value(&mut options.texture, None, "Colours at the vertices");
        ui.add_space(4.0);
        self.decimation(ui, options, full);
    }

    fn decimation(&mut self, ui: &mut Ui, options: &mut OutputOptions, full: Option<usize>) {
        let mut limited = options.triangles.is_some();
        self.triangles.triangles = options.triangles.unwrap_or(self.triangles.triangles);
        ui.horizontal_wrapped(|ui| {
            ui.checkbox(&mut limited, "At most this many triangles:");
            let field = DragValue::new(&mut self.triangles.triangles).range(4..=usize::MAX).speed(500.0);
            let response = ui.add_enabled(limited, field);
            response.widget_info(|| WidgetInfo::labeled(Role::SpinButton, limited, "Most triangles of a mesh"));
        });
        options.triangles = limited.then_some(self.triangles.triangles);
        let all = full.map_or(String::new(), |full| format!("All are {full}. "));
        let line =
            format!("{all}Fewer load faster; how far the full mesh lies from what is left is measured and reported.");
        ui.indent("decimation", |ui| ui.label(RichText::new(line).small().weak()));
    }

    /// Which surface is written.
    fn chosen(&self, session: &Session, document: &Document) -> SurfaceName {
        let is_offered = |name: &SurfaceName| session.results.surfaces(document).contains(name);
        self.surface.filter(is_offered).unwrap_or(SurfaceName::After)
    }

    /// A choice only where there is one.
    fn surface(&mut self, ui: &mut Ui, session: &Session, document: &Document) {
        self.surface = Some(self.chosen(session, document));
        let offered = session.results.surfaces(document);
        if offered.len() > 1 {
            ui.label("Surface to write");
            for name in offered {
                let title = name.other_method().unwrap_or(document.method()).title();
                ui.radio_value(&mut self.surface, Some(name), sentence(title));
            }
        }
        ui.label(
            RichText::new("Bounces, normals, albedo, noise and depth as EXR, and the report, are always written.")
                .small()
                .weak(),
        );
    }

    fn take_written(&mut self, session: &mut Session) {
        if self.written.poll().is_none() {
            return;
        }
        match self.written.last() {
            Some((folder, Ok(report))) => {
                session.done(format!("Wrote {} files into {}", report.files.len(), folder.display()));
            }
            Some((_, Err(error))) => session.error(error.to_string()),
            None => {}
        }
    }
}

/// What the system opens with its program for such a file.
fn file_url(path: &Path) -> String {
    let path = path.display().to_string().replace('\\', "/");
    let kept = |byte: u8| byte.is_ascii_alphanumeric() || b"/._-~:".contains(&byte);
    let coded = path.bytes().map(|byte| if kept(byte) { char::from(byte).to_string() } else { format!("%{byte:02X}") });
    let coded: String = coded.collect();
    if coded.starts_with('/') { format!("file://{coded}") } else { format!("file:///{coded}") }
}

fn pictures(ui: &mut Ui, options: &mut OutputOptions) {
    heading(ui, "Pictures");
    ui.label("Direction of green in normals.png");
    ui.radio_value(&mut options.green, GreenAxis::Up, "Up, as OpenGL reads it");
    ui.radio_value(&mut options.green, GreenAxis::Down, "Down, as DirectX reads it");
    ui.checkbox(&mut options.depth_png, "Depth as a 16-bit PNG too");
    let line = "For programs that read no EXR; offset and scale are in the file and in the report.";
    ui.indent("depth", |ui| ui.label(RichText::new(line).small().weak()));
}

fn lights(ui: &mut Ui, options: &mut OutputOptions, document: &Document) {
    heading(ui, "Lights");
    let reference = document.set.colours.first().map_or("reference", |colour| colour.name.as_str());
    ui.label(format!(
        "lights.lp: the directions to the lights of the {reference} photos, for RelightLab and RTI tools."
    ));
    if document.set.colours.len() > 1 {
        ui.checkbox(&mut options.lights_per_colour, "A light file for each other colour too");
    }
}

fn contents(ui: &mut Ui, folder: &Path, report: &Report) {
    ui.separator();
    ui.label(RichText::new(format!("Written into {}", folder.display())).semi_bold());
    ui.horizontal_wrapped(|ui| {
        for (text, path) in [("Open report", folder.join("report.html")), ("Open folder", folder.to_owned())] {
            if ui.button(text).clicked() {
                let path = std::path::absolute(&path).unwrap_or(path);
                ui.ctx().open_url(OpenUrl::new_tab(file_url(&path)));
            }
        }
        if ui.button("Copy path").clicked() {
            ui.copy_text(folder.display().to_string());
        }
    });
    for line in report.export.decimation_lines() {
        ui.label(line);
    }
    ui.label(format!("Normals: {}", report.conventions.normals));
    ui.label(format!("Unit of depth: {}", report.conventions.unit));
    CollapsingHeader::new(format!("{} files", report.files.len())).default_open(true).show(ui, |ui| {
        for (name, what) in &report.files {
            ui.label(format!("{name}: {what}"));
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_address_of_a_file_names_spaces_and_letters_beyond_ascii_by_their_bytes() {
        assert_eq!(file_url(Path::new("/a b/\u{fc}#1/report.html")), "file:///a%20b/%C3%BC%231/report.html");
    }
}
