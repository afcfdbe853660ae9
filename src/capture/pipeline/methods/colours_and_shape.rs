//! Colours and shape together: the colours tell direct from indirect light, the shape says what the indirect light is made of.

use firstbounce_core::methods::colours_and_shape::{
    ColoursAndShapeError, ColoursAndShapeReport, IndirectMaps, LightReport, NoShape, Photographed, SeparatedLight,
    beta_of_object, separate_by_colours_and_shape,
};
use firstbounce_core::separate::{LightPhotos, SeparateReport, Separation};
use firstbounce_core::stereo::normals::{NormalsError, Paint};
use firstbounce_core::stereo::shape::ShapeError;

use super::super::calibrate::Source;
use super::super::watch::Part;
use super::super::{
    Calibrated, Direct, Known, ObjectPhotos, PipelineError, PipelineWatch, Scene, Separated, SolveOptions, Stage,
};
use super::shape::white_light_if_known;
use super::{Found, Input, MethodReport, Needs, OnShape, Row};
use crate::set::{CaptureSet, Method};

pub(super) const ROW: Row = Row {
    title: "colours and shape",
    purpose: "Photos in several colours tell direct from indirect light, and the shape says what the indirect light is made of",
    needs: Needs { all_colours: true, absolute_albedo: false, surface_before: false },
    compares_albedo: true,
    one_paint: true,
    stage: Stage::Separate,
    direct_light,
};

/// What the method reports of itself.
#[derive(Clone, Debug, PartialEq)]
pub struct ColoursAndShapeSolved {
    /// How it went.
    pub report: ColoursAndShapeReport,
    /// By light, how the indirect light was found.
    pub maps: Vec<IndirectMaps>,
    /// Linear light of a white facet that faces a lamp of intensity 1, where it is known.
    pub white_light: Option<Known<f64>>,
    /// Names of the colours, the reference first.
    pub colours: Vec<String>,
}

impl ColoursAndShapeSolved {
    /// What the user should know before trusting the surface.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        if let Some(error) = &self.report.no_shape {
            let why = match error {
                NoShape::Shape(ShapeError::Normals(NormalsError::TooFewLights { .. })) => {
                    "normals need three lights with a known direction".to_owned()
                }
                error => error.to_string(),
            };
            warnings.push(format!("the shape was not used ({why}): each light has one colour ratio of indirect light"));
        }
        if let Some(amount) = self.report.amount.filter(|amount| amount.has_other_paint()) {
            warnings.push(format!(
                "the colours of {:.0} % of the object do not fit beta: another paint is there; of it the reference colour alone was used",
                100.0 * amount.other_paint_share
            ));
        }
        let findings = self.report.closure.iter().flat_map(|closure| &closure.findings);
        warnings.extend(findings.filter(|finding| finding.is_doubt()).map(|finding| finding.words(&self.colours)));
        warnings
    }
}

fn direct_light(input: &Input, watch: &dyn PipelineWatch, on_shape: &mut OnShape) -> Result<Found, PipelineError> {
    let Input { scene, options, .. } = input;
    let beta = scene.calibrated.beta_values()?;
    let (method, shape) = (&options.colours_and_shape, &options.shape_after());
    let part = Part::of(watch, Stage::Separate, 0, 1);
    let white_light = input.white_light.map(|white| white.value);
    let (found, reports) = with_photographed(scene, &beta, &options.left_out, white_light, |photographed| {
        let found = separate_by_colours_and_shape(photographed, method, shape, &part, on_shape).map_err(failed)?;
        let reports = found.report.lights.iter().zip(photographed.lights);
        let reports = reports.map(|(report, light)| separate_report(report, light)).collect();
        Ok((found, reports))
    })?;
    let (separations, rest): (Vec<_>, Vec<_>) = found.lights.into_iter().map(split).unzip();
    let (indirect, direct) = rest.into_iter().unzip();
    let report = MethodReport::ColoursAndShape(Box::new(ColoursAndShapeSolved {
        report: found.report,
        maps: found.maps,
        white_light: input.white_light.cloned(),
        colours: scene.set.colours.iter().map(|colour| colour.name.clone()).collect(),
    }));
    Ok(Found { separated: Separated { lights: separations, reports }, indirect, direct, shape: None, report })
}

fn failed(error: ColoursAndShapeError) -> PipelineError {
    match error {
        ColoursAndShapeError::Cancelled => PipelineError::Cancelled,
        error => PipelineError::ColoursAndShape(error),
    }
}

/// Lends a set's photos to `work` as the method takes them.
fn with_photographed<T>(
    scene: &Scene,
    beta: &[f64],
    left_out: &[String],
    white_light: Option<f64>,
    work: impl FnOnce(&Photographed) -> Result<T, PipelineError>,
) -> Result<T, PipelineError> {
    let (object, camera) = (&scene.object, scene.camera());
    let alpha = (0..object.photos.len()).map(|l| scene.alpha(l)).collect::<Result<Vec<_>, _>>()?;
    let photos: Vec<Vec<_>> = object.photos.iter().map(|row| row.iter().map(|photo| &**photo).collect()).collect();
    let light = |l: usize| LightPhotos {
        photos: &photos[l],
        noise: &object.noise[l],
        alpha: &alpha[l],
        beta,
        mask: &object.mask,
    };
    let lights: Vec<_> = (0..photos.len()).map(light).collect();
    // Without a direction for every lamp there is no shape: the method then does without, and says so.
    let lamps = scene.lamps(left_out).unwrap_or_else(|_| vec![None; lights.len()]);
    work(&Photographed { lights: &lights, lamps: &lamps, mask: &object.mask, camera: &camera, white_light })
}

/// Puts the beta that the object shows where nothing else gives one, with what makes it doubtful among the warnings. Leaves it open
/// where nothing gives alpha either.
///
/// # Errors
/// `PipelineError`: the grey ball's photos, which say how bright white is, cannot be read, or cancelled.
pub fn add_beta_of_object(
    set: &CaptureSet,
    object: &ObjectPhotos,
    calibrated: &mut Calibrated,
    options: &SolveOptions,
    watch: &dyn PipelineWatch,
) -> Result<(), PipelineError> {
    if calibrated.beta.is_some() || calibrated.alpha.iter().any(Option::is_none) {
        return Ok(());
    }
    let white_light = white_light_if_known(set, calibrated, &options.scale, watch)?.map(|white| white.value);
    let unknown = vec![1.0; set.colours.len()];
    let scene = Scene::of(set, object, calibrated);
    let part = Part::of(watch, Stage::Calibrate, 1, 2);
    // Beta is the paint's: it must not depend on the method that it is used by.
    let options = &SolveOptions { method: Method::ColoursAndShape, paint: Paint::Auto, ..options.clone() };
    let told = with_photographed(&scene, &unknown, &options.left_out, white_light, |photographed| {
        beta_of_object(photographed, &options.colours_and_shape, &options.shape_after(), &part).map_err(failed)
    })?;
    if told.is_empty() {
        return Ok(());
    }
    let names = set.colours.iter().skip(1).map(|colour| colour.name.as_str());
    calibrated.warnings.extend(told.iter().zip(names).filter_map(|(told, name)| told.doubt_words(name)));
    let known = told.into_iter().map(|told| Known::measured(told.estimate, Source::Object, None));
    calibrated.beta = Some(std::iter::once(Known::by_definition()).chain(known).collect());
    Ok(())
}

/// The direct light as bounce 1, and what goes beside it.
fn split(light: SeparatedLight) -> (Separation, (firstbounce_core::Plane, Direct)) {
    let SeparatedLight { direct, indirect, noise, marks } = light;
    let separation = Separation {
        bounces: vec![direct.clone()],
        direct_noise: Some(noise.clone()),
        residual: None,
        marks: marks.clone(),
    };
    (separation, (indirect, Direct { light: direct, noise: Some(noise), marks, report: None }))
}

fn separate_report(report: &LightReport, light: &LightPhotos) -> SeparateReport {
    // Noise of a photo of the reference colour at the object's typical light.
    let photo = light.typical_sigma().first().map_or(0.0, |sigma| sigma / light.alpha[0]);
    SeparateReport {
        bounces: 1,
        colours: light.beta.len(),
        gain: vec![if photo > 0.0 { report.mean_noise / photo } else { 0.0 }],
        condition_number: None,
        noise: vec![report.mean_noise],
        mean: vec![report.mean_direct],
        residual_rms: None,
        residual_expected: None,
        solved_pixels: report.solved_pixels,
        reduced_pixels: report.reduced_pixels,
        unsolved_clipped_pixels: report.unsolved_clipped_pixels,
        unsolved_dark_pixels: report.unsolved_dark_pixels,
    }
}
