//! From photos and rig to surfaces, step by step. `solve`, `evaluate` and the window run these steps.

use std::borrow::Cow;
use std::sync::Arc;

use firstbounce_core::denoise::{DenoiseOptions, DenoiseReport};
use firstbounce_core::mesh::{MeshOptions, from_depth};
use firstbounce_core::methods::by_shape::ByShapeOptions;
use firstbounce_core::methods::colours_and_shape::ColoursAndShapeOptions;
use firstbounce_core::separate::{LightPhotos, SeparateOptions, SeparateReport, Separation, separate};
use firstbounce_core::stereo::normals::{NormalsOptions, Paint};
use firstbounce_core::stereo::shape::{Shape, ShapeOptions, recover_shape};
use firstbounce_core::trust::{Trust, TrustOptions};
use firstbounce_core::{Camera, Marks, Mesh, Plane, Watch};

use super::calibrate::needed_subjects;
use super::methods::{white_light, white_light_if_known};
use super::watch::Part;
use super::{
    AlbedoScale, Calibrated, CaptureReport, CheckOptions, Found, Input, Known, Method, MethodReport, ObjectLevels,
    ObjectPhotos, PhotoStore, PipelineError, PipelineWatch, Preference, Scene, Stage, StageCost, Surface,
    calibrate_for, check_captures, check_surface, judge, judge_method, load_object,
};
use crate::set::{CaptureSet, ShapeSettings, Shot, Subject};

/// How to get from photos to a mesh.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct SolveOptions {
    /// The order m; `None` for the set's own.
    pub bounces: Option<usize>,
    /// The noise of the indirect light.
    pub denoise: DenoiseOptions,
    /// Names of lights that surfaces are recovered without.
    pub left_out: Vec<String>,
    /// Normals and depth.
    pub shape: ShapeOptions,
    /// Whether the object has one albedo; `Auto` lets the method look for it.
    pub paint: Paint,
    /// What is looked for in the captures.
    pub checks: CheckOptions,
    /// Triangles.
    pub mesh: MeshOptions,
    /// How direct light is found.
    pub method: Method,
    /// For colours and shape together.
    pub colours_and_shape: ColoursAndShapeOptions,
    /// For Nayar's method.
    pub nayar: ByShapeOptions,
    /// For methods that need it: what makes albedos absolute, before what the set's file gives.
    pub scale: AlbedoScale,
}

impl SolveOptions {
    /// As a set's file asks for; the defaults else.
    pub fn of(set: &CaptureSet) -> Self {
        let ShapeSettings { leave_out, shadow_share, misfit_share, rounds, indirect_window_px, paint } =
            set.shape.clone();
        let normals =
            NormalsOptions { shadow_fraction: shadow_share, outlier_fraction: misfit_share, paint: Paint::Any };
        Self {
            denoise: DenoiseOptions { radius_px: indirect_window_px, ..DenoiseOptions::default() },
            left_out: leave_out,
            shape: ShapeOptions { normals, rounds, ..ShapeOptions::default() },
            paint,
            method: set.method(),
            ..Self::default()
        }
    }

    /// The order m that a set is separated with; 1 for a method that takes all indirect light together.
    pub fn bounces_of(&self, set: &CaptureSet) -> usize {
        if self.method == Method::Colours { self.bounces.unwrap_or_else(|| set.bounces()) } else { 1 }
    }

    /// The order m that a set is calibrated for: beta is needed for two bounces or more, and where the method needs it.
    pub fn calibrated_bounces_of(&self, set: &CaptureSet) -> usize {
        if self.method == Method::ColoursAndShape { 2 } else { self.bounces_of(set) }
    }

    /// How the surface is recovered from the direct light that the method finds.
    pub fn shape_after(&self) -> ShapeOptions {
        let paint = match self.paint {
            Paint::Auto if !self.method.assumes_one_paint() => Paint::Any,
            paint => paint,
        };
        ShapeOptions { normals: NormalsOptions { paint, ..self.shape.normals }, ..self.shape }
    }

    /// What trust is judged by.
    pub fn trust(&self, bounces: usize) -> TrustOptions {
        TrustOptions { bounces, denoise: self.denoise, ..TrustOptions::default() }
    }
}

/// The bounces of every light.
#[derive(Clone, Debug)]
pub struct Separated {
    /// By light.
    pub lights: Vec<Separation>,
    /// By light.
    pub reports: Vec<SeparateReport>,
}

impl Separated {
    /// Bounce 1 of every light as it is.
    pub fn direct(&self) -> Vec<Direct> {
        let direct = |separation: &Separation| Direct {
            light: separation.bounces.first().cloned().unwrap_or_else(|| Plane::filled(0, 0, 0.0)),
            noise: separation.direct_noise.clone(),
            marks: separation.marks.clone(),
            report: None,
        };
        self.lights.iter().map(direct).collect()
    }
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
    /// How much noise it lost; `None` for light that was not denoised.
    pub report: Option<DenoiseReport>,
}

/// All results of a set by one method.
#[derive(Debug)]
pub struct Solved {
    /// The set, without the lights that the method did without.
    pub set: Arc<CaptureSet>,
    /// How it was solved.
    pub options: SolveOptions,
    /// What was photographed.
    pub object: Arc<ObjectPhotos>,
    /// The rig.
    pub calibrated: Arc<Calibrated>,
    /// The bounces.
    pub separated: Arc<Separated>,
    /// How far the bounces can be trusted; of a method that looks at one colour, how far its photos can.
    pub trust: Trust,
    /// By light, all light that bounced more than once; empty for a method that keeps bounces apart.
    pub indirect: Arc<Vec<Plane>>,
    /// By light, what the surface is recovered from.
    pub direct: Arc<Vec<Direct>>,
    /// The surface from the direct light, or why there is none; the bounces stand either way.
    pub after: Result<Surface, PipelineError>,
    /// The surface from the photos before separation, for comparison; `None` where `after` failed.
    pub before: Option<Surface>,
    /// What the method reports of itself.
    pub report: MethodReport,
    /// What is wrong with the captures.
    pub captures: Arc<CaptureReport>,
    /// What each stage cost.
    pub stages: Vec<StageCost>,
}

/// Runs every stage but the writing of files.
pub fn solve(set: &CaptureSet, options: &SolveOptions, watch: &dyn PipelineWatch) -> Result<Solved, PipelineError> {
    options.denoise.check()?;
    let seen = options.method.set_of(set);
    let store = PhotoStore::default();
    let mut stages = Vec::new();
    let object = StageCost::measure(&mut stages, Stage::Load, || load_object(&seen, &store, watch))?;
    let calibrated =
        StageCost::measure(&mut stages, Stage::Calibrate, || calibrate_for(&seen, &object, options, &store, watch))?;
    let balls = needed_subjects(&seen, Preference::File);
    let is_used = |shot: &Shot| shot.subject == Subject::Object || balls.contains(&shot.subject);
    let checks = || {
        let photos = check_captures(&seen, is_used, &store, &options.checks, watch)?;
        Ok::<_, PipelineError>(photos.with_rig(&seen, &calibrated, &options.checks, watch))
    };
    let captures = StageCost::measure(&mut stages, Stage::Check, checks)?;
    // The balls' photos are not looked at any more.
    drop(store);
    let scene = Scene { set: Cow::Borrowed(set), object: Cow::Owned(object), calibrated: Cow::Owned(calibrated) };
    let solved = reconstruct(scene, None, options, stages, watch)?;
    let captures = Arc::new(captures.with(solved.captures.warnings.clone()));
    Ok(Solved { captures, ..solved })
}

/// From photos and rig to surfaces by one method; of the captures, what the surface shows is checked. `before` is the surface that
/// the photos show before separation, where it is there already; `stages` is what was spent so far.
pub fn reconstruct(
    scene: Scene,
    before: Option<Surface>,
    options: &SolveOptions,
    mut stages: Vec<StageCost>,
    watch: &dyn PipelineWatch,
) -> Result<Solved, PipelineError> {
    let shape_before = before.as_ref().map(|before| before.shape.clone());
    let lit = find_light(scene, shape_before, options, &mut stages, watch)?;
    let Lit { set, scene, raw, before: shape_before, found } = lit;
    let Found { separated, indirect, direct, shape, report } = found;

    let camera = scene.camera();
    let surface = |shape: Arc<Shape>, stages: &mut Vec<StageCost>| {
        let mesh = StageCost::measure(stages, Stage::Mesh, || triangulate(&shape, &camera, &options.mesh))?;
        Ok::<_, PipelineError>(Surface { shape, mesh: Arc::new(mesh) })
    };
    let recover = |lights: &[Direct], shape: &ShapeOptions, half, stages: &mut Vec<StageCost>| {
        let part = Part::of(watch, Stage::Shape, half, 2);
        let recover = || recover(&scene, lights, &options.left_out, shape, &part);
        StageCost::measure(stages, Stage::Shape, recover).map(Arc::new)
    };
    let shape = match shape {
        Some(shape) => Ok(Arc::new(shape)),
        None => recover(&direct, &options.shape_after(), 0, &mut stages),
    };
    let after = match shape.and_then(|shape| surface(shape, &mut stages)) {
        Err(PipelineError::Cancelled) => return Err(PipelineError::Cancelled),
        after => after,
    };
    let trust = match report.colours_and_shape() {
        Some(solved) => {
            let shape = after.as_ref().ok().map(|after| &*after.shape);
            judge_method(&scene.calibrated, &separated.reports, solved, shape)
        }
        None => {
            let levels = ObjectLevels::of(&scene.set, &scene.object);
            judge(&scene.set, &levels, &scene.calibrated, &options.trust(options.calibrated_bounces_of(&scene.set)))?
        }
    };
    let before = match (&after, before, shape_before) {
        (Err(_), ..) => None,
        (Ok(_), Some(before), _) => Some(before),
        (Ok(_), None, Some(shape)) => Some(surface(shape, &mut stages)?),
        (Ok(_), None, None) => {
            let find_raw = || raw_lights(&scene.object, watch);
            let raw = raw.map_or_else(|| StageCost::measure(&mut stages, Stage::Separate, find_raw), Ok)?;
            let shape = recover(&raw.direct(), &options.shape, 1, &mut stages)?;
            Some(surface(shape, &mut stages)?)
        }
    };
    let of_surface = |surface: &Surface| check_surface(&surface.shape.depth.mask, &options.checks);
    let captures = after.as_ref().map(of_surface).unwrap_or_default();
    Ok(Solved {
        captures: Arc::new(CaptureReport::of(captures)),
        set: Arc::new(set.into_owned()),
        options: options.clone(),
        object: Arc::new(scene.object.into_owned()),
        calibrated: Arc::new(scene.calibrated.into_owned()),
        separated: Arc::new(separated),
        indirect: Arc::new(indirect),
        trust,
        direct: Arc::new(direct),
        after,
        before,
        report,
        stages,
    })
}

/// The direct light of a set by one method, and what it was found from.
#[derive(Debug)]
pub struct Lit<'a> {
    /// The set, without the lights that the method did without.
    pub set: Cow<'a, CaptureSet>,
    /// Photos and rig as the method looks at them.
    pub scene: Scene<'a>,
    /// By light, the photos before separation, where they were needed on the way.
    pub raw: Option<Separated>,
    /// The surface that they show, where it was there already or the method needs it.
    pub before: Option<Arc<Shape>>,
    /// What the method found.
    pub found: Found,
}

/// From photos and rig to direct light by one method. `before` is the shape that the photos show before separation, where it is
/// there already; `stages` takes what was spent.
pub fn find_light<'a>(
    scene: Scene<'a>,
    mut before: Option<Arc<Shape>>,
    options: &SolveOptions,
    stages: &mut Vec<StageCost>,
    watch: &dyn PipelineWatch,
) -> Result<Lit<'a>, PipelineError> {
    let (method, needs) = (options.method, options.method.needs());
    let set =
        if needs.all_colours { scene.set.clone() } else { Cow::Owned(scene.set.without_lights(&options.left_out)) };
    let scene = method.scene_of(scene, options);
    let white = StageCost::measure(stages, Stage::Calibrate, || white_light_for(&scene, options, watch))?;
    let find_raw = || StageCost::measure(stages, Stage::Separate, || raw_lights(&scene.object, watch));
    let raw = needs.surface_before.then(find_raw).transpose()?;
    if let (Some(raw), None) = (&raw, &before) {
        let part = Part::of(watch, Stage::Shape, 0, 1);
        let recover = || recover(&scene, &raw.direct(), &options.left_out, &options.shape, &part);
        before = Some(Arc::new(StageCost::measure(stages, Stage::Shape, recover)?));
    }
    let input =
        Input { scene: &scene, raw: raw.as_ref(), before: before.as_deref(), white_light: white.as_ref(), options };
    let found = StageCost::measure(stages, method.stage(), || method.direct_light(&input, watch, &mut |_| {}))?;
    Ok(Lit { set, scene, raw, before, found })
}

/// The light of a white facet, for methods that need it, and where it is known for those that use it.
pub(super) fn white_light_for(
    scene: &Scene,
    options: &SolveOptions,
    watch: &dyn PipelineWatch,
) -> Result<Option<Known<f64>>, PipelineError> {
    let (set, calibrated, scale) = (&scene.set, &scene.calibrated, &options.scale);
    if options.method.needs().absolute_albedo {
        white_light(set, calibrated, scale, watch).map(Some)
    } else if options.method.compares_albedo() {
        white_light_if_known(set, calibrated, scale, watch)
    } else {
        Ok(None)
    }
}

/// The reference colour's photos as if all their light had bounced once: what photometric stereo sees uncorrected.
pub fn raw_lights(object: &ObjectPhotos, watch: &dyn PipelineWatch) -> Result<Separated, PipelineError> {
    let one_bounce = |l: usize| {
        let (photos, noise) = ([&*object.photos[l][0]], [object.noise[l][0]]);
        let light = LightPhotos { photos: &photos, noise: &noise, alpha: &[1.0], beta: &[1.0], mask: &object.mask };
        let part = Part::of(watch, Stage::Separate, l, object.photos.len());
        Ok(separate(&light, &SeparateOptions { bounces: 1 }, &part)?)
    };
    let all = (0..object.photos.len()).map(one_bounce).collect::<Result<Vec<_>, PipelineError>>()?;
    let (lights, reports) = all.into_iter().unzip();
    Ok(Separated { lights, reports })
}

/// The surface that the direct light of `lights` shows; they are those of the set, in its order.
pub fn recover(
    scene: &Scene,
    lights: &[Direct],
    left_out: &[String],
    options: &ShapeOptions,
    watch: &dyn Watch,
) -> Result<Shape, PipelineError> {
    let direct = scene.direct_lights(lights, left_out)?;
    Ok(recover_shape(&direct, &scene.object.mask, &scene.camera(), options, watch)?)
}

/// The depth as triangles, coloured by albedo relative to the brightest part.
pub fn triangulate(shape: &Shape, camera: &Camera, options: &MeshOptions) -> Result<Mesh, PipelineError> {
    let albedo = relative_albedo(&shape.normals.albedo);
    Ok(from_depth(&shape.depth.depth_mm, &shape.depth.mask, camera, Some(&shape.normals.map), Some(&albedo), options)?
        .0)
}

/// Albedo over its largest value: a mesh's colours end at 1.
pub(crate) fn relative_albedo(albedo: &Plane) -> Plane {
    let largest = albedo.data().iter().copied().fold(0.0, f32::max).max(f32::MIN_POSITIVE);
    let data = albedo.data().iter().map(|value| value / largest).collect();
    Plane::from_vec(albedo.width(), albedo.height(), data).unwrap_or_else(|| albedo.clone())
}
