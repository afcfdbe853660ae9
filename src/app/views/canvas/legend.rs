//! Which value has which colour.

use eframe::egui::{Align2, Color32, FontId, Mesh, Painter, Pos2, Rect, Shape, StrokeKind, pos2, vec2};

use super::overlay::short_number;
use crate::gpu::{Display, Kind, Source, colour_of_value};

const BAR: (f32, f32) = (170.0, 10.0);
/// Of a legend without words, on a canvas that is narrower than [`SMALL`].
const SMALL_BAR: (f32, f32) = (80.0, 8.0);
const SMALL: f32 = 340.0;
const MARGIN: f32 = 8.0;
const LINE: f32 = 15.0;
const STEPS: usize = 64;

/// Colours and normals explain themselves: only single values go through the colour map.
pub fn has_legend(source: &Source) -> bool {
    !matches!(source.kind(), Kind::Colour | Kind::Normal)
}

/// What the legend says to those who cannot see it.
pub fn text(display: &Display, quantity: &str) -> String {
    let [low, high] = display.legend_range().map(tick);
    format!("{quantity}, {} from {low} to {high}", display.map.name())
}

/// The quantity, the colour map and the values at its ends and in its middle, in a corner of the canvas.
pub fn paint(painter: &Painter, canvas: Rect, corner: Align2, display: &Display, quantity: &str) {
    let is_small = canvas.width() < SMALL;
    let (width, height) = if is_small { SMALL_BAR } else { BAR };
    let above = if is_small { MARGIN / 2.0 } else { LINE + 2.0 };
    let size = vec2(width + 2.0 * MARGIN, height + above + LINE + MARGIN / 2.0);
    let frame = corner.align_size_within_rect(size, canvas.shrink(MARGIN));
    // Its own dark plate: legible on any picture, in either theme.
    painter.rect(frame, 4.0, Color32::from_black_alpha(235), (1.0, Color32::from_gray(96)), StrokeKind::Inside);
    let write = |at: Pos2, align: Align2, text: &str| {
        painter.text(at, align, text, FontId::proportional(11.0), Color32::from_gray(235));
    };
    let bar = Rect::from_min_size(frame.min + vec2(MARGIN, above), vec2(width, height));
    if !is_small {
        write(bar.left_top() - vec2(0.0, 1.0), Align2::LEFT_BOTTOM, quantity);
    }
    painter.add(Shape::mesh(bar_mesh(bar, display)));
    let [low, high] = display.legend_range();
    let below = bar.bottom() + 1.0;
    write(pos2(bar.left(), below), Align2::LEFT_TOP, &tick(low));
    if !is_small {
        write(pos2(bar.center().x, below), Align2::CENTER_TOP, &tick(0.5 * (low + high)));
    }
    write(pos2(bar.right(), below), Align2::RIGHT_TOP, &tick(high));
}

/// A short number without the zeros at its end.
fn tick(value: f32) -> String {
    let text = short_number(value);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

fn bar_mesh(bar: Rect, display: &Display) -> Mesh {
    let [low, high] = display.legend_range();
    let mut mesh = Mesh::default();
    for step in 0..=STEPS {
        let along = step as f32 / STEPS as f32;
        let [red, green, blue] = colour_of_value(low + along * (high - low), display);
        let x = bar.left() + along * bar.width();
        let colour = Color32::from_rgb(red, green, blue);
        mesh.colored_vertex(pos2(x, bar.top()), colour);
        mesh.colored_vertex(pos2(x, bar.bottom()), colour);
        if step > 0 {
            let last = 2 * step as u32;
            mesh.add_triangle(last - 2, last - 1, last);
            mesh.add_triangle(last - 1, last, last + 1);
        }
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_as_short_as_they_can_be() {
        assert_eq!([1.0, -0.25, 100.0, 0.0, 1.0e6].map(tick), ["1", "-0.25", "100", "0", "1e6"]);
    }

    #[test]
    fn the_text_names_quantity_map_and_ends() {
        assert_eq!(text(&Display::signed(0.5), "Residual, of white"), "Residual, of white, Signed from -0.5 to 0.5");
    }
}
