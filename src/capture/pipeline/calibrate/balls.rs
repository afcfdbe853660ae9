//! The balls of a set: their photos and their circles.

use std::sync::Arc;

use firstbounce_core::sphere::{Ball, Circle, CircleOptions, CircleReport, View, find_circle, refine_circle};
use firstbounce_core::{Camera, Photo, Plane};
use indexmap::IndexMap;

use super::super::{PhotoStore, PipelineError, PipelineWatch, SubjectPhotos, camera_of, load_subject};
use super::{BallCircle, Preference};
use crate::set::{self, BallValue, CaptureSet, Projection, Sphere, SphereKind, Subject, Word};

/// Standard deviation of a circle that the file gives, in pixels: the program wrote it, or the user snapped it to the edge.
const GIVEN_CIRCLE_SD_PX: f64 = 0.1;

/// An edge that contradicts a given circle has to show on more of the rim than one that is looked for: what is reflected
/// in a mirror ball is round too.
const MIN_RIM_TO_CONTRADICT: f64 = 0.4;

/// The photos of the balls that a calibration needs.
pub(super) struct BallPhotos(IndexMap<Subject, Arc<SubjectPhotos>>);

impl BallPhotos {
    pub fn load(
        set: &CaptureSet,
        preference: Preference,
        store: &PhotoStore,
        watch: &dyn PipelineWatch,
    ) -> Result<Self, PipelineError> {
        let mut photos = IndexMap::new();
        for subject in needed_subjects(set, preference) {
            if !photos.contains_key(&subject) {
                photos.insert(subject, Arc::new(load_subject(set, subject, store, watch)?));
            }
        }
        Ok(Self(photos))
    }

    /// The photos of every subject that was read.
    pub fn by_subject(&self) -> impl Iterator<Item = (Subject, &SubjectPhotos)> {
        self.0.iter().map(|(subject, photos)| (*subject, &**photos))
    }
}

/// The balls that have to be looked at: all, or those whose values the file does not give.
pub(super) fn needed(set: &CaptureSet, preference: Preference) -> Vec<SphereKind> {
    let given = &set.calibration;
    let all = |known: &dyn Fn(&str) -> bool| set.lights.iter().all(|light| known(&light.name));
    let balls_only = preference != Preference::File;
    let values = [
        (BallValue::Alpha, set.colours.len() > 1 && !all(&|light| given.alpha.contains_key(light))),
        (BallValue::Beta, set.colours.len() > 1 && given.beta.is_none()),
        (BallValue::Intensity, !all(&|light| given.intensity.contains_key(light))),
        (BallValue::Direction, !all(&|light| set.given_direction(light).is_some())),
    ];
    let is_needed = |kind: &SphereKind| values.iter().any(|(value, open)| (*open || balls_only) && kind.gives(*value));
    SphereKind::ALL.iter().copied().filter(is_needed).collect()
}

/// The subjects whose photos show the balls that have to be looked at, each once.
pub(in crate::pipeline) fn needed_subjects(set: &CaptureSet, preference: Preference) -> Vec<Subject> {
    let needed = needed(set, preference);
    let mut subjects: Vec<_> = needed.iter().filter_map(|kind| set.subject_with(*kind)).collect();
    if needed.contains(&SphereKind::Mirror) && set.shots_of(Subject::MirrorSphereMoved).next().is_some() {
        subjects.push(Subject::MirrorSphereMoved);
    }
    subjects.sort_unstable();
    subjects.dedup();
    subjects
}

/// A ball, its photos and its circle.
pub(super) struct BallShots {
    pub kind: SphereKind,
    photos: Arc<SubjectPhotos>,
    pub ball: Ball,
    pub circle_sd_px: f64,
    pub circle: BallCircle,
    /// The ball's radius, where the scale is known.
    radius_mm: Option<f64>,
}

impl BallShots {
    /// The ball of this kind among the photos that were read; `None` where the set has none.
    pub fn among(photos: &BallPhotos, set: &CaptureSet, kind: SphereKind) -> Result<Option<Self>, PipelineError> {
        set.subject_with(kind).map_or(Ok(None), |subject| Self::in_shots_of(photos, set, (subject, kind)))
    }

    /// The mirror ball in its second place; `None` where the set has no photos of it there.
    pub fn moved(photos: &BallPhotos, set: &CaptureSet) -> Result<Option<Self>, PipelineError> {
        Self::in_shots_of(photos, set, (Subject::MirrorSphereMoved, SphereKind::Mirror))
    }

    fn in_shots_of(
        photos: &BallPhotos,
        set: &CaptureSet,
        (subject, kind): (Subject, SphereKind),
    ) -> Result<Option<Self>, PipelineError> {
        let Some(photos) = photos.0.get(&subject).cloned() else { return Ok(None) };
        let circle = match set.spheres_in(subject).find(|sphere| sphere.kind == kind) {
            Some(sphere) => given(&photos, *sphere),
            None => find(&photos, subject, kind)?,
        };
        Ok(Some(Self::with_circle(photos, set, circle)))
    }

    /// The further balls of this kind in the same pictures, all of them given.
    pub fn others(&self, set: &CaptureSet) -> Vec<Self> {
        let Sphere { subject, kind, .. } = self.circle.sphere;
        let spheres = set.spheres_in(subject).filter(|sphere| sphere.kind == kind).skip(1);
        spheres.map(|sphere| Self::with_circle(self.photos.clone(), set, given(&self.photos, *sphere))).collect()
    }

    fn with_circle(photos: Arc<SubjectPhotos>, set: &CaptureSet, circle: BallCircle) -> Self {
        let size = size_of(&photos);
        let outline = outline(circle.sphere.circle);
        Self {
            kind: circle.sphere.kind,
            photos,
            ball: Ball::new(outline, view(set, size)),
            circle_sd_px: match (&circle.found, circle.doubt()) {
                (Some(found), _) => found.sd_px,
                (None, Some(doubt)) => doubt.off_px,
                (None, None) => GIVEN_CIRCLE_SD_PX,
            },
            radius_mm: set.mm_per_pixel().map(|scale| scale * outline.radius_px),
            circle,
        }
    }

    /// The camera that took the pictures, where their scale is known.
    pub fn camera(&self, set: &CaptureSet) -> Option<Camera> {
        set.mm_per_pixel()?;
        Some(camera_of(set, self.size()))
    }

    /// Width and height of the pictures.
    pub fn size(&self) -> (usize, usize) {
        size_of(&self.photos)
    }

    /// The photo under light `l` in colour `c`, or, where shots name no colour, the one photo under the light.
    pub fn photo(&self, l: usize, c: usize) -> Option<&Photo> {
        self.photos.photo(l, Some(c)).or_else(|| self.photos.photo(l, None))
    }

    /// One photo for each other light.
    pub fn under_other_lights(&self, l: usize, lights: usize) -> Vec<&Photo> {
        (0..lights).filter(|&other| other != l).filter_map(|other| self.photos.under(other).next()).collect()
    }

    /// A photo under the light, in the reference colour if there is a choice.
    pub fn any_photo(&self, l: usize) -> Option<&Photo> {
        self.photo(l, 0).or_else(|| self.photos.under(l).next())
    }

    /// The distance of a lamp in radii of the ball, for a ball in the object's place.
    pub fn lamp_distance_radii(&self, position_mm: [f64; 3]) -> Option<f64> {
        let distance = position_mm.iter().map(|x| x * x).sum::<f64>().sqrt();
        Some(distance / self.radius_mm?)
    }

    /// The ball's radius in mm, where the scale is known.
    pub fn radius_mm(&self) -> Option<f64> {
        self.radius_mm
    }
}

fn find(photos: &SubjectPhotos, subject: Subject, kind: SphereKind) -> Result<BallCircle, PipelineError> {
    let planes: Vec<&Plane> = photos.all().map(|photo| &photo.linear).collect();
    let found = find_circle(&planes, None, &CircleOptions::default())
        .map_err(|reason| PipelineError::Ball { subject, reason })?;
    let (x, y) = found.circle.centre_px;
    let circle = set::Circle { centre: [x, y], radius: found.circle.radius_px };
    Ok(BallCircle { sphere: Sphere { subject, kind, circle, diameter_mm: None }, found: Some(found), edge: None })
}

fn size_of(photos: &SubjectPhotos) -> (usize, usize) {
    photos.all().next().map_or((0, 0), |photo| photo.linear.size())
}

fn outline(circle: set::Circle) -> Circle {
    Circle { centre_px: (circle.centre[0], circle.centre[1]), radius_px: circle.radius }
}

fn given(photos: &SubjectPhotos, sphere: Sphere) -> BallCircle {
    BallCircle { sphere, found: None, edge: edge_near(photos, &outline(sphere.circle)) }
}

/// The edge under a given circle; `None` where none shows, as on a mirror ball before black.
fn edge_near(photos: &SubjectPhotos, given: &Circle) -> Option<CircleReport> {
    let planes: Vec<&Plane> = photos.all().map(|photo| &photo.linear).collect();
    let options = CircleOptions { min_rim_seen: MIN_RIM_TO_CONTRADICT, ..CircleOptions::default() };
    refine_circle(&planes, given, &options).ok()
}

/// The circle of a ball: the one that the set gives, else the one that its edge shows.
///
/// # Errors
/// `NoBall` for a set without it, and what [`super::calibrate`] says of its photos and its edge.
pub fn circle_of(set: &CaptureSet, kind: SphereKind, watch: &dyn PipelineWatch) -> Result<set::Circle, PipelineError> {
    let subject = set.subject_with(kind).ok_or(PipelineError::NoBall { ball: kind })?;
    if let Some(circle) = set.circle(subject, kind) {
        return Ok(circle);
    }
    let photos = load_subject(set, subject, &PhotoStore::default(), watch)?;
    Ok(find(&photos, subject, kind)?.sphere.circle)
}

/// How the camera sees a ball whose pictures have this size. Pictures that do not hold the optical axis are cut-outs from
/// unknown places: there lines of sight count as parallel.
pub(in crate::pipeline) fn view(set: &CaptureSet, size: (usize, usize)) -> View {
    match set.camera.projection {
        Projection::Orthographic { .. } => View::Orthographic,
        Projection::Perspective { focal_length_px, principal_point, .. } => {
            let (width, height) = (size.0 as f64, size.1 as f64);
            let [x, y] = principal_point.unwrap_or([width / 2.0, height / 2.0]);
            if x < width && y < height {
                View::Perspective { focal_length_px, principal_point_px: (x, y) }
            } else {
                View::Orthographic
            }
        }
    }
}
