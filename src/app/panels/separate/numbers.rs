//! The evidence of the verdict, as numbers with units.

use crate::app::widgets::theme::Weight;
use eframe::egui::{CollapsingHeader, Grid, RichText, Ui};
use firstbounce_capture::CaptureSet;
use firstbounce_core::trust::{LightTrust, NO_DIRECTION_DEG, Trust};

/// In the place of a percentage of it.
const NEGATIVE: &str = "bounce 1 is negative";

pub fn ui(ui: &mut Ui, trust: &Trust) {
    if trust.lights.is_empty() {
        return;
    }
    let worst = |value: &dyn Fn(&LightTrust) -> f64| trust.worst(value).unwrap_or(f64::NAN);
    Grid::new("expected errors").num_columns(2).striped(true).show(ui, |ui| {
        let condition = worst(&|light| light.condition_number.unwrap_or(f64::NAN));
        row(ui, "Condition number", &number(condition), "Largest over smallest singular value of the matrix of beta");
        for k in 0..trust.bounces {
            let gain = worst(&|light| light.gain[k]);
            let name = format!("Gain of bounce {}", k + 1);
            row(ui, &name, &number(gain), "Noise of this bounce for unit noise on every photo");
        }
        let (noise, denoised) = (worst(&|light| light.noise_percent), worst(&|light| light.denoised_noise_percent));
        let words = |value| percent(value).map_or(NEGATIVE.into(), |percent| format!("{percent} of it"));
        row(ui, "Noise of bounce 1", &words(noise), "Of a pixel of mean light, as bounce 1 is saved");
        let averaged = "The same after denoising the indirect light: the normals are computed from this";
        row(ui, "Noise after denoising", &words(denoised), averaged);
        let calibration = worst(&|light| light.calibration_percent.unwrap_or(f64::NAN));
        row(
            ui,
            "Calibration error",
            &percent(calibration).map_or(NEGATIVE.into(), |percent| format!("{percent} of bounce 1")),
            "By the intervals of alpha and beta",
        );
        row(
            ui,
            "Truncation bias",
            &truncation(trust),
            "Light of more than m bounces, by the mean light of the colours",
        );
        match &trust.normal {
            Some(normal) => {
                let words =
                    format!("{} ({} before denoising)", angle(normal.denoised_noise_deg), angle(normal.noise_deg));
                row(ui, "Normals, by noise", &words, "Root mean square angle at a pixel of mean light");
                let words = angle(normal.calibration_deg);
                row(ui, "Normals, by calibration", &words, "By the intervals of alpha and beta");
            }
            None => row(ui, "Normals", "need three directions", "Three lights of known direction, not in a plane"),
        }
    });
}

/// What the method in force expects of the normals.
pub fn of_normals(ui: &mut Ui, trust: &Trust) {
    let Some(normal) = &trust.normal else { return };
    Grid::new("expected errors of the normals").num_columns(2).striped(true).show(ui, |ui| {
        row(ui, "Expected error by noise", &angle(normal.denoised_noise_deg), "Root mean square angle over the object");
        row(ui, "Expected error by beta", &angle(normal.calibration_deg), "By the interval of beta");
    });
}

/// The same, light by light.
pub fn lights(ui: &mut Ui, trust: &Trust, set: &CaptureSet) {
    CollapsingHeader::new("Each light").id_salt("each light").show(ui, |ui| each_light(ui, trust, set));
}

fn truncation(trust: &Trust) -> String {
    let tails: Vec<_> = trust.lights.iter().filter_map(|light| light.truncation_percent).collect();
    let largest = tails.iter().copied().max_by(|a, b| a.abs().total_cmp(&b.abs()));
    largest.map_or("unknown: one colour".into(), |percent| format!("{percent:+.1} % of bounce 1"))
}

fn each_light(ui: &mut Ui, trust: &Trust, set: &CaptureSet) {
    Grid::new("each light").striped(true).show(ui, |ui| {
        for heading in ["Light", "Gain", "Noise", "Calibration", "Truncation", "Returned"] {
            ui.label(RichText::new(heading).semi_bold());
        }
        ui.end_row();
        for (light, found) in set.lights.iter().zip(&trust.lights) {
            let percent = |value: Option<f64>| value.and_then(percent).unwrap_or_else(|| "none".into());
            ui.label(&light.name);
            ui.label(number(found.gain[0]));
            ui.label(percent(Some(found.noise_percent)));
            ui.label(percent(found.calibration_percent));
            ui.label(percent(found.truncation_percent));
            ui.label(percent(found.return_share.map(|share| 100.0 * share)))
                .on_hover_text("The share of its light that the object sends back to itself at each bounce");
            ui.end_row();
        }
    });
}

fn row(ui: &mut Ui, name: &str, value: &str, what: &str) {
    ui.label(name).on_hover_text(what);
    ui.label(value).on_hover_text(what);
    ui.end_row();
}

/// A percentage of bounce 1; `None` where bounce 1 is negative.
fn percent(value: f64) -> Option<String> {
    value.is_finite().then(|| format!("{} %", number(value)))
}

fn angle(degrees: f64) -> String {
    if degrees <= NO_DIRECTION_DEG { format!("{degrees:.1}\u{b0}") } else { "no direction left".into() }
}

/// Three digits.
fn number(value: f64) -> String {
    match value.abs() {
        size if size >= 99.95 => format!("{value:.0}"),
        size if size >= 9.995 => format!("{value:.1}"),
        _ => format!("{value:.2}"),
    }
}
