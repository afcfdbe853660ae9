//! The overlay of a ball's photo: its pixels, its circle with handles, its highlights.

use eframe::egui::{Color32, EventFilter, Key, Pos2, Rect, Response, Role, Sense, Stroke, Ui, Vec2, WidgetInfo};
use firstbounce_capture::set::{Circle, SphereKind, Subject};

use super::Calibrate;
use super::balls::{Look, circle_in_force, move_ball};
use crate::app::state::layout::Shown;
use crate::app::state::session::Session;
use crate::app::views::Over;

const HANDLE_SIDE: f32 = 14.0;
const CIRCLE: Color32 = Color32::from_rgb(255, 214, 64);
/// A press of an arrow key, in pixels of the photo; with Shift a tenth, with Ctrl ten times as far.
const NUDGE_PX: f64 = 0.5;

pub fn ui(panel: &mut Calibrate, ui: &mut Ui, over: &Over<'_>, session: &mut Session) {
    let Shown::Photo(shot) = over.shown else { return };
    panel.balls.take_found(session);
    let kinds: Vec<SphereKind> = match shot.subject.sphere_kind() {
        Some(kind) => vec![kind],
        None if shot.subject == Subject::Object => kinds_in_scene(session),
        None => return,
    };
    for kind in &kinds {
        panel.pixels.paint(ui, over, session, shot, *kind);
        // Highlights are those of the ball in its first place.
        if kind.subject().is_shiny_ball() && [kind.subject(), Subject::Object].contains(&shot.subject) {
            panel.highlights.paint(ui, over, session, shot);
        }
    }
    let mut on_handle = false;
    for kind in kinds {
        if let Some(circle) = circle_in_force(session, shot.subject, kind) {
            on_handle |= edit_circle(ui, over, session, (shot.subject, kind), circle);
        }
    }
    if panel.balls.rim.as_ref().is_some_and(|rim| rim.subject == shot.subject) {
        draw_rim(panel, ui, over);
        if let Some(at) = over.canvas.clicked.filter(|_| !on_handle) {
            panel.balls.click_on_rim(session, at);
        }
        return;
    }
    let wanted = shot.subject.sphere_kind().or(panel.balls.in_scene);
    if let (Some(at), Some(kind), true, false) = (over.canvas.clicked, wanted, panel.balls.click_finds, on_handle) {
        panel.balls.find(session, shot.subject, kind, Look::Near(at));
    }
}

/// Marks the points of a rim that were clicked so far.
fn draw_rim(panel: &Calibrate, ui: &mut Ui, over: &Over<'_>) {
    let transform = &over.canvas.transform;
    let painter = ui.painter().with_clip_rect(transform.rect.intersect(ui.clip_rect()));
    for point in panel.balls.rim.iter().flat_map(|rim| &rim.points) {
        painter.circle(transform.to_screen(*point), 4.0, CIRCLE, Stroke::new(1.0, Color32::BLACK));
    }
}

fn kinds_in_scene(session: &Session) -> Vec<SphereKind> {
    session.document().set.spheres_in(Subject::Object).map(|sphere| sphere.kind).collect()
}

/// Draws a circle and moves it as the user wants; whether a handle has the pointer.
fn edit_circle(
    ui: &mut Ui,
    over: &Over<'_>,
    session: &mut Session,
    (subject, kind): (Subject, SphereKind),
    circle: Circle,
) -> bool {
    let transform = &over.canvas.transform;
    let painter = ui.painter().with_clip_rect(transform.rect.intersect(ui.clip_rect()));
    let centre = transform.to_screen(circle.centre);
    let rim = transform.to_screen([circle.centre[0] + circle.radius, circle.centre[1]]);
    painter.circle_stroke(centre, rim.x - centre.x, Stroke::new(3.0, Color32::from_black_alpha(120)));
    painter.circle_stroke(centre, rim.x - centre.x, Stroke::new(1.5, CIRCLE));

    let title = kind.title();
    let id = over.canvas.response.id.with(title);
    let mut moved = circle;
    let mut busy = false;
    if let Some(handle) = handle(ui, transform.rect, id.with("centre"), centre, &format!("{title}, centre")) {
        let px = f64::from(transform.points_per_px());
        let drag = if handle.dragged() { handle.drag_delta() } else { Vec2::ZERO };
        let keys = nudge(ui, &handle);
        moved.centre[0] += f64::from(drag.x) / px + keys[0];
        moved.centre[1] += f64::from(drag.y) / px + keys[1];
        busy |= handle.contains_pointer() || handle.dragged();
    }
    if let Some(handle) = handle(ui, transform.rect, id.with("rim"), rim, &format!("{title}, rim")) {
        if let Some(pointer) = handle.interact_pointer_pos().filter(|_| handle.dragged()) {
            let [x, y] = transform.from_screen(pointer);
            moved.radius = (x - circle.centre[0]).hypot(y - circle.centre[1]).max(1.0);
        }
        let keys = nudge(ui, &handle);
        moved.radius = (moved.radius + keys[0] - keys[1]).max(1.0);
        busy |= handle.contains_pointer() || handle.dragged();
    }
    if moved != circle {
        move_ball(session, subject, kind, moved);
    }
    busy
}

/// A square to take hold of, by the pointer or by Tab and arrow keys; `None` where it lies outside the canvas.
fn handle(ui: &mut Ui, canvas: Rect, id: eframe::egui::Id, at: Pos2, name: &str) -> Option<Response> {
    if !canvas.contains(at) {
        return None;
    }
    let rect = Rect::from_center_size(at, Vec2::splat(HANDLE_SIDE));
    let response = ui.interact(rect, id, Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, name));
    let response = response.on_hover_text(format!("{name}: drag, or nudge with the arrow keys"));
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    let fill = if response.has_focus() || response.hovered() { CIRCLE } else { Color32::from_black_alpha(160) };
    let square = rect.shrink(3.0);
    ui.painter().rect(square, 1.0, fill, Stroke::new(1.5, CIRCLE), eframe::egui::StrokeKind::Inside);
    Some(response)
}

/// How far the arrow keys move a handle that has the focus, in pixels of the photo.
fn nudge(ui: &Ui, handle: &Response) -> [f64; 2] {
    if !handle.has_focus() {
        return [0.0; 2];
    }
    let arrows = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(handle.id, arrows));
    ui.input(|input| {
        let step = match () {
            _ if input.modifiers.shift => 0.1 * NUDGE_PX,
            _ if input.modifiers.command => 10.0 * NUDGE_PX,
            _ => NUDGE_PX,
        };
        let presses = |key| input.num_presses(key) as f64;
        [
            step * (presses(Key::ArrowRight) - presses(Key::ArrowLeft)),
            step * (presses(Key::ArrowDown) - presses(Key::ArrowUp)),
        ]
    })
}
