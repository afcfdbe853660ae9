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
    pub iterations: Vec<ByShapeStep>,
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
            iterations: report.steps.clone(),
        }
    }
}
