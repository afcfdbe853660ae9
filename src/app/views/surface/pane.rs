//! A 3D view below its tool bar: words, the view, and the profile of its section.

use eframe::egui::{Ui, vec2};

use super::canvas::{self, bounds, seen};
use super::pairs;
use super::profile;
use super::scene::{Heat, ink, light};
use super::tool::{Tool, ViewState, point_words};
use crate::app::state::document::Document;
use crate::app::state::results::{StageState, Step};
use crate::app::state::session::Session;
use crate::app::state::surfaces::{LayerName, SurfaceLook};
use crate::app::views::Canvases;
use crate::app::widgets::advice::advice_in_the_middle;

/// Fills the space that is left; whether it was touched.
pub fn ui(ui: &mut Ui, id: u64, look: &mut SurfaceLook, session: &mut Session, canvases: &mut Canvases) -> bool {
    let state = canvases.surface(id);
    let document = session.document();
    session.update_surfaces();
    if session.reference.pairs.is_some() {
        return pairs::ui(ui, look, state, session);
    }
    let visible = seen(look, session, false);
    let Some(around) = bounds(&visible) else {
        let line = nothing(look, &document, session);
        advice_in_the_middle(ui, &line);
        return false;
    };
    let heat = Heat::of(session, look, &visible);
    let light = light(look, &document, &session.results, heat.as_ref(), &visible);
    let unit = visible.first().map_or("mm", |seen| seen.prepared.unit());
    for seen in &visible {
        if let Some(words) = seen.prepared.words() {
            ui.label(format!("{}: {words}.", seen.name.title()));
        }
    }
    if let Some(line) = &light.missing {
        ui.colored_label(ui.visuals().warn_fg_color, line);
    }
    picked(ui, state, unit);
    if state.tool == Tool::Section {
        ui.horizontal_wrapped(|ui| profile::controls(ui, state, &around, unit));
        profile::slide(ui, state, &around);
    }
    let plane = state.plane(&around.centre());
    let space = ui.available_size();
    let below = if plane.is_some() { profile::HEIGHT.min(space.y / 2.0) } else { 0.0 };
    let size = vec2(space.x, space.y - below);
    let shown = canvas::show(ui, size, look, state, session, (light.shading, heat.as_ref()));
    let mut touched = false;
    if let Some(shown) = &shown {
        let response = &shown.response;
        touched = response.clicked() || response.has_focus() || response.drag_started();
        if let Some(picked) = shown.clicked {
            state.pick(picked);
        }
    }
    if let Some(plane) = plane {
        profile::plot(ui, state, &plane, visible, unit, &|name| ink(look, name));
    }
    touched
}

/// What was picked, in words that can be copied.
fn picked(ui: &mut Ui, state: &mut ViewState, unit: &str) {
    if state.picked.is_empty() {
        return;
    }
    let mut lines: Vec<_> = state.picked.iter().map(|picked| point_words(picked, unit)).collect();
    if let Some(length) = state.distance().filter(|_| state.tool == Tool::Distance) {
        lines.push(format!("Distance: {length:.3} {unit}"));
    }
    ui.horizontal_wrapped(|ui| {
        for line in &lines {
            ui.label(line);
        }
        if ui.button("Copy").on_hover_text("The picked values, as text").clicked() {
            ui.copy_text(lines.join("\n"));
        }
        if ui.button("Forget points").clicked() {
            state.picked.clear();
        }
    });
}

/// Why there is nothing to see, and what to do.
fn nothing(look: &SurfaceLook, document: &Document, session: &Session) -> String {
    let asked: Vec<_> = LayerName::all().filter(|name| look.layer(*name).visible).collect();
    if asked.is_empty() {
        return "every layer is hidden: choose one in Layers".into();
    }
    if let Some(line) = asked.iter().find_map(|name| session.surfaces.failed(*name)) {
        return line.to_string();
    }
    match session.results.state(Step::Mesh, document) {
        StageState::Failed { line } | StageState::Blocked { line } | StageState::Cancelled { line } => line,
        StageState::Stale | StageState::Running { .. } => "the surface is being computed".into(),
        StageState::Ready if session.surfaces.is_at_rest() => {
            "this layer is not there: choose another in Layers".into()
        }
        StageState::Ready => "the surface is being prepared".into(),
    }
}
