//! The method, the order m, and what they cost.

mod albedo;
mod curve;
mod method;
mod numbers;
mod verdict;

use eframe::egui::{DragValue, RichText, Ui};
use firstbounce_capture::pipeline::{Method, PipelineError};
use firstbounce_capture::set::Number;
use firstbounce_core::trust::{Rig, Trust, TrustOptions, judge};

use super::{Panel, method_options};
use crate::app::state::document::Document;
use crate::app::state::results::{StageError, StageState, Step};
use crate::app::state::session::Session;
use crate::app::widgets::advice::advice;
use crate::app::widgets::part::part;
use crate::app::widgets::theme::Weight;

/// The panel. It keeps the last verdict, which costs a few milliseconds.
#[derive(Default)]
pub struct Separate {
    judged: Option<Judged>,
}

struct Judged {
    rig: Rig,
    options: TrustOptions,
    verdict: Result<Trust, StageError>,
}

impl Panel for Separate {
    fn ui(&mut self, ui: &mut Ui, session: &mut Session) {
        let document = session.document();
        if document.set.colours.is_empty() {
            advice(ui, "No colour yet: add photos in Captures, in two or more lamp colours.");
            return;
        }
        let method = document.method();
        part(ui, "method", |ui| method::choice(ui, &document, session));
        if method == Method::Colours {
            part(ui, "order", |ui| order(ui, "Order m: bounces to separate", &document, session));
        }
        method_options::ui(ui, session, &document, method);
        part(ui, "outcome", |ui| method::outcome(ui, &document, session));
        part(ui, "pictures", |ui| method::pictures(ui, &document, session));
        match method {
            Method::Shape => in_one_colour(ui, &document, session),
            Method::ColoursAndShape | Method::Colours => self.in_colours(ui, &document, session),
        }
        if method != Method::Colours {
            part(ui, "order", |ui| order(ui, "Bounces to view, by the paper's method", &document, session));
        }
    }
}

/// What is judged of photos in one colour; beta and a bounce's noise say nothing of them.
fn in_one_colour(ui: &mut Ui, document: &Document, session: &mut Session) {
    let is_ready = session.results.state(Step::Shape, document) == StageState::Ready;
    if let Some(shapes) = session.results.shapes().filter(|_| is_ready) {
        part(ui, "verdict", |ui| verdict::ui(ui, &shapes.trust, document, session));
    }
}

/// What the method in force says of its own result, where that is there; until then the paper's bounces are judged.
fn verdict_of_method(document: &Document, session: &Session) -> Option<Trust> {
    let is_ready = session.results.state(Step::Shape, document) == StageState::Ready;
    let shapes = session.results.shapes().filter(|_| is_ready && document.method() == Method::ColoursAndShape)?;
    Some(shapes.trust.clone())
}

impl Separate {
    fn in_colours(&mut self, ui: &mut Ui, document: &Document, session: &mut Session) {
        let options = document.options(document.method());
        let options = options.trust(options.calibrated_bounces_of(&document.set));
        let trust = self.verdict(document, options, session);
        let of_method = verdict_of_method(document, session);
        match &trust {
            Ok(trust) => {
                let in_force = of_method.as_ref().unwrap_or(trust);
                part(ui, "verdict", |ui| verdict::ui(ui, in_force, document, session));
                if document.method() == Method::ColoursAndShape {
                    part(ui, "in force", |ui| numbers::of_normals(ui, in_force));
                    ui.label(RichText::new("The paper's bounces, for comparison").weak());
                }
                part(ui, "numbers", |ui| numbers::ui(ui, trust));
            }
            Err(error) => advice(ui, &error.to_string()),
        }
        part(ui, "beta", |ui| albedo::ui(ui, document, session));
        part(ui, "curve", |ui| curve::ui(ui, document, &options, session));
        if let Ok(trust) = &trust {
            part(ui, "lights", |ui| numbers::lights(ui, trust, &document.set));
        }
    }

    /// The verdict on the document as it is in this frame.
    fn verdict(&mut self, document: &Document, options: TrustOptions, session: &Session) -> Result<Trust, StageError> {
        let rig = session.results.trust_rig(document)?;
        match &self.judged {
            Some(judged) if judged.rig == rig && judged.options == options => judged.verdict.clone(),
            _ => {
                let verdict = judge(&rig, &options).map_err(|error| PipelineError::from(error).into());
                self.judged = Some(Judged { rig, options, verdict: verdict.clone() });
                verdict
            }
        }
    }
}

/// m as a choice of 1 to n, and the noise that is taken out of bounce 1.
fn order(ui: &mut Ui, title: &str, document: &Document, session: &mut Session) {
    let (colours, chosen) = (document.set.colours.len(), document.set.bounces());
    ui.add_space(4.0);
    ui.label(RichText::new(title).semi_bold());
    ui.horizontal_wrapped(|ui| {
        for m in 1..=colours.max(chosen) {
            let choice = ui.radio(m == chosen, format!("m = {m}"));
            if choice.on_hover_text(order_words(m)).clicked() {
                choose_order(session, m);
            }
        }
    });
    if document.set.separation.bounces.is_none() {
        ui.label(RichText::new("The set does not give m: the program chooses.").weak());
    }
    let mut window = document.set.shape.indirect_window_px;
    ui.horizontal(|ui| {
        let hover =
            "Half width of the window over which the paper's method averages the noise of indirect light; 0 for none";
        let name = ui.label("Denoising window").on_hover_text(hover);
        let field = DragValue::new(&mut window).range(Number::IndirectWindowPx.whole_range()).speed(0.05).suffix(" px");
        if ui.add(field).labelled_by(name.id).changed() {
            session.edit("Change denoising window", |document| document.set.shape.indirect_window_px = window);
        }
    });
}

fn choose_order(session: &mut Session, m: usize) {
    session.edit(&format!("Choose order m = {m}"), |document| document.set.separation.bounces = Some(m));
}

fn order_words(m: usize) -> &'static str {
    match m {
        1 => "All light counts as direct: nothing is removed",
        2 => "Direct light, and light that bounced twice: a good model of many scenes, with the least noise",
        _ => "Follows deep cavities better, and costs more noise",
    }
}
