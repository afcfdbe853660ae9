//! Lamps and paint: where the balls are, what they say of alpha, beta, direction and intensity, and how far to trust it.

mod balls;
mod dome;
mod highlights;
mod histogram;
mod over;
mod pixels;
mod rig;
mod values;

use std::sync::Arc;

use eframe::egui::{RichText, Ui};
use firstbounce_capture::pipeline::{Calibrated, Source};
use firstbounce_capture::set::{CaptureSet, SphereKind, Subject, Word};

use super::Panel;
use crate::app::state::document::Document;
use crate::app::state::results::{Calibration, StageState, Step};
use crate::app::state::session::Session;
use crate::app::views::Over;
use crate::app::widgets::advice::advice;
use crate::app::widgets::part::part;

/// The panel.
#[derive(Default)]
pub struct Calibrate {
    balls: balls::Balls,
    pixels: pixels::PixelTints,
    highlights: highlights::Deleted,
    histogram: histogram::Histogram,
    rig: rig::OtherRig,
    lights: rig::OtherLights,
    in_force: Option<InForce>,
}

/// The values in force, kept until what they come from changes.
struct InForce {
    document: Arc<Document>,
    calibration: Option<Arc<Calibration>>,
    measured: Option<Arc<Calibration>>,
    values: Arc<Calibrated>,
}

impl Panel for Calibrate {
    fn ui(&mut self, ui: &mut Ui, session: &mut Session) {
        let document = session.document();
        let set = &document.set;
        if set.lights.is_empty() {
            advice(ui, "There is no light yet: add photos in Captures first.");
            return;
        }
        part(ui, "status", |ui| status(ui, session));
        part(ui, "balls", |ui| self.balls.ui(ui, session));
        part(ui, "pixels", |ui| self.pixels.legend(ui));
        let measured = session.results.measured().filter(|measured| counts_by(measured, set));
        if let Some(measured) = &measured {
            part(ui, "highlights", |ui| self.highlights.ui(ui, session, &measured.calibrated));
        }
        if let Some(measured) = &measured {
            part(ui, "ratios", |ui| {
                ui.collapsing("Ratios on the balls", |ui| self.histogram.ui(ui, set, &measured.calibrated))
            });
        }
        part(ui, "other rig", |ui| ui.collapsing("Use the rig of another set", |ui| self.rig.ui(ui, session)));
        part(ui, "light file", |ui| {
            ui.collapsing("Use the directions of a light file", |ui| self.lights.ui(ui, session))
        });
    }

    fn overlay(&mut self, ui: &mut Ui, over: &Over<'_>, session: &mut Session) {
        over::ui(self, ui, over, session);
    }
}

impl Calibrate {
    /// The values in force, in a tile of their own.
    pub fn values(&mut self, ui: &mut Ui, session: &mut Session) {
        let document = session.document();
        let measured = session.results.measured().filter(|measured| counts_by(measured, &document.set));
        let in_force = self.in_force(session);
        let balls_say = measured.as_deref().map(|measured| &*measured.calibrated);
        values::ui(ui, session, &in_force, balls_say);
    }

    /// The lights on a dome, in a tile of their own.
    pub fn dome(&mut self, ui: &mut Ui, session: &mut Session) {
        let in_force = self.in_force(session);
        dome::ui(ui, &session.document().set, &in_force);
    }

    /// What the file gives, else what the balls say: a typed value counts in the frame in which it is typed, and no longer
    /// than until it is taken back.
    fn in_force(&mut self, session: &Session) -> Arc<Calibrated> {
        let document = session.document();
        let fitting = |results: Option<Arc<Calibration>>| results.filter(|results| counts_by(results, &document.set));
        let calibration = fitting(session.results.calibration());
        let measured = fitting(session.results.measured());
        let same = |kept: &&InForce| {
            Arc::ptr_eq(&kept.document, &document)
                && same_arc(&kept.calibration, &calibration)
                && same_arc(&kept.measured, &measured)
        };
        if let Some(kept) = self.in_force.as_ref().filter(same) {
            return kept.values.clone();
        }
        let base = measured.as_ref().or(calibration.as_ref());
        let mut values = base.map(|base| Calibrated::clone(&base.calibrated)).unwrap_or_default();
        // Strengths are measured with the directions in force, typed ones too.
        let strengths = calibration.iter().flat_map(|calibration| &calibration.calibrated.intensity);
        for (value, in_force) in values.intensity.iter_mut().zip(strengths) {
            if in_force.source != Source::File {
                *value = in_force.clone();
            }
        }
        // No ball gives a beta that is measured on the object.
        let beta = calibration.as_ref().and_then(|calibration| calibration.calibrated.beta.clone());
        let of_object = beta.filter(|beta| beta.iter().any(|beta| beta.source == Source::Object));
        values.beta = values.beta.or(of_object);
        let values = Arc::new(values.with_given(&document.set));
        self.in_force = Some(InForce { document, calibration, measured, values: values.clone() });
        values
    }
}

fn same_arc<T>(a: &Option<Arc<T>>, b: &Option<Arc<T>>) -> bool {
    a.as_ref().map(Arc::as_ptr) == b.as_ref().map(Arc::as_ptr)
}

/// Whether a calibration is of the lights and colours that the set has now.
fn counts_by(calibration: &Calibration, set: &CaptureSet) -> bool {
    let lights = set.lights.iter().map(|light| &light.name);
    let colours = set.colours.iter().map(|colour| &colour.name);
    calibration.lights.iter().eq(lights) && calibration.colours.iter().eq(colours)
}

/// What keeps the balls from being measured. One line in any case: what lies below must not move under the pointer when work
/// begins and ends.
fn status(ui: &mut Ui, session: &Session) {
    let document = session.document();
    let mut words = "Click a ball in its photo, or type what you know.";
    for step in [Step::Measure, Step::Calibrate] {
        match session.results.state(step, &document) {
            StageState::Failed { line } => {
                ui.label(RichText::new(line).color(ui.visuals().error_fg_color));
                return;
            }
            StageState::Blocked { line } | StageState::Cancelled { line } => {
                ui.label(RichText::new(line).color(ui.visuals().warn_fg_color));
                return;
            }
            StageState::Running { .. } => words = "Measuring the balls ...",
            StageState::Stale | StageState::Ready => {}
        }
    }
    ui.label(RichText::new(words).weak());
}

/// Where each ball of the set is seen: in shots of its own, or in the object's scene, and in a second place.
fn balls_of(set: &CaptureSet) -> Vec<(Subject, SphereKind)> {
    let first = SphereKind::ALL.iter().filter_map(|&kind| Some((set.subject_with(kind)?, kind)));
    let balls = Subject::ALL.iter().filter_map(|&subject| Some((subject, subject.sphere_kind()?)));
    let again = balls.filter(|(subject, kind)| *subject != kind.subject() && set.shots_of(*subject).next().is_some());
    first.chain(again).collect()
}

/// What a ball is called: one in a second place by that.
fn title_of(subject: Subject, kind: SphereKind) -> &'static str {
    if subject == Subject::Object || subject == kind.subject() { kind.title() } else { subject.title() }
}
