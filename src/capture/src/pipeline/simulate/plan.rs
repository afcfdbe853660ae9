//! The planner for a rig that could be simulated.

use firstbounce_core::Watch;
use firstbounce_core::lab::{Plan, PlanOptions, plan};

use super::{Exposure, LampOptions, SimulateError, SimulateOptions, prepare};

/// What to plan for, and how finely.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanGrid {
    /// The order m; `None` for the one that a set with these colours would be separated with.
    pub bounces: Option<usize>,
    /// Numbers of frames to look at.
    pub frames: Vec<usize>,
    /// Ratios of the last albedo to the first to look at.
    pub ratios: Vec<f64>,
    /// Side of the picture that is rendered for it.
    pub size_px: usize,
    /// Patches of the surface for it.
    pub patches: usize,
}

impl Default for PlanGrid {
    fn default() -> Self {
        let PlanOptions { frames, ratios, .. } = PlanOptions::default();
        Self { bounces: None, frames, ratios, size_px: 64, patches: 500 }
    }
}

/// Plans for the rig of `options` on a picture as small as `grid` says. The size of the real pictures does not matter: what
/// errs is each pixel.
///
/// # Errors
/// As [`super::simulate`].
pub fn plan_rig(options: &SimulateOptions, grid: &PlanGrid, watch: &dyn Watch) -> Result<Plan, SimulateError> {
    let small =
        SimulateOptions { size_px: grid.size_px, patches: grid.patches.min(options.patches), ..options.clone() };
    small.check()?;
    let part = |from, to| firstbounce_core::Portion { watch, from, to };
    let prepared = prepare(&small, &part(0.0, 0.3))?;
    let plan_options = PlanOptions {
        albedos: options.albedos.clone(),
        lamps: options.lamps.iter().map(LampOptions::lamp).collect(),
        alpha: options.alpha(),
        bounces: grid.bounces.unwrap_or(options.albedos.len().min(2)),
        sensor: options.sensor,
        // A fixed exposure is that of one paint: another would be exposed anew.
        brightest: match options.exposure {
            Exposure::Brightest(light) => light,
            Exposure::White(_) => PlanOptions::default().brightest,
        },
        frames: grid.frames.clone(),
        ratios: grid.ratios.clone(),
        ..PlanOptions::default()
    };
    Ok(plan(&prepared.factors, &prepared.camera, &plan_options, &part(0.3, 1.0))?)
}
