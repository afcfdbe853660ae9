//! The five steps and how each stands: a path, any of whose steps can be opened at any time.

use eframe::egui::{Color32, RichText, Ui};

use crate::app::panels::PanelName;
use crate::app::results::StageState;
use crate::app::session::Session;

/// Shows the steps; a click opens one.
pub fn ui(ui: &mut Ui, session: &mut Session) {
    ui.add_space(4.0);
    for (number, name) in (1..).zip(PanelName::ALL) {
        let state = name.state(session);
        ui.horizontal(|ui| {
            let title = format!("{number}  {}", name.title());
            if ui.selectable_label(session.panel == name, RichText::new(title).strong()).clicked() {
                session.panel = name;
            }
            let (words, colour) = words(&state, ui);
            ui.label(RichText::new(words).color(colour).small()).on_hover_text(line(&state));
        });
    }
}

fn words(state: &StageState, ui: &Ui) -> (String, Color32) {
    let visuals = ui.visuals();
    match state {
        StageState::Stale => ("waiting".into(), visuals.weak_text_color()),
        StageState::Running { fraction } => (format!("{:.0} %", 100.0 * fraction), visuals.hyperlink_color),
        StageState::Ready => ("ready".into(), visuals.weak_text_color()),
        StageState::Failed { .. } => ("failed".into(), visuals.error_fg_color),
        StageState::Blocked { .. } => ("needs something".into(), visuals.warn_fg_color),
    }
}

fn line(state: &StageState) -> String {
    match state {
        StageState::Stale => "Will be computed anew".into(),
        StageState::Running { .. } => "Is being computed".into(),
        StageState::Ready => "Up to date".into(),
        StageState::Failed { line } | StageState::Blocked { line } => line.clone(),
    }
}
