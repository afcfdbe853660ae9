//! The five steps and the state of each; any of them can be opened at any time.

use eframe::egui::{Color32, Panel, RichText, Ui};
use firstbounce_capture::pipeline::Method;

use crate::app::state::panel::{PanelName, StepState};
use crate::app::state::session::Session;
use crate::app::widgets::advice::sentence;
use crate::app::widgets::theme;

/// Shows the steps; a click opens one.
pub fn ui(ui: &mut Ui, session: &mut Session) {
    ui.add_space(4.0);
    // One missing thing stops every later step: it is reported once, where it is.
    let mut reported = String::new();
    for (number, name) in (1..).zip(PanelName::ALL) {
        let state = name.state(session);
        let (words, colour) = words(&state, ui);
        ui.horizontal(|ui| {
            let title = RichText::new(format!("{number}  {}", name.title())).strong();
            if ui.selectable_label(session.panel == name, title).clicked() {
                session.panel = name;
            }
            ui.label(RichText::new(words).color(colour));
        });
        let (StepState::Failed { line } | StepState::Incomplete { line } | StepState::Empty { line }) = state else {
            continue;
        };
        if reported.is_empty() || !line.contains(&reported) {
            ui.indent(number, |ui| ui.label(RichText::new(sentence(&line)).color(colour)));
            reported = line;
        }
    }
}

/// Below the open step: what to look at in it, and the way to the next.
pub fn next(ui: &mut Ui, session: &mut Session) {
    let (look_at, next) = match session.panel {
        PanelName::Captures => ("Check that no photo is clipped and few pixels are dark.", PanelName::Calibrate),
        PanelName::Calibrate => {
            ("Circles on the balls' edges, highlights on the lamps, every value fine.", PanelName::Separate)
        }
        PanelName::Separate if session.document().method() == Method::Colours => {
            ("The highest order m whose verdict is fine.", PanelName::Shape)
        }
        PanelName::Separate => ("Little light left in the creases of the direct light.", PanelName::Shape),
        PanelName::Shape => ("Compare the surface before and after.", PanelName::Export),
        PanelName::Export => return,
    };
    Panel::bottom("next step").show(ui, |ui| {
        ui.label(RichText::new(look_at).small());
        if ui.button(format!("Next: {}", next.title())).clicked() {
            session.panel = next;
        }
    });
}

fn words(state: &StepState, ui: &Ui) -> (String, Color32) {
    let visuals = ui.visuals();
    match state {
        StepState::Empty { .. } => ("empty".into(), visuals.weak_text_color()),
        StepState::Incomplete { .. } => ("incomplete".into(), visuals.warn_fg_color),
        StepState::Running { fraction } => (format!("running, {:.0} %", 100.0 * fraction), visuals.hyperlink_color),
        StepState::Ready => ("\u{2714} ready".into(), theme::fine(visuals)),
        StepState::TakeCare => ("take care".into(), visuals.warn_fg_color),
        StepState::Failed { .. } => ("failed".into(), visuals.error_fg_color),
    }
}
