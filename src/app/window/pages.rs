//! A short page for each step, from the manual's own text.

use eframe::egui::{Context, Key, Modifiers, ScrollArea, Window, vec2};
use egui_commonmark::{CommonMarkCache, CommonMarkViewer};

use crate::app::state::panel::PanelName;

fn page(step: PanelName) -> &'static str {
    match step {
        PanelName::Captures => include_str!("../../../docs/steps/captures.md"),
        PanelName::Calibrate => include_str!("../../../docs/steps/calibrate.md"),
        PanelName::Separate => include_str!("../../../docs/steps/separate.md"),
        PanelName::Shape => include_str!("../../../docs/steps/shape.md"),
        PanelName::Export => include_str!("../../../docs/steps/export.md"),
    }
}

/// The page that is open.
#[derive(Default)]
pub struct Pages {
    open: Option<PanelName>,
    cache: CommonMarkCache,
}

impl Pages {
    /// Opens the page of a step, or closes it.
    pub fn toggle(&mut self, step: PanelName) {
        self.open = if self.open == Some(step) { None } else { Some(step) };
    }

    /// Shows the page while it is open.
    pub fn ui(&mut self, context: &Context) {
        let Some(step) = self.open else { return };
        let mut stays = !context.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape));
        Window::new(format!("About {}", step.title())).open(&mut stays).default_size(vec2(560.0, 460.0)).show(
            context,
            |ui| {
                ScrollArea::vertical().show(ui, |ui| {
                    CommonMarkViewer::new().show(ui, &mut self.cache, page(step));
                });
            },
        );
        if !stays {
            self.open = None;
        }
    }
}
