//! A set's results against its truth.

use firstbounce_core::image::evaluate::{lit_by_three, relative_error, rmse_without_offset};
use firstbounce_core::mesh::LengthUnit;
use firstbounce_core::methods::by_shape::ByShapeStep;
use firstbounce_core::separate::Separation;
use firstbounce_core::stereo::depth::{Depth, integrate};
use firstbounce_core::stereo::shape::Shape;
use firstbounce_core::{AngularError, Camera, Mask, NormalMap, Plane};
use indexmap::IndexMap;
use serde::Serialize;

use super::reconstruct::white_light_for;
use super::truth::{true_normals, true_plane, true_white_light};
use super::watch::Part;
use super::{
    AlbedoScale, Direct, Input, Method, MethodReport, NayarSolved, PhotoStore, PipelineError, PipelineWatch, Scene,
    SolveOptions, Stage, calibrate_for, camera_of, load_object, raw_lights, recover,
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
    /// From the photos before separation.
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

/// Another method than the paper's against the truth.
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
    /// The order m that was separated.
    pub bounces: usize,
    /// Normal errors in degrees.
    pub normal_error_deg: NormalErrors,
    /// By name, the method that was asked for beside the paper's.
    #[serde(skip_serializing_if = "IndexMap::is_empty")]
    pub methods: IndexMap<&'static str, MethodErrors>,
    /// More of Nayar's method; absent where it was not asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nayar: Option<NayarErrors>,
    /// For each bounce, mean absolute error over mean true light, all lights together.
    pub bounce_relative_error: Vec<f64>,
    /// Root mean square depth error, the offset of each connected part of the surface removed, for normals do not tell it;
    /// absent without true depth.
    pub depth_rmse_mm: Option<f64>,
    /// The same for the photos before separation.
    pub depth_rmse_raw_mm: Option<f64>,
    /// The same for the true normals: what integration alone costs.
    pub depth_rmse_true_normals_mm: Option<f64>,
    /// Pixels compared: with a true normal, lit directly by three lights or more, solved by every method.
    pub pixels: usize,
    /// Pixels with a true normal.
    pub pixels_with_truth: usize,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Solves the set raw, separated and with its true direct light, by another method where one is asked for, and compares
/// each with the true normals and depth. A light that surfaces are recovered without is left out of all of it.
pub fn evaluate(
    set: &CaptureSet,
    options: &SolveOptions,
    watch: &dyn PipelineWatch,
) -> Result<Evaluation, PipelineError> {
    let set = &set.without_lights(&options.left_out);
    let by_colours = SolveOptions { method: Method::Colours, left_out: Vec::new(), ..options.clone() };
    let bounces = by_colours.bounces_of(set);
    let store = PhotoStore::default();
    let object = load_object(set, &store, watch)?;
    let size = object.mask.size();
    let truth = Truth::of(set, size)?;
    let calibrated = calibrate_for(set, bounces, &store, watch)?;
    drop(store);
    let scene = Scene::of(set, &object, &calibrated);
    let raw = raw_lights(&object, watch)?;
    let input = Input { scene: &scene, raw: &raw, before: None, white_light: None, options: &by_colours };
    let found = Method::Colours.direct_light(&input, watch, &mut |_| {})?;

    let shape =
        |lights: &[Direct], part: usize| recover(&scene, lights, &by_colours, &Part::of(watch, Stage::Shape, part, 3));
    let after = shape(&found.direct, 0)?;
    let before = shape(&raw.direct(), 1)?;
    let direct = truth.direct.as_ref();
    let ideal = direct.map(|direct| shape(&as_direct(direct, &found.separated.lights), 2)).transpose()?;
    let other = match options.method {
        Method::Colours => None,
        method => Some(Other::find(method, scene.clone(), &before, options, watch)?),
    };

    // One set of pixels for every method: none may win by leaving out what is hard.
    let with_truth = mask_where(&object.mask, |pixel| truth.normals.at_index(pixel).is_some());
    let lit = direct.and_then(|direct| lit_by_three(direct, &with_truth)).unwrap_or_else(|| with_truth.clone());
    let shapes = [Some(&before), Some(&after), ideal.as_ref()].into_iter().flatten();
    let maps: Vec<_> =
        shapes.map(|shape| &shape.normals.map).chain(other.iter().flat_map(|other| &other.on_the_way)).collect();
    let compared = mask_where(&lit, |pixel| maps.iter().all(|map| map.at_index(pixel).is_some()));
    let judge = Judge { camera: scene.camera(), with_truth, compared, truth };

    let part = Part::of(watch, Stage::Shape, 2, 3);
    let depth_options = &options.shape.depth;
    let of_truth = integrate(&judge.truth.normals, &object.mask, None, &judge.camera, depth_options, &part);
    let of_other = |other: &Other| Ok::<_, PipelineError>((other.method.name(), other.errors(&judge)?));
    let warnings = object.warnings.iter().chain(&calibrated.warnings).cloned();
    Ok(Evaluation {
        bounces,
        normal_error_deg: NormalErrors {
            raw: judge.normals(&before.normals.map)?,
            separated: judge.normals(&after.normals.map)?,
            true_direct: ideal.as_ref().map(|ideal| judge.normals(&ideal.normals.map)).transpose()?,
        },
        methods: other.iter().map(of_other).collect::<Result<_, _>>()?,
        nayar: other.as_ref().map(|other| other.nayar_errors(&judge)).transpose()?.flatten(),
        bounce_relative_error: bounce_errors(set, &found.separated.lights, bounces, &judge.compared)?,
        depth_rmse_mm: judge.depth_rmse_mm(&after.depth),
        depth_rmse_raw_mm: judge.depth_rmse_mm(&before.depth),
        depth_rmse_true_normals_mm: of_truth.ok().as_ref().and_then(|depth| judge.depth_rmse_mm(depth)),
        pixels: judge.compared.count(),
        pixels_with_truth: judge.with_truth.count(),
        warnings: warnings.chain(other.iter().flat_map(Other::warnings)).collect(),
    })
}

/// What a rendered set knows of itself.
struct Truth {
    normals: NormalMap,
    /// Where the camera's scale is known.
    depth: Option<Plane>,
    /// By light.
    direct: Option<Vec<Plane>>,
}

impl Truth {
    fn of(set: &CaptureSet, size: (usize, usize)) -> Result<Self, PipelineError> {
        let path = set.truth_depth();
        let known = camera_of(set, size).unit() == LengthUnit::Millimetre && path.is_file();
        Ok(Self {
            normals: true_normals(&set.truth_normals(), size)?,
            depth: known.then(|| true_plane(&path, size)).transpose()?,
            direct: true_bounces(set, 1, size)?,
        })
    }
}

/// Compares with the truth, over the same pixels whatever the method.
struct Judge {
    camera: Camera,
    with_truth: Mask,
    compared: Mask,
    truth: Truth,
}

impl Judge {
    fn normals(&self, found: &NormalMap) -> Result<Angles, PipelineError> {
        let error = found.angular_error(&self.truth.normals, &self.compared);
        error.map(Angles::from).ok_or(PipelineError::NothingToCompare)
    }

    fn depth_rmse_mm(&self, found: &Depth) -> Option<f64> {
        let both = mask_where(&self.with_truth, |pixel| found.mask.data()[pixel]);
        rmse_without_offset(&found.depth_mm, self.truth.depth.as_ref()?, &both, &found.mask)
    }
}

/// Another method than the paper's, with every shape on the way.
struct Other {
    method: Method,
    shape: Shape,
    on_the_way: Vec<NormalMap>,
    report: MethodReport,
}

impl Other {
    fn find(
        method: Method,
        scene: Scene,
        before: &Shape,
        options: &SolveOptions,
        watch: &dyn PipelineWatch,
    ) -> Result<Self, PipelineError> {
        // A rendered set knows it: what is judged here is the method, not the grey ball.
        let scale = AlbedoScale { white_light_of_truth: true_white_light(&scene.set), ..options.scale };
        let options = SolveOptions { method, scale, left_out: Vec::new(), ..options.clone() };
        let scene = method.scene_of(scene, &options);
        let white_light = white_light_for(&scene, &options, watch)?;
        let raw = raw_lights(&scene.object, watch)?;
        let (before, white_light) = (Some(before), white_light.as_ref());
        let input = Input { scene: &scene, raw: &raw, before, white_light, options: &options };
        let mut on_the_way = Vec::new();
        let found = method.direct_light(&input, watch, &mut |shape| on_the_way.push(shape.normals.map.clone()))?;
        let shape = match found.shape {
            Some(shape) => shape,
            None => recover(&scene, &found.direct, &options, &Part::of(watch, Stage::Shape, 2, 3))?,
        };
        if on_the_way.is_empty() {
            on_the_way.push(shape.normals.map.clone());
        }
        Ok(Self { method, shape, on_the_way, report: found.report })
    }

    fn errors(&self, judge: &Judge) -> Result<MethodErrors, PipelineError> {
        let result = judge.normals(&self.shape.normals.map)?;
        Ok(MethodErrors { result, depth_rmse_mm: judge.depth_rmse_mm(&self.shape.depth) })
    }

    fn nayar_errors(&self, judge: &Judge) -> Result<Option<NayarErrors>, PipelineError> {
        let MethodReport::Nayar(NayarSolved { report, white_light }) = &self.report else { return Ok(None) };
        let iteration = |(step, normals): (&ByShapeStep, &NormalMap)| {
            Ok(NayarIteration {
                error_deg: judge.normals(normals)?,
                change_deg: step.change_deg,
                mean_albedo: step.mean_albedo,
                residual: step.residual,
            })
        };
        let iterations = report.steps.iter().zip(&self.on_the_way).map(iteration);
        let MethodErrors { result, depth_rmse_mm } = self.errors(judge)?;
        Ok(Some(NayarErrors {
            result,
            iterations: iterations.collect::<Result<_, PipelineError>>()?,
            ending: report.ending.words(),
            depth_rmse_mm,
            white_light: white_light.value,
            white_light_source: white_light.source.words().to_owned(),
        }))
    }

    fn warnings(&self) -> Vec<String> {
        self.report.warnings(self.shape.report.normals.solved_pixels)
    }
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
