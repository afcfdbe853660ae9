//! Nayar, Ikeuchi and Kanade 1991: photos in one colour, the bounces simulated on the shape that was found.

use firstbounce_core::methods::by_shape::{ByShape, ByShapeReport, Ending, Photographed, separate_by_shape};
use firstbounce_core::separate::{SeparateReport, Separation};
use firstbounce_core::{Mask, Plane};

use super::super::calibrate::Source;
use super::super::watch::Part;
use super::super::{Calibrated, Direct, Known, PipelineError, PipelineWatch, Preference, Separated, Stage, calibrate};
use super::{Found, Input, MethodReport, Needs, OnShape, Row};
use crate::set::{Calibration, CaptureSet, Number};

/// A shape that leaves more than this share of the light unexplained is worth a warning.
const POOR_RESIDUAL: f64 = 0.1;
/// So are later iterations that leave this many times more of the light unexplained than the best one.
const WORSE: f64 = 1.05;
/// So is a pseudo albedo above 1 in more than this share of the pixels.
const MANY_CLAMPED: f64 = 0.02;

pub(super) const ROW: Row = Row {
    title: "Nayar's method",
    purpose: "Photos in one colour; the bounces are simulated on the shape, over and over (Nayar, Ikeuchi and Kanade 1991)",
    needs: Needs { all_colours: false, absolute_albedo: true, surface_before: true },
    compares_albedo: false,
    one_paint: false,
    stage: Stage::Nayar,
    direct_light,
};

fn direct_light(input: &Input, watch: &dyn PipelineWatch, on_shape: &mut OnShape) -> Result<Found, PipelineError> {
    let Input { scene, options, .. } = input;
    let photos = input.raw.ok_or(PipelineError::NoSurfaceBefore)?;
    let raw = photos.direct();
    let pseudo_shape = input.before.ok_or(PipelineError::NoSurfaceBefore)?;
    let white_light = input.white_light.ok_or(PipelineError::NoWhiteLight)?;
    let camera = scene.camera();
    let lights = scene.direct_lights(&raw, &options.left_out)?;
    let photographed =
        Photographed { lights: &lights, mask: &scene.object.mask, camera: &camera, white_light: white_light.value };
    let part = Part::of(watch, Stage::Nayar, 0, 1);
    let found =
        separate_by_shape(&photographed, pseudo_shape, &options.nayar, &options.shape, &part, &mut |_, shape| {
            on_shape(shape);
        })?;
    let ByShape { shape, direct, report } = found;
    let mut separated = photos.clone();
    let direct = replace_bounce_1(&mut separated, &scene.object.mask, raw, direct);
    let report = MethodReport::Nayar(NayarSolved { report, white_light: white_light.clone() });
    Ok(Found { separated, indirect: Vec::new(), direct, shape: Some(shape), report })
}

/// What makes albedos absolute where it is not, or not to be, what the capture file gives.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct AlbedoScale {
    /// Albedo of the grey ball in the reference colour.
    pub grey_albedo: Option<f64>,
    /// Linear light of a white facet that faces a lamp of intensity 1.
    pub white_light: Option<f64>,
    /// The same as a rendered set knows it: used where nothing else gives it.
    pub white_light_of_truth: Option<f64>,
}

/// What Nayar's method tells of itself.
#[derive(Clone, Debug, PartialEq)]
pub struct NayarSolved {
    /// Its iterations.
    pub report: ByShapeReport,
    /// Linear light of a white facet that faces a lamp of intensity 1, and how that is known.
    pub white_light: Known<f64>,
}

impl NayarSolved {
    /// What the user should know before trusting the surface.
    pub fn warnings(&self, solved_pixels: usize) -> Vec<String> {
        let ByShapeReport { steps, chosen, ending, islands, .. } = &self.report;
        let mut warnings = Vec::new();
        let last = steps.last().copied();
        match (ending, last) {
            (Ending::Diverged, _) => {
                warnings.push("Nayar's method diverged: the normals turned further with each iteration".into());
            }
            (Ending::OutOfIterations, Some(last)) => warnings.push(format!(
                "Nayar's method has not come to rest: iteration {} still turned the normals by {:.2} degrees",
                last.iteration, last.change_deg
            )),
            _ => {}
        }
        let Some(step) = steps.get(*chosen) else { return warnings };
        if last.is_some_and(|last| last.residual > WORSE * step.residual) {
            warnings.push(format!(
                "Nayar's method explains the photos best after iteration {chosen} of {}: later ones take away too much light; the \
                 surface is that of iteration {chosen}",
                steps.len() - 1
            ));
        }
        if step.residual > POOR_RESIDUAL {
            warnings.push(format!(
                "Nayar's shape leaves {:.0} % of the light unexplained: surfaces out of sight, a wrong albedo of the grey ball or \
                 several paints may be why",
                100.0 * step.residual
            ));
        }
        if step.clamped_pixels as f64 > MANY_CLAMPED * solved_pixels as f64 {
            warnings.push(format!(
                "{} pixels came out brighter than any paint and were taken as 99 % white: is the albedo of the grey ball right?",
                step.clamped_pixels
            ));
        }
        if *islands > 1 {
            warnings.push(format!(
                "the object has {islands} unconnected parts: how deep they lie to each other is not known, so the light between \
                 them is a guess"
            ));
        }
        warnings
    }
}

/// The light of a white facet that faces a lamp of intensity 1: as given, else as the grey ball shows it.
///
/// # Errors
/// `NoWhiteLight` without a grey ball, `NoGreyAlbedo` where its albedo is not known, `Scale` for impossible values.
pub(in super::super) fn white_light(
    set: &CaptureSet,
    calibrated: &Calibrated,
    scale: &AlbedoScale,
    watch: &dyn PipelineWatch,
) -> Result<Known<f64>, PipelineError> {
    let found = photographed_white_light(set, calibrated, scale, watch);
    match (&found, scale.white_light_of_truth) {
        (Err(PipelineError::NoGreyAlbedo | PipelineError::NoWhiteLight), Some(value)) => {
            Ok(Known::new(value, Source::Truth))
        }
        _ => found,
    }
}

/// The same where it is known; what a rendered set knows of itself does not count.
///
/// # Errors
/// `Scale` for impossible values, and `Cancelled`.
pub(in super::super) fn white_light_if_known(
    set: &CaptureSet,
    calibrated: &Calibrated,
    scale: &AlbedoScale,
    watch: &dyn PipelineWatch,
) -> Result<Option<Known<f64>>, PipelineError> {
    let given = [scale.white_light, scale.grey_albedo, set.calibration.white_light, set.calibration.grey_albedo];
    // The grey ball is looked at only where something says what it is.
    if given.iter().all(Option::is_none) {
        return Ok(None);
    }
    match photographed_white_light(set, calibrated, scale, watch) {
        Ok(known) => Ok(Some(known)),
        Err(error @ (PipelineError::Cancelled | PipelineError::Scale { .. })) => Err(error),
        Err(_) => Ok(None),
    }
}

fn photographed_white_light(
    set: &CaptureSet,
    calibrated: &Calibrated,
    scale: &AlbedoScale,
    watch: &dyn PipelineWatch,
) -> Result<Known<f64>, PipelineError> {
    let given = scale.white_light.or(scale.grey_albedo.is_none().then_some(set.calibration.white_light).flatten());
    if let Some(value) = given {
        let refused = PipelineError::Scale { what: "white_light", value, expected: "from 1e-9 to 1e9" };
        return if Number::WhiteLight.allows(value) { Ok(Known::from_file(value)) } else { Err(refused) };
    }
    let grey_light = match calibrated.grey_light {
        Some(light) => Some(light),
        // Intensities that are given are not measured; the ball's light is needed all the same.
        None => {
            let calibration = Calibration { intensity: Default::default(), ..set.calibration.clone() };
            let measured = calibrate(&CaptureSet { calibration, ..set.clone() }, Preference::File, watch)?.grey_light;
            let first = calibrated.intensity.first().map_or(1.0, |known| known.value);
            measured.map(|light| light / first)
        }
    };
    let grey_light = grey_light.ok_or(PipelineError::NoWhiteLight)?;
    let albedo = scale.grey_albedo.or(set.calibration.grey_albedo).ok_or(PipelineError::NoGreyAlbedo)?;
    if !Number::GreyAlbedo.allows(albedo) {
        let expected = "from 0.0001 to 1";
        return Err(PipelineError::Scale { what: "grey_albedo", value: albedo, expected });
    }
    Ok(Known::new(grey_light / albedo, Source::GreyBall))
}

/// Puts the direct light that was found in place of the photos before separation, with its mean.
fn replace_bounce_1(separated: &mut Separated, mask: &Mask, raw: Vec<Direct>, direct: Vec<Plane>) -> Vec<Direct> {
    let all = separated.lights.iter_mut().zip(&mut separated.reports).zip(raw.into_iter().zip(direct));
    let replace = |((separation, report), (raw, light)): ((&mut Separation, &mut SeparateReport), (Direct, Plane))| {
        report.mean = vec![mean_inside(&light, mask)];
        separation.bounces = vec![light.clone()];
        Direct { light, ..raw }
    };
    all.map(replace).collect()
}

fn mean_inside(plane: &Plane, mask: &Mask) -> f64 {
    let inside = plane.data().iter().zip(mask.data()).filter(|(_, inside)| **inside);
    inside.map(|(light, _)| f64::from(*light)).sum::<f64>() / mask.count().max(1) as f64
}
