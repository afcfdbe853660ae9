//! The palette: commands, pictures, orders and recent sets by a few of their letters.

use std::path::PathBuf;

use eframe::egui::{Align, Context, Id, Key, Layout, Modal, RichText, ScrollArea, TextEdit};
use nucleo_matcher::pattern::{CaseMatching, Normalization, Pattern};
use nucleo_matcher::{Config, Matcher, Utf32Str};

use super::{COMMANDS, Command, CommandId};
use crate::app::state::layout::Shown;
use crate::app::state::session::Session;

/// What was chosen.
#[derive(Clone, Debug, PartialEq)]
pub enum Chosen {
    /// A command.
    Command(CommandId),
    /// A picture, for the view that is active.
    Picture(Shown),
    /// An order m.
    Order(usize),
    /// A set that was open before.
    Recent(PathBuf),
}

/// A line of the palette.
struct Entry {
    label: String,
    keys: Option<&'static Command>,
    chosen: Chosen,
}

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

    /// Shows it while it is open; what was chosen.
    pub fn ui(&mut self, context: &Context, session: &Session) -> Option<Chosen> {
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
        let mut chosen = found.get(self.selected).filter(|_| enter).map(|entry| entry.chosen.clone());

        let modal = Modal::new(Id::unique("palette")).show(context, |ui| {
            ui.set_width(480.0);
            let field =
                TextEdit::singleline(&mut self.typed).hint_text("Type a few letters").desired_width(f32::INFINITY);
            let label = ui.label("Find a command, a picture or a set");
            let field = ui.add(field).labelled_by(label.id);
            field.request_focus();
            if field.changed() {
                self.selected = 0;
            }
            ScrollArea::vertical().max_height(320.0).show(ui, |ui| {
                for (index, entry) in found.iter().enumerate() {
                    ui.horizontal(|ui| {
                        let row = ui.selectable_label(index == self.selected, &entry.label);
                        if index == self.selected && (up || down) {
                            row.scroll_to_me(None);
                        }
                        if row.clicked() {
                            chosen = Some(entry.chosen.clone());
                        }
                        let keys = entry.keys.and_then(|command| command.shortcut.as_ref());
                        if let Some(keys) = keys.map(|keys| ui.ctx().format_shortcut(keys)) {
                            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                                ui.label(RichText::new(keys).weak());
                            });
                        }
                    });
                }
                if found.is_empty() {
                    ui.label("Nothing has these letters.");
                }
            });
        });
        if chosen.is_some() || modal.should_close() {
            self.is_open = false;
        }
        chosen
    }
}

/// Everything that can be chosen now: commands first.
fn entries(session: &Session) -> Vec<Entry> {
    let is_offered = |command: &&Command| (command.enabled)(session) && command.id != CommandId::Palette;
    let of_command = |command: &'static Command| Entry {
        label: command.label(session),
        keys: Some(command),
        chosen: Chosen::Command(command.id),
    };
    let mut entries: Vec<Entry> = COMMANDS.iter().filter(is_offered).map(of_command).collect();
    if session.is_open() {
        let document = session.document();
        let pictures = Shown::offered(&document).into_iter().flat_map(|(_, pictures)| pictures);
        entries.extend(pictures.map(|shown| Entry {
            label: format!("Show {}", shown.title()),
            keys: None,
            chosen: Chosen::Picture(shown),
        }));
        entries.extend((1..=document.set.colours.len()).map(|m| Entry {
            label: format!("Use order m = {m}"),
            keys: None,
            chosen: Chosen::Order(m),
        }));
    }
    entries.extend(session.preferences.recent.iter().map(|folder| Entry {
        label: format!("Open {}", folder.display()),
        keys: None,
        chosen: Chosen::Recent(folder.clone()),
    }));
    entries
}

/// What holds the typed letters in their order, the best first, and of equals the first.
fn matching(typed: &str, session: &Session) -> Vec<Entry> {
    let mut matcher = Matcher::new(Config::DEFAULT);
    let pattern = Pattern::parse(typed, CaseMatching::Ignore, Normalization::Smart);
    let mut letters = Vec::new();
    let mut scored: Vec<_> = entries(session)
        .into_iter()
        .filter_map(|entry| Some((pattern.score(Utf32Str::new(&entry.label, &mut letters), &mut matcher)?, entry)))
        .collect();
    scored.sort_by_key(|(score, _)| std::cmp::Reverse(*score));
    scored.into_iter().map(|(_, entry)| entry).collect()
}
