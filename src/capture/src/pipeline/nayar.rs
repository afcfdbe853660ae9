//! Nayar's method beside the paper's: one capture colour, the bounces simulated on the shape that was found.

use firstbounce_core::nayar::{Ending, Nayar, NayarOptions, NayarReport, NayarStep, Photographed, nayar};
use firstbounce_core::separate::Separation;
use firstbounce_core::shape::{Shape, ShapeOptions};
use firstbounce_core::trust::TrustOptions;
use firstbounce_core::{Camera, Mask};

use super::calibrate::{Known, Preference, Source};
use super::solve::{direct_lights, lamps};
use super::watch::Part;
use super::{
    Calibrated, Direct, ObjectLevels, ObjectPhotos, PipelineError, PipelineWatch, Separated, SolveOptions, Solved,
    Stage, StageCost, Surfaced, calibrate, calibrate_for, camera_of, judge, load_object, raw_lights, recover,
    separate_lights, triangulate,
};
use crate::set::{Calibration, CaptureSet, Number, Separation as Order};

/// A shape that leaves more than this share of the light unexplained is worth a warning.
const POOR_RESIDUAL: f64 = 0.1;
/// So are later iterations that leave this many times more of the light unexplained than the best one.
const WORSE: f64 = 1.05;
/// So is a pseudo albedo above 1 in more than this share of the pixels.
const MANY_CLAMPED: f64 = 0.02;

/// How light is taken apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Liao, Huang and Yang 2011: photos in several colours, whose bounces differ.
    #[default]
    Bounces,
    /// Nayar, Ikeuchi and Kanade 1991: photos in one colour, and the bounces simulated on the shape.
    Nayar,
}

impl Method {
    /// For reports and the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bounces => "bounces",
            Self::Nayar => "nayar",
        }
    }
}

/// What makes albedos absolute where it is not, or not to be, what the capture file gives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AlbedoScale {
    /// Albedo of the grey ball in the reference colour.
    pub grey_albedo: Option<f64>,
    /// Linear light of a white facet that faces a lamp of intensity 1.
    pub white_light: Option<f64>,
}

/// What Nayar's method tells of itself.
#[derive(Clone, Debug, PartialEq)]
pub struct NayarSolved {
    /// Its iterations.
    pub report: NayarReport,
    /// Linear light of a white facet that faces a lamp of intensity 1, and how that is known.
    pub white_light: Known<f64>,
}

impl NayarSolved {
    /// What a person should know before trusting the surface.
    pub fn warnings(&self, solved_pixels: usize) -> Vec<String> {
        let NayarReport { steps, chosen, ending, islands, .. } = &self.report;
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
pub fn white_light(
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
    Ok(Known { value: grey_light / albedo, interval: None, source: Source::GreyBall, pixels: None })
}

/// The set with its reference colour alone: all that Nayar's method looks at.
pub fn in_one_colour(set: &CaptureSet) -> CaptureSet {
    let reference = set.colours.first().map(|colour| colour.name.clone());
    let mut one = set.clone();
    one.colours.truncate(1);
    one.shots.retain(|shot| shot.colour.is_none() || shot.colour == reference);
    one.calibration.beta = None;
    one.calibration.alpha.clear();
    one.separation = Order::default();
    one
}

/// What Nayar's method starts from.
#[derive(Clone, Copy, Debug)]
pub struct Beginning<'a> {
    /// Photos of the reference colour as they are.
    pub raw: &'a [Direct],
    /// The surface that photometric stereo finds in them.
    pub pseudo_shape: &'a Shape,
    /// The object.
    pub mask: &'a Mask,
    /// What sees it.
    pub camera: &'a Camera,
    /// Linear light of a white facet that faces a lamp of intensity 1.
    pub white_light: f64,
}

/// Runs Nayar's method; `on_step` is shown every shape on the way.
pub fn simulate_away(
    set: &CaptureSet,
    calibrated: &Calibrated,
    beginning: &Beginning,
    options: &NayarOptions,
    shape: &ShapeOptions,
    watch: &dyn firstbounce_core::Watch,
    on_step: &mut dyn FnMut(&NayarStep, &Shape),
) -> Result<Nayar, PipelineError> {
    let lights = direct_lights(beginning.raw, lamps(set, calibrated)?, calibrated);
    let photographed = Photographed {
        lights: &lights,
        mask: beginning.mask,
        camera: beginning.camera,
        white_light: beginning.white_light,
    };
    Ok(nayar(&photographed, beginning.pseudo_shape, options, shape, watch, on_step)?)
}

/// Every stage but the writing of files, by Nayar's method. Bounce 1 of the results is the direct light that it found.
pub(super) fn solve_by_nayar(
    set: &CaptureSet,
    options: &SolveOptions,
    watch: &dyn PipelineWatch,
) -> Result<Solved, PipelineError> {
    let set = &in_one_colour(set);
    let mut stages = Vec::new();
    let object = StageCost::measure(&mut stages, Stage::Load, || load_object(set, watch))?;
    let (calibrated, white_light) = StageCost::measure(&mut stages, Stage::Calibrate, || {
        let calibrated = calibrate_for(set, 1, watch)?;
        let white_light = white_light(set, &calibrated, &options.scale, watch)?;
        Ok::<_, PipelineError>((calibrated, white_light))
    })?;
    let mut separated =
        StageCost::measure(&mut stages, Stage::Separate, || separate_lights(set, &object, &calibrated, 1, watch))?;
    let raw = raw_lights(&object, watch)?;
    let trust_options = TrustOptions { bounces: 1, indirect: options.indirect, ..TrustOptions::default() };
    let trust = judge(set, &ObjectLevels::of(set, &object), &calibrated, &trust_options)?;

    let camera = camera_of(set, object.mask.size());
    let pseudo_shape = StageCost::measure(&mut stages, Stage::Shape, || {
        let part = Part::of(watch, Stage::Shape, 0, 1);
        recover(set, &object, &calibrated, &raw, &camera, &options.shape, &part)
    })?;
    let beginning = Beginning {
        raw: &raw,
        pseudo_shape: &pseudo_shape,
        mask: &object.mask,
        camera: &camera,
        white_light: white_light.value,
    };
    let found = StageCost::measure(&mut stages, Stage::Nayar, || {
        let part = Part::of(watch, Stage::Nayar, 0, 1);
        simulate_away(set, &calibrated, &beginning, &options.nayar, &options.shape, &part, &mut |_, _| {})
    })?;
    let Nayar { shape, direct, report } = found;
    let direct = replace_bounce_1(&mut separated, &object, raw, direct);
    let mut surface = |shape: Shape| {
        let mesh = StageCost::measure(&mut stages, Stage::Mesh, || triangulate(&shape, &camera, &options.mesh))?;
        Ok::<_, PipelineError>(Surfaced { shape, mesh })
    };
    let (after, before) = (surface(shape)?, surface(pseudo_shape)?);
    Ok(Solved {
        object,
        calibrated,
        separated,
        trust,
        direct,
        after: Ok(after),
        before: Some(before),
        nayar: Some(NayarSolved { report, white_light }),
        stages,
    })
}

/// Puts the direct light that was found in place of the photos as they are, and tells its mean.
fn replace_bounce_1(
    separated: &mut Separated,
    object: &ObjectPhotos,
    raw: Vec<Direct>,
    direct: Vec<firstbounce_core::Plane>,
) -> Vec<Direct> {
    let all = separated.lights.iter_mut().zip(&mut separated.reports).zip(raw.into_iter().zip(direct));
    let replace = |((separation, report), (raw, light)): ((&mut Separation, _), (Direct, firstbounce_core::Plane))| {
        let report: &mut firstbounce_core::separate::SeparateReport = report;
        report.mean = vec![mean_inside(&light, &object.mask)];
        separation.bounces = vec![light.clone()];
        Direct { light, ..raw }
    };
    all.map(replace).collect()
}

fn mean_inside(plane: &firstbounce_core::Plane, mask: &Mask) -> f64 {
    let inside = plane.data().iter().zip(mask.data()).filter(|(_, inside)| **inside);
    inside.map(|(light, _)| f64::from(*light)).sum::<f64>() / mask.count().max(1) as f64
}
