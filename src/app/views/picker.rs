//! The menu from which a view's picture is chosen.

use eframe::egui::Ui;

use crate::app::state::document::Document;
use crate::app::state::layout::Shown;

/// The menu's content; the picture that was chosen in this frame.
pub fn ui(ui: &mut Ui, document: &Document, current: Option<&Shown>) -> Option<Shown> {
    let mut chosen = None;
    for (group, entries) in Shown::offered(document) {
        ui.menu_button(group, |ui| {
            for shown in entries {
                if ui.selectable_label(current == Some(&shown), shown.title()).clicked() {
                    chosen = Some(shown);
                    ui.close();
                }
            }
        });
    }
    chosen
}
