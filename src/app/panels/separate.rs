//! The order m, and what it costs.

use eframe::egui::Ui;

use super::Panel;
use crate::app::session::Session;

/// The panel.
#[derive(Default)]
pub struct Separate;

impl Panel for Separate {
    fn ui(&mut self, ui: &mut Ui, session: &mut Session) {
        ui.label(format!("The order m, and what it costs. ({})", session.document().set.title()));
    }
}
