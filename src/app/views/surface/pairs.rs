//! Picking pairs of points for a rough alignment: the surface and the reference by turns, each alone in the view.

use eframe::egui::{RichText, Ui};
use nalgebra::Point3;

use super::canvas;
use super::tool::{Picked, Tool, ViewState};
use crate::app::state::session::Session;
use crate::app::state::surfaces::{LayerName, Shade, SurfaceLook};
use crate::app::widgets::theme::Weight;
use crate::gpu::mesh::Shading;

/// The view in the place of the usual one; whether it was touched.
pub fn ui(ui: &mut Ui, look: &mut SurfaceLook, state: &mut ViewState, session: &mut Session) -> bool {
    let Some(pairs) = session.reference.pairs.clone() else { return false };
    let layer = pairs.next();
    ui.horizontal_wrapped(|ui| {
        ui.label(RichText::new(pairs.words()).semi_bold());
        if ui.button("Take the last point back").clicked()
            && let Some(pairs) = &mut session.reference.pairs
        {
            pairs.take_back();
        }
        if pairs.is_enough() && ui.button("Align from these pairs").clicked() {
            session.align_from_pairs();
        }
        if ui.button("Stop picking").clicked() {
            session.reference.pairs = None;
        }
    });
    // The two may lie far apart: each has an eye of its own.
    let mut own = SurfaceLook { shade: Shade::Matcap, turntable: false, ..look.clone() };
    for name in LayerName::all() {
        own.layer_mut(name).visible = name == layer;
    }
    if layer == LayerName::Reference {
        own.camera = state.reference_camera;
    }
    let points: Vec<Point3<f64>> = pairs.on(layer).to_vec();
    let kept = (state.tool, std::mem::take(&mut state.picked));
    state.tool = Tool::Point;
    state.picked = points.into_iter().map(|point| Picked { layer, point }).collect();
    let size = ui.available_size();
    let shown = canvas::show(ui, size, &mut own, state, session, (Shading::Matcap, None));
    (state.tool, state.picked) = kept;
    match layer {
        LayerName::Reference => state.reference_camera = own.camera,
        _ => look.camera = own.camera,
    }
    let Some(shown) = shown else {
        ui.label("This surface is not there yet.");
        return false;
    };
    if let Some(picked) = shown.clicked {
        session.pick_for_pair(picked.point);
    }
    shown.response.clicked() || shown.response.has_focus() || shown.response.drag_started()
}
