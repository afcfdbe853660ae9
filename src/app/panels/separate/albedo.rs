//! beta of every colour: measured, or typed here.

use eframe::egui::{Grid, RichText, Ui};
use firstbounce_capture::set::Number;

use crate::app::state::document::Document;
use crate::app::state::session::Session;
use crate::app::widgets::number_field::fixed;
use crate::app::widgets::theme::Weight;

pub fn ui(ui: &mut Ui, document: &Document, session: &mut Session) {
    let set = &document.set;
    let Some(beta) = session.results.rig(document).beta else { return };
    if set.colours.len() < 2 || beta.len() != set.colours.len() {
        return;
    }
    ui.add_space(4.0);
    let reference = &set.colours[0].name;
    ui.label(RichText::new(format!("beta: albedo over that in {reference}")).semi_bold());
    let measured = session.results.measured();
    let measured = measured.as_deref().and_then(|measured| measured.calibrated.beta.clone());
    Grid::new("beta").num_columns(3).show(ui, |ui| {
        for (c, colour) in set.colours.iter().enumerate().skip(1) {
            let label = ui.label(format!("beta of {}", colour.name));
            let mut value = beta[c];
            let field = fixed(&mut value, 4, Number::Beta.range()).speed(0.002);
            if ui.add(field).labelled_by(label.id).changed() {
                let mut typed = beta.clone();
                typed[c] = value;
                session.edit(&format!("Type beta of {}", colour.name), |document| {
                    document.set.calibration.beta = Some(typed);
                });
            }
            let words = measured.as_ref().and_then(|measured| measured.get(c)).map(|known| match known.interval {
                Some([low, high]) => format!("measured {:.4} \u{b1} {:.4}", known.value, (high - low) / 2.0),
                None => format!("measured {:.4}", known.value),
            });
            ui.label(RichText::new(words.unwrap_or_else(|| "not measured".into())).weak());
            ui.end_row();
        }
    });
    if set.calibration.beta.is_some() && measured.is_some() && ui.button("Use the measured beta").clicked() {
        session.edit("Use the measured beta", |document| document.set.calibration.beta = None);
    }
}
