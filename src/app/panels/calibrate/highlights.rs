//! The highlights on the mirror ball: which one is the lamp's, which are not.

use std::collections::HashMap;

use eframe::egui::{Color32, Rect, RichText, Role, Sense, Stroke, Ui, Vec2, WidgetInfo};
use firstbounce_capture::pipeline::Calibrated;
use firstbounce_core::calibrate::Highlight;

use crate::app::state::results::ShotName;
use crate::app::state::session::Session;
use crate::app::views::Over;
use crate::app::widgets::theme::Weight;

const CHOSEN: Color32 = Color32::from_rgb(80, 220, 120);
const OTHER: Color32 = Color32::from_rgb(240, 150, 60);
/// Candidates below this share are not offered.
const UNLIKELY: f64 = 0.005;
/// A direction that agrees with a candidate's to this is that candidate's.
const SAME: f64 = 1e-9;

/// Candidates that the user deleted, by light: their places among the candidates, and how many there were.
#[derive(Default)]
pub struct Deleted(HashMap<String, (usize, Vec<usize>)>);

impl Deleted {
    /// The candidates of every light that has more than one.
    pub fn ui(&mut self, ui: &mut Ui, session: &mut Session, measured: &Calibrated) {
        let document = session.document();
        let several = measured.highlights.iter().flatten().any(|report| report.candidates.len() > 1);
        if !several {
            return;
        }
        ui.collapsing("Highlights on the mirror ball", |ui| {
            for (l, light) in document.set.lights.iter().enumerate() {
                let Some(Some(report)) = measured.highlights.get(l) else { continue };
                if report.candidates.len() < 2 {
                    continue;
                }
                let chosen = chosen(session, &light.name, &report.candidates);
                ui.label(RichText::new(&light.name).semi_bold());
                for (index, candidate) in report.candidates.iter().enumerate() {
                    let is_likely = candidate.score >= UNLIKELY || chosen == Some(index);
                    if is_likely && !self.is_deleted(&light.name, index, &report.candidates) {
                        self.row(ui, session, &light.name, &report.candidates, index, candidate, chosen == Some(index));
                    }
                }
                if self.0.contains_key(&light.name) && ui.button(format!("Bring back all, {}", light.name)).clicked() {
                    self.0.remove(&light.name);
                    forget_direction(session, &light.name);
                }
            }
        });
        ui.separator();
    }

    #[allow(clippy::too_many_arguments, reason = "a row is all of these")]
    fn row(
        &mut self,
        ui: &mut Ui,
        session: &mut Session,
        light: &str,
        candidates: &[Highlight],
        index: usize,
        candidate: &Highlight,
        chosen: bool,
    ) {
        ui.horizontal_wrapped(|ui| {
            let (x, y) = candidate.position_px;
            let name = format!("Highlight {} of {light}", index + 1);
            let text = format!("{name}: at {x:.0}, {y:.0}, likely to {:.0} %", 100.0 * candidate.score);
            if ui.radio(chosen, text).clicked() {
                choose(session, light, candidate);
            }
            if candidate.seen_under_other_lamps > 0 {
                ui.label(RichText::new("seen under other lamps too").weak());
            }
            if ui.button(format!("Delete {}", name.to_lowercase())).clicked() {
                self.delete(session, light, candidates, index, chosen);
            }
        });
    }

    /// Takes a candidate away; the next likeliest is the lamp's then.
    fn delete(&mut self, session: &mut Session, light: &str, candidates: &[Highlight], index: usize, chosen: bool) {
        let entry = self.0.entry(light.to_owned()).or_insert_with(|| (candidates.len(), Vec::new()));
        entry.1.push(index);
        let next = candidates.iter().enumerate().find(|(other, _)| !entry.1.contains(other));
        match next {
            Some((_, next)) if chosen => choose(session, light, next),
            Some(_) => {}
            None => session.warn(format!("No highlight of {light} is left: type its direction, or bring them back")),
        }
    }

    fn is_deleted(&self, light: &str, index: usize, candidates: &[Highlight]) -> bool {
        self.0.get(light).is_some_and(|(count, deleted)| *count == candidates.len() && deleted.contains(&index))
    }

    /// Marks the candidates in a photo of the mirror ball; a click chooses one, Delete takes it away.
    pub fn paint(&mut self, ui: &mut Ui, over: &Over<'_>, session: &mut Session, shot: &ShotName) {
        let document = session.document();
        let Some(light) = shot.light.as_deref() else { return };
        let Some(measured) = session.results.measured().filter(|m| super::counts_by(m, &document.set)) else { return };
        let index = document.set.light_index(light);
        let Some(Some(report)) = index.and_then(|l| measured.calibrated.highlights.get(l)) else { return };
        let candidates = &report.candidates;
        let in_force = chosen(session, light, candidates);
        let transform = &over.canvas.transform;
        for (index, candidate) in candidates.iter().enumerate() {
            let at = transform.to_screen([candidate.position_px.0, candidate.position_px.1]);
            if self.is_deleted(light, index, candidates) || !transform.rect.contains(at) {
                continue;
            }
            let chosen = in_force == Some(index);
            let rect = Rect::from_center_size(at, Vec2::splat(22.0));
            let id = over.canvas.response.id.with(("highlight", index));
            let response = ui.interact(rect, id, Sense::click());
            let name = format!("Highlight {} of {light} in the photo", index + 1);
            response.widget_info(|| WidgetInfo::selected(Role::RadioButton, true, chosen, &name));
            let stroke = Stroke::new(if response.has_focus() { 3.5 } else { 2.0 }, if chosen { CHOSEN } else { OTHER });
            ui.painter().circle_stroke(at, 10.0, stroke);
            ui.painter().line_segment([at - Vec2::X * 15.0, at - Vec2::X * 6.0], stroke);
            ui.painter().line_segment([at + Vec2::X * 6.0, at + Vec2::X * 15.0], stroke);
            let words = if chosen { "the lamp" } else { "click: this is the lamp" };
            let response = response.on_hover_text(format!("{words}; the panel's list deletes it"));
            if response.clicked() {
                choose(session, light, candidate);
            }
        }
    }
}

/// The candidate whose direction is in force: the likeliest, unless the user chose another.
fn chosen(session: &Session, light: &str, candidates: &[Highlight]) -> Option<usize> {
    let Some(given) = session.document().set.given_direction(light) else { return Some(0) };
    let agrees = |candidate: &Highlight| {
        let direction = candidate.direction.direction_to_light;
        direction.iter().zip(given).all(|(a, b)| (a - b).abs() < SAME)
    };
    candidates.iter().position(agrees)
}

fn choose(session: &mut Session, light: &str, candidate: &Highlight) {
    let direction = candidate.direction.direction_to_light;
    session.edit(&format!("Choose highlight of {light}"), |document| {
        document.set.put_direction(light, [direction.x, direction.y, direction.z]);
    });
}

fn forget_direction(session: &mut Session, light: &str) {
    session.edit(&format!("Measure direction of {light}"), |document| {
        document.set.calibration.direction.shift_remove(light);
    });
}
