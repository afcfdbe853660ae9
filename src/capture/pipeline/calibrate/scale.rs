//! The scale at the object's z = 0: mm per pixel as the camera gives it, and as balls of known diameter say.

use super::warning::Warning;
use crate::set::{CaptureSet, Projection};

/// What gives a scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ScaleSource {
    /// `[camera]` of the capture file.
    Typed,
    /// `diameter_mm` of balls.
    Balls,
}

impl ScaleSource {
    /// Of a set with a scale.
    pub fn of(set: &CaptureSet) -> Self {
        match set.camera.projection {
            Projection::Orthographic { mm_per_pixel: None } => Self::Balls,
            _ => Self::Typed,
        }
    }

    /// For the user.
    pub fn words(self) -> &'static str {
        match self {
            Self::Typed => "capture.toml",
            Self::Balls => "diameter of balls",
        }
    }
}

/// A ball's own scale may be off the one in force by this share: that of a diameter measured with a ruler.
const MAX_SHARE: f64 = 0.01;
/// And by that of so many pixels of its radius.
const MAX_OFF_PX: f64 = 1.0;

/// The balls whose diameters contradict the scale in force.
pub(super) fn contradicted_scale(set: &CaptureSet) -> Vec<Warning<'static>> {
    let Some(in_force) = set.mm_per_pixel() else { return Vec::new() };
    let source = ScaleSource::of(set);
    let contradicted = set.spheres.iter().filter_map(|sphere| {
        let measured = set.mm_per_pixel_of(sphere)?;
        let allowed = MAX_SHARE.max(MAX_OFF_PX / sphere.circle.radius);
        let is_off = (measured / in_force - 1.0).abs() > allowed;
        is_off.then_some(Warning::Scale { ball: sphere.kind, in_force, measured, source })
    });
    contradicted.collect()
}
