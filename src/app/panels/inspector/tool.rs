//! Measuring tools drawn on pictures: a rectangle, a lasso, a line. By pointer, or by typed corners.

use eframe::egui::{Color32, Painter, Pos2, RichText, Stroke, Ui};
use firstbounce_capture::set::Subject;
use firstbounce_core::image::statistics::Region;

use super::OnSubject;
use crate::app::views::Over;
use crate::app::views::canvas::Transform;
use crate::app::widgets::number_field::up_to;
use crate::app::widgets::theme::Weight;

/// What dragging on a picture draws.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Tool {
    /// Nothing: it moves the picture.
    #[default]
    Pan,
    Rectangle,
    Lasso,
    Line,
}

impl Tool {
    const ALL: [(Self, &'static str); 4] =
        [(Self::Pan, "Move picture"), (Self::Rectangle, "Rectangle"), (Self::Lasso, "Lasso"), (Self::Line, "Line")];
}

/// The tool in hand and what was drawn.
#[derive(Default)]
pub struct Tools {
    tool: Tool,
    region: OnSubject<Region>,
    line: OnSubject<[[f64; 2]; 2]>,
    drawing: bool,
}

impl Tools {
    /// The region on pictures of this subject.
    pub fn region(&self, subject: Subject) -> Option<&Region> {
        self.region.as_ref().filter(|(of, _)| *of == subject).map(|(_, region)| region)
    }

    /// The line on pictures of this subject.
    pub fn line(&self, subject: Subject) -> Option<[[f64; 2]; 2]> {
        self.line.filter(|(of, _)| *of == subject).map(|(_, line)| line)
    }

    /// Whether drags are for drawing.
    pub fn wants_drag(&self, _: Subject) -> bool {
        self.tool != Tool::Pan
    }

    pub fn ui(&mut self, ui: &mut Ui, subject: Subject, size: (usize, usize)) {
        ui.add_space(4.0);
        ui.label(RichText::new("Dragging on a picture draws").semi_bold());
        ui.horizontal_wrapped(|ui| {
            for (tool, name) in Tool::ALL {
                ui.radio_value(&mut self.tool, tool, name);
            }
        });
        let (width, height) = (size.0 as f64, size.1 as f64);
        match self.tool {
            Tool::Pan => {}
            Tool::Rectangle => {
                let mut corners = match self.region(subject) {
                    Some(Region::Rectangle(a, b)) => [*a, *b],
                    _ => [[0.0, 0.0], [width, height]],
                };
                if points(ui, ["Left", "Top", "Right", "Bottom"], &mut corners, size) {
                    self.region = Some((subject, Region::Rectangle(corners[0], corners[1])));
                }
            }
            Tool::Line => {
                let middle = [[0.0, height / 2.0], [width, height / 2.0]];
                let mut ends = self.line(subject).unwrap_or(middle);
                if points(ui, ["From x", "From y", "To x", "To y"], &mut ends, size) {
                    self.line = Some((subject, ends));
                }
            }
            Tool::Lasso => {
                ui.label(RichText::new("Drag around what is to be measured.").weak());
            }
        }
        ui.horizontal_wrapped(|ui| {
            if self.region(subject).is_some() && ui.button("Clear region").clicked() {
                self.region = None;
            }
            if self.line(subject).is_some() && ui.button("Clear line").clicked() {
                self.line = None;
            }
        });
    }

    /// Takes the drag of this frame and draws what there is.
    pub fn overlay(&mut self, ui: &mut Ui, over: &Over<'_>) {
        let subject = over.shown.subject();
        if let Some(drag) = over.canvas.dragged.filter(|_| self.tool != Tool::Pan) {
            let starts = !self.drawing;
            self.drawing = !drag.finished;
            match self.tool {
                Tool::Pan => {}
                Tool::Rectangle => self.region = Some((subject, Region::Rectangle(drag.from_px, drag.to_px))),
                Tool::Line => self.line = Some((subject, [drag.from_px, drag.to_px])),
                Tool::Lasso => self.lasso(subject, starts, drag.from_px, drag.to_px),
            }
        }
        let painter = ui.painter_at(over.canvas.transform.rect);
        if let Some(region) = self.region(subject) {
            outline(&painter, &over.canvas.transform, &corners_of(region), true);
        }
        if let Some(line) = self.line(subject) {
            outline(&painter, &over.canvas.transform, &line, false);
        }
    }

    fn lasso(&mut self, subject: Subject, starts: bool, from_px: [f64; 2], to_px: [f64; 2]) {
        match &mut self.region {
            Some((of, Region::Lasso(corners))) if *of == subject && !starts => {
                if corners.last() != Some(&to_px) {
                    corners.push(to_px);
                }
            }
            region => *region = Some((subject, Region::Lasso(vec![from_px, to_px]))),
        }
    }
}

/// Four fields for two points; whether one was changed.
fn points(ui: &mut Ui, names: [&str; 4], points: &mut [[f64; 2]; 2], size: (usize, usize)) -> bool {
    let mut changed = false;
    let [[x0, y0], [x1, y1]] = points;
    ui.horizontal_wrapped(|ui| {
        for (i, (name, value)) in names.into_iter().zip([x0, y0, x1, y1]).enumerate() {
            let end = if i % 2 == 0 { size.0 } else { size.1 } as f64;
            let label = ui.label(name);
            let field = up_to(value, 1, 0.0..=end).suffix(" px");
            changed |= ui.add(field).labelled_by(label.id).changed();
        }
    });
    changed
}

fn corners_of(region: &Region) -> Vec<[f64; 2]> {
    match region {
        Region::Rectangle(a, b) => vec![*a, [b[0], a[1]], *b, [a[0], b[1]]],
        Region::Lasso(corners) => corners.clone(),
    }
}

/// Light on dark, so that it shows on any picture.
fn outline(painter: &Painter, transform: &Transform, corners: &[[f64; 2]], closed: bool) {
    let mut points: Vec<Pos2> = corners.iter().map(|corner| transform.to_screen(*corner)).collect();
    if closed {
        points.extend(points.first().copied());
    }
    painter.line(points.clone(), Stroke::new(3.0, Color32::BLACK));
    painter.line(points, Stroke::new(1.5, Color32::from_rgb(255, 214, 64)));
}
