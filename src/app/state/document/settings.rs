//! The window's settings beyond capture.toml.

use firstbounce_capture::pipeline::{OutputOptions, SolveOptions};
use firstbounce_core::denoise::DenoiseOptions;
use firstbounce_core::methods::by_shape::ByShapeOptions;
use firstbounce_core::stereo::normals::NormalsOptions;
use firstbounce_core::stereo::shape::ShapeOptions;
use serde::{Deserialize, Serialize};

use super::reference::ReferenceSettings;

/// How the window solves a set.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Settings {
    /// From bounce 1 to the surface.
    pub shape: ShapeSettings,
    /// The other method, for comparison.
    pub nayar: NayarSettings,
    /// What to write, and by which conventions.
    pub export: OutputOptions,
    /// The scan that the surface is compared with.
    pub reference: Option<Box<ReferenceSettings>>,
}

/// Whether and how the set is also solved by Nayar's method; the numbers' defaults are those of the command line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct NayarSettings {
    /// Whether it is: it takes seconds, or minutes with many patches.
    pub compute: bool,
    /// About how many patches exchange light.
    pub patches: usize,
    /// Iterations after which to stop.
    pub max_iterations: usize,
}

impl Default for NayarSettings {
    fn default() -> Self {
        let ByShapeOptions { patches, max_iterations, .. } = ByShapeOptions::default();
        Self { compute: false, patches, max_iterations }
    }
}

impl NayarSettings {
    /// As the pipeline takes them.
    pub fn options(&self) -> ByShapeOptions {
        ByShapeOptions { patches: self.patches, max_iterations: self.max_iterations, ..ByShapeOptions::default() }
    }
}

/// How the surface is recovered; the defaults are those of the command line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ShapeSettings {
    /// Names of lights that photometric stereo does without.
    pub left_out: Vec<String>,
    /// A light is in shadow below this share of the brightest light's.
    pub shadow_fraction: f64,
    /// With five or more lights, one that misses the fit by more than this share is left out.
    pub outlier_fraction: f64,
    /// How often near lamps are placed anew over the depth.
    pub rounds: usize,
    /// Half width of the window in which the noise of indirect light is averaged; 0 for none.
    pub indirect_radius_px: usize,
}

impl Default for ShapeSettings {
    fn default() -> Self {
        let ShapeOptions { normals: NormalsOptions { shadow_fraction, outlier_fraction }, rounds, .. } =
            ShapeOptions::default();
        let indirect_radius_px = DenoiseOptions::default().radius_px;
        Self { left_out: Vec::new(), shadow_fraction, outlier_fraction, rounds, indirect_radius_px }
    }
}

impl ShapeSettings {
    /// As the pipeline takes them.
    pub fn options(&self) -> SolveOptions {
        let normals = NormalsOptions { shadow_fraction: self.shadow_fraction, outlier_fraction: self.outlier_fraction };
        SolveOptions {
            denoise: DenoiseOptions { radius_px: self.indirect_radius_px, ..DenoiseOptions::default() },
            shape: ShapeOptions { normals, rounds: self.rounds, ..ShapeOptions::default() },
            ..SolveOptions::default()
        }
    }
}
