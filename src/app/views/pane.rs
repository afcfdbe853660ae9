//! One view: its tool bar, its canvas, and what panels draw over it.

use eframe::egui::containers::menu::{MenuButton, MenuConfig};
use eframe::egui::{Align2, Color32, PopupCloseBehavior, Rect, Role, Ui, WidgetInfo, vec2};
use firstbounce_core::image::photo::{CLIPPED, DARK};
use firstbounce_core::separate::{OUTSIDE, UNSOLVED};

use super::picture::{Picture, outdated, picture, previewed};
use super::{Canvases, Over, Overlay, picker};
use crate::app::state::layout::{Arrange, Hover, Look, Shown, View};
use crate::app::state::session::Session;
use crate::app::views::canvas::{Canvas, CanvasResponse, Compare, PrimaryDrag};
use crate::app::views::surface;
use crate::app::widgets::advice::advice_in_the_middle;
use crate::app::widgets::number_field::up_to;
use crate::app::widgets::plate::{plate, plate_in};
use crate::gpu::{ColourMap, Display};

/// The whole view.
pub fn ui(ui: &mut Ui, view: &mut View, session: &mut Session, canvases: &mut Canvases, overlay: &mut dyn Overlay) {
    ui.push_id(view.id, |ui| {
        ui.horizontal_wrapped(|ui| tools(ui, view, session, canvases));
        if view.shown == Shown::Surface {
            if surface::ui(ui, view.id, &mut view.surface, session, canvases) {
                session.views.activate(view.id);
            }
            return;
        }
        let document = session.document();
        let Session { results, jobs, .. } = session;
        if let Some(words) = canvases.statistics.words(view.id, &view.shown, &document, results, jobs) {
            ui.label(words);
        }
        match picture(&view.shown, &document, &session.results) {
            Ok(shown) => {
                if let Some(line) = outdated(&view.shown, &document, &session.results) {
                    ui.colored_label(ui.visuals().warn_fg_color, line);
                }
                canvas(ui, view, &shown, session, canvases, overlay);
            }
            Err(error) => advice_in_the_middle(ui, &error.to_string()),
        }
    });
}

fn tools(ui: &mut Ui, view: &mut View, session: &mut Session, canvases: &mut Canvases) {
    let document = session.document();
    ui.menu_button(format!("Picture: {}", view.shown.title()), |ui| {
        let in_3d = ui.selectable_label(view.shown == Shown::Surface, Shown::Surface.title()).clicked();
        let chosen = picker::ui(ui, &document, Some(&view.shown)).or(in_3d.then_some(Shown::Surface));
        if let Some(chosen) = chosen {
            view.shown = chosen;
            view.look = Default::default();
            session.views.activate(view.id);
        }
    });
    if view.shown == Shown::Surface {
        surface::toolbar(ui, &mut view.surface, canvases.surface(view.id), &document, session);
        ui.menu_button("Look from", |ui| surface::eye_menu(ui, &mut view.surface, canvases.surface(view.id), session));
        ui.menu_button("Arrange", |ui| arrange_menu(ui, view.id, session));
        return;
    }
    let against = view.against.as_ref().map_or("Compare".into(), |other| format!("Compare: {}", other.title()));
    ui.menu_button(against, |ui| {
        if ui.selectable_label(view.against.is_none(), "Nothing").clicked() {
            view.against = None;
            ui.close();
        }
        if let Some(chosen) = picker::ui(ui, &document, view.against.as_ref()) {
            view.against = Some(chosen);
        }
    });
    if let Some(other) = view.against.clone() {
        ui.toggle_value(&mut view.wipe, "Wipe")
            .on_hover_text("A line divides the two; without it, hold B to see the other");
        if ui.button("Difference").on_hover_text("Shows this picture minus the other").clicked() {
            view.shown = Shown::difference(view.shown.clone(), other);
            view.against = None;
            view.look = Default::default();
        }
    }
    let proposal = picture(&view.shown, &document, &session.results).map_or([0.0, 1.0], |shown| shown.display.range);
    // Stays open while one thing after the other is tried.
    let stays = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    MenuButton::new("Colours").config(stays).ui(ui, |ui| look(ui, view, proposal));
    zoom(ui, view, canvases);
    ui.menu_button("Arrange", |ui| {
        ui.checkbox(&mut view.linked, "Zoom and pan with the others");
        arrange_menu(ui, view.id, session);
    });
}

fn arrange_menu(ui: &mut Ui, id: u64, session: &mut Session) {
    for (name, arrange) in [
        ("Split right", Arrange::SplitRight),
        ("Split down", Arrange::SplitDown),
        ("New tab", Arrange::NewTab),
        ("Close view", Arrange::Close),
    ] {
        if ui.button(name).clicked() {
            session.views.arrange(id, arrange);
            ui.close();
        }
    }
}

/// The two zooms that are used most.
fn zoom(ui: &mut Ui, view: &View, canvases: &mut Canvases) {
    let title = view.shown.title();
    for (text, words, one_to_one) in [("Fit", "Fit", false), ("1:1", "One to one", true)] {
        let button = ui.button(text);
        button.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("{words}, {title}")));
        if button
            .on_hover_text(if one_to_one { "A pixel of the screen for every pixel" } else { "The whole picture" })
            .clicked()
        {
            canvases.zoom(view, one_to_one);
        }
    }
}

/// The values at the two ends of the map: the picture's own, or typed.
fn range(ui: &mut Ui, range: &mut Option<[f32; 2]>, proposal: [f32; 2]) {
    let mut own = range.is_some();
    ui.checkbox(&mut own, "Custom range");
    let mut ends = range.unwrap_or(proposal);
    let speed = f64::from((ends[1] - ends[0]).abs()) * 0.005;
    ui.add_enabled_ui(own, |ui| {
        ui.horizontal(|ui| {
            for (end, name) in ends.iter_mut().zip(["Low end", "High end"]) {
                let label = ui.label(name);
                ui.add(up_to(end, 5, Look::ENDS).speed(speed)).labelled_by(label.id);
            }
        });
    });
    *range = own.then_some(ends);
}

fn look(ui: &mut Ui, view: &mut View, proposal: [f32; 2]) {
    let look = &mut view.look;
    let exposure = ui.label("Exposure");
    ui.add(up_to(&mut look.exposure_stops, 2, Look::EXPOSURE_STOPS).speed(0.05).suffix(" stops"))
        .labelled_by(exposure.id);
    let mut gamma = look.gamma.unwrap_or(2.2);
    ui.horizontal(|ui| {
        let mut own = look.gamma.is_some();
        let name = ui.checkbox(&mut own, "Gamma instead of the sRGB curve");
        ui.add_enabled(own, up_to(&mut gamma, 2, Look::GAMMA).speed(0.02)).labelled_by(name.id);
        look.gamma = own.then_some(gamma);
    });
    ui.separator();
    ui.label("Colour map");
    ui.selectable_value(&mut look.map, None, "Default of the picture");
    for map in ColourMap::ALL {
        ui.selectable_value(&mut look.map, Some(map), map.name());
    }
    range(ui, &mut view.look.range, proposal);
    ui.separator();
    let look = &mut view.look;
    ui.checkbox(&mut look.clip_zebra, "Clipping zebra");
    ui.checkbox(&mut look.negative_zebra, "Zebra below zero");
    ui.checkbox(&mut look.plain, "Hide the tints of clipped and dark pixels");
    if ui.button("Reset colours").clicked() {
        *look = Default::default();
    }
}

/// Says on the canvas, and to screen readers, which of two pictures is seen where.
fn compared(ui: &Ui, view: &View, response: &CanvasResponse) {
    let Some(other) = &view.against else { return };
    let (own, other) = (view.shown.title(), other.title());
    let canvas = response.transform.rect;
    let words = match (response.shows_other, view.wipe) {
        (true, _) => format!("Shows {other}"),
        (false, true) => format!("Left of the line {own}, right of the line {other}"),
        (false, false) => {
            plate_in(&ui.painter_at(canvas), canvas, Align2::CENTER_TOP, &format!("Hold B for {other}"));
            format!("B, held, shows the other: {other}")
        }
    };
    ui.ctx().accesskit_node_builder(response.response.id, |node| node.set_description(words));
}

/// What the tints of marked pixels mean.
fn tints(ui: &Ui, view: &View, display: &Display, canvas: Rect) {
    let marks: &[(u8, &str)] = match view.shown {
        Shown::Photo(_) | Shown::Bounce { .. } => &[(CLIPPED, "clipped"), (DARK, "dark")],
        Shown::Marks { .. } => {
            &[(CLIPPED, "clipped"), (DARK, "dark"), (UNSOLVED, "too few colours left"), (OUTSIDE, "outside")]
        }
        _ => return,
    };
    let tint = |mark: u8| display.tints[mark.trailing_zeros() as usize % display.tints.len()];
    let mut corner = canvas.shrink(8.0).left_bottom();
    for (mark, words) in marks.iter().rev().filter(|(mark, _)| tint(*mark).strength > 0.0) {
        let [red, green, blue] = tint(*mark).colour;
        let plate = plate(&ui.painter_at(canvas), corner, Align2::LEFT_BOTTOM, &format!("     {words}"));
        let swatch = Rect::from_center_size(plate.left_center() + vec2(11.0, 0.0), vec2(9.0, 9.0));
        ui.painter_at(canvas).rect_filled(swatch, 2.0, Color32::from_rgb(red, green, blue));
        corner.y -= plate.height() + 2.0;
    }
}

fn canvas(
    ui: &mut Ui,
    view: &mut View,
    shown: &Picture,
    session: &mut Session,
    canvases: &mut Canvases,
    overlay: &mut dyn Overlay,
) {
    let document = session.document();
    let display = view.look.over(&shown.display);
    let other = view.against.as_ref().and_then(|other| picture(other, &document, &session.results).ok());
    let other_display = other.as_ref().map(|other| view.look.over(&other.display));

    let state = canvases.pictures.entry(view.id).or_default();
    if view.linked {
        state.view = canvases.shared;
    }
    state.compare = if view.wipe { Compare::Wipe } else { Compare::Hold };
    let primary = if overlay.wants_drag(&view.shown, session) { PrimaryDrag::Caller } else { PrimaryDrag::Pan };
    let label = view.shown.title();
    let other_label = view.against.as_ref().map(Shown::title).unwrap_or_default();
    let mut canvas =
        Canvas::new(state, &shown.source, &display).label(&label).legend(shown.quantity).primary_drag(primary);
    if let (Some(other), Some(display)) = (&other, &other_display) {
        canvas = canvas.against(&other.source, display).other_label(&other_label);
    }
    let response: CanvasResponse = canvas.show(ui);
    if view.linked {
        canvases.shared = state.view;
    }

    if response.response.clicked() || response.response.has_focus() || response.response.drag_started() {
        session.views.activate(view.id);
    }
    if let Some(pixel) = response.hovered {
        session.views.hover = Some(Hover { shown: view.shown.clone(), pixel });
    }
    match &other {
        Some(_) => compared(ui, view, &response),
        None => tints(ui, view, &display, response.transform.rect),
    }
    if let Some(words) = previewed(&view.shown, &document, &session.results) {
        let canvas = response.transform.rect;
        plate_in(&ui.painter_at(canvas), canvas, Align2::LEFT_TOP, words);
        if other.is_none() {
            ui.ctx().accesskit_node_builder(response.response.id, |node| node.set_description(words));
        }
    }
    overlay.overlay(ui, &Over { shown: &view.shown, picture: shown, canvas: &response }, session);
}
