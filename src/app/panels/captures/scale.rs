//! The scale of the object, from a line of known length that is drawn on a photo of it.

use eframe::egui::{Button, Color32, Stroke, Ui};
use firstbounce_capture::set::{Number, Projection, Subject};

use crate::app::state::layout::Shown;
use crate::app::state::results::ShotName;
use crate::app::state::session::Session;
use crate::app::views::Over;
use crate::app::widgets::number_field::up_to;

/// Shorter lines say too little: a pixel more or less is 5 % of this one.
const MIN_LENGTH_PX: f64 = 20.0;

/// The line, and what it is long.
pub struct ScalePart {
    /// Whether drags on the object's photos draw the line.
    draws: bool,
    ends_px: Option<[[f64; 2]; 2]>,
    length_mm: f64,
}

impl Default for ScalePart {
    fn default() -> Self {
        Self { draws: false, ends_px: None, length_mm: 10.0 }
    }
}

impl ScalePart {
    pub fn ui(&mut self, ui: &mut Ui, session: &mut Session) {
        if !self.draws {
            let hover = "For a ruler, or any two points of the object whose distance you know";
            if ui.button("Draw a line of known length").on_hover_text(hover).clicked() {
                self.draws = true;
                if let Some(shot) = session.document().set.shots_of(Subject::Object).next() {
                    session.views.show(Shown::Photo(ShotName::of(shot)));
                }
            }
            return;
        }
        ui.group(|ui| {
            let length_px = self.length_px();
            ui.label(match length_px {
                Some(length) => format!("The line is {length:.1} px long."),
                None => format!("Drag along a known length on a photo of the object, {MIN_LENGTH_PX} px at least."),
            });
            let label = ui.label("Its length in mm");
            ui.add(up_to(&mut self.length_mm, 4, 1e-6..=1e6).speed(0.05)).labelled_by(label.id);
            let mm_per_px = length_px.map(|length| self.length_mm / length);
            ui.horizontal_wrapped(|ui| {
                let words = match mm_per_px {
                    Some(scale) => format!("Use {scale:.6} mm per pixel"),
                    None => "Use this scale".into(),
                };
                if ui.add_enabled(mm_per_px.is_some(), Button::new(words)).clicked() {
                    mm_per_px.into_iter().for_each(|scale| use_scale(session, scale));
                    *self = Self { length_mm: self.length_mm, ..Self::default() };
                }
                if ui.button("Cancel the line").clicked() {
                    *self = Self { length_mm: self.length_mm, ..Self::default() };
                }
            });
        });
    }

    fn length_px(&self) -> Option<f64> {
        let [[x0, y0], [x1, y1]] = self.ends_px?;
        Some((x1 - x0).hypot(y1 - y0)).filter(|length| *length >= MIN_LENGTH_PX)
    }

    pub fn wants_drag(&self, shown: &Shown) -> bool {
        self.draws && shown.subject() == Subject::Object
    }

    /// Takes the drag of this frame and draws the line.
    pub fn overlay(&mut self, ui: &Ui, over: &Over<'_>) {
        if !self.wants_drag(over.shown) {
            return;
        }
        if let Some(drag) = over.canvas.dragged {
            self.ends_px = Some([drag.from_px, drag.to_px]);
        }
        let Some(ends_px) = self.ends_px else { return };
        let painter = ui.painter_at(over.canvas.transform.rect);
        let ends = ends_px.map(|end| over.canvas.transform.to_screen(end));
        painter.line_segment(ends, Stroke::new(3.0, Color32::BLACK));
        painter.line_segment(ends, Stroke::new(1.5, Color32::from_rgb(255, 214, 64)));
    }
}

/// Of a perspective camera the scale at the object's z = 0 gives the distance.
fn use_scale(session: &mut Session, mm_per_px: f64) {
    let within = |what: Number, value: f64| value.clamp(*what.range().start(), *what.range().end());
    session.edit("Measure the scale", |document| match &mut document.set.camera.projection {
        Projection::Orthographic { mm_per_pixel } => *mm_per_pixel = Some(within(Number::MmPerPixel, mm_per_px)),
        Projection::Perspective { focal_length_px, working_distance_mm, .. } => {
            *working_distance_mm = within(Number::WorkingDistanceMm, mm_per_px * *focal_length_px);
        }
    });
}
