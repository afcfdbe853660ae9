//! A set's results against its truth.

use firstbounce_core::evaluate::{lit_by_three, relative_error, rmse_without_offset};
use firstbounce_core::separate::Separation;
use firstbounce_core::{AngularError, Mask, Plane};
use serde::Serialize;

use super::truth::{true_normals, true_plane};
use super::watch::Part;
use super::{
    Direct, PipelineError, PipelineWatch, SolveOptions, Stage, calibrate_for, camera_of, load_object, quiet_lights,
    raw_lights, recover, separate_lights,
};
use crate::set::CaptureSet;

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

/// Normal errors of three ways to the normals, over the same pixels.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct NormalErrors {
    /// From the photos as they are.
    pub raw: Angles,
    /// From bounce 1 as separated.
    pub separated: Angles,
    /// From the true direct light, through the same calibration: what remains is not separation's fault.
    pub true_direct: Option<Angles>,
}

/// How far the results of a set are from its truth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Evaluation {
    /// The order m that was separated.
    pub bounces: usize,
    /// Normal errors in degrees.
    pub normal_error_deg: NormalErrors,
    /// For each bounce, mean absolute error over mean true light, all lights together.
    pub bounce_relative_error: Vec<f64>,
    /// Root mean square depth error, offset removed; absent without true depth.
    pub depth_rmse_mm: Option<f64>,
    /// The same for the photos as they are.
    pub depth_rmse_raw_mm: Option<f64>,
    /// The same for the true normals: what integration alone costs.
    pub depth_rmse_true_normals_mm: Option<f64>,
    /// Pixels compared: with a true normal, lit directly by three lights or more, solved by every method.
    pub pixels: usize,
    /// Pixels with a true normal.
    pub pixels_with_truth: usize,
    /// What a person should know.
    pub warnings: Vec<String>,
}

/// Solves the set raw, separated and with its true direct light, and compares each with the true normals and depth.
pub fn evaluate(
    set: &CaptureSet,
    options: &SolveOptions,
    watch: &dyn PipelineWatch,
) -> Result<Evaluation, PipelineError> {
    let bounces = options.bounces.unwrap_or_else(|| set.bounces());
    let object = load_object(set, watch)?;
    let size = object.mask.size();
    let truth = true_normals(&set.truth_normals(), size)?;
    let calibrated = calibrate_for(set, bounces, watch)?;
    let separated = separate_lights(set, &object, &calibrated, bounces, watch)?;
    let direct = true_bounces(set, 1, size)?;

    let camera = camera_of(set, size);
    let shape = |lights: &[Direct], part: usize| {
        recover(set, &object, &calibrated, lights, &camera, &options.shape, &Part::of(watch, Stage::Shape, part, 3))
    };
    let quiet = quiet_lights(set, &object, &calibrated, &separated, &options.indirect, watch)?;
    let after = shape(&quiet, 0)?;
    let raw = shape(&raw_lights(&object, watch)?, 1)?;
    let ideal = direct.as_ref().map(|direct| shape(&as_direct(direct, &separated.lights), 2)).transpose()?;

    // One set of pixels for every method: none may win by leaving out what is hard.
    let with_truth = mask_where(&object.mask, |pixel| truth.at_index(pixel).is_some());
    let lit = match &direct {
        Some(direct) => lit_by_three(direct, &with_truth).unwrap_or_else(|| with_truth.clone()),
        None => with_truth.clone(),
    };
    let methods = [Some(&raw), Some(&after), ideal.as_ref()];
    let compared =
        mask_where(&lit, |pixel| methods.iter().flatten().all(|shape| shape.normals.map.at_index(pixel).is_some()));
    let error = |shape: &firstbounce_core::shape::Shape| {
        let error = shape.normals.map.angular_error(&truth, &compared);
        error.map(Angles::from).ok_or(PipelineError::NothingToCompare)
    };
    let normal_error_deg = NormalErrors {
        raw: error(&raw)?,
        separated: error(&after)?,
        true_direct: ideal.as_ref().map(error).transpose()?,
    };

    let depth_path = set.truth_depth();
    let depth = if depth_path.is_file() { Some(true_plane(&depth_path, size)?) } else { None };
    let rmse = |found: &firstbounce_core::depth::Depth| {
        let both = mask_where(&with_truth, |pixel| found.mask.data()[pixel]);
        depth.as_ref().and_then(|truth| rmse_without_offset(&found.depth_mm, truth, &both))
    };
    let part = Part::of(watch, Stage::Shape, 2, 3);
    let of_truth = firstbounce_core::depth::integrate(&truth, &object.mask, None, &camera, &options.shape.depth, &part);
    Ok(Evaluation {
        bounces,
        normal_error_deg,
        bounce_relative_error: bounce_errors(set, &separated.lights, bounces, &compared)?,
        depth_rmse_mm: rmse(&after.depth),
        depth_rmse_raw_mm: rmse(&raw.depth),
        depth_rmse_true_normals_mm: of_truth.ok().as_ref().and_then(rmse),
        pixels: compared.count(),
        pixels_with_truth: with_truth.count(),
        warnings: object.warnings.into_iter().chain(calibrated.warnings).collect(),
    })
}

/// For each bounce that has a truth, the mean over the lights of its relative error.
fn bounce_errors(
    set: &CaptureSet,
    lights: &[Separation],
    bounces: usize,
    compared: &Mask,
) -> Result<Vec<f64>, PipelineError> {
    let mut errors = Vec::new();
    for k in 1..=bounces {
        let Some(truth) = true_bounces(set, k, compared.size())? else { break };
        let found = lights.iter().map(|light| &light.bounces[k - 1]);
        let each: Vec<_> = found.zip(&truth).filter_map(|(f, t)| relative_error(f, t, compared)).collect();
        if each.is_empty() {
            break;
        }
        errors.push(each.iter().sum::<f64>() / each.len() as f64);
    }
    Ok(errors)
}

/// The true light of a bounce under every light; `None` where a light has no such file.
fn true_bounces(set: &CaptureSet, k: usize, size: (usize, usize)) -> Result<Option<Vec<Plane>>, PipelineError> {
    let paths: Vec<_> = set.lights.iter().map(|light| set.truth_bounce(k, &light.name)).collect();
    if !paths.iter().all(|path| path.is_file()) {
        return Ok(None);
    }
    paths.iter().map(|path| true_plane(path, size)).collect::<Result<_, _>>().map(Some)
}

/// True direct light where the separation solved its pixels.
fn as_direct(truth: &[Plane], like: &[Separation]) -> Vec<Direct> {
    let direct = |(light, like): (&Plane, &Separation)| Direct {
        light: light.clone(),
        noise: None,
        marks: like.marks.clone(),
        report: None,
    };
    truth.iter().zip(like).map(direct).collect()
}

/// The pixels of `mask` for which `keep` holds.
fn mask_where(mask: &Mask, keep: impl Fn(usize) -> bool) -> Mask {
    let data = mask.data().iter().enumerate().map(|(pixel, &inside)| inside && keep(pixel)).collect();
    Mask::from_vec(mask.width(), mask.height(), data).unwrap_or_else(|| mask.clone())
}
