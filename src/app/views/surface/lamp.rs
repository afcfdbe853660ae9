//! A lamp to drag on a small dome over the corner of the view: a relief is judged under grazing light.

use eframe::egui::{Color32, Id, Key, Rect, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};

/// Of the dome, in points.
const RADIUS: f32 = 34.0;
/// Away from the edges of the view, in points.
const MARGIN: f32 = 12.0;
/// What an arrow key moves the lamp by, of the dome's radius.
const STEP: f32 = 0.05;
/// The lamp stays above the horizon.
const MOST: f32 = 0.98;

/// Draws the dome and moves the lamp on it: to it in the object's frame, x right, y up, z toward the camera, of length 1.
pub fn dome(ui: &Ui, id: Id, view: Rect, direction: [f32; 3]) -> Option<[f32; 3]> {
    let centre = pos2(view.right() - RADIUS - MARGIN, view.top() + RADIUS + MARGIN);
    let rect = Rect::from_center_size(centre, vec2(2.0 * RADIUS, 2.0 * RADIUS));
    let response = ui.interact(rect, id, Sense::click_and_drag());
    let length = direction.iter().map(|x| x * x).sum::<f32>().sqrt().max(f32::MIN_POSITIVE);
    let mut at = vec2(direction[0] / length, -direction[1] / length);

    let before = at;
    if let Some(pointer) = response.interact_pointer_pos() {
        at = (pointer - centre) / RADIUS;
        response.request_focus();
    }
    if response.has_focus() {
        let presses = |key| ui.input(|input| input.num_presses(key) as f32);
        at.x += STEP * (presses(Key::ArrowRight) - presses(Key::ArrowLeft));
        at.y += STEP * (presses(Key::ArrowDown) - presses(Key::ArrowUp));
    }
    if at.length() > MOST {
        at *= MOST / at.length();
    }

    let painter = ui.painter_at(view);
    painter.circle(centre, RADIUS, Color32::from_black_alpha(170), Stroke::new(1.0, Color32::from_gray(120)));
    painter.circle_stroke(centre, 0.5 * RADIUS, Stroke::new(1.0, Color32::from_gray(80)));
    let rim = if response.has_focus() { ui.visuals().selection.stroke } else { Stroke::new(1.0, Color32::BLACK) };
    painter.circle(centre + RADIUS * at, 6.0, Color32::from_rgb(255, 210, 90), rim);
    response.widget_info(|| WidgetInfo::labeled(Role::Slider, true, "Lamp to drag"));
    response.on_hover_text("Drag the lamp; the middle is straight above, the rim is the horizon");
    (at != before).then(|| [at.x, -at.y, (1.0 - at.length_sq()).max(0.0).sqrt()])
}
