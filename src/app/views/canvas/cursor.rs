//! The pixel cursor: pointing at a pixel without a pointer.

use eframe::egui::{Color32, Key, Painter, Rect, Response, Stroke, StrokeKind, Ui};

use super::view::{Transform, View};

/// Points from the cursor's middle to the end of its arms.
const ARM: f32 = 9.0;

/// Moves the cursor by Shift and arrow keys, Ctrl for ten pixels; it starts in the middle of the canvas. Returns the view that
/// keeps it in sight, if that is another one.
pub fn walk(
    ui: &Ui,
    response: &Response,
    transform: &Transform,
    size: (usize, usize),
    cursor: &mut Option<(usize, usize)>,
) -> Option<View> {
    *cursor = cursor.filter(|&(x, y)| x < size.0 && y < size.1);
    let (right, down) = ui.input(|input| {
        let presses = |key| input.num_presses(key) as i64;
        let step = if input.modifiers.command { 10 } else { 1 };
        let right = presses(Key::ArrowRight) - presses(Key::ArrowLeft);
        let down = presses(Key::ArrowDown) - presses(Key::ArrowUp);
        if input.modifiers.shift { (step * right, step * down) } else { (0, 0) }
    });
    if !response.has_focus() || (right, down) == (0, 0) || size.0 == 0 || size.1 == 0 {
        return None;
    }
    let middle = transform.from_screen(transform.rect.center());
    let (x, y) = cursor.unwrap_or((middle[0].max(0.0) as usize, middle[1].max(0.0) as usize));
    let moved = |from: usize, by: i64, length: usize| (from as i64 + by).clamp(0, length as i64 - 1) as usize;
    let (x, y) = (moved(x, right, size.0), moved(y, down, size.1));
    *cursor = Some((x, y));
    let at = transform.to_screen([x as f64 + 0.5, y as f64 + 0.5]);
    (!transform.rect.contains(at)).then(|| transform.panned(transform.rect.center() - at))
}

/// A frame around the pixel, or a cross when the pixel is small; dark on light, so that it shows on any picture.
pub fn paint(painter: &Painter, transform: &Transform, cursor: Option<(usize, usize)>) {
    let Some((x, y)) = cursor else { return };
    let (x, y) = (x as f64, y as f64);
    let pixel = Rect::from_min_max(transform.to_screen([x, y]), transform.to_screen([x + 1.0, y + 1.0]));
    let at = pixel.center();
    for stroke in [Stroke::new(3.0, Color32::BLACK), Stroke::new(1.0, Color32::WHITE)] {
        if pixel.width() > ARM {
            painter.rect_stroke(pixel, 0.0, stroke, StrokeKind::Middle);
        } else {
            painter.hline(at.x - ARM..=at.x + ARM, at.y, stroke);
            painter.vline(at.x, at.y - ARM..=at.y + ARM, stroke);
        }
    }
}
