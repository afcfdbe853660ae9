//! A set's results against its truth.

mod judge;
mod oracle;
mod record;

use firstbounce_core::NormalMap;
use firstbounce_core::image::evaluate::lit_by_three;
use firstbounce_core::methods::by_shape::ByShapeStep;
use firstbounce_core::methods::colours_and_shape::ColoursAndShapeOptions;
use firstbounce_core::stereo::depth::integrate;
use firstbounce_core::stereo::shape::{Shape, ShapeOptions};

use super::reconstruct::white_light_for;
use super::truth::true_white_light;
use super::watch::Part;
use super::{
    AlbedoScale, Direct, Found, Input, MethodReport, PhotoStore, PipelineError, PipelineWatch, Scene, SolveOptions,
    Stage, calibrate_for, load_object, raw_lights, recover,
};
use crate::set::{CaptureSet, Method};
use judge::{Judge, Truth, mask_where};

pub use record::{Angles, Evaluation, MethodErrors, NayarErrors, NayarIteration, NormalErrors};

/// Surfaces that an evaluation recovers, for its progress.
const SURFACES: usize = 6;

/// Solves the set before separation, by the method in force and with its true direct light, and compares each with the true
/// normals and depth. A light that surfaces are recovered without is left out of all of it.
pub fn evaluate(
    set: &CaptureSet,
    options: &SolveOptions,
    watch: &dyn PipelineWatch,
) -> Result<Evaluation, PipelineError> {
    // A rendered set knows it: what is judged here is the method, not the grey ball.
    let scale = AlbedoScale { white_light_of_truth: true_white_light(set), ..options.scale };
    let set = &options.method.set_of(&set.without_lights(&options.left_out));
    let options = &SolveOptions { left_out: Vec::new(), scale, ..options.clone() };
    let store = PhotoStore::default();
    let object = load_object(set, &store, watch)?;
    let truth = Truth::of(set, object.mask.size())?;
    let calibrated = calibrate_for(set, &object, options, &store, watch)?;
    drop(store);
    let scene = options.method.scene_of(Scene::of(set, &object, &calibrated), options);

    let recovered = std::cell::Cell::new(0);
    let shape = |lights: &[Direct], options: &ShapeOptions| {
        let part = Part::of(watch, Stage::Shape, recovered.replace(recovered.get() + 1), SURFACES);
        recover(&scene, lights, &[], options, &part)
    };
    let raw = raw_lights(&object, watch)?;
    let before = shape(&raw.direct(), &options.shape)?;
    let white_light = white_light_for(&scene, options, watch)?;
    let input =
        Input { scene: &scene, raw: Some(&raw), before: Some(&before), white_light: white_light.as_ref(), options };
    let mut on_the_way = Vec::new();
    let keep = &mut |shape: &Shape| {
        if options.method == Method::Shape {
            on_the_way.push(shape.normals.map.clone());
        }
    };
    let Found { separated, direct, shape: found, report, .. } = options.method.direct_light(&input, watch, keep)?;
    let after = found.map_or_else(|| shape(&direct, &options.shape_after()), Ok)?;
    let global = global_ratio(&input, watch)?.map(|lights| shape(&lights, &options.shape)).transpose()?;
    let lights = truth.direct.as_ref();
    let ideal = lights.map(|lights| shape(&oracle::true_direct(lights, &separated.lights), &options.shape));
    let noisy = lights.map(|lights| oracle::noisy_direct(&scene, lights, &separated.lights)).transpose()?;
    let oracle = noisy.map(|lights| shape(&lights, &options.shape_after())).transpose()?;
    let ideal = ideal.transpose()?;

    // One set of pixels for every way: none may win by leaving out what is hard.
    let with_truth = mask_where(&object.mask, |pixel| truth.normals.at_index(pixel).is_some());
    let lit = lights.and_then(|lights| lit_by_three(lights, &with_truth)).unwrap_or_else(|| with_truth.clone());
    let shapes = [Some(&before), Some(&after), global.as_ref(), ideal.as_ref(), oracle.as_ref()];
    let maps: Vec<_> = shapes.into_iter().flatten().map(|shape| &shape.normals.map).chain(&on_the_way).collect();
    let compared = mask_where(&lit, |pixel| maps.iter().all(|map| map.at_index(pixel).is_some()));
    let judge = Judge { camera: scene.camera(), with_truth, compared, truth };

    let part = Part::of(watch, Stage::Shape, SURFACES - 1, SURFACES);
    let of_truth = integrate(&judge.truth.normals, &object.mask, None, &judge.camera, &options.shape.depth, &part);
    let angles = |shape: &Option<Shape>| shape.as_ref().map(|shape| judge.normals(&shape.normals.map)).transpose();
    let separated_error = judge.normals(&after.normals.map)?;
    let depth_rmse_mm = judge.depth_rmse_mm(&after.depth);
    let errors = MethodErrors { result: separated_error, depth_rmse_mm };
    let warnings = object.warnings.iter().chain(&calibrated.warnings).cloned();
    Ok(Evaluation {
        method: options.method.name(),
        bounces: separated.reports.first().map_or(1, |report| report.bounces),
        normal_error_deg: NormalErrors {
            raw: judge.normals(&before.normals.map)?,
            separated: separated_error,
            global_ratio: angles(&global)?,
            true_direct: angles(&ideal)?,
            oracle: angles(&oracle)?,
        },
        methods: [(options.method.name(), errors)].into_iter().collect(),
        nayar: nayar_errors(&report, errors, &on_the_way, &judge)?,
        bounce_relative_error: judge.bounce_errors(set, &separated.lights)?,
        depth_rmse_mm,
        depth_rmse_raw_mm: judge.depth_rmse_mm(&before.depth),
        depth_rmse_true_normals_mm: of_truth.ok().as_ref().and_then(|depth| judge.depth_rmse_mm(depth)),
        predicted_noise_deg: judge.mean(&after.normals.noise_deg),
        pixels: judge.compared.count(),
        pixels_with_truth: judge.with_truth.count(),
        warnings: warnings.chain(report.warnings(after.report.normals.solved_pixels)).collect(),
    })
}

/// Direct light by one colour ratio of indirect light for each light; `None` for one colour.
fn global_ratio(input: &Input, watch: &dyn PipelineWatch) -> Result<Option<Vec<Direct>>, PipelineError> {
    if input.scene.set.colours.len() < 2 || input.scene.calibrated.beta.is_none() {
        return Ok(None);
    }
    let colours_and_shape = ColoursAndShapeOptions { rounds: 0, ..input.options.colours_and_shape };
    let options = SolveOptions { method: Method::ColoursAndShape, colours_and_shape, ..input.options.clone() };
    let found = Method::ColoursAndShape.direct_light(&Input { options: &options, ..*input }, watch, &mut |_| {})?;
    Ok(Some(found.direct))
}

fn nayar_errors(
    report: &MethodReport,
    errors: MethodErrors,
    on_the_way: &[NormalMap],
    judge: &Judge,
) -> Result<Option<NayarErrors>, PipelineError> {
    let Some(nayar) = report.nayar() else { return Ok(None) };
    let iteration = |(step, normals): (&ByShapeStep, &NormalMap)| {
        Ok(NayarIteration {
            error_deg: judge.normals(normals)?,
            change_deg: step.change_deg,
            mean_albedo: step.mean_albedo,
            residual: step.residual,
        })
    };
    let iterations = nayar.report.steps.iter().zip(on_the_way).map(iteration);
    Ok(Some(NayarErrors {
        result: errors.result,
        iterations: iterations.collect::<Result<_, PipelineError>>()?,
        ending: nayar.report.ending.words(),
        depth_rmse_mm: errors.depth_rmse_mm,
        white_light: nayar.white_light.value,
        white_light_source: nayar.white_light.source.words().to_owned(),
    }))
}
