//! The values in force: typed or measured, with interval, verdict and source.

use eframe::egui::{Color32, Grid, Label, RichText, Role, Ui, Vec2, WidgetInfo, vec2};
use firstbounce_capture::pipeline::{Calibrated, Known, Source, Verdict};
use firstbounce_capture::set::{CaptureSet, Number};
use firstbounce_core::trust::Level;

use crate::app::state::session::Session;
use crate::app::widgets::number_field::fixed;
use crate::app::widgets::part::part;
use crate::app::widgets::theme::{self, Weight};

/// Between the cells of the table, in points.
const SPACING: Vec2 = vec2(16.0, 8.0);
/// Of a reason below a value, in points.
const REASON_WIDTH: f32 = 190.0;

/// A change of a value by the user.
enum Change<T> {
    Typed(T),
    BackToMeasured,
}

/// Every value of the rig in one table, a light a row, and those of the paint above it.
pub fn ui(ui: &mut Ui, session: &mut Session, in_force: &Calibrated, measured: Option<&Calibrated>) {
    let document = session.document();
    let set = &document.set;
    let heading = |ui: &mut Ui, text: &str, meaning: &str| {
        ui.label(RichText::new(text).semi_bold()).on_hover_text(meaning);
    };
    let others = || set.colours.iter().enumerate().skip(1);
    if set.colours.len() > 1 {
        Grid::new("paint").striped(true).spacing(SPACING).show(ui, |ui| {
            let reference = &set.colours[0].name;
            for (c, colour) in others() {
                let meaning = format!("The paint's albedo in {} over that in {reference}", colour.name);
                heading(ui, &format!("beta, {}", colour.name), &meaning);
                ui.vertical(|ui| part(ui, c, |ui| beta(ui, session, set, in_force, measured, c)));
                ui.end_row();
            }
        });
        ui.add_space(8.0);
    }
    Grid::new("lights").striped(true).spacing(SPACING).show(ui, |ui| {
        heading(ui, "Light", "");
        for (_, colour) in others() {
            let meaning = format!("The lamp's intensity in {} over that in {}", colour.name, set.colours[0].name);
            heading(ui, &format!("alpha, {}", colour.name), &meaning);
        }
        heading(ui, "Intensity", "The lamp's intensity in the reference colour over that of the first light");
        heading(ui, "Direction x, y, z", "To the light: x right, y up, z toward the camera; of any length");
        ui.end_row();
        for (l, light) in set.lights.iter().enumerate() {
            ui.label(RichText::new(&light.name).semi_bold());
            for (c, _) in others() {
                ui.vertical(|ui| part(ui, (l, c), |ui| alpha(ui, session, set, in_force, measured, (l, c))));
            }
            ui.vertical(|ui| part(ui, (l, "intensity"), |ui| intensity(ui, session, set, in_force, l)));
            ui.vertical(|ui| part(ui, (l, "direction"), |ui| direction(ui, session, set, in_force, l)));
            ui.end_row();
        }
    });
}

fn beta(
    ui: &mut Ui,
    session: &mut Session,
    set: &CaptureSet,
    in_force: &Calibrated,
    measured: Option<&Calibrated>,
    c: usize,
) {
    let colour = &set.colours[c].name;
    let label = format!("beta, {colour}");
    let known = in_force.beta.as_ref().and_then(|beta| beta.get(c));
    let typed = set.calibration.beta.is_some();
    let was = measured.and_then(|measured| measured.beta.as_ref()?.get(c));
    let verdict = in_force.judge_beta(set, c);
    match number(ui, (Number::Beta, &label), known, was, typed, verdict) {
        Some(Change::Typed(value)) => session.edit(&format!("Type {label}"), |document| {
            let colours = document.set.colours.len();
            let old = in_force.beta.as_deref().map(values).unwrap_or_else(|| vec![1.0; colours]);
            document.set.calibration.beta = Some(with(old, colours, c, value));
        }),
        Some(Change::BackToMeasured) => {
            session.edit("Measure beta", |document| document.set.calibration.beta = None);
        }
        None => {}
    }
}

fn alpha(
    ui: &mut Ui,
    session: &mut Session,
    set: &CaptureSet,
    in_force: &Calibrated,
    measured: Option<&Calibrated>,
    (l, c): (usize, usize),
) {
    let light = &set.lights[l].name;
    let colour = &set.colours[c].name;
    let label = format!("alpha, {light}, {colour}");
    let of = |calibrated: &Calibrated| calibrated.alpha.get(l)?.as_ref()?.get(c).cloned();
    let known = of(in_force);
    let was = measured.and_then(of);
    let typed = set.calibration.alpha.contains_key(light);
    let verdict = in_force.judge_alpha(l, c);
    match number(ui, (Number::Alpha, &label), known.as_ref(), was.as_ref(), typed, verdict) {
        Some(Change::Typed(value)) => session.edit(&format!("Type {label}"), |document| {
            let colours = document.set.colours.len();
            let old = in_force.alpha.get(l).and_then(Option::as_deref).map(values);
            let new = with(old.unwrap_or_else(|| vec![1.0; colours]), colours, c, value);
            document.set.calibration.alpha.insert(light.clone(), new);
        }),
        Some(Change::BackToMeasured) => session.edit(&format!("Measure alpha, {light}"), |document| {
            document.set.calibration.alpha.shift_remove(light);
        }),
        None => {}
    }
}

fn intensity(ui: &mut Ui, session: &mut Session, set: &CaptureSet, in_force: &Calibrated, l: usize) {
    let light = &set.lights[l].name;
    let label = format!("intensity, {light}");
    let typed = set.calibration.intensity.contains_key(light);
    let (known, verdict) = (in_force.intensity.get(l), in_force.judge_intensity(l));
    match number(ui, (Number::Intensity, &label), known, None, typed, verdict) {
        Some(Change::Typed(value)) => session.edit(&format!("Type {label}"), |document| {
            document.set.calibration.intensity.insert(light.clone(), value);
        }),
        Some(Change::BackToMeasured) => session.edit(&format!("Measure {label}"), |document| {
            document.set.calibration.intensity.shift_remove(light);
        }),
        None => {}
    }
}

fn direction(ui: &mut Ui, session: &mut Session, set: &CaptureSet, in_force: &Calibrated, l: usize) {
    let light = &set.lights[l];
    let label = format!("direction, {}", light.name);
    // As it was typed, of any length: a field must not change under the hand that fills it.
    let given = light.direction.or_else(|| set.calibration.direction.get(&light.name).copied());
    let known = in_force.direction.get(l).and_then(Option::as_ref);
    let old = given.or_else(|| known.map(|known| known.value));
    let mut new = old.unwrap_or([0.0, 0.0, 1.0]);
    ui.horizontal(|ui| {
        if old.is_none() {
            ui.label(RichText::new("unknown").color(ui.visuals().error_fg_color));
        }
        for (axis, number) in ["x", "y", "z"].into_iter().zip(&mut new) {
            field(ui, Number::Direction, number, &format!("{label}, {axis}"));
        }
        if let Some(angle) = known.and_then(half_angle_deg) {
            ui.label(RichText::new(format!("\u{b1} {angle:.2}\u{b0}")).weak());
        }
    });
    let changed = Some(new) != old && (old.is_some() || new != [0.0, 0.0, 1.0]);
    if changed {
        session.edit(&format!("Type {label}"), |document| document.set.put_direction(&light.name, new));
    }
    let source = known.map_or("", |known| known.source.words());
    let back = judged(ui, &label, source, given.is_some(), in_force.judge_direction(l));
    if back {
        session.edit(&format!("Measure {label}"), |document| {
            document.set.calibration.direction.shift_remove(&light.name);
            if let Some(light) = document.set.lights.get_mut(l) {
                light.direction = None;
            }
        });
    }
}

/// One number with its interval, and below it verdict, source and the way back.
fn number(
    ui: &mut Ui,
    (what, label): (Number, &str),
    known: Option<&Known<f64>>,
    measured: Option<&Known<f64>>,
    typed: bool,
    verdict: Option<Verdict>,
) -> Option<Change<f64>> {
    let mut value = known.map_or(1.0, |known| known.value);
    let mut change = None;
    ui.horizontal(|ui| {
        if known.is_none() {
            ui.label(RichText::new("unknown").color(ui.visuals().error_fg_color));
        }
        if field(ui, what, &mut value, label) {
            change = Some(Change::Typed(value));
        }
        if let Some([low, high]) = known.and_then(|known| known.interval) {
            ui.label(RichText::new(format!("\u{b1} {:.4}", (high - low) / 2.0)).weak())
                .on_hover_text(format!("95 % interval: {low:.4} to {high:.4}"));
        }
        if let Some(was) = measured.filter(|_| typed) {
            ui.label(RichText::new(format!("measured {:.4}", was.value)).weak());
        }
    });
    let source = known.map_or("", |known| known.source.words());
    if judged(ui, label, source, typed, verdict) {
        change = Some(Change::BackToMeasured);
    }
    change
}

/// Verdict, source, and a button back to what was measured; whether it was pressed.
fn judged(ui: &mut Ui, label: &str, source: &str, typed: bool, verdict: Option<Verdict>) -> bool {
    let mut back = false;
    ui.horizontal(|ui| {
        if let Some(verdict) = &verdict {
            ui.label(RichText::new(verdict.level.words()).small().semi_bold().color(colour(ui, verdict.level)));
        }
        let source = if typed && source == Source::File.words() { "typed or from capture.toml" } else { source };
        ui.label(RichText::new(source).small().weak());
        if typed {
            let button = ui.small_button("Back to measured");
            button.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Back to measured, {label}")));
            back = button.clicked();
        }
    });
    if let Some(reason) = verdict.as_ref().map(Verdict::reason).filter(|reason| !reason.is_empty()) {
        ui.scope(|ui| {
            ui.set_max_width(REASON_WIDTH);
            ui.add(Label::new(RichText::new(reason).small()).wrap());
        });
    }
    back
}

/// A number under an accessible name; whether it was changed.
fn field(ui: &mut Ui, what: Number, number: &mut f64, name: &str) -> bool {
    let field = fixed(number, 4, what.range()).speed(0.001);
    let response = part(ui, name, |ui| ui.add(field));
    response.widget_info(|| WidgetInfo::labeled(Role::SpinButton, true, name));
    response.changed()
}

fn colour(ui: &Ui, level: Level) -> Color32 {
    match level {
        Level::Fine => theme::fine(ui.visuals()),
        Level::TakeCare => ui.visuals().warn_fg_color,
        Level::DoNotTrust => ui.visuals().error_fg_color,
    }
}

fn values(known: &[Known<f64>]) -> Vec<f64> {
    known.iter().map(|known| known.value).collect()
}

/// `old` with one value changed, for as many colours as there are.
fn with(mut old: Vec<f64>, colours: usize, c: usize, value: f64) -> Vec<f64> {
    old.resize(colours, 1.0);
    if let Some(slot) = old.get_mut(c) {
        *slot = value;
    }
    old
}

fn half_angle_deg(known: &Known<[f64; 3]>) -> Option<f64> {
    let [low, high] = known.interval?;
    let widest = low.iter().zip(high).map(|(low, high)| (high - low) / 2.0).fold(0.0, f64::max);
    Some(widest.to_degrees())
}
