//! The image canvas: one picture, or two to compare, with zoom, pan, numbers and legend.
//!
//! ```no_run
//! # use firstbounce::{app::canvas::{Canvas, CanvasState}, gpu::{Display, Source}};
//! # fn f(ui: &mut eframe::egui::Ui, state: &mut CanvasState, source: &Source) {
//! let shown = Canvas::new(state, source, &Display::default()).label("Bounce 1, left").legend("Light, of white").show(ui);
//! if let Some([x_px, y_px]) = shown.clicked {
//!     println!("{x_px} {y_px}");
//! }
//! # }
//! ```
//!
//! The caller draws over the picture with `CanvasResponse::transform`, and interacts with `ui.interact`: what is registered
//! after the canvas lies above it.

mod cursor;
pub(in crate::app) mod legend;
mod navigation;
mod overlay;
mod view;
mod wipe;

use std::sync::Arc;

use eframe::egui::{
    Align2, Color32, Key, Painter, PointerButton, Rect, Response, Role, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo,
};
use eframe::egui_wgpu::Callback;

use crate::app::widgets::plate::plate_in;
use crate::app::widgets::theme;
use crate::gpu::{CanvasCallback, CanvasStatus, Display, Drawing, Resolution, Source};

pub use navigation::PrimaryDrag;
pub use view::{MAX_SCALE, Transform, View};

/// Shows the other picture for as long as it is held.
const HOLD_KEY: Key = Key::B;
const KEYS: &str = "Arrow keys move the picture, plus and minus zoom, F fits, 0 shows it one to one. Shift and arrow keys move \
                    the pixel cursor, Enter clicks there.";

/// How two pictures are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Compare {
    /// Holding B shows the other picture.
    #[default]
    Hold,
    /// The other picture lies right of a line that the user drags; B still shows it whole.
    Wipe,
}

/// What a canvas keeps from frame to frame. Linked canvases copy each other's `view`.
pub struct CanvasState {
    /// Which part of the picture is seen.
    pub view: View,
    /// How the other picture is compared, if there is one.
    pub compare: Compare,
    /// Position of the line between the two: 0 at the left of the canvas, 1 at the right.
    pub wipe: f32,
    cursor: Option<(usize, usize)>,
    /// Where the primary button went down, for a drag that is the caller's.
    drag_from_px: Option<[f64; 2]>,
    status: Arc<CanvasStatus>,
}

impl Default for CanvasState {
    fn default() -> Self {
        let (view, compare, status) = (View::default(), Compare::default(), Arc::default());
        Self { view, compare, wipe: 0.5, cursor: None, drag_from_px: None, status }
    }
}

/// A drag with the primary button, where that is the caller's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drag {
    /// Where the button went down, in pixels of the picture.
    pub from_px: [f64; 2],
    /// Where the pointer is, in pixels of the picture.
    pub to_px: [f64; 2],
    /// Whether the button was let go in this frame.
    pub finished: bool,
}

/// What happened on a canvas in this frame.
pub struct CanvasResponse {
    /// The canvas as a widget.
    pub response: Response,
    /// The way between the picture and the screen, for what the caller draws over it.
    pub transform: Transform,
    /// The pixel `(x, y)` under the pointer, or else under the keyboard's pixel cursor.
    pub hovered: Option<(usize, usize)>,
    /// Where the user clicked, by pointer or Enter, in pixels of the picture (centres at .5), inside it or not.
    pub clicked: Option<[f64; 2]>,
    /// A drag with the primary button, if the caller asked for drags.
    pub dragged: Option<Drag>,
    /// How much of the picture the card shows; `None` before the first drawing.
    pub resolution: Option<Resolution>,
    /// Whether the other picture is shown because its key is held.
    pub shows_other: bool,
}

/// The widget.
#[must_use = "call show"]
pub struct Canvas<'a> {
    state: &'a mut CanvasState,
    source: &'a Source,
    display: &'a Display,
    label: &'a str,
    other: Option<(&'a Source, &'a Display)>,
    other_label: &'a str,
    legend: Option<&'a str>,
    primary: PrimaryDrag,
}

impl<'a> Canvas<'a> {
    /// Shows `source` as `display` says.
    pub fn new(state: &'a mut CanvasState, source: &'a Source, display: &'a Display) -> Self {
        let (label, primary) = ("Picture", PrimaryDrag::default());
        Self { state, source, display, label, other: None, other_label: "Other picture", legend: None, primary }
    }

    /// The accessible name: what the picture is. Give every canvas of a window its own.
    pub fn label(mut self, label: &'a str) -> Self {
        self.label = label;
        self
    }

    /// The picture to compare with.
    pub fn against(mut self, source: &'a Source, display: &'a Display) -> Self {
        self.other = Some((source, display));
        self
    }

    /// What the picture to compare with is called.
    pub fn other_label(mut self, label: &'a str) -> Self {
        self.other_label = label;
        self
    }

    /// Explains the colours of single values; `quantity` names them with their unit, "light, of white" for instance.
    pub fn legend(mut self, quantity: &'a str) -> Self {
        self.legend = Some(quantity);
        self
    }

    /// What dragging with the primary button does.
    pub fn primary_drag(mut self, primary: PrimaryDrag) -> Self {
        self.primary = primary;
        self
    }

    /// Fills the space that is left.
    pub fn show(mut self, ui: &mut Ui) -> CanvasResponse {
        let size = ui.available_size().max(Vec2::splat(1.0));
        let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        let picture = self.source.size();
        let density = ui.ctx().pixels_per_point();
        if response.clicked() || response.drag_started() {
            response.request_focus();
        }

        // Input first, so that the frame shows what the user just did.
        let before = self.state.view.transform(rect, picture, density);
        self.state.view = navigation::navigate(ui, &response, &before, self.state.view, self.primary);
        let moved = self.state.view.transform(rect, picture, density);
        self.state.view =
            cursor::walk(ui, &response, &moved, picture, &mut self.state.cursor).unwrap_or(self.state.view);
        let transform = self.state.view.transform(rect, picture, density);

        let shows_other = self.other.is_some() && self.holds_key(ui, &response);
        self.paint(ui, &response, &transform, shows_other);
        self.describe(ui, &response, &transform, shows_other);
        self.respond(ui, response, transform, shows_other)
    }

    /// The key counts while the canvas has the focus, or the pointer when nothing has the focus.
    fn holds_key(&self, ui: &Ui, response: &Response) -> bool {
        let listens = response.has_focus() || (response.hovered() && ui.memory(|memory| memory.focused().is_none()));
        listens && ui.input(|input| input.key_down(HOLD_KEY))
    }

    fn paint(&mut self, ui: &mut Ui, response: &Response, transform: &Transform, shows_other: bool) {
        let rect = transform.rect;
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, 0.0, theme::canvas(ui.visuals()));
        painter.rect_filled(transform.image_rect(), 0.0, ui.visuals().faint_bg_color);

        let shown = self.other.filter(|_| shows_other).unwrap_or((self.source, self.display));
        match self.other.filter(|_| self.state.compare == Compare::Wipe && !shows_other) {
            Some(other) => {
                let line = rect.left() + self.state.wipe * rect.width();
                let (left, right) = rect.split_left_right_at_x(line);
                self.paint_part(ui, left, transform, (self.source, self.display));
                self.paint_part(ui, right, transform, other);
                self.paint_legend(&painter, rect, Align2::LEFT_BOTTOM, (self.source, self.display));
                self.paint_legend(&painter, rect, Align2::RIGHT_BOTTOM, other);
                plate_in(&painter, rect, Align2::LEFT_TOP, self.label);
                plate_in(&painter, rect, Align2::RIGHT_TOP, self.other_label);
                let id = response.id.with("wipe");
                wipe::handle(ui, id, rect, &mut self.state.wipe, &format!("Wipe, {}", self.label));
            }
            None => {
                self.paint_part(ui, rect, transform, shown);
                self.paint_legend(&painter, rect, Align2::RIGHT_BOTTOM, shown);
                if shows_other {
                    plate_in(&painter, rect, Align2::LEFT_TOP, self.other_label);
                }
            }
        }
        if let Some(line) = self.reduced() {
            plate_in(&painter, rect, Align2::CENTER_TOP, &line);
        }
        let rim = ui.visuals().widgets.noninteractive.bg_stroke;
        painter.rect_stroke(transform.image_rect(), 0.0, rim, StrokeKind::Outside);
        if response.has_focus() {
            cursor::paint(&painter, transform, self.state.cursor);
            painter.rect_stroke(rect, 0.0, Stroke::new(2.0, ui.visuals().selection.stroke.color), StrokeKind::Inside);
        }
    }

    /// One picture in one part of the canvas, grid and numbers included.
    fn paint_part(&self, ui: &Ui, part: Rect, transform: &Transform, (source, display): (&Source, &Display)) {
        let seen = part.intersect(ui.clip_rect());
        if !seen.is_positive() {
            return;
        }
        let painter = ui.painter().with_clip_rect(seen);
        let background = gamma_space(theme::canvas(ui.visuals()));
        let drawing = Drawing { source, display, placement: transform.placement(), background };
        let callback = CanvasCallback::new(&drawing, self.state.status.clone(), ui.ctx().clone());
        // The clip cuts at whole pixels; the viewport is a point wider so that rounding never leaves a gap.
        painter.add(Callback::new_paint_callback(seen.expand(1.0), callback));
        overlay::close_up(&painter, transform, source, display, background);
    }

    /// That the picture is larger than the card's textures, and how it is shown.
    fn reduced(&self) -> Option<String> {
        let divisor = self.state.status.resolution()?.divisor;
        (divisor > 1).then(|| {
            format!("Shown at 1/{divisor} of its resolution: larger than the card's textures. Values are those of the whole picture.")
        })
    }

    fn paint_legend(&self, painter: &Painter, rect: Rect, corner: Align2, (source, display): (&Source, &Display)) {
        if let Some(quantity) = self.legend.filter(|_| legend::has_legend(source)) {
            legend::paint(painter, rect, corner, display, quantity);
        }
    }

    fn describe(&self, ui: &Ui, response: &Response, transform: &Transform, shows_other: bool) {
        let label = self.label;
        response.widget_info(|| WidgetInfo::labeled(Role::Image, ui.is_enabled(), label));
        let mut value = format!("Zoom {:.0} %", 100.0 * transform.scale());
        if let Some((x, y)) = self.state.cursor {
            let numbers = self.source.values_at(x, y).iter().map(|value| format!(" {value}")).collect::<String>();
            value.push_str(&format!(", pixel {x}, {y}:{numbers}"));
        }
        if let Some(quantity) = self.legend.filter(|_| legend::has_legend(self.source)) {
            value.push_str(&format!(", {}", legend::text(self.display, quantity)));
        }
        if shows_other {
            value.push_str(&format!(", shows {}", self.other_label));
        }
        if let Some(line) = self.reduced() {
            value.push_str(&format!(", {line}"));
        }
        ui.ctx().accesskit_node_builder(response.id, |node| {
            node.set_value(value);
            node.set_description(KEYS);
        });
    }

    fn respond(self, ui: &Ui, response: Response, transform: Transform, shows_other: bool) -> CanvasResponse {
        let at_pointer = response.interact_pointer_pos().map(|point| transform.from_screen(point));
        let at_cursor = self.state.cursor.map(|(x, y)| [x as f64 + 0.5, y as f64 + 0.5]);
        let pointer = ui.input(|input| input.pointer.hover_pos()).filter(|_| response.contains_pointer());
        let under_pointer = pointer.and_then(|point| transform.pixel_at(point));
        if response.drag_started_by(PointerButton::Primary) {
            let pressed_at = ui.input(|input| input.pointer.press_origin());
            self.state.drag_from_px = pressed_at.map(|point| transform.from_screen(point));
        }
        let finished = response.drag_stopped_by(PointerButton::Primary);
        let from_px = self.state.drag_from_px.filter(|_| self.primary == PrimaryDrag::Caller);
        let dragged = from_px.zip(at_pointer).map(|(from_px, to_px)| Drag { from_px, to_px, finished });
        if !response.dragged_by(PointerButton::Primary) {
            self.state.drag_from_px = None;
        }
        CanvasResponse {
            hovered: under_pointer.or(self.state.cursor.filter(|_| response.has_focus())),
            clicked: if response.clicked() { at_pointer.or(at_cursor) } else { None },
            dragged,
            resolution: self.state.status.resolution(),
            shows_other,
            response,
            transform,
        }
    }
}

fn gamma_space(colour: Color32) -> [f32; 3] {
    [colour.r(), colour.g(), colour.b()].map(|channel| f32::from(channel) / 255.0)
}
