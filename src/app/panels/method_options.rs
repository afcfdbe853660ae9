//! The numbers that a method needs beside the photos: for the panel that chooses the method in force, and the one that compares.

use eframe::egui::{DragValue, Grid, Ui};
use firstbounce_capture::pipeline::Method;
use firstbounce_capture::set::Number;

use crate::app::state::document::{Document, NayarSettings};
use crate::app::state::session::Session;

/// Nothing for a method without numbers of its own.
pub fn ui(ui: &mut Ui, session: &mut Session, document: &Document, method: Method) {
    let needs_albedo = method.needs().absolute_albedo || method.compares_albedo();
    if !needs_albedo && method != Method::Shape {
        return;
    }
    let mut settings = document.settings.nayar.clone();
    let mut changed = None;
    Grid::new("nayar options").num_columns(2).show(ui, |ui| {
        if needs_albedo {
            grey_albedo(ui, session, document);
        }
        if method != Method::Shape {
            return;
        }
        let mut whole = |ui: &mut Ui, label: &str, hover: &str, value: &mut usize, range, speed| {
            let name = ui.label(label).on_hover_text(hover);
            if ui.add(DragValue::new(value).range(range).speed(speed)).labelled_by(name.id).changed() {
                changed = Some(format!("Change {}", label.to_lowercase()));
            }
            ui.end_row();
        };
        let patches = "About how many pieces of the surface exchange light; time grows with the square";
        whole(ui, "Patches", patches, &mut settings.patches, NayarSettings::PATCHES, 20.0);
        whole(
            ui,
            "Most iterations",
            "When to stop at the latest",
            &mut settings.max_iterations,
            NayarSettings::ITERATIONS,
            0.05,
        );
    });
    if let Some(name) = changed {
        session.edit(&name, |document| document.settings.nayar = settings);
    }
}

/// Makes the paint's albedo absolute; a typed light of white does so without a ball.
fn grey_albedo(ui: &mut Ui, session: &mut Session, document: &Document) {
    let given = document.set.calibration.white_light;
    if let Some(light) = given {
        ui.label("Light of a white facet").on_hover_text("white_light under [calibration] in capture.toml");
        ui.monospace(format!("{light:.4}"));
        ui.end_row();
        return;
    }
    let hover = "The part of the light that the grey ball reflects in the reference colour, as its maker states it: the method \
                 needs to know how bright the paint is in itself";
    let name = ui.label("Albedo of the grey ball").on_hover_text(hover);
    let old = document.set.calibration.grey_albedo;
    let mut albedo = old.unwrap_or(0.0);
    let words = |value: f64, _| if value > 0.0 { format!("{value:.3}") } else { "unknown".into() };
    let field =
        DragValue::new(&mut albedo).range(0.0..=*Number::GreyAlbedo.range().end()).speed(0.002).custom_formatter(words);
    if ui.add(field.custom_parser(|text| text.trim().parse().ok())).labelled_by(name.id).changed() {
        let new = (albedo > 0.0).then(|| albedo.max(*Number::GreyAlbedo.range().start()));
        session.edit("Type albedo of the grey ball", |document| document.set.calibration.grey_albedo = new);
    }
    ui.end_row();
}
