//! A set's results against its truth.

use firstbounce_core::image::evaluate::{lit_by_three, relative_error, rmse_without_offset};
use firstbounce_core::mesh::LengthUnit;
use firstbounce_core::methods::by_shape::{ByShape, ByShapeStep};
use firstbounce_core::separate::Separation;
use firstbounce_core::stereo::depth::Depth;
use firstbounce_core::stereo::shape::Shape;
use firstbounce_core::{AngularError, Mask, NormalMap, Plane};
use serde::Serialize;

use super::truth::{true_normals, true_plane, true_white_light};
use super::watch::Part;
use super::{
    Beginning, Calibrated, Direct, Known, Method, NayarSolved, ObjectPhotos, PipelineError, PipelineWatch,
    SolveOptions, Stage, calibrate_for, camera_of, denoise_lights, load_object, raw_lights, recover, separate_lights,
    simulate_away, white_light,
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

/// How far the results of a set are from its truth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Evaluation {
    /// The order m that was separated.
    pub bounces: usize,
    /// Normal errors in degrees.
    pub normal_error_deg: NormalErrors,
    /// The same for Nayar's method; absent where it was not asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nayar: Option<NayarErrors>,
    /// For each bounce, mean absolute error over mean true light, all lights together.
    pub bounce_relative_error: Vec<f64>,
    /// Root mean square depth error, the offset of each connected part of the surface removed, for normals do not tell it;
    /// absent without true depth.
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
    let quiet = denoise_lights(set, &object, &calibrated, &separated, &options.denoise, watch)?;
    let after = shape(&quiet, 0)?;
    let raw_lights = raw_lights(&object, watch)?;
    let raw = Pseudo { shape: shape(&raw_lights, 1)?, lights: raw_lights };
    let ideal = direct.as_ref().map(|direct| shape(&as_direct(direct, &separated.lights), 2)).transpose()?;
    let nayar = match options.method {
        Method::Bounces => None,
        Method::Nayar => Some(by_nayar(set, &object, &calibrated, &raw, options, watch)?),
    };

    // One set of pixels for every method: none may win by leaving out what is hard.
    let with_truth = mask_where(&object.mask, |pixel| truth.at_index(pixel).is_some());
    let lit = match &direct {
        Some(direct) => lit_by_three(direct, &with_truth).unwrap_or_else(|| with_truth.clone()),
        None => with_truth.clone(),
    };
    let iterations = nayar.iter().flat_map(|nayar| nayar.steps.iter().map(|(_, normals)| normals));
    let methods = [Some(&raw.shape), Some(&after), ideal.as_ref()].into_iter().flatten();
    let maps: Vec<_> = methods.map(|shape| &shape.normals.map).chain(iterations).collect();
    let compared = mask_where(&lit, |pixel| maps.iter().all(|map| map.at_index(pixel).is_some()));
    let error_of = |normals: &NormalMap| {
        normals.angular_error(&truth, &compared).map(Angles::from).ok_or(PipelineError::NothingToCompare)
    };
    let error = |shape: &Shape| error_of(&shape.normals.map);
    let normal_error_deg = NormalErrors {
        raw: error(&raw.shape)?,
        separated: error(&after)?,
        true_direct: ideal.as_ref().map(error).transpose()?,
    };

    let depth_path = set.truth_depth();
    let in_mm = camera.unit() == LengthUnit::Millimetre;
    let depth = if in_mm && depth_path.is_file() { Some(true_plane(&depth_path, size)?) } else { None };
    let rmse = |found: &Depth| {
        let both = mask_where(&with_truth, |pixel| found.mask.data()[pixel]);
        depth.as_ref().and_then(|truth| rmse_without_offset(&found.depth_mm, truth, &both, &found.mask))
    };
    let part = Part::of(watch, Stage::Shape, 2, 3);
    let of_truth =
        firstbounce_core::stereo::depth::integrate(&truth, &object.mask, None, &camera, &options.shape.depth, &part);
    Ok(Evaluation {
        bounces,
        normal_error_deg,
        nayar: nayar.as_ref().map(|nayar| nayar.errors(&error_of, &rmse)).transpose()?,
        bounce_relative_error: bounce_errors(set, &separated.lights, bounces, &compared)?,
        depth_rmse_mm: rmse(&after.depth),
        depth_rmse_raw_mm: rmse(&raw.shape.depth),
        depth_rmse_true_normals_mm: of_truth.ok().as_ref().and_then(rmse),
        pixels: compared.count(),
        pixels_with_truth: with_truth.count(),
        warnings: object
            .warnings
            .iter()
            .chain(&calibrated.warnings)
            .cloned()
            .chain(nayar.iter().flat_map(ByNayar::warnings))
            .collect(),
    })
}

/// The photos as they are, and the surface they show.
struct Pseudo {
    lights: Vec<Direct>,
    shape: Shape,
}

/// Nayar's method with every shape on the way.
struct ByNayar {
    steps: Vec<(ByShapeStep, NormalMap)>,
    found: ByShape,
    white_light: Known<f64>,
    white_light_source: String,
}

impl ByNayar {
    fn errors(
        &self,
        error_of: &dyn Fn(&NormalMap) -> Result<Angles, PipelineError>,
        rmse: &dyn Fn(&Depth) -> Option<f64>,
    ) -> Result<NayarErrors, PipelineError> {
        let iteration = |(step, normals): &(ByShapeStep, NormalMap)| {
            Ok(NayarIteration {
                error_deg: error_of(normals)?,
                change_deg: step.change_deg,
                mean_albedo: step.mean_albedo,
                residual: step.residual,
            })
        };
        Ok(NayarErrors {
            result: error_of(&self.found.shape.normals.map)?,
            iterations: self.steps.iter().map(iteration).collect::<Result<_, PipelineError>>()?,
            ending: self.found.report.ending.words(),
            depth_rmse_mm: rmse(&self.found.shape.depth),
            white_light: self.white_light.value,
            white_light_source: self.white_light_source.clone(),
        })
    }

    fn warnings(&self) -> Vec<String> {
        let solved = NayarSolved { report: self.found.report.clone(), white_light: self.white_light.clone() };
        solved.warnings(self.found.shape.report.normals.solved_pixels)
    }
}

fn by_nayar(
    set: &CaptureSet,
    object: &ObjectPhotos,
    calibrated: &Calibrated,
    pseudo: &Pseudo,
    options: &SolveOptions,
    watch: &dyn PipelineWatch,
) -> Result<ByNayar, PipelineError> {
    let (white_light, white_light_source) = match white_light(set, calibrated, &options.scale, watch) {
        Ok(known) => (known.clone(), known.source.words().to_owned()),
        // A rendered set knows it: what is judged here is the method, not the grey ball.
        Err(error @ (PipelineError::NoGreyAlbedo | PipelineError::NoWhiteLight)) => {
            let value = true_white_light(set).ok_or(error)?;
            (Known::from_file(value), "the set's truth".to_owned())
        }
        Err(error) => return Err(error),
    };
    let camera = camera_of(set, object.mask.size());
    let beginning = Beginning {
        raw: &pseudo.lights,
        pseudo_shape: &pseudo.shape,
        mask: &object.mask,
        camera: &camera,
        white_light: white_light.value,
    };
    let mut steps = Vec::new();
    let part = Part::of(watch, Stage::Nayar, 0, 1);
    let mut on_step = |step: &ByShapeStep, shape: &Shape| steps.push((*step, shape.normals.map.clone()));
    let found = simulate_away(set, calibrated, &beginning, &options.nayar, &options.shape, &part, &mut on_step)?;
    Ok(ByNayar { steps, found, white_light, white_light_source })
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
