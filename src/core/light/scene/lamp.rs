//! Lamps, and the light they throw on a point directly.

use nalgebra::{Point3, Unit, Vector3};
use rayon::prelude::*;

use super::SceneError;
use crate::light::radiosity::{Occluders, Patch, Patches};
use crate::options::check_range;

/// A lamp's light is divided by the square of its distance, and multiplied by that of another.
const MIN_DISTANCE_MM: f64 = 1e-6;
const MAX_PLACE_MM: f64 = 1e8;
/// Relative to the first light, and far beyond any lamp.
const MAX_INTENSITY: f64 = 1e9;

/// A lamp. Its intensity is the irradiance of a facet at the origin that faces it, with nothing between.
#[derive(Clone, Debug, PartialEq)]
pub enum Lamp {
    /// So far away that its rays are parallel.
    Directional {
        /// From the object to the light, unit length.
        direction_to_light: Unit<Vector3<f64>>,
        /// Irradiance of a facet that faces it.
        intensity: f64,
    },
    /// A small lamp that shines equally to all sides.
    Point {
        /// Where it is.
        position_mm: Point3<f64>,
        /// Irradiance of a facet at the origin that faces it.
        intensity: f64,
    },
    /// A Lambertian rectangle that shines to the side of `half_width_mm x half_height_mm`.
    Area {
        /// Its centre.
        centre_mm: Point3<f64>,
        /// From the centre to the middle of one side.
        half_width_mm: Vector3<f64>,
        /// From the centre to the middle of the next side.
        half_height_mm: Vector3<f64>,
        /// Irradiance of a facet at the origin that faces its centre.
        intensity: f64,
        /// Points along each side that stand for it; 8 make 64 rays and shadows of 64 steps.
        points_per_side: usize,
    },
}

/// A point of a lamp, or a direction.
#[derive(Clone, Copy, Debug)]
enum Source {
    Far { direction_to_light: Unit<Vector3<f64>>, strength: f64 },
    Near { position: Point3<f64>, axis: Option<Unit<Vector3<f64>>>, strength_mm2: f64 },
}

/// A lamp broken down into sources without extent.
#[derive(Clone, Debug)]
pub(super) struct Sources(Vec<Source>);

/// A point that receives light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Receiver {
    /// Where light arrives.
    pub(super) point: Point3<f64>,
    /// Unit normal there.
    pub(super) normal: Unit<Vector3<f64>>,
    /// The patch it lies on, which cannot shade it.
    pub(super) patch: usize,
}

impl Receiver {
    /// Whether another point lies on the same smooth surface: about the same normal, and no step between them.
    pub(super) fn continues(&self, other: &Receiver) -> bool {
        let across = other.point - self.point;
        self.normal.dot(&other.normal) > 0.985 && self.normal.dot(&across).abs() <= 0.3 * across.norm()
    }
}

impl Lamp {
    /// Irradiance of a facet at the origin that faces it.
    pub fn intensity(&self) -> f64 {
        match self {
            Self::Directional { intensity, .. } | Self::Point { intensity, .. } | Self::Area { intensity, .. } => {
                *intensity
            }
        }
    }

    /// Where it is; of an area lamp its centre. `None` for a distant lamp.
    pub fn position_mm(&self) -> Option<Point3<f64>> {
        match self {
            Self::Directional { .. } => None,
            Self::Point { position_mm, .. } => Some(*position_mm),
            Self::Area { centre_mm, .. } => Some(*centre_mm),
        }
    }

    /// As photometric stereo takes it; an area lamp as its centre.
    pub fn stereo(&self) -> crate::stereo::normals::Lamp {
        match self.position_mm() {
            Some(position_mm) => crate::stereo::normals::Lamp::Near(position_mm),
            None => crate::stereo::normals::Lamp::Distant(self.direction_to_light().into_inner()),
        }
    }

    /// From the origin to the light.
    pub fn direction_to_light(&self) -> Unit<Vector3<f64>> {
        match self {
            Self::Directional { direction_to_light, .. } => *direction_to_light,
            Self::Point { position_mm: place, .. } | Self::Area { centre_mm: place, .. } => {
                Unit::new_normalize(place.coords)
            }
        }
    }

    /// Whether the lamp can shine on the origin.
    pub fn check(&self) -> Result<(), SceneError> {
        let intensity = self.intensity();
        check_range("intensity", intensity, (0.0..=MAX_INTENSITY).contains(&intensity), "from 0 to 1e9")?;
        if let Some(position) = self.position_mm() {
            let far_mm = position.coords.amax();
            let range = "at most 1e8 mm; give the direction of a lamp so far away";
            check_range("a coordinate of the lamp", far_mm, far_mm <= MAX_PLACE_MM, range)?;
        }
        match self {
            Self::Directional { direction_to_light, .. } => {
                let length = direction_to_light.norm();
                check_range("the length of direction_to_light", length, (length - 1.0).abs() <= 1e-6, "1")?;
            }
            Self::Point { position_mm, .. } => {
                let distance_mm = position_mm.coords.norm();
                check_range(
                    "the distance of the lamp",
                    distance_mm,
                    distance_mm >= MIN_DISTANCE_MM,
                    "at least 1e-6 mm",
                )?;
            }
            Self::Area { centre_mm, half_width_mm, half_height_mm, points_per_side, .. } => {
                let points = *points_per_side;
                check_range("points_per_side", points as f64, (1..=64).contains(&points), "between 1 and 64")?;
                let toward_origin = -half_width_mm.cross(half_height_mm).dot(&centre_mm.coords);
                let range = "its front; swap width and height";
                check_range("the side an area lamp turns to the origin", toward_origin, toward_origin > 0.0, range)?;
            }
        }
        Ok(())
    }

    pub(super) fn sources(&self) -> Result<Sources, SceneError> {
        self.check()?;
        Ok(Sources(match *self {
            Self::Directional { direction_to_light, intensity } => {
                vec![Source::Far { direction_to_light, strength: intensity }]
            }
            Self::Point { position_mm, intensity } => {
                let strength_mm2 = intensity * position_mm.coords.norm_squared();
                vec![Source::Near { position: position_mm, axis: None, strength_mm2 }]
            }
            Self::Area { centre_mm, half_width_mm, half_height_mm, intensity, points_per_side } => {
                let axis = Unit::new_normalize(half_width_mm.cross(&half_height_mm));
                let at = |k: usize| (2 * k + 1) as f64 / points_per_side as f64 - 1.0;
                let position = |k: usize| {
                    let (i, j) = (k % points_per_side, k / points_per_side);
                    centre_mm + half_width_mm * at(i) + half_height_mm * at(j)
                };
                let count = points_per_side * points_per_side;
                let source = |k| Source::Near { position: position(k), axis: Some(axis), strength_mm2: 1.0 };
                let unscaled: Vec<Source> = (0..count).map(source).collect();
                let facing = Unit::new_normalize(centre_mm.coords);
                let at_origin: f64 = unscaled.iter().map(|source| source.arriving(&Point3::origin(), &facing).0).sum();
                let strength_mm2 = intensity / at_origin;
                (0..count).map(|k| Source::Near { position: position(k), axis: Some(axis), strength_mm2 }).collect()
            }
        }))
    }
}

impl Source {
    /// Irradiance at a point with nothing between, and the unit direction to the source with the distance.
    fn arriving(&self, point: &Point3<f64>, normal: &Unit<Vector3<f64>>) -> (f64, Vector3<f64>, f64) {
        match *self {
            Self::Far { direction_to_light, strength } => {
                (strength * normal.dot(&direction_to_light).max(0.0), direction_to_light.into_inner(), f64::INFINITY)
            }
            Self::Near { position, axis, strength_mm2 } => {
                let across = position - point;
                let distance = across.norm();
                let direction = across / distance;
                let leaving = axis.map_or(1.0, |axis| (-axis.dot(&direction)).max(0.0));
                (strength_mm2 * leaving * normal.dot(&direction).max(0.0) / (distance * distance), direction, distance)
            }
        }
    }
}

impl Sources {
    /// Irradiance with shadows.
    pub(super) fn irradiance(&self, receiver: &Receiver, occluders: &Occluders, diagonal_mm: f64) -> f64 {
        let arriving = |source: &Source| {
            let (irradiance, direction, distance_mm) = source.arriving(&receiver.point, &receiver.normal);
            // Twice the diagonal is outside the surface in every direction.
            let target = receiver.point + direction * distance_mm.min(2.0 * diagonal_mm);
            let lit = irradiance > 0.0 && !occluders.blocked(&receiver.point, &target, [Some(receiver.patch), None]);
            if lit { irradiance } else { 0.0 }
        };
        self.0.iter().map(arriving).sum()
    }
}

/// Direct irradiance of every patch from every lamp: the mean over `points_per_side^2` points of the patch.
pub fn irradiances(patches: &Patches, lamps: &[Lamp], points_per_side: usize) -> Result<Vec<Vec<f64>>, SceneError> {
    let column = |lamp: &Lamp| {
        let sources = lamp.sources()?;
        let mean = |(index, patch): (usize, &Patch)| {
            let points = even_points(patch, points_per_side);
            let count = points.len() as f64;
            let irradiance = |point| {
                let receiver = Receiver { point, normal: patch.normal, patch: index };
                sources.irradiance(&receiver, patches.occluders(), patches.diagonal_mm())
            };
            points.into_iter().map(irradiance).sum::<f64>() / count
        };
        Ok(patches.as_slice().par_iter().enumerate().map(mean).collect())
    };
    lamps.iter().map(column).collect()
}

/// The centres of the `side^2` equal triangles a patch is cut into.
fn even_points(patch: &Patch, side: usize) -> Vec<Point3<f64>> {
    let third = 1.0 / (3.0 * side as f64);
    let mut points = Vec::with_capacity(side * side);
    for i in 0..side {
        for j in 0..side - i {
            let (u, v) = (3.0 * i as f64 * third, 3.0 * j as f64 * third);
            points.push(patch.point(u + third, v + third));
            if i + j + 2 <= side {
                points.push(patch.point(u + 2.0 * third, v + 2.0 * third));
            }
        }
    }
    points
}
