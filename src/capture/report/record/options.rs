//! The options in force, by the words of the capture file and of the command line.

use serde::Serialize;

use crate::pipeline::{Method, SolveOptions};
use crate::set::ShapeSettings;

/// How a set was solved.
#[derive(Clone, Debug, Serialize)]
pub struct OptionsRecord {
    /// The name of the method.
    pub method: Method,
    /// The order m.
    pub bounces: usize,
    /// `[shape]`
    pub shape: ShapeSettings,
    /// With Nayar's method: about how many patches exchange light.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub patches: Option<usize>,
    /// With Nayar's method: iterations after which it stops.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_iterations: Option<usize>,
}

impl OptionsRecord {
    /// Of a run that separated this many bounces.
    pub fn of(options: &SolveOptions, bounces: usize) -> Self {
        let nayar = (options.method == Method::Shape).then_some(options.nayar);
        Self {
            method: options.method,
            bounces,
            shape: ShapeSettings {
                leave_out: options.left_out.clone(),
                shadow_share: options.shape.normals.shadow_fraction,
                misfit_share: options.shape.normals.outlier_fraction,
                rounds: options.shape.rounds,
                indirect_window_px: options.denoise.radius_px,
                paint: options.paint,
            },
            patches: nayar.map(|nayar| nayar.patches),
            max_iterations: nayar.map(|nayar| nayar.max_iterations),
        }
    }
}
