//! What a person chooses in the window beyond capture.toml.

use std::ops::RangeInclusive;

use firstbounce_capture::pipeline::{OutputOptions, SolveOptions};
use firstbounce_core::indirect::IndirectOptions;
use firstbounce_core::nayar::NayarOptions;
use firstbounce_core::normals::NormalsOptions;
use firstbounce_core::shape::ShapeOptions;
use serde::{Deserialize, Serialize};

use super::reference::{Poses, ReferenceSettings};

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

impl Settings {
    /// The same with every number within its range: files beside a set may say anything.
    pub fn within_ranges(mut self) -> Self {
        let ShapeSettings { shadow_fraction, outlier_fraction, rounds, indirect_radius_px, .. } = &mut self.shape;
        for share in [shadow_fraction, outlier_fraction] {
            *share = clamped(*share, &ShapeSettings::SHARES);
        }
        *rounds = clamped(*rounds, &ShapeSettings::ROUNDS);
        *indirect_radius_px = clamped(*indirect_radius_px, &ShapeSettings::RADII_PX);
        self.nayar.patches = clamped(self.nayar.patches, &NayarSettings::PATCHES);
        self.nayar.max_iterations = clamped(self.nayar.max_iterations, &NayarSettings::ITERATIONS);
        if let Some(reference) = &mut self.reference {
            reference.poses = reference.poses.filter(Poses::is_usable);
        }
        self
    }
}

/// JSON has no word for what is no number, so a comparison always has an answer.
fn clamped<T: PartialOrd + Copy>(value: T, range: &RangeInclusive<T>) -> T {
    match value {
        low if low < *range.start() => *range.start(),
        high if high > *range.end() => *range.end(),
        within => within,
    }
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
        let NayarOptions { patches, max_iterations, .. } = NayarOptions::default();
        Self { compute: false, patches, max_iterations }
    }
}

impl NayarSettings {
    /// What `patches` may be.
    pub const PATCHES: RangeInclusive<usize> = 16..=20_000;
    /// What `max_iterations` may be.
    pub const ITERATIONS: RangeInclusive<usize> = 1..=100;

    /// As the pipeline takes them.
    pub fn options(&self) -> NayarOptions {
        NayarOptions { patches: self.patches, max_iterations: self.max_iterations, ..NayarOptions::default() }
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
        let indirect_radius_px = IndirectOptions::default().radius_px;
        Self { left_out: Vec::new(), shadow_fraction, outlier_fraction, rounds, indirect_radius_px }
    }
}

impl ShapeSettings {
    /// What `shadow_fraction` and `outlier_fraction` may be.
    pub const SHARES: RangeInclusive<f64> = 0.0..=0.99;
    /// What `rounds` may be.
    pub const ROUNDS: RangeInclusive<usize> = 1..=10;
    /// What `indirect_radius_px` may be.
    pub const RADII_PX: RangeInclusive<usize> = 0..=64;

    /// As the pipeline takes them.
    pub fn options(&self) -> SolveOptions {
        let normals = NormalsOptions { shadow_fraction: self.shadow_fraction, outlier_fraction: self.outlier_fraction };
        SolveOptions {
            indirect: IndirectOptions { radius_px: self.indirect_radius_px, ..IndirectOptions::default() },
            shape: ShapeOptions { normals, rounds: self.rounds, ..ShapeOptions::default() },
            ..SolveOptions::default()
        }
    }
}
