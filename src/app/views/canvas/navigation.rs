//! Moving about a picture by mouse, trackpad, touch and keys.

use eframe::egui::{EventFilter, InputState, Key, PointerButton, Response, Ui, Vec2, vec2};

use super::view::{Transform, View};

/// How much larger a press of + makes the picture.
const KEY_ZOOM: f32 = 1.25;
/// How far an arrow key moves the picture, as a part of the canvas.
const KEY_PAN: f32 = 0.1;
/// Points of wheel travel that make the picture e times larger.
const WHEEL_TRAVEL: f32 = 240.0;

/// What dragging with the primary button does. The middle button always moves the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum PrimaryDrag {
    /// Moves the picture.
    #[default]
    Pan,
    /// Is left to the caller: a brush, a lasso, a rectangle.
    Caller,
}

/// The view after what the user did in this frame.
pub fn navigate(ui: &Ui, response: &Response, transform: &Transform, view: View, primary: PrimaryDrag) -> View {
    if response.dragged_by(PointerButton::Middle)
        || (primary == PrimaryDrag::Pan && response.dragged_by(PointerButton::Primary))
    {
        return transform.panned(response.drag_delta());
    }
    // Also over what the caller drew on top.
    if let Some(anchor) = ui.input(|input| input.pointer.hover_pos()).filter(|_| response.contains_pointer()) {
        let factor = ui.input_mut(wheel_zoom);
        if factor != 1.0 {
            return transform.zoomed(factor, anchor);
        }
    }
    if response.has_focus() {
        let arrows = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
        return ui.input(|input| by_keys(input, transform)).unwrap_or(view);
    }
    view
}

/// How much larger wheel and pinch make the picture; what they did is used up, so that nothing around the canvas scrolls.
fn wheel_zoom(input: &mut InputState) -> f32 {
    let travel = input.smooth_scroll_delta().y;
    input.smooth_scroll_delta = Vec2::ZERO;
    (travel / WHEEL_TRAVEL).exp() * input.zoom_delta()
}

fn by_keys(input: &InputState, transform: &Transform) -> Option<View> {
    // With Ctrl or Alt the same keys belong to the window.
    if input.modifiers.command || input.modifiers.alt {
        return None;
    }
    let pressed = |key| input.key_pressed(key);
    let middle = transform.rect.center();
    if pressed(Key::Plus) || pressed(Key::Equals) {
        return Some(transform.zoomed(KEY_ZOOM, middle));
    }
    if pressed(Key::Minus) {
        return Some(transform.zoomed(1.0 / KEY_ZOOM, middle));
    }
    // With Shift the arrows move the pixel cursor; + needs Shift on some keyboards.
    if input.modifiers.shift {
        return None;
    }
    let presses = |key| input.num_presses(key) as f32;
    let step =
        vec2(presses(Key::ArrowLeft) - presses(Key::ArrowRight), presses(Key::ArrowUp) - presses(Key::ArrowDown));
    (step != Vec2::ZERO).then(|| transform.panned(step * KEY_PAN * transform.rect.size()))
}
