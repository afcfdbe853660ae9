//! Nayar's method in numbers.

use firstbounce_core::methods::by_shape::ByShapeStep;
use serde::Serialize;

use crate::pipeline::NayarSolved;

/// How Nayar's method went.
#[derive(Clone, Debug, Serialize)]
pub struct NayarRecord {
    /// "converged", "out of iterations" or "diverged".
    pub ending: &'static str,
    /// The iteration whose shape is the result; 0 is the pseudo shape.
    pub chosen: usize,
    /// Linear light of a white facet that faces a lamp of intensity 1.
    pub white_light: f64,
    /// Where that comes from.
    pub white_light_source: &'static str,
    /// Patches of the last surface.
    pub patches: usize,
    /// Pixels along a patch.
    pub patch_px: usize,
    /// The pseudo shape, then the shape after each iteration.
    pub iterations: Vec<NayarStepRecord>,
}

/// One shape on the way.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct NayarStepRecord {
    /// How far the iteration turned the normals on the mean, in degrees.
    pub change_deg: f64,
    /// Mean absolute albedo.
    pub mean_albedo: f64,
    /// Pixels brighter than any paint.
    pub clamped_pixels: usize,
    /// The part of the light that was found to be indirect.
    pub indirect_fraction: f64,
    /// What the shape does not explain of the photos, relative to their light.
    pub residual: f64,
}

impl NayarRecord {
    /// Of a run.
    pub fn of(nayar: &NayarSolved) -> Self {
        let report = &nayar.report;
        Self {
            ending: report.ending.words(),
            chosen: report.chosen,
            white_light: nayar.white_light.value,
            white_light_source: nayar.white_light.source.words(),
            patches: report.patches,
            patch_px: report.patch_px,
            iterations: report.steps.iter().map(NayarStepRecord::of).collect(),
        }
    }
}

impl NayarStepRecord {
    fn of(step: &ByShapeStep) -> Self {
        Self {
            change_deg: step.change_deg,
            mean_albedo: step.mean_albedo,
            clamped_pixels: step.clamped_pixels,
            indirect_fraction: step.indirect_fraction,
            residual: step.residual,
        }
    }
}
