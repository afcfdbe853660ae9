//! Values under the cursor.

use eframe::egui::Ui;

use super::Panel;
use crate::app::session::Session;

/// The panel.
#[derive(Default)]
pub struct Inspector;

impl Panel for Inspector {
    fn ui(&mut self, ui: &mut Ui, session: &mut Session) {
        ui.label(format!("Values under the cursor. ({})", session.document().set.title()));
    }
}
