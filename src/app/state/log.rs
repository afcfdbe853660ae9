//! What the program tells in passing: lines in a log, and toasts that go by themselves.

use std::collections::VecDeque;
use std::time::{Duration, Instant, SystemTime};

use eframe::egui::{Align2, Area, Context, Frame, Id, Label, Order, RichText, Role, WidgetInfo, vec2};

/// Lines that are kept.
const MOST_LINES: usize = 500;
const TOAST_FOR: Duration = Duration::from_secs(6);
/// Toasts on screen at once: more would hide the work.
const MOST_TOASTS: usize = 4;

/// How much a line matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Something was done.
    Done,
    /// Something to know before trusting a number.
    Warning,
    /// Something was not done.
    Error,
}

/// One line of the log.
#[derive(Clone, Debug)]
pub struct Line {
    /// When.
    pub at: SystemTime,
    /// How much it matters.
    pub level: Level,
    /// For a person.
    pub text: String,
}

/// The log, newest line last, and the toasts on screen.
#[derive(Default)]
pub struct Log {
    lines: VecDeque<Line>,
    toasts: Vec<(Instant, Level, String)>,
}

impl Log {
    /// Adds a line.
    pub fn add(&mut self, level: Level, text: impl Into<String>) {
        if self.lines.len() == MOST_LINES {
            self.lines.pop_front();
        }
        self.lines.push_back(Line { at: SystemTime::now(), level, text: text.into() });
    }

    /// Adds a line and shows it for a while.
    pub fn toast(&mut self, level: Level, text: impl Into<String>) {
        let text = text.into();
        self.add(level, text.clone());
        self.toasts.retain(|(_, _, shown)| *shown != text);
        self.toasts.push((Instant::now(), level, text));
        let superfluous = self.toasts.len().saturating_sub(MOST_TOASTS);
        self.toasts.drain(..superfluous);
    }

    /// Every line, the oldest first.
    pub fn lines(&self) -> impl DoubleEndedIterator<Item = &Line> {
        self.lines.iter()
    }

    /// Takes all toasts away.
    pub fn dismiss(&mut self) {
        self.toasts.clear();
    }

    /// The toasts, over everything else.
    pub fn show_toasts(&mut self, context: &Context) {
        self.toasts.retain(|(since, ..)| since.elapsed() < TOAST_FOR);
        let Some(next) = self.toasts.iter().map(|(since, ..)| TOAST_FOR.saturating_sub(since.elapsed())).min() else {
            return;
        };
        context.request_repaint_after(next);
        let area = Area::new(Id::unique("toasts")).order(Order::Foreground).interactable(true);
        let mut dismissed = None;
        area.anchor(Align2::RIGHT_BOTTOM, vec2(-12.0, -40.0)).show(context, |ui| {
            for (index, (_, level, text)) in self.toasts.iter().enumerate() {
                Frame::popup(ui.style()).show(ui, |ui| {
                    ui.set_max_width(420.0);
                    ui.horizontal(|ui| {
                        let shown = ui.add(Label::new(coloured(ui.visuals(), *level, text)).wrap());
                        shown.widget_info(|| WidgetInfo::labeled(Role::Alert, true, text));
                        if ui.small_button("Dismiss").clicked() {
                            dismissed = Some(index);
                        }
                    });
                });
            }
        });
        if let Some(index) = dismissed {
            self.toasts.remove(index);
        }
    }
}

/// A line in the colour of its level; the words say it too.
pub fn coloured(visuals: &eframe::egui::Visuals, level: Level, text: &str) -> RichText {
    match level {
        Level::Done => RichText::new(text),
        Level::Warning => RichText::new(format!("Warning: {text}")).color(visuals.warn_fg_color),
        Level::Error => RichText::new(format!("Error: {text}")).color(visuals.error_fg_color),
    }
}
