//! Files.

use eframe::egui::Ui;

use super::Panel;
use crate::app::session::Session;

/// The panel.
#[derive(Default)]
pub struct Export;

impl Panel for Export {
    fn ui(&mut self, ui: &mut Ui, session: &mut Session) {
        ui.label(format!("Files. ({})", session.document().set.title()));
    }
}
