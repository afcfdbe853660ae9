//! The widget by its accessible name, with and without a renderer.

use std::sync::Arc;

use eframe::egui::accesskit::Role;
use eframe::egui::{
    Button, Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, Pos2, Rect, ScrollArea, TouchPhase,
    Vec2, vec2,
};
use egui_kittest::kittest::{NodeT, Queryable};
use egui_kittest::wgpu::WgpuTestRenderer;
use egui_kittest::{Harness, HarnessBuilder};
use firstbounce::app::views::canvas::{Canvas, CanvasState, Compare, Drag, PrimaryDrag, Transform, View};
use firstbounce::gpu::{self, CanvasGpu, CanvasPlane, ColourMap, Display, Drawing, Output, Source, Twin};
use firstbounce_core::Plane;

use crate::card::card;

const SIZE: (usize, usize) = (200, 150);
const LABEL: &str = "Bounce 1, left";

struct Window {
    canvas: CanvasState,
    sources: [Source; 2],
    displays: [Display; 2],
    primary: PrimaryDrag,
    transform: Option<Transform>,
    hovered: Option<(usize, usize)>,
    clicked: Option<[f64; 2]>,
    dragged: Option<Drag>,
    shows_other: bool,
}

impl Default for Window {
    fn default() -> Self {
        let waves = |across: f32, down: f32| {
            let wave = |x, y| 0.5 + 0.45 * (across * x as f32).sin() * (down * y as f32).cos();
            Source::plane(CanvasPlane::new(Arc::new(Plane::from_fn(SIZE.0, SIZE.1, wave))))
        };
        Self {
            canvas: CanvasState::default(),
            sources: [waves(0.05, 0.08), waves(0.11, 0.02)],
            displays: [ColourMap::Grey, ColourMap::Viridis].map(|map| Display { map, ..Display::default() }),
            primary: PrimaryDrag::Pan,
            transform: None,
            hovered: None,
            clicked: None,
            dragged: None,
            shows_other: false,
        }
    }
}

impl Window {
    fn ui(&mut self, ui: &mut eframe::egui::Ui) {
        ui.add(Button::new("Before"));
        let canvas =
            Canvas::new(&mut self.canvas, &self.sources[0], &self.displays[0]).label(LABEL).legend("Light, of white");
        let canvas = canvas.against(&self.sources[1], &self.displays[1]).primary_drag(self.primary);
        let height = ui.available_height() - 40.0;
        let shown = ui.allocate_ui(vec2(ui.available_width(), height), |ui| canvas.show(ui)).inner;
        ui.add(Button::new("After"));
        self.transform = Some(shown.transform);
        self.hovered = shown.hovered;
        self.clicked = shown.clicked.or(self.clicked);
        self.dragged = shown.dragged.or(self.dragged);
        self.shows_other = shown.shows_other;
    }

    fn transform(&self) -> Transform {
        self.transform.expect("the window was shown")
    }

    fn scale(&self) -> f32 {
        self.transform().scale()
    }
}

fn builder() -> HarnessBuilder<Window> {
    Harness::builder().with_size(Vec2::new(480.0, 400.0)).with_max_steps(40).with_step_dt(1.0 / 60.0)
}

fn window() -> Harness<'static, Window> {
    builder().build_ui_state(|ui, window: &mut Window| window.ui(ui), Window::default())
}

fn canvas_rect(harness: &Harness<'_, Window>) -> Rect {
    harness.get_by_role_and_label(Role::Image, LABEL).rect()
}

fn focus(harness: &mut Harness<'_, Window>) {
    harness.get_by_role_and_label(Role::Image, LABEL).focus();
    harness.run();
}

fn press(harness: &mut Harness<'_, Window>, modifiers: Modifiers, key: Key) {
    harness.key_press_modifiers(modifiers, key);
    harness.run();
}

fn screen_of(harness: &Harness<'_, Window>, image_px: [f64; 2]) -> Pos2 {
    harness.state().transform().to_screen(image_px)
}

fn button(harness: &mut Harness<'_, Window>, pos: Pos2, pressed: bool) {
    harness.hover_at(pos);
    harness.event(Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE });
    harness.step();
}

#[test]
fn it_is_an_image_with_a_name_a_zoom_and_a_legend() {
    let harness = window();
    let canvas = harness.get_by_role_and_label(Role::Image, LABEL);
    let value = canvas.accesskit_node().value().unwrap_or_default();
    assert!(value.starts_with("Zoom ") && value.ends_with("Light, of white, Grey from 0 to 1"), "{value}");
}

#[test]
fn a_click_gives_the_pixel_of_the_picture() {
    let mut harness = window();
    let there = screen_of(&harness, [120.25, 31.5]);
    button(&mut harness, there, true);
    button(&mut harness, there, false);
    let [x, y] = harness.state().clicked.unwrap();
    assert!((x - 120.25).hypot(y - 31.5) < 1e-3, "{x} {y}");
    assert_eq!(harness.state().hovered, Some((120, 31)));
}

#[test]
fn keys_zoom_and_pan_once_it_has_the_focus() {
    let mut harness = window();
    let fit = harness.state().scale();
    press(&mut harness, Modifiers::NONE, Key::Plus);
    assert_eq!(harness.state().scale(), fit, "keys belong to the widget with the focus");
    focus(&mut harness);
    press(&mut harness, Modifiers::NONE, Key::Plus);
    assert!((harness.state().scale() / fit - 1.25).abs() < 1e-3);
    let before = screen_of(&harness, [0.0, 0.0]);
    press(&mut harness, Modifiers::NONE, Key::ArrowRight);
    assert!((before.x - screen_of(&harness, [0.0, 0.0]).x - 0.1 * canvas_rect(&harness).width()).abs() < 1.0);
}

#[test]
fn tab_leaves_the_canvas() {
    let mut harness = window();
    focus(&mut harness);
    press(&mut harness, Modifiers::NONE, Key::Tab);
    assert!(harness.get_by_label("After").is_focused());
    press(&mut harness, Modifiers::SHIFT, Key::Tab);
    press(&mut harness, Modifiers::SHIFT, Key::Tab);
    assert!(harness.get_by_label("Before").is_focused());
}

#[test]
fn a_pixel_can_be_chosen_without_a_pointer() {
    let mut harness = window();
    focus(&mut harness);
    for key in [Key::ArrowRight, Key::ArrowRight, Key::ArrowDown] {
        press(&mut harness, Modifiers::SHIFT, key);
    }
    press(&mut harness, Modifiers::NONE, Key::Enter);
    let [x, y] = harness.state().clicked.unwrap();
    assert!((x - 102.5).abs() <= 1.0 && (y - 76.5).abs() <= 1.0, "{x} {y}");
}

#[test]
fn the_wheel_zooms_about_the_cursor_up_to_64() {
    let mut harness = window();
    let there = screen_of(&harness, [40.0, 100.0]);
    harness.hover_at(there);
    for _ in 0..20 {
        harness.event(Event::MouseWheel {
            unit: MouseWheelUnit::Point,
            delta: vec2(0.0, 120.0),
            source: MouseWheelSource::Wheel,
            phase: TouchPhase::Move,
            modifiers: Modifiers::NONE,
        });
        harness.run();
    }
    assert_eq!(harness.state().scale(), 64.0);
    assert_eq!(harness.state().hovered.map(|(x, y)| x.abs_diff(40) + y.abs_diff(100) <= 2), Some(true));
}

#[test]
fn a_drag_moves_the_picture_unless_the_caller_wants_it() {
    for primary in [PrimaryDrag::Pan, PrimaryDrag::Caller] {
        let mut harness = window();
        harness.state_mut().primary = primary;
        let (from, to) = (screen_of(&harness, [60.0, 60.0]), screen_of(&harness, [80.0, 75.0]));
        button(&mut harness, from, true);
        harness.hover_at(from.lerp(to, 0.5));
        harness.step();
        harness.hover_at(to);
        harness.step();
        button(&mut harness, to, false);
        match primary {
            PrimaryDrag::Pan => assert!((screen_of(&harness, [60.0, 60.0]) - to).length() < 2.0),
            PrimaryDrag::Caller => {
                let Drag { from_px: [x0, y0], to_px: [x1, y1], finished } = harness.state().dragged.unwrap();
                assert!(finished);
                assert!((x0 - 60.0).hypot(y0 - 60.0) < 0.1 && (x1 - 80.0).hypot(y1 - 75.0) < 0.1);
                assert_eq!(harness.state().canvas.view, View::Fit);
            }
        }
    }
}

#[test]
fn the_other_picture_shows_while_its_key_is_held() {
    let mut harness = window();
    focus(&mut harness);
    harness.key_down(Key::B);
    harness.step();
    assert!(harness.state().shows_other);
    harness.key_up(Key::B);
    harness.step();
    assert!(!harness.state().shows_other);
}

#[test]
fn the_wipe_is_a_slider() {
    let mut harness = window();
    harness.state_mut().canvas.compare = Compare::Wipe;
    harness.run();
    let slider = "Wipe, Bounce 1, left";
    harness.get_by_role_and_label(Role::Slider, slider).set_value_accesskit(0.25);
    harness.run();
    assert_eq!(harness.state().canvas.wipe, 0.25);
    harness.get_by_role_and_label(Role::Slider, slider).focus();
    harness.run();
    press(&mut harness, Modifiers::NONE, Key::ArrowRight);
    assert!((harness.state().canvas.wipe - 0.27).abs() < 1e-6);
    let rect = canvas_rect(&harness);
    let line = rect.left() + 0.27 * rect.width();
    button(&mut harness, Pos2::new(line, rect.center().y), true);
    button(&mut harness, Pos2::new(rect.left() + 0.6 * rect.width(), rect.center().y), true);
    button(&mut harness, Pos2::new(rect.left() + 0.6 * rect.width(), rect.center().y), false);
    assert!((harness.state().canvas.wipe - 0.6).abs() < 0.01, "{}", harness.state().canvas.wipe);
}

#[test]
fn the_window_shows_what_the_twin_computes_on_both_sides_of_the_wipe() {
    let Some(card) = card("the window against the twin") else { return };
    for density in [1.0, 1.5] {
        let render_state = card.render_state();
        gpu::install(&render_state);
        let mut harness = builder()
            .with_pixels_per_point(density)
            .renderer(WgpuTestRenderer::from_render_state(render_state))
            .build_ui_state(|ui, window: &mut Window| window.ui(ui), Window::default());
        harness.set_render_cursor(false);
        harness.state_mut().canvas.compare = Compare::Wipe;
        harness.state_mut().canvas.wipe = 0.4;
        harness.run();
        let picture = harness.render().unwrap();

        let window = harness.state();
        let transform = window.transform();
        let rect = transform.rect;
        let line = density * (rect.left() + 0.4 * rect.width());
        let seen = transform.image_rect().shrink(2.0);
        let mut compared = 0;
        for (side, (source, display)) in window.sources.iter().zip(&window.displays).enumerate() {
            let drawing = Drawing { source, display, placement: transform.placement(), background: [0.0; 3] };
            let twin = Twin::new(drawing);
            for (x, y, pixel) in picture.enumerate_pixels() {
                let at = [x as f32 + 0.5, y as f32 + 0.5];
                let point = Pos2::new(at[0], at[1]) / density;
                // Left out: the line itself with its grip, the legends below, and the names of the two above.
                let is_named = point.y < rect.top() + 30.0;
                let covered = (at[0] - line).abs() < 12.0 || point.y > rect.bottom() - 60.0 || is_named;
                if covered || !seen.contains(point) || (at[0] > line) != (side == 1) {
                    continue;
                }
                for (shown, twin) in pixel.0.iter().zip(twin.pixel(at)) {
                    assert!((f32::from(*shown) - 255.0 * twin).abs() <= 1.0, "{x} {y}: {pixel:?}");
                }
                compared += 1;
            }
        }
        assert!(compared > 50_000, "{compared}");
    }
}

#[test]
fn a_picture_larger_than_the_textures_says_so_and_keeps_its_values() {
    let Some(card) = card("larger than the textures, in the window") else { return };
    let render_state = card.render_state();
    gpu::install(&render_state);
    let mut limited = CanvasGpu::with_max_side(
        render_state.device.clone(),
        render_state.queue.clone(),
        render_state.target_format,
        Output::Colours,
        64,
    );
    limited.begin_frame();
    render_state.renderer.write().callback_resources.insert(limited);
    let mut harness = builder()
        .renderer(WgpuTestRenderer::from_render_state(render_state))
        .build_ui_state(|ui, window: &mut Window| window.ui(ui), Window::default());
    harness.render().unwrap();
    focus(&mut harness);
    press(&mut harness, Modifiers::SHIFT, Key::ArrowRight);
    harness.render().unwrap();
    harness.run();
    let value = harness.get_by_role_and_label(Role::Image, LABEL).accesskit_node().value().unwrap_or_default();
    assert!(value.contains("Shown at 1/4 of its resolution"), "{value}");
    // The pixel cursor is in the middle, one step right: the number there is that of the whole picture.
    let (x, y) = harness.state().hovered.unwrap();
    let whole = harness.state().sources[0].values_at(x, y)[0];
    assert!(value.contains(&format!("pixel {x}, {y}: {whole}")), "{value}");
}

#[test]
fn a_canvas_half_out_of_sight_keeps_its_picture_in_place() {
    let Some(card) = card("half out of sight") else { return };
    let render_state = card.render_state();
    gpu::install(&render_state);
    let mut harness = builder().renderer(WgpuTestRenderer::from_render_state(render_state)).build_ui_state(
        |ui, window: &mut Window| {
            // Fading edges would cover the picture.
            ui.style_mut().spacing.scroll.fade.strength = 0.0;
            // 900 points high, scrolled by 350: the canvas begins above the window and ends below it.
            ScrollArea::vertical().vertical_scroll_offset(350.0).show(ui, |ui| {
                ui.allocate_ui(vec2(ui.available_width(), 900.0), |ui| window.ui(ui));
            });
        },
        Window::default(),
    );
    harness.set_render_cursor(false);
    harness.run();
    let picture = harness.render().unwrap();
    let window = harness.state();
    let transform = window.transform();
    assert!(transform.rect.top() < 0.0 && transform.rect.bottom() > 400.0);
    let (source, display) = (&window.sources[0], &window.displays[0]);
    let placement = transform.placement();
    let twin = Twin::new(Drawing { source, display, placement, background: [0.0; 3] });
    let seen = transform.image_rect().intersect(Rect::from_min_max(Pos2::ZERO, Pos2::new(440.0, 400.0))).shrink(10.0);
    assert!(seen.area() > 50_000.0);
    for (x, y, pixel) in picture.enumerate_pixels().filter(|&(x, y, _)| seen.contains(Pos2::new(x as f32, y as f32))) {
        let expected = 255.0 * twin.pixel([x as f32 + 0.5, y as f32 + 0.5])[0];
        assert!((f32::from(pixel.0[0]) - expected).abs() <= 1.0, "{x} {y}: {pixel:?} {expected}");
    }
}
