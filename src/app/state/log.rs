//! The log: lines that the program reports in passing, and toasts that go by themselves.

use std::collections::VecDeque;
use std::time::{Duration, Instant, SystemTime};

/// Lines that are kept.
const MAX_LINES: usize = 500;
const TOAST_FOR: Duration = Duration::from_secs(6);
/// Toasts on screen at once: more would hide the work.
const MAX_TOASTS: usize = 4;

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
    /// For the user.
    pub text: String,
}

/// A line that is shown for a while.
#[derive(Clone, Debug)]
pub struct Toast {
    since: Instant,
    /// How much it matters.
    pub level: Level,
    /// For the user.
    pub text: String,
}

/// The log, newest line last, and the toasts on screen.
#[derive(Default)]
pub struct Log {
    lines: VecDeque<Line>,
    toasts: Vec<Toast>,
}

impl Log {
    /// Adds a line.
    pub fn add(&mut self, level: Level, text: impl Into<String>) {
        if self.lines.len() == MAX_LINES {
            self.lines.pop_front();
        }
        self.lines.push_back(Line { at: SystemTime::now(), level, text: text.into() });
    }

    /// Adds a line and shows it for a while.
    pub fn toast(&mut self, level: Level, text: impl Into<String>) {
        let text = text.into();
        self.add(level, text.clone());
        self.toasts.retain(|toast| toast.text != text);
        self.toasts.push(Toast { since: Instant::now(), level, text });
        let superfluous = self.toasts.len().saturating_sub(MAX_TOASTS);
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

    /// The toasts on screen, the oldest first, and when the next of them goes.
    pub fn toasts(&mut self) -> (&[Toast], Option<Duration>) {
        self.toasts.retain(|toast| toast.since.elapsed() < TOAST_FOR);
        let next = self.toasts.iter().map(|toast| TOAST_FOR.saturating_sub(toast.since.elapsed())).min();
        (&self.toasts, next)
    }

    /// Takes one toast away.
    pub fn dismiss_one(&mut self, index: usize) {
        self.toasts.remove(index);
    }
}
