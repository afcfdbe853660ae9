//! One view: its header, its canvas with what panels draw over it, and the strip below.

use eframe::egui::containers::menu::MenuButton;
use eframe::egui::{
    Align, Align2, Color32, Label, Layout, Rect, RichText, Role, TextStyle, Ui, UiBuilder, WidgetInfo, pos2, vec2,
};
use firstbounce_core::image::photo::{CLIPPED, DARK};
use firstbounce_core::separate::{OUTSIDE, UNSOLVED};

use super::picture::{Picture, outdated, picture, previewed};
use super::saving::Take;
use super::scale::scaled;
use super::{Canvases, Over, Overlay, picker, strip};
use crate::app::state::layout::{self, Arrange, Hover, Pane, Shown, View};
use crate::app::state::session::Session;
use crate::app::views::canvas::{Canvas, CanvasResponse, Compare, PrimaryDrag};
use crate::app::views::surface;
use crate::app::widgets::advice::advice_in_the_middle;
use crate::app::widgets::plate::{plate, plate_in};
use crate::app::widgets::theme::Weight;
use crate::gpu::Display;

const HEADER_HEIGHT: f32 = 24.0;
/// Tiles that are wider have the tools of a surface beside each other.
const WIDE: f32 = 640.0;
/// Tiles that are narrower have their zooms by keys and menu alone.
const NARROW: f32 = 260.0;

/// The whole view.
pub fn ui(ui: &mut Ui, view: &mut View, session: &mut Session, canvases: &mut Canvases, overlay: &mut dyn Overlay) {
    ui.push_id(view.id, |ui| {
        header(ui, view, session, canvases);
        match view.shown {
            Shown::Surface => in_3d(ui, view, session, canvases),
            Shown::Pane(pane) => overlay.pane(ui, pane, session),
            _ => in_2d(ui, view, session, canvases, overlay),
        }
    });
}

fn in_3d(ui: &mut Ui, view: &mut View, session: &mut Session, canvases: &mut Canvases) {
    canvases.take_eye(view);
    if surface::ui(ui, view.id, &mut view.surface, session, canvases) {
        session.views.activate(view.id);
    }
    canvases.give_eye(view);
}

fn in_2d(ui: &mut Ui, view: &mut View, session: &mut Session, canvases: &mut Canvases, overlay: &mut dyn Overlay) {
    let document = session.document();
    let below =
        Rect::from_min_max(pos2(ui.max_rect().left(), ui.max_rect().bottom() - strip::HEIGHT), ui.max_rect().max);
    let above = Rect::from_min_max(ui.cursor().min, pos2(ui.max_rect().right(), below.top()));
    ui.scope_builder(UiBuilder::new().max_rect(above), |ui| {
        match picture(&view.drawn(), &document, &session.results) {
            Ok(shown) => {
                if let Some(line) = outdated(&view.shown, &document, &session.results) {
                    ui.add(Label::new(RichText::new(line).color(ui.visuals().warn_fg_color)).truncate());
                }
                canvas(ui, view, &shown, session, canvases, overlay);
            }
            Err(error) => advice_in_the_middle(ui, &error.to_string()),
        }
    });
    ui.scope_builder(UiBuilder::new().max_rect(below), |ui| strip::ui(ui, view, session, canvases));
}

/// One row: what is shown, and what is done with the tile.
fn header(ui: &mut Ui, view: &mut View, session: &mut Session, canvases: &mut Canvases) {
    let is_active = session.views.active_id() == Some(view.id);
    let width = ui.available_width();
    let mut tile = ui.max_rect();
    tile.min.y += HEADER_HEIGHT + ui.spacing().item_spacing.y;
    if !matches!(view.shown, Shown::Surface | Shown::Pane(_)) {
        tile.max.y -= strip::HEIGHT;
    }
    ui.horizontal(|ui| {
        ui.set_min_height(HEADER_HEIGHT);
        ui.spacing_mut().item_spacing.x = 4.0;
        let few = width < NARROW;
        picture_menu(ui, view, session, is_active, 0.45 * width);
        if view.shown == Shown::Surface {
            let document = session.document();
            surface::toolbar(ui, &mut view.surface, canvases.surface(view.id), &document, session, width > WIDE);
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            tile_buttons(ui, view, session);
            ui.menu_button("\u{2026}", |ui| tile_menu(ui, tile, view, session, canvases))
                .response
                .on_hover_text("Zoom, colours, arrangement")
                .widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("More, {}", view.shown.title())));
            if !few && !matches!(view.shown, Shown::Surface | Shown::Pane(_)) {
                zoom(ui, view, canvases);
            }
        });
    });
}

/// What the view shows, and the pictures to choose from.
fn picture_menu(ui: &mut Ui, view: &mut View, session: &mut Session, is_active: bool, width: f32) {
    let document = session.document();
    let title = view.drawn().title();
    let short = if view.shown == Shown::Surface { format!("{}, 3D", view.surface.title()) } else { title.clone() };
    let text = RichText::new(elided(ui, &short, width));
    let button = MenuButton::new(if is_active { text.semi_bold() } else { text });
    let (response, _) = button.ui(ui, |ui| {
        let in_3d = ui.selectable_label(view.shown == Shown::Surface, Shown::Surface.title()).clicked();
        let mut chosen = picker::ui(ui, &document, Some(&view.shown)).or(in_3d.then_some(Shown::Surface));
        ui.separator();
        for pane in Pane::ALL {
            let shown = Shown::Pane(pane);
            if ui.selectable_label(view.shown == shown, pane.title()).clicked() {
                chosen = Some(shown);
            }
        }
        if let Some(chosen) = chosen {
            view.shown = chosen;
            view.look = Default::default();
            session.views.activate(view.id);
            ui.close();
        }
    });
    response.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Picture: {title}")));
    response.on_hover_text(title);
}

/// As much of a text as fits, in the width of the button's own letters.
fn elided(ui: &Ui, text: &str, width: f32) -> String {
    let font = TextStyle::Button.resolve(ui.style());
    let wide = |text: &str| ui.painter().layout_no_wrap(text.to_owned(), font.clone(), Color32::WHITE).size().x > width;
    if !wide(text) {
        return text.to_owned();
    }
    let mut kept: Vec<char> = text.chars().collect();
    while kept.len() > 1 && wide(&format!("{}\u{2026}", kept.iter().collect::<String>())) {
        kept.truncate((kept.len() * 9 / 10).max(1).min(kept.len() - 1));
    }
    format!("{}\u{2026}", kept.into_iter().collect::<String>())
}

fn tile_buttons(ui: &mut Ui, view: &View, session: &mut Session) {
    let several = session.views.has_several();
    let button = |ui: &mut Ui, text: &str, what: &str| {
        let button = ui.small_button(text);
        button.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("{what}, {}", view.shown.title())));
        button.on_hover_text(what).clicked()
    };
    if several && button(ui, "\u{d7}", "Close view") {
        session.views.arrange(view.id, Arrange::Close);
    }
    let is_maximised = session.views.maximised() == Some(view.id);
    let (sign, what) = if is_maximised { ("\u{1f5d7}", "All views again") } else { ("\u{1f5d6}", "Only this view") };
    if (several || is_maximised) && button(ui, sign, what) {
        session.views.maximise(view.id);
    }
}

fn tile_menu(ui: &mut Ui, tile: Rect, view: &mut View, session: &mut Session, canvases: &mut Canvases) {
    if view.shown == Shown::Surface {
        ui.menu_button("Look from", |ui| surface::eye_menu(ui, &mut view.surface, canvases.surface(view.id), session));
    }
    ui.checkbox(&mut view.linked, "Zoom and pan with the others");
    ui.separator();
    for (name, take) in [("Copy picture", Take::Copy), ("Save picture", Take::Save)] {
        let hover = "As it is seen, with its legend and scale bar; saved into the folder \"pictures\" of the set";
        if ui.button(name).on_hover_text(hover).clicked() {
            let folder = session.document().set.folder.clone();
            canvases.saving.start(ui.ctx(), tile, take, &folder, &view.drawn().title());
            ui.close();
        }
    }
    ui.separator();
    for (name, arrange) in [
        ("Split right", Arrange::SplitRight),
        ("Split down", Arrange::SplitDown),
        ("New tab", Arrange::NewTab),
        ("Close view", Arrange::Close),
    ] {
        if ui.button(name).clicked() {
            session.views.arrange(view.id, arrange);
            ui.close();
        }
    }
}

/// The two zooms that are used most.
fn zoom(ui: &mut Ui, view: &View, canvases: &mut Canvases) {
    let title = view.shown.title();
    for (text, words, one_to_one) in [("1:1", "One to one", true), ("Fit", "Fit", false)] {
        let button = ui.small_button(text);
        button.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("{words}, {title}")));
        if button
            .on_hover_text(if one_to_one { "A pixel of the screen for every pixel" } else { "The whole picture" })
            .clicked()
        {
            canvases.zoom(view, one_to_one);
        }
    }
}

/// Says on the canvas, and to screen readers, which of two pictures is seen where.
fn compared(ui: &Ui, view: &View, response: &CanvasResponse) {
    let Some(other) = view.against.as_ref().filter(|_| view.compare != layout::Compare::Difference) else { return };
    let (own, other) = (view.shown.title(), other.title());
    let canvas = response.transform.rect;
    let words = match (response.shows_other, view.compare == layout::Compare::Wipe) {
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
    let drawn = view.drawn();
    let against = view.against.as_ref().filter(|_| view.compare != layout::Compare::Difference);
    let other = against.and_then(|other| picture(other, &document, &session.results).ok());
    let scale = |of: &Shown, picture: &Picture| scaled(of, picture, view, other.is_some(), &document, &session.results);
    let (display, factor) = scale(&drawn, shown);
    let other_display = against.zip(other.as_ref()).map(|(of, other)| scale(of, other).0);

    let state = canvases.pictures.entry(view.id).or_default();
    if view.linked {
        state.view = canvases.shared;
    }
    state.compare = if view.compare == layout::Compare::Wipe { Compare::Wipe } else { Compare::Hold };
    let primary = if overlay.wants_drag(&view.shown, session) { PrimaryDrag::Caller } else { PrimaryDrag::Pan };
    let label = drawn.title();
    let other_label = against.map(Shown::title).unwrap_or_default();
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
        session.views.hover = Some(Hover { shown: drawn.clone(), pixel });
    }
    if response.response.double_clicked() {
        session.views.maximise(view.id);
    }
    match &other {
        Some(_) => compared(ui, view, &response),
        None => tints(ui, view, &display, response.transform.rect),
    }
    if let Some(factor) = factor {
        let canvas = response.transform.rect;
        plate_in(&ui.painter_at(canvas), canvas, Align2::RIGHT_TOP, &format!("\u{d7} {factor}"));
    }
    if let Some(words) = previewed(&view.shown, &document, &session.results) {
        let canvas = response.transform.rect;
        plate_in(&ui.painter_at(canvas), canvas, Align2::LEFT_TOP, words);
        if other.is_none() {
            ui.ctx().accesskit_node_builder(response.response.id, |node| node.set_description(words));
        }
    }
    overlay.overlay(ui, &Over { shown: &drawn, picture: shown, canvas: &response }, session);
}
