//! Lamps and paint: alpha, beta, direction and intensity.

use eframe::egui::Ui;

use super::Panel;
use crate::app::session::Session;

/// The panel.
#[derive(Default)]
pub struct Calibrate;

impl Panel for Calibrate {
    fn ui(&mut self, ui: &mut Ui, session: &mut Session) {
        ui.label(format!(
            "Lamps and paint: alpha, beta, direction and intensity. ({})",
            session.document().set.title()
        ));
    }
}
