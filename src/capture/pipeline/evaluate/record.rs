//! How far results are from the truth, as `evaluate --json` prints it.

use firstbounce_core::AngularError;
use indexmap::IndexMap;
use serde::Serialize;

/// Angles between found and true normals in degrees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Angles {
    /// Mean over the compared pixels.
    pub mean: f64,
    /// Median over the compared pixels.
    pub median: f64,
}

impl From<AngularError> for Angles {
    fn from(error: AngularError) -> Self {
        Self { mean: error.mean_deg, median: error.median_deg }
    }
}

/// Normal errors of several ways to the normals, over the same pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NormalErrors {
    /// From the photos before separation.
    pub raw: Angles,
    /// By the method in force.
    pub separated: Angles,
    /// With one colour ratio of indirect light for each light; absent for one colour.
    pub global_ratio: Option<Angles>,
    /// From the true direct light, through the same calibration: what remains is not separation's fault.
    pub true_direct: Option<Angles>,
    /// From the true direct light with the noise of the photos, all colours averaged by weight, by the photometric stereo in
    /// force: what no method can undercut.
    pub oracle: Option<Angles>,
}

/// Nayar's method against the truth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct NayarErrors {
    /// Normal errors of its result, in degrees.
    pub result: Angles,
    /// The pseudo shape, then the shape after each iteration.
    pub iterations: Vec<NayarIteration>,
    /// "converged", "out of iterations" or "diverged".
    pub ending: &'static str,
    /// Root mean square depth error, the offset of each island removed; absent without true depth.
    pub depth_rmse_mm: Option<f64>,
    /// Linear light of a white facet that faces a lamp of intensity 1.
    pub white_light: f64,
    /// Where that comes from.
    pub white_light_source: String,
}

/// One shape of Nayar's method against the truth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NayarIteration {
    /// Normal error in degrees.
    pub error_deg: Angles,
    /// How far the iteration turned the normals on the mean, in degrees.
    pub change_deg: f64,
    /// Mean absolute albedo.
    pub mean_albedo: f64,
    /// What the shape does not explain of the photos, relative to their light.
    pub residual: f64,
}

/// A method against the truth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MethodErrors {
    /// Normal errors of its result, in degrees.
    pub result: Angles,
    /// Root mean square depth error, the offset of each island removed; absent without true depth.
    pub depth_rmse_mm: Option<f64>,
}

/// How far the results of a set are from its truth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Evaluation {
    /// The name of the method in force.
    pub method: &'static str,
    /// The order m that was separated.
    pub bounces: usize,
    /// Normal errors in degrees.
    pub normal_error_deg: NormalErrors,
    /// The method in force, by its name.
    pub methods: IndexMap<&'static str, MethodErrors>,
    /// More of Nayar's method; absent where it was not asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nayar: Option<NayarErrors>,
    /// Mean absolute error over mean true light, all lights together: of direct light and, of a method that keeps bounces
    /// apart, of each further bounce.
    pub bounce_relative_error: Vec<f64>,
    /// Root mean square depth error, the offset of each connected part of the surface removed, for normals do not tell it;
    /// absent without true depth.
    pub depth_rmse_mm: Option<f64>,
    /// The same for the photos before separation.
    pub depth_rmse_raw_mm: Option<f64>,
    /// The same for the true normals: what integration alone costs.
    pub depth_rmse_true_normals_mm: Option<f64>,
    /// Predicted noise of the normals by the method in force: the mean over the compared pixels, in degrees.
    pub predicted_noise_deg: f64,
    /// Pixels compared: with a true normal, lit directly by three lights or more, solved in every way that is compared.
    pub pixels: usize,
    /// Pixels with a true normal.
    pub pixels_with_truth: usize,
    /// What the user should know.
    pub warnings: Vec<String>,
}
