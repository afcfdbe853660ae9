//! Moving the eye by mouse, trackpad, touch and keys.

use eframe::egui::{EventFilter, InputState, Key, PointerButton, Pos2, Rect, Response, Ui, Vec2};
use nalgebra::Point3;

use crate::gpu::mesh::{Bounds, Camera, Frame};

/// Degrees for a point of dragging.
const DRAG_DEG: f64 = 0.4;
/// Degrees for a press of an arrow key.
const KEY_DEG: f64 = 10.0;
/// Part of the view's height for a press of Shift and an arrow key.
const KEY_PAN: f64 = 0.1;
/// How much nearer a press of + goes.
const KEY_ZOOM: f64 = 0.8;
/// Points of wheel travel that take the eye e times nearer.
const WHEEL_TRAVEL: f32 = 240.0;
/// The keys, for those who cannot see them in use.
pub const KEYS: &str = "Arrow keys turn the object, with Shift they move it, plus and minus go nearer and farther, F shows all \
                        of it. Enter picks the point in the middle. Holding B shows the surface before instead.";

/// What the eye does after what the user did in this frame.
pub enum Moved {
    /// Nothing.
    No,
    /// To here.
    To(Camera),
}

/// The place of a point of the screen in the view.
pub fn in_view(rect: Rect, point: Pos2) -> [f64; 2] {
    [f64::from(point.x - rect.left()), f64::from(point.y - rect.top())]
}

/// Takes the eye where the user wants it. `hit` finds which point of the surface is seen at a place of the view.
pub fn navigate(
    ui: &Ui,
    response: &Response,
    (camera, frame, bounds): (&Camera, &Frame, &Bounds),
    hit: &dyn Fn([f64; 2]) -> Option<Point3<f64>>,
) -> Moved {
    let rect = response.rect;
    let at = |point: Pos2| in_view(rect, point);
    let seen = |place: [f64; 2]| hit(place).unwrap_or_else(|| frame.on_target_plane(place));
    if response.double_clicked() {
        let point = response.interact_pointer_pos().and_then(|point| hit(at(point)));
        return point.map_or(Moved::No, |point| Moved::To(camera.looking_at(&point)));
    }
    let shift = ui.input(|input| input.modifiers.shift);
    let by = |button| response.dragged_by(button);
    let delta = response.drag_delta();
    if by(PointerButton::Middle) || by(PointerButton::Secondary) || (by(PointerButton::Primary) && shift) {
        let height = f64::from(rect.height().max(1.0));
        return Moved::To(camera.panned(f64::from(delta.x) / height, -f64::from(delta.y) / height));
    }
    if by(PointerButton::Primary) && delta != Vec2::ZERO {
        return Moved::To(camera.orbited(-DRAG_DEG * f64::from(delta.x), DRAG_DEG * f64::from(delta.y)));
    }
    if let Some(pointer) = ui.input(|input| input.pointer.hover_pos()).filter(|_| response.contains_pointer()) {
        let factor = ui.input_mut(wheel_factor);
        if factor != 1.0 {
            return Moved::To(camera.dollied(f64::from(factor), &seen(at(pointer)), bounds));
        }
    }
    if response.has_focus() {
        let arrows = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
        return ui.input(|input| by_keys(input, camera, bounds));
    }
    Moved::No
}

/// How far wheel and pinch take the eye; what they did is used up, so that nothing around the view scrolls.
fn wheel_factor(input: &mut InputState) -> f32 {
    let travel = input.smooth_scroll_delta().y;
    input.smooth_scroll_delta = Vec2::ZERO;
    (-travel / WHEEL_TRAVEL).exp() / input.zoom_delta()
}

fn by_keys(input: &InputState, camera: &Camera, bounds: &Bounds) -> Moved {
    // With Ctrl or Alt the same keys belong to the window.
    if input.modifiers.command || input.modifiers.alt {
        return Moved::No;
    }
    let pressed = |key| input.key_pressed(key);
    if pressed(Key::Plus) || pressed(Key::Equals) {
        return Moved::To(camera.dollied(KEY_ZOOM, &camera.target(), bounds));
    }
    if pressed(Key::Minus) {
        return Moved::To(camera.dollied(1.0 / KEY_ZOOM, &camera.target(), bounds));
    }
    let presses = |key| input.num_presses(key) as f64;
    let right = presses(Key::ArrowRight) - presses(Key::ArrowLeft);
    let up = presses(Key::ArrowUp) - presses(Key::ArrowDown);
    if right == 0.0 && up == 0.0 {
        return Moved::No;
    }
    Moved::To(match input.modifiers.shift {
        true => camera.panned(KEY_PAN * right, KEY_PAN * up),
        false => camera.orbited(-KEY_DEG * right, -KEY_DEG * up),
    })
}
