//! The values of every picture at one pixel.

use eframe::egui::{CollapsingHeader, DragValue, Ui};
use firstbounce_capture::set::Subject;

use super::number;
use crate::app::state::document::Document;
use crate::app::state::layout::{Hover, Shown};
use crate::app::state::session::Session;
use crate::app::views::picture;
use crate::app::widgets::advice::advice;

/// The pixel that is looked at: the one under the pointer last, unless it is held.
#[derive(Default)]
pub struct Cursor {
    last: Option<Hover>,
    held: bool,
}

impl Cursor {
    /// Takes the pixel under the pointer.
    pub fn follow(&mut self, hover: Option<&Hover>) {
        if !self.held && hover.is_some() {
            self.last = hover.cloned();
        }
    }

    /// Where it is; `None` until a picture was pointed at.
    pub fn at(&self) -> Option<&Hover> {
        self.last.as_ref()
    }

    pub fn ui(&mut self, ui: &mut Ui, document: &Document, session: &Session) {
        self.place(ui, document, session);
        let Some(Hover { shown, pixel: (x, y) }) = &self.last else {
            advice(ui, "Point at a pixel, or type its column and row.");
            return;
        };
        for (group, entries) in Shown::offered(document) {
            let of_subject: Vec<_> = entries.into_iter().filter(|entry| entry.subject() == shown.subject()).collect();
            if of_subject.is_empty() {
                continue;
            }
            let open = shown.light().is_none_or(|light| group.ends_with(light)) || !group.starts_with("Light");
            // What is folded away is not computed.
            CollapsingHeader::new(&group).default_open(open).show(ui, |ui| {
                let value = |entry: &Shown| Some((entry.title(), values(entry, (*x, *y), document, session)?));
                let known: Vec<_> = of_subject.iter().filter_map(value).collect();
                if known.is_empty() {
                    ui.label("No value here yet.");
                }
                for (title, value) in known {
                    ui.horizontal_wrapped(|ui| {
                        ui.label(title);
                        ui.monospace(value);
                    });
                }
            });
        }
    }

    /// Column and row, to be typed by whoever does not point.
    fn place(&mut self, ui: &mut Ui, document: &Document, session: &Session) {
        ui.horizontal_wrapped(|ui| {
            let first = || session.views.active().map(|view| view.shown.clone()).unwrap_or_default();
            let mut hover = self.last.clone().unwrap_or_else(|| Hover { shown: first(), pixel: (0, 0) });
            let Ok(shown) = picture(&hover.shown, document, &session.results) else { return };
            let (width, height) = shown.source.size();
            let mut field = |name: &str, value: &mut usize, end: usize| {
                let label = ui.label(name);
                ui.add(DragValue::new(value).range(0..=end.saturating_sub(1))).labelled_by(label.id).changed()
            };
            let typed = field("Column", &mut hover.pixel.0, width) | field("Row", &mut hover.pixel.1, height);
            if typed {
                (self.last, self.held) = (Some(hover), true);
            }
            ui.checkbox(&mut self.held, "Hold this pixel").on_hover_text("Stays here while the pointer moves on");
        });
    }
}

fn values(shown: &Shown, (x, y): (usize, usize), document: &Document, session: &Session) -> Option<String> {
    if shown.subject() != Subject::Object && !matches!(shown, Shown::Photo(_)) {
        return None;
    }
    let picture = picture(shown, document, &session.results).ok()?;
    let values = picture.source.values_at(x, y);
    let words: Vec<_> = values.iter().map(|value| number(f64::from(*value))).collect();
    (!words.is_empty()).then(|| words.join(", ") + shown.quantity(&document.set).unit)
}
