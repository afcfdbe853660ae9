//! Photos to linear light.

use std::sync::Arc;

use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::{
    CaptureCheck, CheckOptions, CheckedPhotos, MemoryOptions, ObjectLevels, ObjectPhotos, PhotoStore, PipelineError,
    Preference, ShotLight, SubjectPhotos, Work as MemoryWork, check_memory, with_crosstalk,
};
use firstbounce_capture::set::{Projection, Shot, Subject};
use firstbounce_core::{Photo, Plane};
use rayon::prelude::*;

use super::{Step, without_given};
use crate::app::base::jobs::Job;
use crate::app::state::document::Document;
use crate::app::state::results::Results;
use crate::app::state::results::engine::{AnyKey, Done, Known, Stage, Work};
use crate::app::state::results::error::StageError;
use crate::app::state::results::pictures::{Batch, MarksName, PlaneName, ShotName, range_of};
use crate::gpu::CanvasMarks;

/// Every photo of the set, or why it could not be read.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// In the order of the set's shots.
    pub shots: Vec<LoadedShot>,
    /// The object's photos, noise and mask together, or why they do not fit together.
    pub object: Result<Arc<ObjectPhotos>, StageError>,
    /// The object's mean light and its noise; empty where there is no object.
    pub levels: ObjectLevels,
    /// What is wrong with the captures, as far as the photos alone show it.
    pub captures: CheckedPhotos,
    /// What the user should know of the files.
    pub warnings: Vec<String>,
}

/// One shot of the set.
#[derive(Clone, Debug)]
pub struct LoadedShot {
    /// Which one.
    pub name: ShotName,
    /// In linear light, or why not.
    pub photo: Result<Arc<Photo>, StageError>,
    /// What its light was divided by.
    pub exposure: f64,
    /// What its files say of themselves, in words.
    pub files: Vec<String>,
    /// Where most of its values lie.
    pub range: [f32; 2],
}

impl Loaded {
    /// The shot of this name.
    pub fn shot(&self, name: &ShotName) -> Option<&LoadedShot> {
        self.shots.iter().find(|shot| shot.name == *name)
    }

    /// Whether anything of the photos calls for care.
    pub fn has_warnings(&self) -> bool {
        !self.warnings.is_empty() || !self.captures.report.warnings.is_empty()
    }
}

/// The stage.
pub struct Load;

#[derive(PartialEq)]
struct Key {
    /// The set, reduced to what decides over the photos.
    set: CaptureSet,
    reloads: u64,
}

impl Stage for Load {
    fn step(&self) -> Step {
        Step::Load
    }

    fn needs(&self) -> Option<Step> {
        None
    }

    fn title(&self) -> String {
        "Loading".into()
    }

    fn job_name(&self, _: &Document) -> String {
        "Read photos".into()
    }

    fn key(&self, known: &Known) -> Option<AnyKey> {
        Some(AnyKey::new(Key { set: photos_of(&known.document.set), reloads: known.results.reloads }))
    }

    fn work(&self, document: Arc<Document>, results: &Results) -> Option<Work> {
        let store = results.photos.clone();
        Some(Box::new(move |job| {
            let loaded = load(&document.set, &store, job)?;
            let pictures = pictures(&loaded);
            let warnings = [loaded.captures.report.lines(), loaded.warnings.clone()].concat();
            Ok(Done::new(loaded).with_pictures(pictures).with_warnings(warnings))
        }))
    }
}

/// What decides over the photos in linear light.
fn photos_of(set: &CaptureSet) -> CaptureSet {
    let mut set = without_given(set);
    set.camera.projection = Projection::default();
    set.lights.iter_mut().for_each(|light| light.position_mm = None);
    set.spheres.clear();
    set.name.clear();
    set
}

fn pictures(loaded: &Loaded) -> Batch {
    let mut batch = Batch::new(Step::Load);
    for shot in &loaded.shots {
        if let Ok(photo) = &shot.photo {
            batch.put_ranged(PlaneName::Photo(shot.name.clone()), &photo.linear, shot.range);
            batch.put_marks(MarksName::Photo(shot.name.clone()), &photo.marks);
        }
    }
    if let Ok(object) = &loaded.object {
        batch.put_mask(CanvasMarks::of_mask(&object.mask));
    }
    batch
}

fn load(set: &CaptureSet, store: &PhotoStore, job: &Job) -> Result<Loaded, StageError> {
    check_memory(set, MemoryWork::Window, &MemoryOptions::default()).map_err(PipelineError::from)?;
    let shots: Vec<&Shot> = set.shots.iter().collect();
    // What is gone or was changed since it was read is read again, or is an error.
    store.keep_only(set);
    let lights = store.read(set, &shots, job)?;
    let check = CaptureCheck::new(set, &CheckOptions::default()).map_err(PipelineError::CheckOption)?;
    lights.par_iter().enumerate().for_each(|(shot, light)| check.look_at(shot, light));
    let captures = check.finish(job)?;
    let all: Vec<_> = shots.into_iter().zip(lights).collect();
    let object = object(set, store, job, &all);
    let mut warnings = object.as_ref().map(|object| object.warnings.clone()).unwrap_or_default();
    warnings.sort();
    warnings.dedup();
    let levels = object.as_ref().map(|object| ObjectLevels::of(set, object)).unwrap_or_default();
    Ok(Loaded {
        shots: all.par_iter().map(|(shot, light)| loaded_shot(shot, light)).collect(),
        object,
        levels,
        captures,
        warnings,
    })
}

fn object(
    set: &CaptureSet,
    store: &PhotoStore,
    job: &Job,
    all: &[(&Shot, ShotLight)],
) -> Result<Arc<ObjectPhotos>, StageError> {
    if let Some(problem) = set.check().into_iter().next() {
        return Err(StageError::Set(problem));
    }
    let of_object: Vec<_> = all.iter().filter(|(shot, _)| shot.subject == Subject::Object).cloned().collect();
    let (set, _) = with_crosstalk(set, Preference::File, store, job)?;
    let photos = SubjectPhotos::of(&set, Subject::Object, &of_object)?;
    Ok(Arc::new(ObjectPhotos::of(&set, photos)?))
}

fn loaded_shot(shot: &Shot, light: &ShotLight) -> LoadedShot {
    let photo = light.as_ref().map(|light| light.photo.clone());
    let photo = photo.map_err(|error| PipelineError::Photo(error.clone()).into());
    let range = photo.as_ref().map_or([0.0, 1.0], |photo| [0.0, white_of(shot.subject, &photo.linear)]);
    let light = light.as_ref().ok();
    let exposure = light.map_or(1.0, |light| f64::from(light.exposure));
    let files = light.map(|light| light.files.iter().map(|(_, metadata)| metadata.to_string()).collect());
    LoadedShot { name: ShotName::of(shot), photo, exposure, files: files.unwrap_or_default(), range }
}

/// What is shown as white. On a mirror ball the brightest spot matters, elsewhere all but it.
fn white_of(subject: Subject, photo: &Plane) -> f32 {
    if subject.is_shiny_ball() {
        photo.data().par_iter().copied().filter(|light| light.is_finite()).reduce(|| f32::MIN_POSITIVE, f32::max)
    } else {
        range_of(photo)[1]
    }
}
