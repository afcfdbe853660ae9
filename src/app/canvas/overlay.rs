//! What lies over the picture: the pixel grid, the numbers in the pixels, and the legend.

use eframe::egui::{
    Align2, Color32, FontId, Mesh, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, Visuals, pos2, vec2,
};

use super::view::Transform;
use crate::gpu::{Display, Kind, Source, colour_of_value, shade};

/// Physical pixels of the screen for a pixel of the picture, from which the grid is drawn.
const GRID_FROM: f32 = 16.0;
/// The same for numbers.
const NUMBERS_FROM: f32 = 40.0;
const LEGEND_SIZE: (f32, f32) = (160.0, 10.0);
const LEGEND_STEPS: usize = 64;

/// Lines between the pixels, and their numbers, when they are large enough.
pub fn close_up(painter: &Painter, transform: &Transform, source: &Source, display: &Display) {
    if transform.scale() < GRID_FROM {
        return;
    }
    let seen = transform.rect.intersect(transform.image_rect()).intersect(painter.clip_rect());
    if !seen.is_positive() {
        return;
    }
    let (first, last) = (transform.from_screen(seen.min), transform.from_screen(seen.max));
    let columns = first[0].max(0.0) as usize..=last[0] as usize;
    let rows = first[1].max(0.0) as usize..=last[1] as usize;
    let line = Stroke::new(1.0, Color32::from_gray(128).gamma_multiply(0.5));
    for x in columns.clone() {
        painter.vline(transform.to_screen([x as f64, 0.0]).x, seen.y_range(), line);
    }
    for y in rows.clone() {
        painter.hline(seen.x_range(), transform.to_screen([0.0, y as f64]).y, line);
    }
    if transform.scale() >= NUMBERS_FROM {
        for y in rows {
            columns.clone().for_each(|x| numbers(painter, transform, source, display, (x, y)));
        }
    }
}

fn numbers(painter: &Painter, transform: &Transform, source: &Source, display: &Display, (x, y): (usize, usize)) {
    let values = source.values_at(x, y);
    let [red, green, blue, _] = shade(source, display, (x, y)).map(f32::from);
    let bright = 0.299 * red + 0.587 * green + 0.114 * blue > 140.0;
    let ink = if bright { Color32::BLACK } else { Color32::WHITE };
    // Six characters fill the pixel's width, three lines its height.
    let font = FontId::monospace(transform.points_per_px() / 4.4);
    let text = values.iter().map(|&value| short_number(value)).collect::<Vec<_>>().join("\n");
    painter.text(transform.to_screen([x as f64 + 0.5, y as f64 + 0.5]), Align2::CENTER_CENTER, text, font, ink);
}

/// A number in at most six characters.
fn short_number(value: f32) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if !(0.001..99_999.5).contains(&size) => format!("{value:.0e}"),
        size if size < 10.0 => format!("{value:.3}"),
        size if size < 1000.0 => format!("{value:.1}"),
        _ => format!("{value:.0}"),
    }
}

/// What a legend says to those who cannot see it; `None` if the picture has none.
pub fn legend_text(source: &Source, display: &Display, unit: &str) -> Option<String> {
    if matches!(source.kind(), Kind::Colour | Kind::Normal) {
        return None;
    }
    let [low, high] = display.legend_range().map(short_number);
    Some(format!("{} from {low} to {high} {unit}", display.map.name()).trim_end().to_owned())
}

/// The colour map with the values at its ends and in its middle, in the corner of the canvas. Returns its place.
pub fn legend(painter: &Painter, canvas: Rect, display: &Display, unit: &str, visuals: &Visuals) -> Rect {
    let (width, height) = LEGEND_SIZE;
    let frame = Rect::from_min_max(canvas.max - vec2(width + 40.0, height + 34.0), canvas.max - vec2(8.0, 8.0));
    painter.rect(frame, 4.0, visuals.extreme_bg_color.gamma_multiply(0.85), visuals.window_stroke, StrokeKind::Inside);
    let bar = Rect::from_min_size(frame.min + vec2(16.0, 6.0), vec2(width, height));
    painter.add(Shape::mesh(bar_mesh(bar, display)));
    let [low, high] = display.legend_range();
    let middle = 0.5 * (low + high);
    for (value, align) in [(low, Align2::LEFT_TOP), (middle, Align2::CENTER_TOP), (high, Align2::RIGHT_TOP)] {
        let along = (value - low) / (high - low);
        let at = pos2(bar.left() + along * bar.width(), bar.bottom() + 2.0);
        let unit = if value == high && !unit.is_empty() { format!(" {unit}") } else { String::new() };
        painter.text(at, align, short_number(value) + &unit, FontId::proportional(10.0), visuals.text_color());
    }
    frame
}

fn bar_mesh(bar: Rect, display: &Display) -> Mesh {
    let [low, high] = display.legend_range();
    let mut mesh = Mesh::default();
    for step in 0..=LEGEND_STEPS {
        let along = step as f32 / LEGEND_STEPS as f32;
        let [red, green, blue] = colour_of_value(low + along * (high - low), display);
        let x = bar.left() + along * bar.width();
        let colour = Color32::from_rgb(red, green, blue);
        mesh.colored_vertex(Pos2::new(x, bar.top()), colour);
        mesh.colored_vertex(Pos2::new(x, bar.bottom()), colour);
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
    fn numbers_fit_their_pixels() {
        for (value, text) in [
            (0.0, "0"),
            (0.12345, "0.123"),
            (-0.5, "-0.500"),
            (12.34, "12.3"),
            (-999.94, "-999.9"),
            (65535.0, "65535"),
            (1.0e6, "1e6"),
            (-0.00012, "-1e-4"),
        ] {
            assert_eq!(short_number(value), text);
            assert!(text.len() <= 6);
        }
    }
}
