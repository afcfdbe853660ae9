//! Words over a picture.

use eframe::egui::{Align2, Color32, FontId, Painter, Pos2, Rect, vec2};

/// Words on a dark plate whose `align` point lies at `at`, legible on any picture in either theme; where the plate lies.
pub fn plate(painter: &Painter, at: Pos2, align: Align2, words: &str) -> Rect {
    let text = painter.layout_no_wrap(words.to_owned(), FontId::proportional(12.0), Color32::from_gray(235));
    let plate = align.anchor_size(at, text.size() + vec2(10.0, 6.0));
    if !words.is_empty() {
        painter.rect_filled(plate, 4.0, Color32::from_black_alpha(220));
        painter.galley(plate.min + vec2(5.0, 3.0), text, Color32::PLACEHOLDER);
    }
    plate
}

/// The same in a corner of a canvas, a little away from its edge.
pub fn plate_in(painter: &Painter, canvas: Rect, corner: Align2, words: &str) -> Rect {
    plate(painter, corner.pos_in_rect(&canvas.shrink(6.0)), corner, words)
}
