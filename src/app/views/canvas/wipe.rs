//! The line between two pictures, which the user drags.

use eframe::egui::accesskit::{Action, ActionData};
use eframe::egui::{CursorIcon, EventFilter, Id, Key, Rect, Response, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

/// How far an arrow key moves the line, as a part of the canvas' width.
const STEP: f32 = 0.02;
/// Points on either side of the line that can be grabbed.
const GRAB: f32 = 6.0;

/// Draws the line at `wipe` of the canvas' width, 0 to 1, and moves it: a slider by mouse, keyboard and accessible name.
pub fn handle(ui: &Ui, id: Id, canvas: Rect, wipe: &mut f32, label: &str) -> Response {
    let x = canvas.left() + *wipe * canvas.width();
    let grab = Rect::from_min_max(pos2(x - GRAB, canvas.top()), pos2(x + GRAB, canvas.bottom()));
    let mut response = ui.interact(grab, id, Sense::click_and_drag()).on_hover_cursor(CursorIcon::ResizeHorizontal);

    let before = *wipe;
    if let Some(pointer) = response.interact_pointer_pos() {
        *wipe = (pointer.x - canvas.left()) / canvas.width().max(1.0);
        response.request_focus();
    }
    if response.has_focus() {
        let arrows = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(id, arrows));
        *wipe += STEP * ui.input(|input| steps(input, Key::ArrowRight) - steps(input, Key::ArrowLeft));
    }
    ui.input(|input| {
        let asked = |action| input.num_accesskit_action_requests(id, action) as f32;
        *wipe += STEP * (asked(Action::Increment) - asked(Action::Decrement));
        for request in input.accesskit_action_requests(id, Action::SetValue) {
            if let Some(ActionData::NumericValue(value)) = request.data {
                *wipe = value as f32;
            }
        }
    });
    *wipe = wipe.clamp(0.0, 1.0);
    if *wipe != before {
        response.mark_changed();
    }

    let value = f64::from(*wipe);
    response.widget_info(|| WidgetInfo::slider(ui.is_enabled(), value, label));
    ui.ctx().accesskit_node_builder(id, |node| {
        node.set_min_numeric_value(0.0);
        node.set_max_numeric_value(1.0);
        node.set_numeric_value_step(f64::from(STEP));
        [Action::SetValue, Action::Increment, Action::Decrement].into_iter().for_each(|action| node.add_action(action));
    });
    paint(ui, canvas, *wipe, &response);
    response
}

fn steps(input: &eframe::egui::InputState, key: Key) -> f32 {
    input.num_presses(key) as f32
}

fn paint(ui: &Ui, canvas: Rect, wipe: f32, response: &Response) {
    let x = canvas.left() + wipe * canvas.width();
    let visuals = ui.style().interact(response);
    let painter = ui.painter().with_clip_rect(canvas.intersect(ui.clip_rect()));
    // A dark rim keeps the line visible on any picture.
    painter.vline(x, canvas.y_range(), Stroke::new(4.0, eframe::egui::Color32::from_black_alpha(120)));
    painter.vline(x, canvas.y_range(), Stroke::new(2.0, visuals.fg_stroke.color));
    let grip = Rect::from_center_size(pos2(x, canvas.center().y), vec2(10.0, 28.0));
    let outline = if response.has_focus() { ui.visuals().selection.stroke } else { visuals.fg_stroke };
    painter.rect(grip, 4.0, visuals.bg_fill, outline, eframe::egui::StrokeKind::Inside);
}
