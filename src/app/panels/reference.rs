//! The reference scan: loading it, registration the surface onto it, and how far the two are apart.

use eframe::egui::{Button, ComboBox, Grid, ProgressBar, RichText, Role, Ui, WidgetInfo};
use egui_plot::{Line, Plot, Points};
use firstbounce_capture::mesh_file::read::LengthScale;
use firstbounce_capture::pipeline::Compared;
use firstbounce_core::mesh::compare::{Comparison, Start};

use crate::app::base::bars::Bars;
use crate::app::base::dialogs::Choose;
use crate::app::state::document::{Document, ReferenceSource};
use crate::app::state::reference::{How, Outcome};
use crate::app::state::session::Session;
use crate::app::widgets::advice::advice;
use crate::app::widgets::bars::chart;
use crate::app::widgets::part::part;
use crate::app::widgets::path_field::PathField;
use crate::app::widgets::theme::Weight;

const HEIGHT: f32 = 130.0;

/// The part of the Shape step.
#[derive(Default)]
pub struct ReferencePanel {
    path: PathField,
    unit: LengthScale,
}

impl ReferencePanel {
    /// Shows all of it.
    pub fn ui(&mut self, ui: &mut Ui, session: &mut Session, document: &Document) {
        ui.separator();
        ui.label(RichText::new("Reference scan").semi_bold());
        self.choose(ui, session, document);
        part(ui, "reference state", |ui| state(ui, session));
        if session.reference.mesh().is_none() {
            return;
        }
        part(ui, "align", |ui| align(ui, session, document));
        part(ui, "numbers", |ui| numbers(ui, session, document));
    }

    fn choose(&mut self, ui: &mut Ui, session: &mut Session, document: &Document) {
        let before = self.unit;
        ComboBox::from_label("Unit of the reference file").selected_text(self.unit.name()).show_ui(ui, |ui| {
            for unit in LengthScale::ALL {
                ui.selectable_value(&mut self.unit, unit, unit.name());
            }
        });
        if before != self.unit
            && let Some(reference) = &document.settings.reference
            && matches!(reference.source, ReferenceSource::File(_))
        {
            session.load_reference(reference.source.clone(), self.unit);
        }
        let dialogs = session.dialogs();
        let chosen = self.path.ui(ui, "Reference file (OBJ, PLY, STL)", Choose::Mesh, &dialogs, &mut session.jobs);
        let mut path = chosen.into_iter().next();
        ui.horizontal_wrapped(|ui| {
            let typed = self.path.text.trim();
            if ui.add_enabled(!typed.is_empty(), Button::new("Load reference")).clicked() {
                path = Some(typed.into());
            }
            if document.set.truth_depth().is_file() && ui.button("Use this set's own truth").clicked() {
                session.load_reference(ReferenceSource::Truth, LengthScale::Millimetre);
            }
            if document.settings.reference.is_some() && ui.button("Remove reference").clicked() {
                session.edit("Remove the reference", |document| document.settings.reference = None);
            }
        });
        if let Some(path) = path {
            let path = std::path::absolute(&path).unwrap_or(path);
            session.load_reference(ReferenceSource::File(path), self.unit);
        }
    }
}

fn state(ui: &mut Ui, session: &Session) {
    match session.reference.loaded() {
        None if session.reference.is_loading() => advice(ui, "The reference is being read."),
        None => advice(ui, "Load a scan of the object to see how far the surface is from it."),
        Some(Err(error)) => {
            ui.colored_label(ui.visuals().error_fg_color, error.to_string());
        }
        Some(Ok(loaded)) => {
            ui.label(&loaded.words);
            for warning in &loaded.warnings {
                ui.colored_label(ui.visuals().warn_fg_color, warning);
            }
        }
    }
}

fn align(ui: &mut Ui, session: &mut Session, document: &Document) {
    let is_aligned = document.settings.reference.as_ref().is_some_and(|reference| reference.poses.is_some());
    let is_free = session.reference.comparing().is_none();
    ui.add_enabled_ui(is_free, |ui| {
        ui.horizontal_wrapped(|ui| {
            let automatic = ui.button("Align automatically");
            let hover =
                "From the camera's frame, by iterative closest point; for scans that lie almost where the object does";
            if automatic.on_hover_text(hover).clicked() {
                session.compare_with_reference(How::Align(Start::CameraFrame));
            }
            let picking = session.reference.pairs.is_some();
            let pick = ui.selectable_label(picking, "Pick three pairs of points");
            if pick.on_hover_text("For scans that lie anywhere: the same places on surface and scan").clicked() {
                if picking { session.reference.pairs = None } else { session.pick_pairs() }
            }
            let enough = session.reference.pairs.as_ref().is_some_and(|pairs| pairs.is_enough());
            if ui.add_enabled(enough, Button::new("Align from the pairs")).clicked() {
                session.align_from_pairs();
            }
            if ui.button("Compare without alignment").on_hover_text("Distances in the frames of the files").clicked() {
                session.compare_with_reference(How::AsTheyLie);
            }
            if is_aligned && ui.button("Remove the alignment").clicked() {
                session.edit("Remove the alignment", |document| {
                    if let Some(reference) = &mut document.settings.reference {
                        reference.poses = None;
                    }
                });
            }
        });
    });
    if let Some(pairs) = &session.reference.pairs {
        ui.label(pairs.words());
    }
    if let Some(job) = session.reference.comparing() {
        ui.horizontal(|ui| {
            ui.add(ProgressBar::new(job.fraction()).desired_width(180.0).text(job.name()));
            if ui.button("Cancel comparison").clicked() {
                job.cancel();
            }
        });
    }
}

fn numbers(ui: &mut Ui, session: &mut Session, document: &Document) {
    let meshes = session.results.current_meshes(document);
    let is_current = session.reference.is_current(document, meshes.as_ref());
    let Some(compared) = session.reference.compared() else {
        if session.reference.comparing().is_none() {
            advice(ui, "Align, or compare without alignment, to see distances.");
        }
        return;
    };
    let outcome = match compared {
        Ok(outcome) => outcome.clone(),
        Err(error) => {
            ui.colored_label(ui.visuals().error_fg_color, error.to_string());
            return;
        }
    };
    if !is_current {
        ui.colored_label(ui.visuals().warn_fg_color, "Surface or alignment changed since: compare again.");
    }
    let warnings = outcome.after.warnings.iter();
    warnings.for_each(|warning| {
        ui.colored_label(ui.visuals().warn_fg_color, warning);
    });
    table(ui, &outcome);
    if let Err(line) = &outcome.before {
        ui.colored_label(ui.visuals().warn_fg_color, format!("Before: {line}"));
    }
    if ui.button("Show the heat map").clicked() {
        session.show_heat_map();
    }
    histogram(ui, &outcome.bars, outcome.after.comparison.bias_mm);
    if let Some(alignment) = &outcome.after.alignment {
        iterations(ui, &alignment.iterations.iter().map(|step| step.rms_mm).collect::<Vec<_>>());
    }
}

type Row = (&'static str, fn(&Comparison) -> String);

/// In the words and with the digits of `firstbounce compare`.
const ROWS: &[Row] = &[
    ("Mean distance", |c| format!("{:.4} mm", c.mean_mm)),
    ("Mean signed distance", |c| format!("{:.4} mm", c.bias_mm)),
    ("Rms distance", |c| format!("{:.4} mm", c.rms_mm)),
    ("95th percentile of the distance", |c| format!("{:.4} mm", c.p95_mm)),
    ("Largest distance", |c| format!("{:.4} mm", c.max_mm)),
    ("Overlap", |c| format!("{:.1} %", 100.0 * c.overlap)),
    ("Mean orientation error", |c| format!("{:.2} degrees", c.orientation_error_deg)),
    ("Rotation", |c| format!("{:.3} degrees", c.rotation_deg)),
    ("Translation along x", |c| format!("{:.4} mm", c.translation_mm.x)),
    ("Translation along y", |c| format!("{:.4} mm", c.translation_mm.y)),
    ("Translation along z", |c| format!("{:.4} mm", c.translation_mm.z)),
];

fn table(ui: &mut Ui, outcome: &Outcome) {
    let before = outcome.before.as_ref().ok().map(|compared: &Compared| &compared.comparison);
    Grid::new("reference numbers").num_columns(3).striped(true).show(ui, |ui| {
        for heading in ["", "before", "after"] {
            ui.label(RichText::new(heading).semi_bold());
        }
        ui.end_row();
        for (what, value) in ROWS {
            ui.label(*what);
            ui.monospace(before.map_or_else(|| "-".into(), value));
            ui.monospace(value(&outcome.after.comparison));
            ui.end_row();
        }
    });
    if ui.button("Copy the numbers").clicked() {
        let line = |(what, value): &Row| {
            let before = before.map_or_else(|| "-".into(), value);
            format!("{what}\t{before}\t{}\n", value(&outcome.after.comparison))
        };
        ui.copy_text(format!("\tbefore\tafter\n{}", ROWS.iter().map(line).collect::<String>()));
    }
}

fn histogram(ui: &mut Ui, bars: &Bars, bias_mm: f64) {
    let plot = Plot::new("distances").height(HEIGHT).allow_drag(false).allow_zoom(false).allow_scroll(false);
    let plot = plot.allow_boxed_zoom(false).x_axis_label("signed distance, mm").y_axis_label("vertices");
    let shown = plot.show(ui, |plot| plot.bar_chart(chart(bars, "vertices")));
    let [low, high] = bars.range();
    let words =
        format!("Histogram of the distances of the surface after from {low:.3} to {high:.3} mm, mean {bias_mm:.4} mm");
    shown.response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &words));
}

fn iterations(ui: &mut Ui, rms_mm: &[f64]) {
    let points = || (1..).zip(rms_mm).map(|(step, rms)| [f64::from(step), *rms]).collect::<Vec<_>>();
    let plot = Plot::new("icp").height(HEIGHT).allow_drag(false).allow_zoom(false).allow_scroll(false);
    let plot = plot.allow_boxed_zoom(false).x_axis_label("iteration").y_axis_label("rms, mm").include_y(0.0);
    let shown = plot.show(ui, |plot| {
        plot.line(Line::new("rms", points()).width(1.5));
        plot.points(Points::new("rms", points()).radius(2.5));
    });
    let last = rms_mm.last().copied().unwrap_or_default();
    let words = format!("Rms of the {} iterations of the alignment, {last:.4} mm at the end", rms_mm.len());
    shown.response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &words));
    ui.label(words);
}
