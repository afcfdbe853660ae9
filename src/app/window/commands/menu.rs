//! The menu bar.

use eframe::egui::{Button, MenuBar, Ui};

use super::{COMMANDS, CommandId, Menu};
use crate::app::state::session::Session;

/// Shows every command under its menu; the one that was chosen.
pub fn menu_bar(ui: &mut Ui, session: &Session) -> Option<CommandId> {
    let mut chosen = None;
    MenuBar::new().ui(ui, |ui| {
        for menu in Menu::ALL {
            ui.menu_button(menu.title(), |ui| {
                for command in COMMANDS.iter().filter(|command| command.menu == menu) {
                    let mut button = Button::new(command.label(session));
                    if let Some(shortcut) = &command.shortcut {
                        button = button.shortcut_text(ui.ctx().format_shortcut(shortcut));
                    }
                    if ui.add_enabled((command.enabled)(session), button).clicked() {
                        chosen = Some(command.id);
                        ui.close();
                    }
                }
            });
        }
    });
    chosen
}
