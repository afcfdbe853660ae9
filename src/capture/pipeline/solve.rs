//! Photos and calibration to bounces, surface and mesh.

use firstbounce_core::denoise::{DenoiseOptions, DenoiseReport, denoise_direct};
use firstbounce_core::mesh::{MeshOptions, from_depth};
use firstbounce_core::methods::by_shape::ByShapeOptions;
use firstbounce_core::separate::{LightPhotos, SeparateOptions, SeparateReport, Separation, separate};
use firstbounce_core::stereo::normals::{DirectLight, Lamp};
use firstbounce_core::stereo::shape::{Shape, ShapeOptions, recover_shape};
use firstbounce_core::trust::{Trust, TrustOptions};
use firstbounce_core::{Camera, Marks, Mesh, Plane, Projection};
use nalgebra::{Point3, Vector3};

use super::nayar::solve_by_nayar;
use super::watch::Part;
use super::{
    AlbedoScale, Calibrated, Method, NayarSolved, ObjectLevels, ObjectPhotos, PipelineError, PipelineWatch, Stage,
    StageCost, calibrate_for, judge, load_object,
};
use crate::set::{self, CaptureSet};

/// How to get from photos to a mesh.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SolveOptions {
    /// The order m; `None` for the set's own.
    pub bounces: Option<usize>,
    /// The noise of the indirect light.
    pub denoise: DenoiseOptions,
    /// Normals and depth.
    pub shape: ShapeOptions,
    /// Triangles.
    pub mesh: MeshOptions,
    /// How the light is taken apart.
    pub method: Method,
    /// For Nayar's method.
    pub nayar: ByShapeOptions,
    /// For Nayar's method: what makes albedos absolute, before what the set's file gives.
    pub scale: AlbedoScale,
}

/// The bounces of every light.
#[derive(Clone, Debug)]
pub struct Separated {
    /// By light.
    pub lights: Vec<Separation>,
    /// By light.
    pub reports: Vec<SeparateReport>,
}

/// What photometric stereo takes of one light.
#[derive(Clone, Debug)]
pub struct Direct {
    /// Direct light in the reference colour.
    pub light: Plane,
    /// Its predicted noise.
    pub noise: Option<Plane>,
    /// Marks of the separation.
    pub marks: Marks,
    /// How much quieter it became; `None` for light that was not separated.
    pub report: Option<DenoiseReport>,
}

impl From<Separation> for Direct {
    /// Bounce 1 as it is.
    fn from(separation: Separation) -> Self {
        let light = separation.bounces.into_iter().next().unwrap_or_else(|| Plane::filled(0, 0, 0.0));
        Self { light, noise: separation.direct_noise, marks: separation.marks, report: None }
    }
}

/// A surface and its triangles.
#[derive(Clone, Debug)]
pub struct Surfaced {
    /// Normals, albedo, depth.
    pub shape: Shape,
    /// The depth as triangles.
    pub mesh: Mesh,
}

/// All results of a set.
#[derive(Debug)]
pub struct Solved {
    /// What was photographed.
    pub object: ObjectPhotos,
    /// The rig.
    pub calibrated: Calibrated,
    /// The bounces.
    pub separated: Separated,
    /// How far the bounces can be trusted.
    pub trust: Trust,
    /// By light, bounce 1 with less noise: what the surface is recovered from.
    pub direct: Vec<Direct>,
    /// The surface from bounce 1, or why there is none; the bounces stand either way.
    pub after: Result<Surfaced, PipelineError>,
    /// The surface from the photos as they are, for comparison; `None` where `after` failed.
    pub before: Option<Surfaced>,
    /// What Nayar's method tells; `None` where the light was taken apart by colours. Then bounce 1 is the direct light that
    /// this method found, and `trust` speaks of the photos alone.
    pub nayar: Option<NayarSolved>,
    /// What each stage cost.
    pub stages: Vec<StageCost>,
}

/// Runs every stage but the writing of files.
pub fn solve(set: &CaptureSet, options: &SolveOptions, watch: &dyn PipelineWatch) -> Result<Solved, PipelineError> {
    match options.method {
        Method::Bounces => solve_by_bounces(set, options, watch),
        Method::Nayar => solve_by_nayar(set, options, watch),
    }
}

fn solve_by_bounces(
    set: &CaptureSet,
    options: &SolveOptions,
    watch: &dyn PipelineWatch,
) -> Result<Solved, PipelineError> {
    options.denoise.check()?;
    let bounces = options.bounces.unwrap_or_else(|| set.bounces());
    let mut stages = Vec::new();
    let object = StageCost::measure(&mut stages, Stage::Load, || load_object(set, watch))?;
    let calibrated = StageCost::measure(&mut stages, Stage::Calibrate, || calibrate_for(set, bounces, watch))?;
    let separated = StageCost::measure(&mut stages, Stage::Separate, || {
        separate_lights(set, &object, &calibrated, bounces, watch)
    })?;
    let trust_options = TrustOptions { bounces, denoise: options.denoise, ..TrustOptions::default() };
    let trust = judge(set, &ObjectLevels::of(set, &object), &calibrated, &trust_options)?;
    let direct = StageCost::measure(&mut stages, Stage::Separate, || {
        denoise_lights(set, &object, &calibrated, &separated, &options.denoise, watch)
    })?;
    let raw = StageCost::measure(&mut stages, Stage::Separate, || raw_lights(&object, watch))?;

    let camera = camera_of(set, object.mask.size());
    let stage = |lights: &[Direct], half: usize, stages: &mut Vec<StageCost>| {
        let part = Part::of(watch, Stage::Shape, half, 2);
        let shape = StageCost::measure(stages, Stage::Shape, || {
            recover(set, &object, &calibrated, lights, &camera, &options.shape, &part)
        })?;
        let mesh = StageCost::measure(stages, Stage::Mesh, || triangulate(&shape, &camera, &options.mesh))?;
        Ok(Surfaced { shape, mesh })
    };
    let after = match stage(&direct, 0, &mut stages) {
        Err(PipelineError::Cancelled) => return Err(PipelineError::Cancelled),
        after => after,
    };
    let before = match &after {
        Ok(_) => Some(stage(&raw, 1, &mut stages)?),
        Err(_) => None,
    };
    Ok(Solved { object, calibrated, separated, trust, direct, after, before, nayar: None, stages })
}

/// Separates every light into `bounces` bounces.
pub fn separate_lights(
    set: &CaptureSet,
    object: &ObjectPhotos,
    calibrated: &Calibrated,
    bounces: usize,
    watch: &dyn PipelineWatch,
) -> Result<Separated, PipelineError> {
    let beta = calibrated.beta_values()?;
    let mut separated = Separated { lights: Vec::new(), reports: Vec::new() };
    for l in 0..object.photos.len() {
        let part = Part::of(watch, Stage::Separate, l, object.photos.len());
        let (separation, report) = with_light(set, object, calibrated, &beta, l, |light| {
            Ok(separate(light, &SeparateOptions { bounces }, &part)?)
        })?;
        separated.lights.push(separation);
        separated.reports.push(report);
    }
    Ok(separated)
}

/// Takes most of the noise of the indirect light out of bounce 1.
pub fn denoise_lights(
    set: &CaptureSet,
    object: &ObjectPhotos,
    calibrated: &Calibrated,
    separated: &Separated,
    options: &DenoiseOptions,
    watch: &dyn PipelineWatch,
) -> Result<Vec<Direct>, PipelineError> {
    let beta = calibrated.beta_values()?;
    let quiet = |(l, separation): (usize, &Separation)| {
        let part = Part::of(watch, Stage::Separate, l, separated.lights.len());
        let quiet = with_light(set, object, calibrated, &beta, l, |light| {
            Ok(denoise_direct(light, separation, options, &part)?)
        })?;
        Ok(Direct {
            light: quiet.direct,
            noise: Some(quiet.noise),
            marks: separation.marks.clone(),
            report: Some(quiet.report),
        })
    };
    separated.lights.iter().enumerate().map(quiet).collect()
}

/// Lends all that is known of light `l` to `work`.
fn with_light<T>(
    set: &CaptureSet,
    object: &ObjectPhotos,
    calibrated: &Calibrated,
    beta: &[f64],
    l: usize,
    work: impl FnOnce(&LightPhotos) -> Result<T, PipelineError>,
) -> Result<T, PipelineError> {
    let alpha = calibrated.alpha_values(set, l)?;
    let photos: Vec<_> = object.photos[l].iter().collect();
    work(&LightPhotos { photos: &photos, noise: &object.noise[l], alpha: &alpha, beta, mask: &object.mask })
}

/// The reference colour's photos as if all their light had bounced once: what photometric stereo sees uncorrected.
pub fn raw_lights(object: &ObjectPhotos, watch: &dyn PipelineWatch) -> Result<Vec<Direct>, PipelineError> {
    let one_bounce = |l: usize| {
        let (photos, noise) = ([&object.photos[l][0]], [object.noise[l][0]]);
        let light = LightPhotos { photos: &photos, noise: &noise, alpha: &[1.0], beta: &[1.0], mask: &object.mask };
        let part = Part::of(watch, Stage::Separate, l, object.photos.len());
        Ok(separate(&light, &SeparateOptions { bounces: 1 }, &part)?.0.into())
    };
    (0..object.photos.len()).map(one_bounce).collect()
}

/// The surface that bounce 1 of `lights` shows.
pub fn recover(
    set: &CaptureSet,
    object: &ObjectPhotos,
    calibrated: &Calibrated,
    lights: &[Direct],
    camera: &Camera,
    options: &ShapeOptions,
    watch: &dyn firstbounce_core::Watch,
) -> Result<Shape, PipelineError> {
    let direct = direct_lights(lights, lamps(set, calibrated)?, calibrated);
    Ok(recover_shape(&direct, &object.mask, camera, options, watch)?)
}

/// Light and lamps as photometric stereo takes them.
pub(super) fn direct_lights<'a>(
    lights: &'a [Direct],
    lamps: Vec<Lamp>,
    calibrated: &Calibrated,
) -> Vec<DirectLight<'a>> {
    let direct = |(l, (direct, lamp)): (usize, (&'a Direct, Lamp))| DirectLight {
        direct: &direct.light,
        noise: direct.noise.as_ref(),
        marks: &direct.marks,
        lamp,
        intensity: calibrated.intensity[l].value,
    };
    lights.iter().zip(lamps).enumerate().map(direct).collect()
}

/// Where each lamp is: its position if the set gives one, else its direction.
pub fn lamps(set: &CaptureSet, calibrated: &Calibrated) -> Result<Vec<Lamp>, PipelineError> {
    let lamp = |(l, light): (usize, &set::Light)| match (light.position_mm, &calibrated.direction[l]) {
        (Some(position), _) => Ok(Lamp::Near(Point3::from(position))),
        (None, Some(direction)) => Ok(Lamp::Distant(Vector3::from(direction.value))),
        (None, None) => Err(PipelineError::NoDirection { light: light.name.clone() }),
    };
    set.lights.iter().enumerate().map(lamp).collect()
}

/// The set's camera for pictures of this size.
pub fn camera_of(set: &CaptureSet, size: (usize, usize)) -> Camera {
    let projection = match set.camera.projection {
        set::Projection::Orthographic { mm_per_pixel } => Projection::Orthographic { mm_per_pixel },
        set::Projection::Perspective { focal_length_px, principal_point, working_distance_mm } => {
            let [x, y] = principal_point.unwrap_or([size.0 as f64 / 2.0, size.1 as f64 / 2.0]);
            Projection::Perspective { focal_length_px, principal_point_px: (x, y), working_distance_mm }
        }
    };
    Camera { projection, size }
}

/// The depth as triangles, coloured by albedo relative to the brightest part.
pub fn triangulate(shape: &Shape, camera: &Camera, options: &MeshOptions) -> Result<Mesh, PipelineError> {
    let albedo = relative_albedo(&shape.normals.albedo);
    Ok(from_depth(&shape.depth.depth_mm, &shape.depth.mask, camera, Some(&shape.normals.map), Some(&albedo), options)?
        .0)
}

/// Albedo over its largest value: a mesh's colours end at 1.
pub(super) fn relative_albedo(albedo: &Plane) -> Plane {
    let largest = albedo.data().iter().copied().fold(0.0, f32::max).max(f32::MIN_POSITIVE);
    let data = albedo.data().iter().map(|value| value / largest).collect();
    Plane::from_vec(albedo.width(), albedo.height(), data).unwrap_or_else(|| albedo.clone())
}
