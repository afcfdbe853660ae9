//! The camera: how its files store light, and the question that 8-bit files raise.

use eframe::egui::{ComboBox, RichText, Ui};
use firstbounce_capture::set::{Camera, Encoding, Number, Projection};

use super::scale::ScalePart;
use crate::app::state::layout::Shown;
use crate::app::state::session::Session;
use crate::app::views::Over;
use crate::app::widgets::number_field::up_to;

/// What a perspective camera begins with: a lens of 50 mm before pixels of 10 micrometres, half a metre away.
const FIRST_FOCAL_LENGTH_PX: f64 = 5000.0;
const FIRST_DISTANCE_MM: f64 = 500.0;

/// The user's answers in this session.
#[derive(Default)]
pub struct CameraPart {
    /// Who answered is not asked again.
    answered: bool,
    scale: ScalePart,
}

impl CameraPart {
    pub fn ui(&mut self, ui: &mut Ui, session: &mut Session) {
        self.question(ui, session);
        let old = session.document().set.camera.clone();
        let mut new = old.clone();
        ui.collapsing("Camera and scale", |ui| {
            camera(ui, &mut new);
            if new != old {
                session.edit("Change camera", |document| document.set.camera = new);
            }
            self.scale.ui(ui, session);
        });
    }

    pub fn overlay(&mut self, ui: &Ui, over: &Over<'_>) {
        self.scale.overlay(ui, over);
    }

    pub fn wants_drag(&self, shown: &Shown) -> bool {
        self.scale.wants_drag(shown)
    }

    /// 8-bit files are nearly always sRGB, and taken for linear they bend every number.
    fn question(&mut self, ui: &mut Ui, session: &mut Session) {
        let document = session.document();
        let Some(loaded) = session.results.loaded() else { return };
        let warnings = loaded.warnings.clone();
        for warning in &warnings {
            ui.label(RichText::new(warning).small().color(ui.visuals().warn_fg_color));
        }
        let kinds = ["eight-bit", "probably-srgb"];
        let coarse = loaded.captures.report.warnings.iter().any(|warning| kinds.contains(&warning.kind()));
        if !coarse || self.answered || document.set.camera.encoding.is_some() {
            return;
        }
        ui.group(|ui| {
            ui.label(
                "Some photos have 8 bits a pixel. Cameras and picture programs store such files with the sRGB curve, \
                 unless the camera was set to linear. Which is it?",
            );
            ui.horizontal_wrapped(|ui| {
                if ui.button("They are sRGB").clicked() {
                    session.edit("Files are sRGB", |document| document.set.camera.encoding = Some(Encoding::Srgb));
                    self.answered = true;
                }
                if ui.button("They are linear").clicked() {
                    session.edit("Files are linear", |document| document.set.camera.encoding = Some(Encoding::Linear));
                    self.answered = true;
                }
            });
        });
    }
}

fn camera(ui: &mut Ui, camera: &mut Camera) {
    encoding_box(ui, "Encoding of the files", "as each file says, else linear", &mut camera.encoding);
    let label = ui.label("Black level, stored value");
    ui.add(up_to(&mut camera.black_level, 4, Number::BlackLevel.range()).speed(1.0)).labelled_by(label.id);
    optional(
        ui,
        "White level, stored value",
        "White level is the file type's maximum",
        (Number::WhiteLevel, &mut camera.white_level, 65535.0),
    );
    projection_box(ui, &mut camera.projection);
    match &mut camera.projection {
        Projection::Orthographic { mm_per_pixel } => optional(
            ui,
            "Millimetres per pixel",
            "Scale unknown: the shape is in pixels",
            (Number::MmPerPixel, mm_per_pixel, 0.1),
        ),
        Projection::Perspective { focal_length_px, principal_point, working_distance_mm } => {
            for (title, what, value) in [
                ("Focal length, px", Number::FocalLengthPx, focal_length_px),
                ("Distance to the object, mm", Number::WorkingDistanceMm, working_distance_mm),
            ] {
                let label = ui.label(title);
                ui.add(up_to(value, 4, what.range()).speed(1.0)).labelled_by(label.id);
            }
            principal_point_fields(ui, principal_point);
            distortion_fields(ui, &mut camera.distortion);
        }
    }
}

/// Of the lens, as OpenCV defines it: undone when photos are read.
fn distortion_fields(ui: &mut Ui, distortion: &mut Option<[f64; 4]>) {
    let mut straight = distortion.is_none();
    if ui.checkbox(&mut straight, "The lens does not distort").changed() {
        *distortion = (!straight).then_some([0.0; 4]);
    }
    for (value, name) in distortion.iter_mut().flatten().zip(["k1", "k2", "p1", "p2"]) {
        let label = ui.label(format!("Distortion {name}"));
        ui.add(up_to(value, 6, Number::Distortion.range()).speed(0.001)).labelled_by(label.id);
    }
}

/// Where the optical axis meets the picture; absent, in its centre.
fn principal_point_fields(ui: &mut Ui, principal_point: &mut Option<[f64; 2]>) {
    let mut centred = principal_point.is_none();
    if ui.checkbox(&mut centred, "The optical axis meets the picture in its centre").changed() {
        *principal_point = (!centred).then_some([0.0, 0.0]);
    }
    for (value, axis) in principal_point.iter_mut().flatten().zip(["x", "y"]) {
        let label = ui.label(format!("Principal point {axis}, px"));
        ui.add(up_to(value, 3, Number::PrincipalPoint.range()).speed(0.5)).labelled_by(label.id);
    }
}

/// Parallel rays, or rays through one point; what is known of the scale goes along.
fn projection_box(ui: &mut Ui, projection: &mut Projection) {
    let words = |is_perspective: bool| if is_perspective { "perspective" } else { "orthographic: far away" };
    let mut is_perspective = matches!(projection, Projection::Perspective { .. });
    let before = is_perspective;
    ComboBox::from_label("Projection").selected_text(words(is_perspective)).show_ui(ui, |ui| {
        for choice in [false, true] {
            ui.selectable_value(&mut is_perspective, choice, words(choice));
        }
    });
    if is_perspective != before {
        *projection = other_projection(*projection);
    }
}

fn other_projection(projection: Projection) -> Projection {
    match projection {
        Projection::Orthographic { mm_per_pixel } => Projection::Perspective {
            focal_length_px: FIRST_FOCAL_LENGTH_PX,
            principal_point: None,
            working_distance_mm: mm_per_pixel.map_or(FIRST_DISTANCE_MM, |scale| scale * FIRST_FOCAL_LENGTH_PX),
        },
        Projection::Perspective { focal_length_px, working_distance_mm, .. } => {
            Projection::Orthographic { mm_per_pixel: Some(working_distance_mm / focal_length_px) }
        }
    }
}

/// An encoding, or what holds where none is given.
pub(super) fn encoding_box(ui: &mut Ui, label: &str, absent: &str, encoding: &mut Option<Encoding>) {
    let words = |encoding: &Option<Encoding>| match encoding {
        None => absent.to_owned(),
        Some(Encoding::Linear) => "linear".to_owned(),
        Some(Encoding::Srgb) => "sRGB".to_owned(),
        Some(Encoding::Gamma(_)) => "gamma".to_owned(),
    };
    ComboBox::from_label(label).selected_text(words(encoding)).show_ui(ui, |ui| {
        for choice in [None, Some(Encoding::Linear), Some(Encoding::Srgb), Some(Encoding::Gamma(2.2))] {
            ui.selectable_value(encoding, choice, words(&choice));
        }
    });
    if let Some(Encoding::Gamma(gamma)) = encoding {
        let label = ui.label("Gamma");
        ui.add(up_to(gamma, 4, Number::Gamma.range()).speed(0.01)).labelled_by(label.id);
    }
}

/// A number that may be absent, and what it is when it is first given.
pub(super) fn optional(ui: &mut Ui, label: &str, absent: &str, (what, value, first): (Number, &mut Option<f64>, f64)) {
    let mut none = value.is_none();
    if ui.checkbox(&mut none, absent).changed() {
        *value = (!none).then_some(first);
    }
    if let Some(number) = value {
        let name = ui.label(label);
        ui.add(up_to(number, 6, what.range()).speed(0.001 * first)).labelled_by(name.id);
    }
}
