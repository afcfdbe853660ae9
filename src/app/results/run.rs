//! The stages' work, by the pipeline that the command line runs.

use std::sync::{Arc, Mutex, PoisonError};

use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::{
    BallPhotos, Calibrated, Direct, MemoryOptions, ObjectLevels, ObjectPhotos, PipelineError, Preference, Separated,
    Work, calibrate_on, camera_of, check_memory, judge, load_object, load_subject, quiet_lights, raw_lights, recover,
    separate_lights, triangulate,
};
use firstbounce_capture::set::{Colour, Light, Shot, Subject};
use firstbounce_core::mesh::MeshOptions;
use firstbounce_core::shape::Shape;
use firstbounce_core::trust::{Trust, TrustOptions};
use firstbounce_core::{AngularError, Photo, Plane, Watch};
use rayon::prelude::*;

use super::pictures::{ShotName, range_of};
use super::{Calibration, Given, Meshes};
use crate::app::document::Document;
use crate::app::jobs::Job;

/// Every photo of the set, or why it could not be read.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// In the order of the set's shots.
    pub shots: Vec<LoadedShot>,
    /// The object's photos, noise and mask together, or why they do not fit together.
    pub object: Result<ObjectPhotos, String>,
    /// The object's mean light and its noise; empty where there is no object.
    pub levels: ObjectLevels,
    /// The balls' photos, so that a typed value or a moved circle reads no file again.
    balls: Arc<Mutex<BallPhotos>>,
    /// What a person should know of the files.
    pub warnings: Vec<String>,
}

/// One shot of the set.
#[derive(Clone, Debug)]
pub struct LoadedShot {
    /// Which one.
    pub name: ShotName,
    /// In linear light, or why not.
    pub photo: Result<Photo, String>,
    /// Where most of its values lie.
    pub range: [f32; 2],
}

impl Loaded {
    /// The shot of this name.
    pub fn shot(&self, name: &ShotName) -> Option<&LoadedShot> {
        self.shots.iter().find(|shot| shot.name == *name)
    }
}

/// Normals and depth.
#[derive(Clone, Debug)]
pub struct Shapes {
    /// By light: bounce 1 with less noise.
    pub direct: Vec<Direct>,
    /// How far that can be trusted.
    pub trust: Trust,
    /// From bounce 1.
    pub after: Shape,
    /// From the photos as they are.
    pub before: Shape,
    /// How far the normals turned; `None` where no pixel has both.
    pub turned: Option<AngularError>,
}

pub fn load(set: &CaptureSet, job: &Job) -> Result<Loaded, String> {
    check_memory(set, Work::Window, &MemoryOptions::default()).map_err(|shortage| line(shortage.into()))?;
    let right = set.check().is_empty();
    let object = if right { load_object(set, job).map_err(line) } else { Err("the set has errors".into()) };
    let mut warnings = object.as_ref().map(|object| object.warnings.clone()).unwrap_or_default();
    let balls = load_balls(set, right, job, &mut warnings)?;
    let mut shots = Vec::with_capacity(set.shots.len());
    for (index, shot) in set.shots.iter().enumerate() {
        if job.is_cancelled() {
            return Err("cancelled".into());
        }
        Watch::progress(job, index as f32 / set.shots.len() as f32);
        let name = ShotName::of(shot);
        let of_object = || object.as_ref().ok().and_then(|object| object_photo(set, object, shot));
        let known = of_object().or_else(|| ball_photo(set, &balls, shot));
        let photo = match known {
            Some(photo) => Ok(photo),
            None => load_shot(set, shot, job).map(|(photo, said)| {
                warnings.extend(said);
                photo
            }),
        };
        let range = photo.as_ref().map_or([0.0, 1.0], |photo| [0.0, white_of(shot.subject, &photo.linear)]);
        shots.push(LoadedShot { name, photo, range });
    }
    warnings.sort();
    warnings.dedup();
    let levels = object.as_ref().map(|object| ObjectLevels::of(set, object)).unwrap_or_default();
    Ok(Loaded { shots, object, levels, balls: Arc::new(Mutex::new(balls)), warnings })
}

/// What is shown as white. On a mirror ball the brightest spot matters, elsewhere all but it.
fn white_of(subject: Subject, photo: &Plane) -> f32 {
    if subject == Subject::MirrorSphere {
        photo.data().par_iter().copied().filter(|light| light.is_finite()).reduce(|| f32::MIN_POSITIVE, f32::max)
    } else {
        range_of(photo)[1]
    }
}

/// The photos of the balls that have shots of their own. Where one of a ball's photos cannot be read, every shot of it is
/// left to tell by itself what is wrong with it.
fn load_balls(set: &CaptureSet, right: bool, job: &Job, warnings: &mut Vec<String>) -> Result<BallPhotos, String> {
    let mut balls = BallPhotos::default();
    for subject in set.subjects().into_iter().filter(|subject| right && subject.sphere_kind().is_some()) {
        match load_subject(set, subject, job) {
            Ok(photos) => {
                warnings.extend_from_slice(&photos.warnings);
                balls.put(subject, Arc::new(photos));
            }
            Err(PipelineError::Cancelled) => return Err(line(PipelineError::Cancelled)),
            Err(_) => {}
        }
    }
    Ok(balls)
}

fn ball_photo(set: &CaptureSet, balls: &BallPhotos, shot: &Shot) -> Option<Photo> {
    let light = shot.light.as_deref().and_then(|name| set.light_index(name)).unwrap_or_default();
    let colour = shot.colour.as_deref().and_then(|name| set.colour_index(name));
    balls.of(shot.subject)?.photo(light, colour).cloned()
}

fn object_photo(set: &CaptureSet, object: &ObjectPhotos, shot: &Shot) -> Option<Photo> {
    let light = set.light_index(shot.light.as_deref().filter(|_| shot.subject == Subject::Object)?)?;
    let colour = set.colour_index(shot.colour.as_deref()?)?;
    object.photos.get(light)?.get(colour).cloned()
}

/// One shot by itself, whatever is wrong with the rest of the set.
fn load_shot(set: &CaptureSet, shot: &Shot, job: &Job) -> Result<(Photo, Vec<String>), String> {
    // Dark frames and flat fields are shown as they are; all others corrected by them.
    let correction =
        |other: &&Shot| matches!(other.subject, Subject::Dark | Subject::FlatField) && other.subject != shot.subject;
    let shown = Shot { subject: Subject::MirrorSphere, ..shot.clone() };
    let light = shot.light.clone().unwrap_or_default();
    let colour = shot.colour.clone().unwrap_or_default();
    let channel = set.channel_of(shot);
    let alone = CaptureSet {
        folder: set.folder.clone(),
        camera: set.camera.clone(),
        lights: vec![Light { name: light, ..Light::default() }],
        colours: vec![Colour { name: colour, channel }],
        shots: set.shots.iter().filter(correction).cloned().chain([shown]).collect(),
        ..CaptureSet::default()
    };
    let photos = load_subject(&alone, Subject::MirrorSphere, job).map_err(line)?;
    let photo = photos.all().next().cloned().ok_or("this shot has no file")?;
    Ok((photo, photos.warnings))
}

/// The rig by the balls, or by the file first.
pub fn calibration(
    set: &CaptureSet,
    preference: Preference,
    loaded: &Loaded,
    job: &Job,
) -> Result<Calibration, String> {
    let photos = {
        let mut kept = loaded.balls.lock().unwrap_or_else(PoisonError::into_inner);
        kept.load_missing(set, preference, job).map_err(line)?;
        kept.clone()
    };
    Ok(Calibration {
        lights: set.lights.iter().map(|light| light.name.clone()).collect(),
        colours: set.colours.iter().map(|colour| colour.name.clone()).collect(),
        calibrated: calibrate_on(set, preference, &photos).map_err(line)?,
        given: Given { values: set.calibration.clone(), lights: set.lights.clone() },
    })
}

pub fn separate(
    set: &CaptureSet,
    loaded: &Loaded,
    calibration: &Calibration,
    bounces: usize,
    job: &Job,
) -> Result<Separated, String> {
    let object = loaded.object.as_ref().map_err(Clone::clone)?;
    separate_lights(set, object, &calibration.calibrated, bounces, job).map_err(line)
}

pub fn shape(
    document: &Document,
    loaded: &Loaded,
    calibration: &Calibration,
    separated: &Separated,
    job: &Job,
) -> Result<Shapes, String> {
    let object = loaded.object.as_ref().map_err(Clone::clone)?;
    let (set, calibrated) = (&document.set, &calibration.calibrated);
    let options = document.settings.shape.options();
    let direct = quiet_lights(set, object, calibrated, separated, &options.indirect, job).map_err(line)?;
    let bounces = separated.reports.first().map_or(1, |report| report.bounces);
    let trust_options = TrustOptions { bounces, indirect: options.indirect, ..TrustOptions::default() };
    let trust = judge(set, &loaded.levels, calibrated, &trust_options).map_err(line)?;
    let raw = raw_lights(object, job).map_err(line)?;
    let camera = camera_of(set, object.mask.size());

    // Lights that are left out are left out of both, so that before and after differ by the bounces alone.
    let Used { set, calibrated, used } = Used::of(document, calibrated);
    let surface = |lights: &[Direct]| {
        recover(&set, object, &calibrated, &kept(lights, &used), &camera, &options.shape, job).map_err(line)
    };
    let after = surface(&direct)?;
    let before = surface(&raw)?;
    let turned = before.normals.map.angular_error(&after.normals.map, &after.normals.solved());
    Ok(Shapes { direct, trust, after, before, turned })
}

/// The lights that photometric stereo uses, and what is known of them.
pub(super) struct Used {
    pub set: CaptureSet,
    pub calibrated: Calibrated,
    /// By light of the document's set.
    pub used: Vec<bool>,
}

impl Used {
    pub fn of(document: &Document, calibrated: &Calibrated) -> Self {
        let set = &document.set;
        let used: Vec<_> = set.lights.iter().map(|l| !document.settings.shape.left_out.contains(&l.name)).collect();
        let calibrated = Calibrated {
            direction: kept(&calibrated.direction, &used),
            intensity: kept(&calibrated.intensity, &used),
            ..calibrated.clone()
        };
        Self { set: document.used_set(), calibrated, used }
    }
}

pub(super) fn kept<T: Clone>(all: &[T], used: &[bool]) -> Vec<T> {
    all.iter().zip(used).filter(|(_, used)| **used).map(|(item, _)| item.clone()).collect()
}

pub fn meshes(set: &CaptureSet, shapes: &Shapes) -> Result<Meshes, String> {
    let camera = camera_of(set, shapes.after.depth.mask.size());
    let mesh = |shape| triangulate(shape, &camera, &MeshOptions::default()).map_err(line);
    Ok(Meshes { after: mesh(&shapes.after)?, before: mesh(&shapes.before)? })
}

pub(super) fn line(error: PipelineError) -> String {
    error.to_string().replace('\n', " ")
}
