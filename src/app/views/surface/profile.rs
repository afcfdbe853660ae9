//! The cut of every visible surface with a plane, plotted.

use std::sync::Arc;

use eframe::egui::{Color32, DragValue, Role, Slider, Ui, WidgetInfo};
use egui_plot::{Legend, Line, Plot};
use firstbounce_core::mesh::section;
use nalgebra::{Isometry3, UnitVector3};

use super::tool::{Cut, SectionPlane, ViewState};
use crate::app::state::surfaces::LayerName;
use crate::app::state::surfaces::Prepared;
use crate::gpu::mesh::Bounds;

/// Points of the screen that the plot takes.
pub const HEIGHT: f32 = 170.0;

/// A surface that is seen, and where it lies.
#[derive(Clone)]
pub struct Seen {
    /// Which one.
    pub name: LayerName,
    /// Ready to be drawn.
    pub prepared: Arc<Prepared>,
    /// Where it lies in the object frame.
    pub pose: Isometry3<f64>,
}

impl PartialEq for Seen {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name && Arc::ptr_eq(&self.prepared, &other.prepared) && self.pose == other.pose
    }
}

/// The cut, and of what.
pub struct Profile {
    plane: SectionPlane,
    of: Vec<Seen>,
    /// By surface, its lines in the plot's coordinates.
    pub lines: Vec<(LayerName, Vec<Vec<[f64; 2]>>)>,
}

impl Profile {
    /// Cuts all of them.
    pub fn new(plane: SectionPlane, of: Vec<Seen>) -> Self {
        let cut = |seen: &Seen| {
            let to_mesh = seen.pose.inverse();
            let normal = UnitVector3::new_normalize(to_mesh.rotation * plane.normal.into_inner());
            let lines = section(seen.prepared.shown(), &(to_mesh * plane.point), &normal);
            let flat = |point| {
                let from_origin = seen.pose * point - plane.origin;
                [plane.along.dot(&from_origin), plane.up.dot(&from_origin)]
            };
            (seen.name, lines.into_iter().map(|line| line.into_iter().map(flat).collect()).collect())
        };
        let lines = of.iter().map(cut).collect();
        Self { plane, of, lines }
    }

    fn is(&self, plane: &SectionPlane, of: &[Seen]) -> bool {
        self.plane == *plane && self.of == of
    }

    /// All points as a table: layer, horizontal, vertical, separated by tabs.
    fn table(&self, unit: &str) -> String {
        let [along, up] = self.plane.names;
        let mut table = format!("surface\t{along} ({unit})\t{up} ({unit})\n");
        for (name, lines) in &self.lines {
            for [s, z] in lines.iter().flatten() {
                table.push_str(&format!("{}\t{s:.5}\t{z:.5}\n", name.title()));
            }
        }
        table
    }
}

/// How the plane lies, and where.
pub fn controls(ui: &mut Ui, state: &mut ViewState, bounds: &Bounds, unit: &str) {
    for cut in Cut::ALL {
        ui.selectable_value(&mut state.cut, cut, cut.name());
    }
    match state.cut.axis() {
        Some(axis) => {
            let [low, high] = bounds.along(axis);
            let mut at = state.at[axis].unwrap_or((low + high) / 2.0);
            let label = ui.label("Section at");
            let field = DragValue::new(&mut at)
                .range(low..=high)
                .speed((high - low) / 400.0)
                .max_decimals(3)
                .suffix(format!(" {unit}"));
            if ui.add(field).labelled_by(label.id).changed() {
                state.at[axis] = Some(at);
            }
        }
        None if state.picked.len() < 2 => {
            ui.label("Click two points on a surface.");
        }
        None => {}
    }
}

/// A slider over the whole width, for the plane across an axis.
pub fn slide(ui: &mut Ui, state: &mut ViewState, bounds: &Bounds) {
    let Some(axis) = state.cut.axis() else { return };
    let [low, high] = bounds.along(axis);
    let mut at = state.at[axis].unwrap_or((low + high) / 2.0);
    ui.scope(|ui| {
        ui.spacing_mut().slider_width = (ui.available_width() - 20.0).max(40.0);
        let slider = Slider::new(&mut at, low..=high).show_value(false);
        let response = ui.add(slider);
        response.widget_info(|| WidgetInfo::slider(true, at, "Slide the section"));
        if response.changed() {
            state.at[axis] = Some(at);
        }
    });
}

/// The plot of the cut; computed again when the plane or a surface has changed.
pub fn plot(
    ui: &mut Ui,
    state: &mut ViewState,
    plane: &SectionPlane,
    seen: Vec<Seen>,
    unit: &str,
    colour: &dyn Fn(LayerName) -> Color32,
) {
    if !state.profile.as_ref().is_some_and(|profile| profile.is(plane, &seen)) {
        state.profile = Some(Profile::new(*plane, seen));
    }
    let Some(profile) = &state.profile else { return };
    let [along, up] = plane.names;
    let points: usize = profile.lines.iter().map(|(_, lines)| lines.iter().map(Vec::len).sum::<usize>()).sum();
    let names: Vec<_> = profile.lines.iter().map(|(name, _)| name.title()).collect();
    let spoken = format!("Profile of {}, {points} points, {up} over {along}", names.join(", "));
    ui.horizontal_wrapped(|ui| {
        ui.label(&spoken);
        if ui.button("Copy profile").on_hover_text("As a table, separated by tabs").clicked() {
            ui.copy_text(profile.table(unit));
        }
    });
    let plot = Plot::new("section")
        .height(ui.available_height().max(40.0))
        .data_aspect(1.0)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .x_axis_label(format!("{along}, {unit}"))
        .y_axis_label(format!("{up}, {unit}"))
        .legend(Legend::default())
        .show(ui, |plot| {
            for (name, lines) in &profile.lines {
                for line in lines {
                    plot.line(Line::new(name.title(), line.clone()).color(colour(*name)).width(1.5));
                }
            }
        });
    plot.response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &spoken));
}
