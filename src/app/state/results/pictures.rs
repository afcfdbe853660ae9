//! Every plane of the results, ready to be shown: under a name that stays while its numbers change.

use std::collections::HashMap;
use std::sync::Arc;

use firstbounce_capture::pipeline::SurfaceName;
use firstbounce_capture::set::{Shot, Subject, Word};
use firstbounce_core::stereo::shape::Shape;
use firstbounce_core::{Marks, Plane};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{Plain, PlainPicture, Step};
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
    /// x, y or z of the normals.
    Normal(SurfaceName, usize),
    /// By how many degrees taking the bounces out turned the normals; not a number where one of them is missing.
    Turned,
    /// A row of the table of plain pictures.
    Plain(PlainPicture),
}

impl From<PlainPicture> for PlaneName {
    fn from(picture: PlainPicture) -> Self {
        Self::Plain(picture)
    }
}

/// Marks of the results.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum MarksName {
    /// Clipped and dark pixels of a shot.
    Photo(ShotName),
    /// Of the separation of a light.
    Separation(String),
    /// Of the normals.
    Normals(SurfaceName),
    /// 1 inside the object.
    Mask,
}

/// The stage that gives a surface.
pub fn stage_of(surface: SurfaceName) -> Step {
    surface.other_method().map_or(Step::Shape, Step::ByMethod)
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

    /// Puts all pictures of one stage in place of those it gave before. The same name keeps its picture's key: the old
    /// numbers stay on screen until the new ones are on the card.
    pub(super) fn take(&mut self, batch: Batch) {
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
            Self::Bounce(..) => Step::Separate,
            Self::Normal(name, _) => stage_of(*name),
            Self::Turned => Step::Shape,
            Self::Plain(picture) => picture.step(),
        }
    }
}

impl MarksName {
    fn stage(&self) -> Step {
        match self {
            Self::Photo(_) | Self::Mask => Step::Load,
            Self::Separation(_) => Step::Separate,
            Self::Normals(name) => stage_of(*name),
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
    pub fn new(stage: Step) -> Self {
        Self { stage, planes: Vec::new(), marks: Vec::new() }
    }

    pub fn put_shape(&mut self, name: SurfaceName, shape: &Shape) {
        let normals = &shape.normals;
        for (axis, plane) in [normals.map.x(), normals.map.y(), normals.map.z()].into_iter().enumerate() {
            self.put_ranged(PlaneName::Normal(name, axis), plane, [-1.0, 1.0]);
        }
        self.put(Plain::Albedo.of(name), &normals.albedo);
        self.put(Plain::NormalNoise.of(name), &normals.noise_deg);
        self.put(Plain::Depth.of(name), &depth_where_known(shape));
        self.put_marks(MarksName::Normals(name), &normals.marks);
    }

    pub fn put(&mut self, name: impl Into<PlaneName>, plane: &Plane) {
        self.put_ranged(name.into(), plane, range_of(plane));
    }

    pub fn put_ranged(&mut self, name: PlaneName, plane: &Plane, range: [f32; 2]) {
        self.planes.push((name, Arc::new(plane.clone()), range));
    }

    pub fn put_mask(&mut self, mask: CanvasMarks) {
        self.marks.push((MarksName::Mask, mask));
    }

    pub fn put_marks(&mut self, name: MarksName, marks: &Marks) {
        self.marks.push((name, CanvasMarks::new(marks.clone())));
    }
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
