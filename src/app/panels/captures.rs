//! Which photo is which: light, colour and subject of every file.

use eframe::egui::Ui;

use super::Panel;
use crate::app::session::Session;

/// The panel.
#[derive(Default)]
pub struct Captures;

impl Panel for Captures {
    fn ui(&mut self, ui: &mut Ui, session: &mut Session) {
        ui.label(format!(
            "Which photo is which: light, colour and subject of every file. ({})",
            session.document().set.title()
        ));
    }
}

impl Captures {
    /// Files and folders that were dropped on the window, or chosen in a dialog.
    pub fn dropped(&mut self, paths: Vec<std::path::PathBuf>, session: &mut Session) {
        session.warn(format!("{} dropped files are not assigned", paths.len()));
    }
}
