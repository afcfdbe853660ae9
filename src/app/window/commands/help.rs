//! The help sheet: every command with its keys, and what the mouse does.

use eframe::egui::{Context, Grid, Key, Modifiers, RichText, ScrollArea, Window};

use super::{COMMANDS, Menu};
use crate::app::widgets::theme::Weight;

/// What works without a command.
const BY_HAND: [(&str, &str); 8] = [
    ("Wheel, or plus and minus", "Zoom at the pointer"),
    ("Drag, or arrow keys", "Move the picture"),
    ("Shift and arrow keys", "Move the pixel cursor; Enter clicks there"),
    ("Hold B", "Show the picture that a view is compared with, or the surface before"),
    ("Double click on a picture", "Only this view, or all"),
    ("Tab, Shift+Tab", "To the next or the last control"),
    ("Space, Enter", "Press the control"),
    ("Drop files on the window", "Open a set, or add photos to the open one"),
];

/// The sheet's own state.
#[derive(Default)]
pub struct HelpSheet {
    is_open: bool,
}

impl HelpSheet {
    /// Opens or closes it.
    pub fn toggle(&mut self) {
        self.is_open ^= true;
    }

    /// Shows it while it is open.
    pub fn ui(&mut self, context: &Context) {
        if self.is_open && context.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Escape)) {
            self.is_open = false;
        }
        Window::new("Keys and commands").open(&mut self.is_open).default_width(420.0).show(context, |ui| {
            ScrollArea::vertical().max_height(480.0).show(ui, |ui| {
                for menu in Menu::ALL {
                    ui.label(RichText::new(menu.title()).semi_bold());
                    Grid::new(menu.title()).num_columns(2).striped(true).show(ui, |ui| {
                        for command in COMMANDS.iter().filter(|command| command.menu == menu) {
                            let keys = command.shortcut.as_ref().map(|keys| ui.ctx().format_shortcut(keys));
                            ui.label(keys.unwrap_or_default());
                            ui.label(command.title);
                            ui.end_row();
                        }
                    });
                    ui.add_space(6.0);
                }
                ui.label(RichText::new("In the views").semi_bold());
                Grid::new("by hand").num_columns(2).striped(true).show(ui, |ui| {
                    for (keys, what) in BY_HAND {
                        ui.label(keys);
                        ui.label(what);
                        ui.end_row();
                    }
                });
            });
        });
    }
}
