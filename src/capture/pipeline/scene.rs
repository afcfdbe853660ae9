//! A set's photos and rig together: what every step from photos to a surface looks at.

use std::borrow::Cow;

use firstbounce_core::stereo::normals::{DirectLight, Lamp};
use firstbounce_core::{Camera, Projection};
use nalgebra::{Point3, Vector3};

use super::{Calibrated, Direct, Known, ObjectPhotos, PipelineError};
use crate::set::{self, CaptureSet, Light};

/// A set, its photos and its rig. Photos are shared, so that a copy that looks at fewer of them costs little.
#[derive(Clone, Debug)]
pub struct Scene<'a> {
    /// What the capture file says.
    pub set: Cow<'a, CaptureSet>,
    /// What was photographed.
    pub object: Cow<'a, ObjectPhotos>,
    /// The rig.
    pub calibrated: Cow<'a, Calibrated>,
}

impl<'a> Scene<'a> {
    /// All of a set.
    pub fn of(set: &'a CaptureSet, object: &'a ObjectPhotos, calibrated: &'a Calibrated) -> Self {
        Self { set: Cow::Borrowed(set), object: Cow::Borrowed(object), calibrated: Cow::Borrowed(calibrated) }
    }

    /// The camera, for the size of the photos.
    pub fn camera(&self) -> Camera {
        camera_of(&self.set, self.object.mask.size())
    }

    /// alpha of every colour under light `l`.
    pub(super) fn alpha(&self, l: usize) -> Result<Vec<f64>, PipelineError> {
        self.calibrated.alpha_values(&self.set, l)
    }

    /// The reference colour's photos and calibration alone.
    pub(super) fn in_one_colour(self) -> Self {
        let mut object = self.object.into_owned();
        object.photos.iter_mut().for_each(|row| row.truncate(1));
        object.noise.iter_mut().for_each(|row| row.truncate(1));
        let mut calibrated = self.calibrated.into_owned();
        // Of the reference colour both are known, also where the balls or the file do not tell the others'.
        let alone = || Some(vec![Known::by_definition()]);
        calibrated.alpha.iter_mut().for_each(|alpha| *alpha = alone());
        calibrated.beta = alone();
        let set = Cow::Owned(self.set.in_one_colour());
        Self { set, object: Cow::Owned(object), calibrated: Cow::Owned(calibrated) }
    }

    /// The same without some lights, by their names. What the balls showed of single pixels is left behind.
    pub(super) fn without(self, lights: &[String]) -> Self {
        if lights.is_empty() {
            return self;
        }
        let used: Vec<_> = self.set.lights.iter().map(|light| !lights.contains(&light.name)).collect();
        let mut object = self.object.into_owned();
        (object.photos, object.noise) = (kept(&object.photos, &used), kept(&object.noise, &used));
        let of_all = &*self.calibrated;
        let calibrated = Calibrated {
            alpha: kept(&of_all.alpha, &used),
            beta: of_all.beta.clone(),
            crosstalk: of_all.crosstalk.clone(),
            intensity: kept(&of_all.intensity, &used),
            grey_light: of_all.grey_light,
            direction: kept(&of_all.direction, &used),
            circles: of_all.circles.clone(),
            warnings: of_all.warnings.clone(),
            ..Calibrated::default()
        };
        let set = Cow::Owned(self.set.without_lights(lights));
        Self { set, object: Cow::Owned(object), calibrated: Cow::Owned(calibrated) }
    }

    /// Light and lamps as photometric stereo takes them, without the lights that are left out. `lights` are those of the
    /// set, in its order.
    pub(super) fn direct_lights<'l>(
        &self,
        lights: &'l [Direct],
        left_out: &[String],
    ) -> Result<Vec<DirectLight<'l>>, PipelineError> {
        let used =
            self.set.lights.iter().zip(lights).enumerate().filter(|(_, (light, _))| !left_out.contains(&light.name));
        let direct = |(l, (light, direct)): (usize, (&Light, &'l Direct))| {
            Ok(DirectLight {
                direct: &direct.light,
                noise: direct.noise.as_ref(),
                marks: &direct.marks,
                lamp: lamp(light, &self.calibrated.direction[l])?,
                intensity: self.calibrated.intensity[l].value,
            })
        };
        used.map(direct).collect()
    }

    /// Where each lamp is and its intensity; `None` for one that is left out.
    pub(super) fn lamps(&self, left_out: &[String]) -> Result<Vec<Option<(Lamp, f64)>>, PipelineError> {
        let placed = |(l, light): (usize, &Light)| {
            if left_out.contains(&light.name) {
                return Ok(None);
            }
            Ok(Some((lamp(light, &self.calibrated.direction[l])?, self.calibrated.intensity[l].value)))
        };
        self.set.lights.iter().enumerate().map(placed).collect()
    }
}

/// Where a lamp is: its position if the set gives one, else its direction.
fn lamp(light: &Light, direction: &Option<Known<[f64; 3]>>) -> Result<Lamp, PipelineError> {
    match (light.position_mm, direction) {
        (Some(position), _) => Ok(Lamp::Near(Point3::from(position))),
        (None, Some(direction)) => Ok(Lamp::Distant(Vector3::from(direction.value))),
        (None, None) => Err(PipelineError::NoDirection { light: light.name.clone() }),
    }
}

fn kept<T: Clone>(all: &[T], used: &[bool]) -> Vec<T> {
    all.iter().zip(used).filter(|(_, used)| **used).map(|(item, _)| item.clone()).collect()
}

/// The set's camera for pictures of this size.
pub fn camera_of(set: &CaptureSet, size: (usize, usize)) -> Camera {
    let projection = match set.camera.projection {
        set::Projection::Orthographic { .. } => Projection::Orthographic { mm_per_pixel: set.mm_per_pixel() },
        set::Projection::Perspective { focal_length_px, principal_point, working_distance_mm } => {
            let [x, y] = principal_point.unwrap_or([size.0 as f64 / 2.0, size.1 as f64 / 2.0]);
            Projection::Perspective { focal_length_px, principal_point_px: (x, y), working_distance_mm }
        }
    };
    Camera { projection, size }
}
