//! The choices of a 3D view: shading, layers, eye, tool.

use eframe::egui::containers::menu::{MenuButton, MenuConfig};
use eframe::egui::{Button, Checkbox, DragValue, PopupCloseBehavior, Ui};

use super::canvas::{bounds, seen};
use super::tool::{Tool, ViewState};
use crate::app::state::document::Document;
use crate::app::state::results::{StageError, SurfaceName};
use crate::app::state::session::Session;
use crate::app::state::surfaces::{LayerColours, LayerName, Shade, SurfaceLook};
use crate::gpu::mesh::{Lens, StandardView};

/// Width over height of a view that was never drawn.
const DEFAULT_ASPECT: f64 = 1.5;

/// A menu that stays open while several things are changed in it.
fn lasting_menu(ui: &mut Ui, title: impl Into<String>, contents: impl FnOnce(&mut Ui)) {
    let config = MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    MenuButton::from_button(Button::new(title.into())).config(config).ui(ui, contents);
}

/// Shading, layers and tools.
pub fn toolbar(
    ui: &mut Ui,
    look: &mut SurfaceLook,
    state: &mut ViewState,
    document: &Document,
    session: &Session,
    is_wide: bool,
) {
    let shade = match look.shade {
        Shade::Lamp => match super::scene::lamp(look, document, &session.results) {
            Some((name, _)) => format!("lit by {name}"),
            None => "lit by a lamp".into(),
        },
        shade => shade.name().into(),
    };
    let title = if is_wide { format!("Shading: {shade}") } else { "Shading".into() };
    lasting_menu(ui, title, |ui| shading(ui, look, document));
    lasting_menu(ui, "Layers", |ui| layers(ui, look, document, session));
    if is_wide {
        tools(ui, state);
    } else {
        lasting_menu(ui, "Measure", |ui| tools(ui, state));
    }
}

fn tools(ui: &mut Ui, state: &mut ViewState) {
    for (tool, name, hover) in [
        (Tool::Point, "Point", "Click to read a position"),
        (Tool::Distance, "Distance", "Click two points to measure the distance between them"),
        (Tool::Section, "Section", "Cuts the surfaces with a plane and plots the profile below"),
    ] {
        if ui.selectable_label(state.tool == tool, name).on_hover_text(hover).clicked() {
            state.tool = tool;
            state.picked.clear();
        }
    }
}

fn shading(ui: &mut Ui, look: &mut SurfaceLook, document: &Document) {
    for shade in Shade::ALL {
        ui.selectable_value(&mut look.shade, shade, shade.name());
    }
    if look.shade == Shade::Lamp {
        ui.separator();
        for light in &document.set.lights {
            let is_chosen = look.lamp.as_ref() == Some(&light.name);
            if ui.selectable_label(is_chosen, format!("Lamp {}", light.name)).clicked() {
                look.lamp = Some(light.name.clone());
            }
        }
    }
    if look.shade == Shade::Distance {
        ui.separator();
        let mut own = look.distance_mm.is_some();
        let mut ends = look.distance_mm.unwrap_or(1.0);
        ui.add(Checkbox::new(&mut own, "Custom range")).on_hover_text("Otherwise the 95th percentile of the distances");
        let label = ui.label("Largest distance shown");
        let field =
            DragValue::new(&mut ends).range(SurfaceLook::DISTANCES_MM).speed(0.01).max_decimals(4).suffix(" mm");
        ui.add_enabled(own, field).labelled_by(label.id);
        look.distance_mm = own.then_some(ends);
    }
    ui.separator();
    ui.checkbox(&mut look.wireframe, "Wireframe over the surface");
}

fn layers(ui: &mut Ui, look: &mut SurfaceLook, document: &Document, session: &Session) {
    // The method in force is the first layer.
    let by_itself = LayerName::Surface(SurfaceName::By(document.method()));
    for name in LayerName::all().filter(|name| *name != by_itself) {
        let is_there = session.surfaces.layer(name).is_some();
        let layer = look.layer_mut(name);
        ui.horizontal(|ui| {
            let show =
                ui.add_enabled(is_there, Checkbox::new(&mut layer.visible, format!("Show {}", name.in_sentence())));
            show.on_disabled_hover_text(match name {
                LayerName::Reference => "Load a reference in the Shape step".into(),
                LayerName::AFTER | LayerName::Surface(SurfaceName::Before) => "This surface is not computed yet".into(),
                LayerName::Surface(SurfaceName::By(method)) => StageError::NotAsked { method }.to_string(),
            });
        });
        ui.indent(name.title(), |ui| {
            ui.checkbox(&mut layer.shaded, format!("Light {}", name.in_sentence()));
            ui.horizontal(|ui| {
                let label = ui.label(format!("Colour of {}", name.in_sentence()));
                ui.color_edit_button_srgb(&mut layer.colour).labelled_by(label.id);
            });
        });
    }
    ui.separator();
    ui.label("Show layers in their own colours");
    for (colours, name) in [
        (LayerColours::Several, "When several are visible"),
        (LayerColours::Always, "Always"),
        (LayerColours::Never, "Never"),
    ] {
        ui.radio_value(&mut look.colours, colours, name);
    }
    let own = SurfaceLook::default();
    if ui.button("The default colours").on_hover_text("After teal, before amber, reference grey").clicked() {
        for name in LayerName::all() {
            look.layer_mut(name).colour = own.layer(name).colour;
        }
    }
}

/// Where the eye is, for the view's own menu.
pub fn eye_menu(ui: &mut Ui, look: &mut SurfaceLook, state: &ViewState, session: &Session) {
    for view in StandardView::ALL {
        if ui.button(format!("{} view", view.name())).clicked() {
            look_from(look, state, view, session);
            ui.close();
        }
    }
    if ui.button("Fit to view").clicked() {
        look.camera = None;
        ui.close();
    }
    ui.separator();
    ui.radio_value(&mut look.lens, Lens::Perspective, "Perspective");
    ui.radio_value(&mut look.lens, Lens::Orthographic, "Orthographic");
    ui.checkbox(&mut look.turntable, "Turntable");
}

/// Takes the eye of a view to a named side.
pub fn look_from(look: &mut SurfaceLook, state: &ViewState, from: StandardView, session: &Session) {
    if let Some(bounds) = bounds(&seen(look, session, false)) {
        look.look_from(from, &bounds, if state.aspect > 0.0 { state.aspect } else { DEFAULT_ASPECT });
    }
}
