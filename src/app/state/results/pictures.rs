//! Every plane of the results, ready to be shown: under a name that stays while its numbers change.

use std::collections::HashMap;
use std::sync::Arc;

use firstbounce_capture::pipeline::Separated;
use firstbounce_capture::set::{Shot, Subject, Word};
use firstbounce_core::stereo::shape::Shape;
use firstbounce_core::{Marks, NormalMap, Plane};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::nayar::ByNayar;
use super::run::{Loaded, Shapes};
use super::stage::Step;
use crate::app::base::jobs::drop_aside;
use crate::gpu::{CanvasMarks, CanvasPlane};

/// A shot by its words, as it survives an edit of others.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct ShotName {
    /// What it shows.
    #[serde(with = "subject_word")]
    pub subject: Subject,
    /// The light's name.
    pub light: Option<String>,
    /// The colour's name.
    pub colour: Option<String>,
}

mod subject_word {
    use super::{Subject, Word};
    use serde::{Deserialize, Deserializer, Serializer, de::Error};

    pub fn serialize<S: Serializer>(subject: &Subject, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(subject.word())
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Subject, D::Error> {
        let word = String::deserialize(deserializer)?;
        Subject::from_word(&word).ok_or_else(|| D::Error::custom("no such subject"))
    }
}

impl ShotName {
    /// The name of a shot of the set.
    pub fn of(shot: &Shot) -> Self {
        Self { subject: shot.subject, light: shot.light.clone(), colour: shot.colour.clone() }
    }
}

/// A plane of the results.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum PlaneName {
    /// Linear light.
    Photo(ShotName),
    /// Bounce k of a light, as it is saved; k counts from 1.
    Bounce(String, usize),
    /// Predicted noise of bounce 1 of a light.
    Noise(String),
    /// What the bounces leave of the photos.
    Residual(String),
    /// Bounce 1 with less noise.
    Direct(String),
    /// Direct light of a light, as Nayar's method finds it.
    NayarDirect(String),
    /// x, y or z of the normals.
    Normal(When, usize),
    /// Albedo.
    Albedo(When),
    /// Predicted noise of the normals in degrees.
    NormalNoise(When),
    /// By how many degrees taking the bounces out turned the normals; not a number where one of them is missing.
    Turned,
    /// Depth in the mesh's unit; not a number where there is none.
    Depth(When),
}

/// Marks of the results.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum MarksName {
    /// Clipped and dark pixels of a shot.
    Photo(ShotName),
    /// Of the separation of a light.
    Separation(String),
    /// Of the normals.
    Normals(When),
    /// 1 inside the object.
    Mask,
}

/// From the photos as they are, from bounce 1, or by the other method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum When {
    /// From the photos as they are.
    Before,
    /// From bounce 1.
    After,
    /// From the reference colour's photos by Nayar's method.
    Nayar,
}

impl When {
    /// The stage that gives it.
    pub fn stage(self) -> Step {
        match self {
            Self::Before | Self::After => Step::Shape,
            Self::Nayar => Step::Nayar,
        }
    }
}

/// A plane and where most of its values lie.
#[derive(Clone, Debug)]
pub struct Stored {
    /// The plane.
    pub plane: CanvasPlane,
    /// Lowest and highest value but for the outermost half percent.
    pub range: [f32; 2],
}

/// Every plane and all marks of the results.
#[derive(Default)]
pub struct Pictures {
    planes: HashMap<PlaneName, Stored>,
    marks: HashMap<MarksName, CanvasMarks>,
}

impl Pictures {
    /// A plane, if it was computed.
    pub fn plane(&self, name: &PlaneName) -> Option<&Stored> {
        self.planes.get(name)
    }

    /// Marks, if they were computed.
    pub fn marks(&self, name: &MarksName) -> Option<&CanvasMarks> {
        self.marks.get(name)
    }

    /// Takes the pictures that came with a result.
    pub(super) fn take_from<T>(&mut self, (result, batch): (T, Batch)) -> T {
        self.take(batch);
        result
    }

    /// Puts all pictures of one stage in place of those it gave before. The same name keeps its picture's key: the old
    /// numbers stay on screen until the new ones are on the card.
    fn take(&mut self, batch: Batch) {
        let stage = batch.stage;
        let old_planes: HashMap<_, _> = self.planes.extract_if(|name, _| name.stage() == stage).collect();
        for (name, plane, range) in batch.planes {
            let mut new = CanvasPlane::new(plane);
            if let Some(old) = old_planes.get(&name).filter(|old| old.plane.plane.size() == new.plane.size()) {
                new.key = old.plane.key.next_version();
            }
            self.planes.insert(name, Stored { plane: new, range });
        }
        let old_marks: HashMap<_, _> = self.marks.extract_if(|name, _| name.stage() == stage).collect();
        for (name, mut new) in batch.marks {
            if let Some(old) = old_marks.get(&name) {
                new.key = old.key.next_version();
            }
            self.marks.insert(name, new);
        }
        drop_aside((old_planes, old_marks));
    }
}

impl PlaneName {
    /// The stage that gives it.
    fn stage(&self) -> Step {
        match self {
            Self::Photo(_) => Step::Load,
            Self::Bounce(..) | Self::Noise(_) | Self::Residual(_) => Step::Separate,
            Self::Turned | Self::Direct(_) => Step::Shape,
            Self::NayarDirect(_) => Step::Nayar,
            Self::Normal(when, _) | Self::Albedo(when) | Self::NormalNoise(when) | Self::Depth(when) => when.stage(),
        }
    }
}

impl MarksName {
    fn stage(&self) -> Step {
        match self {
            Self::Photo(_) | Self::Mask => Step::Load,
            Self::Separation(_) => Step::Separate,
            Self::Normals(when) => when.stage(),
        }
    }
}

/// The pictures of one stage, gathered off the UI thread: at 24 megapixels even a copy of marks would be felt there.
pub struct Batch {
    stage: Step,
    planes: Vec<(PlaneName, Arc<Plane>, [f32; 2])>,
    marks: Vec<(MarksName, CanvasMarks)>,
}

impl Batch {
    fn new(stage: Step) -> Self {
        Self { stage, planes: Vec::new(), marks: Vec::new() }
    }

    pub fn of_loaded(loaded: &Loaded) -> Self {
        let mut batch = Self::new(Step::Load);
        for shot in &loaded.shots {
            if let Ok(photo) = &shot.photo {
                batch.put_ranged(PlaneName::Photo(shot.name.clone()), &photo.linear, shot.range);
                batch.put_marks(MarksName::Photo(shot.name.clone()), &photo.marks);
            }
        }
        if let Ok(object) = &loaded.object {
            batch.marks.push((MarksName::Mask, CanvasMarks::of_mask(&object.mask)));
        }
        batch
    }

    pub fn of_separated(lights: &[String], separated: &Separated) -> Self {
        let mut batch = Self::new(Step::Separate);
        for (light, separation) in lights.iter().zip(&separated.lights) {
            for (k, bounce) in (1..).zip(&separation.bounces) {
                batch.put(PlaneName::Bounce(light.clone(), k), bounce);
            }
            if let Some(noise) = &separation.direct_noise {
                batch.put(PlaneName::Noise(light.clone()), noise);
            }
            if let Some(residual) = &separation.residual {
                batch.put(PlaneName::Residual(light.clone()), residual);
            }
            batch.put_marks(MarksName::Separation(light.clone()), &separation.marks);
        }
        batch
    }

    pub fn of_shapes(lights: &[String], shapes: &Shapes) -> Self {
        let mut batch = Self::new(Step::Shape);
        for (light, direct) in lights.iter().zip(&shapes.direct) {
            batch.put(PlaneName::Direct(light.clone()), &direct.light);
        }
        batch.put_shape(When::After, &shapes.after);
        batch.put_shape(When::Before, &shapes.before);
        if let Some(turned) = turned(&shapes.before.normals.map, &shapes.after.normals.map) {
            batch.put(PlaneName::Turned, &turned);
        }
        batch
    }

    pub fn of_nayar(found: &ByNayar) -> Self {
        let mut batch = Self::new(Step::Nayar);
        for (light, direct) in &found.direct {
            batch.put(PlaneName::NayarDirect(light.clone()), direct);
        }
        batch.put_shape(When::Nayar, &found.shape);
        batch
    }

    fn put_shape(&mut self, when: When, shape: &Shape) {
        let normals = &shape.normals;
        for (axis, plane) in [normals.map.x(), normals.map.y(), normals.map.z()].into_iter().enumerate() {
            self.put_ranged(PlaneName::Normal(when, axis), plane, [-1.0, 1.0]);
        }
        self.put(PlaneName::Albedo(when), &normals.albedo);
        self.put(PlaneName::NormalNoise(when), &normals.noise_deg);
        self.put(PlaneName::Depth(when), &depth_where_known(shape));
        self.put_marks(MarksName::Normals(when), &normals.marks);
    }

    fn put(&mut self, name: PlaneName, plane: &Plane) {
        self.put_ranged(name, plane, range_of(plane));
    }

    fn put_ranged(&mut self, name: PlaneName, plane: &Plane, range: [f32; 2]) {
        self.planes.push((name, Arc::new(plane.clone()), range));
    }

    fn put_marks(&mut self, name: MarksName, marks: &Marks) {
        self.marks.push((name, CanvasMarks::new(marks.clone())));
    }
}

/// Angles between two maps of normals in degrees; not a number where one has none.
fn turned(before: &NormalMap, after: &NormalMap) -> Option<Plane> {
    let (width, height) = after.size();
    let angle = |index: usize| match (before.at_index(index), after.at_index(index)) {
        // The arc cosine of a float knows no angle below 0.02 degrees.
        (Some(a), Some(b)) => a.cross(&b).norm().atan2(a.dot(&b)).to_degrees(),
        _ => f32::NAN,
    };
    Plane::from_vec(width, height, (0..width * height).into_par_iter().map(angle).collect())
}

fn depth_where_known(shape: &Shape) -> Plane {
    let depth = &shape.depth;
    let known = |(z, known): (&f32, &bool)| if *known { *z } else { f32::NAN };
    let data = depth.depth_mm.data().par_iter().zip(depth.mask.data()).map(known).collect();
    Plane::from_vec(depth.depth_mm.width(), depth.depth_mm.height(), data).unwrap_or_else(|| depth.depth_mm.clone())
}

/// Lowest and highest value but for the outermost half percent, of values that are numbers and not zero: planes are zero
/// where they say nothing. [0, 1] where there is none.
pub fn range_of(plane: &Plane) -> [f32; 2] {
    // A sparse sample is enough to choose an exposure.
    let step = (plane.data().len() / 40_000).max(1);
    let mut sample: Vec<f32> =
        plane.data().iter().step_by(step).copied().filter(|value| value.is_finite() && *value != 0.0).collect();
    sample.sort_unstable_by(f32::total_cmp);
    let at = |share: f64| sample.get(((sample.len().saturating_sub(1)) as f64 * share).round() as usize).copied();
    match (at(0.005), at(0.995)) {
        (Some(low), Some(high)) if low < high => [low, high],
        (Some(low), Some(_)) => [low.min(0.0), low.max(f32::MIN_POSITIVE)],
        _ => [0.0, 1.0],
    }
}
