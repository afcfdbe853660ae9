//! The canvas overlay: the pixel grid and the numbers in the pixels.

use eframe::egui::{Align2, Color32, FontId, Painter, Stroke};

use super::view::Transform;
use crate::gpu::{Display, Source, shade};

/// Physical pixels of the screen for a pixel of the picture, from which the grid is drawn.
const GRID_FROM: f32 = 16.0;
/// The same for numbers.
const NUMBERS_FROM: f32 = 40.0;

/// Lines between the pixels, and their numbers, when they are large enough.
pub fn close_up(painter: &Painter, transform: &Transform, source: &Source, display: &Display, background: [f32; 3]) {
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
            for x in columns.clone() {
                let ink = ink_on(shade(source, display, (x, y), background));
                numbers(painter, transform, &source.values_at(x, y), (x, y), ink);
            }
        }
    }
}

/// Black or white, whichever has more contrast (contrast ratio of WCAG 2.2).
fn ink_on([red, green, blue, _]: [u8; 4]) -> Color32 {
    let linear = |channel: u8| (f32::from(channel) / 255.0).powf(2.2);
    let luminance = 0.2126 * linear(red) + 0.7152 * linear(green) + 0.0722 * linear(blue);
    let (with_black, with_white) = ((luminance + 0.05) / 0.05, 1.05 / (luminance + 0.05));
    if with_black > with_white { Color32::BLACK } else { Color32::WHITE }
}

fn numbers(painter: &Painter, transform: &Transform, values: &[f32], (x, y): (usize, usize), ink: Color32) {
    // Six characters fill the pixel's width, three lines its height.
    let font = FontId::monospace(transform.points_per_px() / 4.4);
    let text = values.iter().map(|&value| short_number(value)).collect::<Vec<_>>().join("\n");
    painter.text(transform.to_screen([x as f64 + 0.5, y as f64 + 0.5]), Align2::CENTER_CENTER, text, font, ink);
}

/// A number in at most six characters.
pub fn short_number(value: f32) -> String {
    match value.abs() {
        0.0 => "0".to_owned(),
        size if !(0.001..99_999.5).contains(&size) => format!("{value:.0e}"),
        size if size < 9.9995 => format!("{value:.3}"),
        size if size < 999.95 => format!("{value:.1}"),
        _ => format!("{value:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_out_on_every_colour() {
        let luminance = |[red, green, blue]: [u8; 3]| {
            let linear = |channel: u8| (f32::from(channel) / 255.0).powf(2.2);
            0.2126 * linear(red) + 0.7152 * linear(green) + 0.0722 * linear(blue)
        };
        let steps = || (0..=255_u8).step_by(15);
        for red in steps() {
            for (green, blue) in steps().flat_map(|green| steps().map(move |blue| (green, blue))) {
                let below = luminance([red, green, blue]);
                let ink = luminance(ink_on([red, green, blue, 255]).to_array()[..3].try_into().unwrap());
                let (light, dark) = (below.max(ink), below.min(ink));
                assert!((light + 0.05) / (dark + 0.05) > 4.5, "{red} {green} {blue}");
            }
        }
    }

    #[test]
    fn numbers_fit_their_pixels() {
        for (value, text) in [
            (0.0, "0"),
            (0.12345, "0.123"),
            (-0.5, "-0.500"),
            (12.34, "12.3"),
            (-999.94, "-999.9"),
            (-9.9999, "-10.0"),
            (65535.0, "65535"),
            (1.0e6, "1e6"),
            (-0.00012, "-1e-4"),
        ] {
            assert_eq!(short_number(value), text);
            assert!(text.len() <= 6);
        }
    }
}
