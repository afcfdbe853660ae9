//! The fields of what is to be simulated.

use std::path::Path;

use eframe::egui::emath::Numeric;
use eframe::egui::{ComboBox, Grid, RichText, Ui};
use firstbounce_capture::mesh_file::read::LengthScale;
use firstbounce_lab::simulate::{Exposure, SimulateOptions};

use super::mesh::MeshChoice;
use super::values::{LampKind, SceneKind, Values};
use crate::app::base::dialogs::Choose;
use crate::app::state::session::Session;
use crate::app::widgets::number_field::up_to;
use crate::app::widgets::part::part;
use crate::app::widgets::theme::Weight;

const MAX_COLOURS: usize = 8;
const MAX_LAMPS: usize = 32;
/// Of a colour that is added, after that of the one before: far enough apart for little noise.
const NEXT_ALBEDO: f64 = 0.5;

/// Shows all fields.
pub fn ui(ui: &mut Ui, values: &mut Values, mesh: &mut MeshChoice, session: &mut Session) {
    part(ui, "scene", |ui| scene(ui, values, mesh, session));
    part(ui, "paint", |ui| paint(ui, values));
    part(ui, "lights", |ui| lights(ui, values));
    part(ui, "camera", |ui| camera(ui, values));
    part(ui, "sensor", |ui| sensor(ui, values));
    heading(ui, "Calibration");
    ui.checkbox(&mut values.balls, "Photos of the calibration balls");
}

fn heading(ui: &mut Ui, text: &str) {
    ui.add_space(8.0);
    ui.label(RichText::new(text).semi_bold());
}

/// A field of a number, its name before it, as a row of a grid.
fn row<N: Numeric>(ui: &mut Ui, name: &str, value: &mut N, (least, most): (N, N), unit: &str) -> bool {
    let label = ui.label(name);
    let speed = if N::INTEGRAL { 0.2 } else { 0.005 * value.to_f64().abs().max(0.2) };
    let field = up_to(value, if N::INTEGRAL { 0 } else { 3 }, least..=most).speed(speed).suffix(unit);
    let changed = ui.add(field).labelled_by(label.id).changed();
    ui.end_row();
    changed
}

/// The options say themselves what is too little or too much.
const ANY: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

fn rows(ui: &mut Ui, name: &str, contents: impl FnOnce(&mut Ui)) {
    Grid::new(name).num_columns(2).show(ui, contents);
}

fn scene(ui: &mut Ui, values: &mut Values, mesh: &mut MeshChoice, session: &mut Session) {
    heading(ui, "Scene");
    ui.horizontal_wrapped(|ui| {
        for kind in SceneKind::ALL {
            if ui.radio_value(&mut values.scene.kind, kind, kind.title()).changed() {
                values.scene.take_measures();
            }
        }
    });
    if values.scene.kind == SceneKind::Mesh {
        mesh_file(ui, values, mesh, session);
    }
    rows(ui, "measures", |ui| {
        if let Some(name) = values.scene.kind.size_name() {
            row(ui, name, &mut values.scene.size_mm, ANY, " mm");
        }
        if let Some((name, _)) = values.scene.kind.angle() {
            row(ui, name, &mut values.scene.angle_deg, ANY, "\u{b0}");
        }
        row(ui, "Patches that exchange light", &mut values.base.patches, (2, 60_000), "");
    });
}

fn mesh_file(ui: &mut Ui, values: &mut Values, mesh: &mut MeshChoice, session: &mut Session) {
    let dialogs = session.dialogs();
    let label = "Mesh file (OBJ, PLY, STL)";
    let mut chosen = mesh.field.ui(ui, label, Choose::Mesh, &dialogs, &mut session.jobs).into_iter().next();
    ui.horizontal_wrapped(|ui| {
        if ui.button("Use this mesh").clicked() && !mesh.field.text.trim().is_empty() {
            chosen = Some(Path::new(mesh.field.text.trim()).to_owned());
        }
        ComboBox::from_label("Unit of the mesh").width(70.0).selected_text(values.scene.unit.name()).show_ui(
            ui,
            |ui| {
                for unit in LengthScale::ALL {
                    ui.selectable_value(&mut values.scene.unit, unit, unit.name());
                }
            },
        );
    });
    ui.checkbox(&mut values.scene.flip, "Turn its faces the other way round");
    if let Some(path) = chosen {
        mesh.choose(&path, values);
    }
    for warning in mesh.warnings() {
        ui.colored_label(ui.visuals().warn_fg_color, warning);
    }
}

fn paint(ui: &mut Ui, values: &mut Values) {
    heading(ui, "Paint, by lamp colour");
    rows(ui, "albedos", |ui| {
        for (c, albedo) in values.base.albedos.iter_mut().enumerate() {
            row(ui, &format!("Albedo in c{}", c + 1), albedo, ANY, "");
        }
    });
    ui.horizontal(|ui| {
        let count = values.base.albedos.len();
        ui.add_enabled_ui(count < MAX_COLOURS, |ui| {
            if ui.button("Add a colour").clicked() {
                let last = values.base.albedos.last().copied().unwrap_or(1.0);
                values.base.albedos.push(NEXT_ALBEDO * last);
            }
        });
        ui.add_enabled_ui(count > 1, |ui| {
            if ui.button("Remove the last colour").clicked() {
                values.base.albedos.pop();
            }
        });
    });
    let words = match values.base.albedos.len() {
        1 => "One colour cannot separate bounces.".to_owned(),
        2 => "Two colours separate bounces up to order m = 2. c1 is the reference colour.".to_owned(),
        count => format!("{count} colours separate bounces up to order m = {count}. c1 is the reference colour."),
    };
    ui.label(RichText::new(words).small().weak());
}

fn lights(ui: &mut Ui, values: &mut Values) {
    heading(ui, "Lights on a ring");
    ui.horizontal_wrapped(|ui| {
        for kind in LampKind::ALL {
            ui.radio_value(&mut values.ring.kind, kind, kind.title());
        }
    });
    let mut count = values.ring.intensities.len();
    rows(ui, "ring", |ui| {
        if row(ui, "Number of lights", &mut count, (1, MAX_LAMPS), "") {
            values.ring.resize(count);
        }
        row(ui, "Tilt from the camera's axis", &mut values.ring.tilt_deg, ANY, "\u{b0}");
        if values.ring.kind != LampKind::Distant {
            row(ui, "Distance of the lamps", &mut values.ring.distance_mm, ANY, " mm");
        }
        if values.ring.kind == LampKind::Area {
            row(ui, "Side of a lamp", &mut values.ring.side_mm, ANY, " mm");
        }
        for (l, intensity) in values.ring.intensities.iter_mut().enumerate() {
            row(ui, &format!("Intensity of light{}", l + 1), intensity, ANY, "");
        }
    });
}

fn camera(ui: &mut Ui, values: &mut Values) {
    heading(ui, "Camera");
    ui.horizontal_wrapped(|ui| {
        ui.radio_value(&mut values.lens.is_perspective, false, "Orthographic");
        ui.radio_value(&mut values.lens.is_perspective, true, "Perspective");
    });
    rows(ui, "camera", |ui| {
        if values.lens.is_perspective {
            row(ui, "Working distance", &mut values.lens.distance_mm, ANY, " mm");
        }
        row(ui, "Side of the picture", &mut values.base.size_px, (16, 4096), " px");
    });
}

fn sensor(ui: &mut Ui, values: &mut Values) {
    heading(ui, "Sensor");
    let SimulateOptions { sensor, exposure: Exposure::Brightest(light) | Exposure::White(light), .. } =
        &mut values.base;
    rows(ui, "sensor", |ui| {
        row(ui, "Bits", &mut sensor.bits, (1, 16), "");
        row(ui, "Frames averaged", &mut sensor.frames, (1, 10_000), "");
        row(ui, "Full well", &mut sensor.full_well_electrons, ANY, " electrons");
        row(ui, "Read noise", &mut sensor.read_noise_electrons, ANY, " electrons");
        row(ui, "Light of the brightest pixel", light, ANY, " of white");
        row(ui, "Seed of the noise", &mut sensor.seed, (0, u64::from(u32::MAX)), "");
    });
}
