//! The order m, and what it costs.

mod albedo;
mod curve;
mod numbers;
mod verdict;

use eframe::egui::{RichText, Ui};
use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::{PipelineError, SolveOptions};
use firstbounce_core::trust::{Rig, Trust, TrustOptions, judge};

use super::Panel;
use crate::app::state::document::Document;
use crate::app::state::results::StageError;
use crate::app::state::session::Session;
use crate::app::widgets::advice::advice;
use crate::app::widgets::part::part;

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
        order(ui, &document, session);
        let options = TrustOptions {
            bounces: document.set.bounces(),
            denoise: SolveOptions::of(&document.set).denoise,
            ..TrustOptions::default()
        };
        let trust = self.verdict(&document, options, session);
        match &trust {
            Ok(trust) => {
                part(ui, "verdict", |ui| verdict::ui(ui, trust, &document.set, session));
                part(ui, "numbers", |ui| numbers::ui(ui, trust));
            }
            Err(error) => advice(ui, &error.to_string()),
        }
        part(ui, "beta", |ui| albedo::ui(ui, &document, session));
        part(ui, "curve", |ui| curve::ui(ui, &document, &options, session));
        if let Ok(trust) = &trust {
            part(ui, "lights", |ui| numbers::lights(ui, trust, &document.set));
        }
    }
}

impl Separate {
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

/// m as a choice of 1 to n.
fn order(ui: &mut Ui, document: &Document, session: &mut Session) {
    let (colours, chosen) = (document.set.colours.len(), document.set.bounces());
    ui.label(RichText::new("Order m: bounces to separate").strong());
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

/// Names of colours and lights for the words of a verdict.
fn names(set: &CaptureSet) -> (Vec<String>, Vec<String>) {
    let colours = set.colours.iter().map(|colour| colour.name.clone()).collect();
    (colours, set.lights.iter().map(|light| light.name.clone()).collect())
}
