//! The palette: commands by a few of their letters.

use eframe::egui::{Context, Id, Key, Modal, ScrollArea, TextEdit};
use nucleo_matcher::pattern::{CaseMatching, Normalization, Pattern};
use nucleo_matcher::{Config, Matcher, Utf32Str};

use super::{COMMANDS, Command, CommandId};
use crate::app::state::session::Session;

/// The palette's own state.
#[derive(Default)]
pub struct Palette {
    is_open: bool,
    typed: String,
    selected: usize,
}

impl Palette {
    /// Opens it, empty.
    pub fn open(&mut self) {
        *self = Self { is_open: true, ..Self::default() };
    }

    /// Shows it while it is open; the command that was chosen.
    pub fn ui(&mut self, context: &Context, session: &Session) -> Option<CommandId> {
        if !self.is_open {
            return None;
        }
        let (up, down, enter) = context.input_mut(|input| {
            let mut pressed = |key| input.consume_key(eframe::egui::Modifiers::NONE, key);
            (pressed(Key::ArrowUp), pressed(Key::ArrowDown), pressed(Key::Enter))
        });
        let found = matching(&self.typed, session);
        let last = found.len().saturating_sub(1);
        self.selected = match (up, down) {
            (true, _) => self.selected.saturating_sub(1),
            (_, true) => self.selected + 1,
            _ => self.selected,
        }
        .min(last);
        let mut chosen = found.get(self.selected).filter(|_| enter).map(|(command, _)| command.id);

        let modal = Modal::new(Id::unique("palette")).show(context, |ui| {
            ui.set_width(420.0);
            let field =
                TextEdit::singleline(&mut self.typed).hint_text("Type a few letters").desired_width(f32::INFINITY);
            let label = ui.label("Find a command");
            let field = ui.add(field).labelled_by(label.id);
            field.request_focus();
            if field.changed() {
                self.selected = 0;
            }
            ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
                for (index, (command, label)) in found.iter().enumerate() {
                    let row = ui.selectable_label(index == self.selected, label);
                    if index == self.selected && (up || down) {
                        row.scroll_to_me(None);
                    }
                    if row.clicked() {
                        chosen = Some(command.id);
                    }
                }
                if found.is_empty() {
                    ui.label("No command has these letters.");
                }
            });
        });
        if chosen.is_some() || modal.should_close() {
            self.is_open = false;
        }
        chosen
    }
}

/// The commands that can be run now and hold the typed letters in their order, the best first.
fn matching(typed: &str, session: &Session) -> Vec<(&'static Command, String)> {
    let mut matcher = Matcher::new(Config::DEFAULT);
    let pattern = Pattern::parse(typed, CaseMatching::Ignore, Normalization::Smart);
    let mut letters = Vec::new();
    let mut scored: Vec<_> = COMMANDS
        .iter()
        .filter(|command| (command.enabled)(session) && command.id != CommandId::Palette)
        .filter_map(|command| {
            let label = command.label(session);
            let score = pattern.score(Utf32Str::new(&label, &mut letters), &mut matcher)?;
            Some((score, command, label))
        })
        .collect();
    scored.sort_by_key(|(score, ..)| std::cmp::Reverse(*score));
    scored.into_iter().map(|(_, command, label)| (command, label)).collect()
}
