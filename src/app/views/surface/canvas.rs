//! The 3D view as a widget.

use eframe::egui::{Align2, Key, Rect, Response, Role, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo};
use eframe::egui_wgpu::Callback;
use nalgebra::Isometry3;

use super::lamp;
use super::navigation::{KEYS, Moved, in_view, navigate};
use super::overlay::{self, ScaleBar};
use super::profile::Seen;
use super::scene::{self, Heat};
use super::tool::{Picked, Tool, ViewState, point_words};
use crate::app::state::session::Session;
use crate::app::state::surfaces::{Dragged, LayerName, Shade, SurfaceLook};
use crate::app::views::canvas::legend;
use crate::app::widgets::theme;
use crate::gpu::mesh::{Bounds, Frame, MeshCallback, PlaneDrawing, Scene, Shading};

/// What the accessible name begins with; the surfaces follow.
const LABEL: &str = "Surface in 3D";
/// Shows the surface before instead of after for as long as it is held.
const HOLD_KEY: Key = Key::B;
const TURNTABLE_DEG_PER_S: f64 = 30.0;
/// A hand that holds the machine up for longer does not make the object jump.
const LONGEST_FRAME_S: f32 = 0.1;

/// The surfaces that are seen; `flicker` shows before in the place of after, and after in that of before.
pub fn seen(look: &SurfaceLook, session: &Session, flicker: bool) -> Vec<Seen> {
    let visible = |name: LayerName| {
        let shown = match (name, flicker) {
            (LayerName::AFTER, true) => LayerName::BEFORE,
            (LayerName::BEFORE, true) => LayerName::AFTER,
            _ => name,
        };
        look.layer(shown).visible
    };
    let seen = |name: LayerName| {
        let prepared = session.surfaces.layer(name)?.clone();
        let pose = match name {
            LayerName::Reference => session.reference_pose(),
            _ => Isometry3::identity(),
        };
        Some(Seen { name, prepared, pose })
    };
    LayerName::all().filter(|name| visible(*name)).filter_map(seen).collect()
}

/// The box around everything.
pub fn bounds(seen: &[Seen]) -> Option<Bounds> {
    let all = seen.iter().map(|seen| seen.prepared.geometry.bounds.moved(&seen.pose));
    all.reduce(|all, one| all.with(&one))
}

/// The first surface on a line of sight, and where.
fn hit(seen: &[Seen], frame: &Frame, at: [f64; 2]) -> Option<Picked> {
    let ray = frame.ray(at);
    let on = |seen: &Seen| {
        let to_mesh = seen.pose.inverse();
        let direction = to_mesh * ray.direction.into_inner();
        let point = seen.prepared.pickable.as_ref()?.first_hit(&(to_mesh * ray.origin), &direction)?;
        Some(Picked { layer: seen.name, point: seen.pose * point })
    };
    let distance = |picked: &Picked| (picked.point - ray.origin).norm();
    seen.iter().filter_map(on).min_by(|one, other| distance(one).total_cmp(&distance(other)))
}

/// What the view was drawn with.
pub struct Shown {
    /// The widget.
    pub response: Response,
    /// A point that was clicked on in this frame.
    pub clicked: Option<Picked>,
}

/// The widget over all of `size`.
pub fn show(
    ui: &mut Ui,
    size: Vec2,
    look: &mut SurfaceLook,
    state: &mut ViewState,
    session: &Session,
    (shading, heat): (Shading, Option<&Heat>),
) -> Option<Shown> {
    let (rect, response) = ui.allocate_exact_size(size.max(Vec2::splat(1.0)), Sense::click_and_drag());
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    let listens = response.has_focus() || (response.hovered() && ui.memory(|memory| memory.focused().is_none()));
    let flicker = listens && ui.input(|input| input.key_down(HOLD_KEY));
    let seen = self::seen(look, session, flicker);
    let bounds = bounds(&seen)?;
    let size = [f64::from(rect.width()), f64::from(rect.height())];
    state.aspect = size[0] / size[1];

    // Input first, so that the frame shows what the user just did.
    let camera = look.camera(&bounds, state.aspect);
    let before = camera.frame(size, &bounds);
    let touched = |at| hit(&seen, &before, at);
    match navigate(ui, &response, (&camera, &before, &bounds), &|at| touched(at).map(|picked| picked.point)) {
        Moved::No => {}
        Moved::To(camera) => look.camera = Some(camera),
    }
    turn(ui, look, &bounds, state.aspect);
    let camera = look.camera(&bounds, state.aspect);
    let frame = camera.frame(size, &bounds);
    let clicked = response.clicked().then(|| {
        let middle = [size[0] / 2.0, size[1] / 2.0];
        let at = response.interact_pointer_pos().map_or(middle, |point| in_view(rect, point));
        hit(&seen, &frame, at)
    });

    let unit = seen.first().map_or("mm", |seen| seen.prepared.unit());
    paint(ui, rect, look, state, &seen, (&frame, &bounds), shading, heat);
    decorate(ui, &response, state, &frame, (unit, shading));
    if look.shade == Shade::Drag
        && let Some(direction) = lamp::dome(ui, response.id.with("lamp"), rect, look.dragged.0)
    {
        look.dragged = Dragged(direction);
    }
    describe(ui, &response, look, state, &seen, &frame, unit);
    Some(Shown { response, clicked: clicked.flatten() })
}

fn turn(ui: &Ui, look: &mut SurfaceLook, bounds: &Bounds, aspect: f64) {
    if look.turntable {
        let passed = ui.input(|input| input.stable_dt).min(LONGEST_FRAME_S);
        look.camera = Some(look.camera(bounds, aspect).orbited(TURNTABLE_DEG_PER_S * f64::from(passed), 0.0));
        ui.ctx().request_repaint();
    }
}

#[expect(clippy::too_many_arguments, reason = "they are what a picture is made of")]
fn paint(
    ui: &Ui,
    rect: Rect,
    look: &SurfaceLook,
    state: &ViewState,
    seen: &[Seen],
    (frame, bounds): (&Frame, &Bounds),
    shading: Shading,
    heat: Option<&Heat>,
) {
    let visuals = ui.visuals();
    let around = theme::canvas(visuals);
    let background = [around.r(), around.g(), around.b()];
    let (origin_px, size_px) = overlay::physical(rect, ui.ctx().pixels_per_point());
    let plane = state.plane(&bounds.centre()).map(|plane| PlaneDrawing {
        normal: plane.normal.into_inner().into(),
        offset: plane.normal.dot(&plane.point.coords),
        colour: [1.0, 0.62, 0.1],
        half_width_px: 1.0,
    });
    let unit_px = frame.unit_on_target() / f64::from(ui.ctx().pixels_per_point());
    let scene = Scene {
        size_px,
        frame: *frame,
        layers: scene::drawings(look, seen, shading, heat, visuals, unit_px),
        background: background.map(|channel| f32::from(channel) / 255.0),
        plane,
    };
    ui.painter().rect_filled(rect, 0.0, around);
    let callback = MeshCallback::new(scene, origin_px, state.kept.clone());
    ui.painter().with_clip_rect(rect).add(Callback::new_paint_callback(rect, callback));
}

fn decorate(ui: &Ui, response: &Response, state: &ViewState, frame: &Frame, (unit, shading): (&str, Shading)) {
    let rect = response.rect;
    let painter = ui.painter_at(rect);
    let ink = ui.visuals().text_color();
    overlay::scale_bar(&painter, rect, &ScaleBar::of(frame, rect.width()), unit, ink);
    overlay::axes(&painter, rect, frame);
    if let Some(display) = shading.legend() {
        legend::paint(&painter, rect, Align2::RIGHT_BOTTOM, &display, &quantity(shading, unit));
    }
    let colour = eframe::egui::Color32::from_rgb(255, 190, 60);
    let places: Vec<_> =
        state.picked.iter().filter_map(|picked| overlay::on_screen(frame, rect, &picked.point)).collect();
    if let ([from, to], Some(length)) = (places.as_slice(), state.distance().filter(|_| state.tool == Tool::Distance)) {
        overlay::measured(&painter, *from, *to, &format!("{length:.3} {unit}"), colour);
    }
    for (number, at) in places.iter().enumerate() {
        let name = if places.len() > 1 { (number + 1).to_string() } else { String::new() };
        overlay::mark(&painter, *at, &name, colour);
    }
    if response.has_focus() {
        overlay::crosshair(&painter, rect, ink.gamma_multiply(0.7));
        let stroke = Stroke::new(2.0, ui.visuals().selection.stroke.color);
        painter.rect_stroke(rect, 0.0, stroke, StrokeKind::Inside);
    }
}

/// The quantity that the colours show.
fn quantity(shading: Shading, unit: &str) -> String {
    match shading {
        Shading::Distance(_) => "Distance to the reference, mm".into(),
        _ => format!("Height z, {unit}"),
    }
}

fn describe(
    ui: &Ui,
    response: &Response,
    look: &SurfaceLook,
    state: &ViewState,
    seen: &[Seen],
    frame: &Frame,
    unit: &str,
) {
    let label = format!("{LABEL}, {}", look.title());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, ui.is_enabled(), &label));
    let names: Vec<_> = seen.iter().map(|seen| seen.name.in_sentence()).collect();
    let bar = ScaleBar::of(frame, response.rect.width());
    let mut value = format!("{}, {}, scale bar {}", names.join(" and "), look.shade.name(), bar.words(unit));
    for picked in &state.picked {
        value.push_str(&format!(". {}", point_words(picked, unit)));
    }
    ui.ctx().accesskit_node_builder(response.id, |node| {
        node.set_value(value);
        node.set_description(KEYS);
    });
}
