//! The overlay of a 3D view: scale bar, axes, picked points.

use eframe::egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, Vec2, vec2};
use nalgebra::Point3;

use crate::app::widgets::plate::plate;
use crate::gpu::mesh::Frame;

const MARGIN: f32 = 12.0;
/// The scale bar is at most this part of the view's width.
const BAR_PART: f64 = 0.25;
const AXIS: f32 = 26.0;
const AXES: [(&str, Color32); 3] = [
    ("x", Color32::from_rgb(226, 88, 80)),
    ("y", Color32::from_rgb(96, 186, 92)),
    ("z", Color32::from_rgb(88, 140, 236)),
];

/// A length of the object that is round, and how long it is on the screen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScaleBar {
    /// In the object's unit.
    pub length: f64,
    /// On the screen.
    pub points: f32,
}

impl ScaleBar {
    /// The longest of 1, 2, 5, 10, ... that fits into a part of a view of this width.
    pub fn of(frame: &Frame, width: f32) -> Self {
        let unit = frame.unit_on_target();
        let longest = f64::from(width) * BAR_PART * unit;
        let decade = 10f64.powf(longest.log10().floor());
        let length = [5.0, 2.0, 1.0].into_iter().map(|step| step * decade).find(|length| *length <= longest);
        let length = length.unwrap_or(decade);
        Self { length, points: (length / unit) as f32 }
    }

    /// "20 mm"
    pub fn words(&self, unit: &str) -> String {
        let decimals = (-self.length.log10().floor()).clamp(0.0, 9.0) as usize;
        format!("{:.decimals$} {unit}", self.length)
    }
}

/// The bar with its length, at the lower left.
pub fn scale_bar(painter: &Painter, rect: Rect, bar: &ScaleBar, unit: &str, ink: Color32) {
    let left = rect.left_bottom() + vec2(MARGIN, -MARGIN);
    let right = left + vec2(bar.points, 0.0);
    let stroke = Stroke::new(2.0, ink);
    painter.line_segment([left, right], stroke);
    for end in [left, right] {
        painter.line_segment([end - vec2(0.0, 4.0), end + vec2(0.0, 4.0)], stroke);
    }
    let middle = left.lerp(right, 0.5) - vec2(0.0, 4.0);
    painter.text(middle, Align2::CENTER_BOTTOM, bar.words(unit), FontId::proportional(12.0), ink);
}

/// x right, y up, z toward the photographing camera, as they lie now; what points at the viewer is drawn last.
pub fn axes(painter: &Painter, rect: Rect, frame: &Frame) {
    let origin = rect.left_bottom() + vec2(MARGIN + AXIS + 8.0, -MARGIN - AXIS - 34.0);
    let [right, up, back] = frame.axes();
    let mut drawn: Vec<_> = AXES
        .iter()
        .enumerate()
        .map(|(axis, (name, colour))| {
            let tip = vec2(right[axis] as f32, -(up[axis] as f32)) * AXIS;
            (back[axis], tip, *name, *colour)
        })
        .collect();
    drawn.sort_by(|(one, ..), (other, ..)| one.total_cmp(other));
    for (_, tip, name, colour) in drawn {
        painter.line_segment([origin, origin + tip], Stroke::new(2.0, colour));
        let beyond = if tip.length() > 4.0 { tip.normalized() * 9.0 } else { vec2(7.0, -7.0) };
        painter.text(origin + tip + beyond, Align2::CENTER_CENTER, name, FontId::proportional(12.0), colour);
    }
}

/// Where a point of the object is on the screen.
pub fn on_screen(frame: &Frame, rect: Rect, point: &Point3<f64>) -> Option<Pos2> {
    let [x, y, _] = frame.project(point)?;
    Some(rect.min + vec2(x as f32, y as f32))
}

/// A ring around a picked point with its name.
pub fn mark(painter: &Painter, at: Pos2, name: &str, colour: Color32) {
    painter.circle_stroke(at, 5.0, Stroke::new(3.5, Color32::from_black_alpha(180)));
    painter.circle_stroke(at, 5.0, Stroke::new(1.8, colour));
    plate(painter, at + vec2(9.0, -9.0), Align2::LEFT_BOTTOM, name);
}

/// A line between two picked points with its length.
pub fn measured(painter: &Painter, from: Pos2, to: Pos2, words: &str, colour: Color32) {
    painter.line_segment([from, to], Stroke::new(3.5, Color32::from_black_alpha(180)));
    painter.line_segment([from, to], Stroke::new(1.8, colour));
    plate(painter, from.lerp(to, 0.5), Align2::CENTER_CENTER, words);
}

/// The point that Enter picks.
pub fn crosshair(painter: &Painter, rect: Rect, ink: Color32) {
    let middle = rect.center();
    for arm in [vec2(8.0, 0.0), vec2(0.0, 8.0)] {
        painter.line_segment([middle - arm, middle + arm], Stroke::new(1.0, ink));
    }
}

/// The size of a view in whole physical pixels, and its top left corner.
pub fn physical(rect: Rect, pixels_per_point: f32) -> ([f32; 2], [u32; 2]) {
    let round = |corner: Pos2| (corner.to_vec2() * pixels_per_point).round();
    let (from, to) = (round(rect.min), round(rect.max));
    let size: Vec2 = (to - from).max(Vec2::ZERO);
    ([from.x, from.y], [size.x as u32, size.y as u32])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gpu::mesh::{Bounds, Camera, Lens, StandardView};

    #[test]
    fn the_scale_bar_is_a_round_length_that_fits() {
        for radius in [0.003, 0.7, 12.0, 480.0] {
            let corner = nalgebra::Vector3::repeat(radius / 3.0_f64.sqrt());
            let bounds = Bounds::new(Point3::origin() - corner, Point3::origin() + corner);
            let camera = Camera::fitted(&bounds, StandardView::Front, Lens::Orthographic, 1.5);
            let frame = camera.frame([600.0, 400.0], &bounds);
            let bar = ScaleBar::of(&frame, 600.0);
            assert!(bar.points <= 150.001 && bar.points > 50.0, "{bar:?}");
            let lead = bar.length / 10f64.powf((bar.length.log10() + 1e-9).floor());
            assert!([1.0, 2.0, 5.0].iter().any(|step| (lead - step).abs() < 1e-6), "{bar:?}");
        }
        assert_eq!(ScaleBar { length: 0.05, points: 1.0 }.words("mm"), "0.05 mm");
        assert_eq!(ScaleBar { length: 200.0, points: 1.0 }.words("px"), "200 px");
    }
}
