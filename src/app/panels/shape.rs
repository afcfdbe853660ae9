//! Normals and depth.

use eframe::egui::Ui;

use super::Panel;
use crate::app::session::Session;

/// The panel.
#[derive(Default)]
pub struct ShapePanel;

impl Panel for ShapePanel {
    fn ui(&mut self, ui: &mut Ui, session: &mut Session) {
        ui.label(format!("Normals and depth. ({})", session.document().set.title()));
    }
}
