//! The inspector: numbers under the cursor, in a region and along a line.

mod cursor;
mod histogram;
mod line;
mod polynomial;
mod region;
mod tool;

use eframe::egui::{CollapsingHeader, ScrollArea, Ui, vec2};
use firstbounce_capture::set::Subject;

use super::Panel;
use crate::app::state::layout::Shown;
use crate::app::state::session::Session;
use crate::app::views::Over;
use crate::app::views::picture;
use crate::app::widgets::advice::advice;

/// Of what changes with the pointer, in points.
const CURSOR_HEIGHT: f32 = 190.0;
const POLYNOMIAL_HEIGHT: f32 = 250.0;

/// The panel.
#[derive(Default)]
pub struct Inspector {
    cursor: cursor::Cursor,
    tool: tool::Tools,
    region: region::RegionSection,
    line: line::LineSection,
}

impl Panel for Inspector {
    fn ui(&mut self, ui: &mut Ui, session: &mut Session) {
        let document = session.document();
        self.cursor.follow(session.views.hover.as_ref());
        section(ui, "Under the cursor", |ui| {
            of_height(ui, "cursor", CURSOR_HEIGHT, |ui| self.cursor.ui(ui, &document, session));
        });
        section(ui, "N(beta) of this pixel", |ui| {
            of_height(ui, "polynomial", POLYNOMIAL_HEIGHT, |ui| match self.cursor.at() {
                Some(at) => polynomial::ui(ui, at, &document, session),
                None => advice(ui, "Point at a pixel of the object."),
            });
        });
        let Some(shown) = session.views.active().map(|view| view.shown.clone()) else { return };
        match picture(&shown, &document, &session.results) {
            Ok(picture) => {
                self.tool.ui(ui, shown.subject(), picture.source.size());
                let region = self.tool.region(shown.subject());
                section(ui, "Statistics and histogram", |ui| self.region.ui(ui, &shown, &picture, region, session));
                let line = self.tool.line(shown.subject());
                section(ui, "Profile along the line", |ui| self.line.ui(ui, &shown, line, &document, session));
            }
            Err(error) => advice(ui, &error.to_string()),
        }
    }

    fn overlay(&mut self, ui: &mut Ui, over: &Over<'_>, _: &mut Session) {
        self.tool.overlay(ui, over);
    }

    fn wants_drag(&self, shown: &Shown, _: &Session) -> bool {
        self.tool.wants_drag(shown.subject())
    }
}

/// Pictures of one subject lie on each other, and share what is drawn on them.
type OnSubject<T> = Option<(Subject, T)>;

/// Content whose height stays the same while the pointer moves, so that nothing below it does.
fn of_height(ui: &mut Ui, salt: &str, height: f32, content: impl FnOnce(&mut Ui)) {
    let size = vec2(ui.available_width(), height);
    ui.allocate_ui(size, |ui| {
        ui.set_min_size(size);
        ui.set_max_width(size.x);
        ScrollArea::vertical().id_salt(salt).auto_shrink(false).max_height(height).show(ui, content);
    });
}

fn section(ui: &mut Ui, title: &str, content: impl FnOnce(&mut Ui)) {
    CollapsingHeader::new(title).default_open(true).show(ui, content);
}

/// A value in at most four digits.
fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if size >= 1000.0 => format!("{value:.0}"),
        size if size >= 10.0 => format!("{value:.2}"),
        size if size >= 0.001 => format!("{value:.4}"),
        _ => format!("{value:.1e}"),
    }
}
