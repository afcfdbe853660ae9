//! Direct light to a surface: normals and depth, in rounds where lamps are near and each needs the other.

use thiserror::Error;

use crate::options::{OptionError, check_range};
use crate::stereo::depth::{Depth, DepthError, DepthOptions, integrate};
use crate::stereo::normals::{
    DirectLight, Lamp, Normals, NormalsError, NormalsOptions, NormalsReport, Surface, normals,
};
use crate::{Camera, Mask, Plane, Portion, Watch};

/// How to recover the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ShapeOptions {
    /// Photometric stereo.
    pub normals: NormalsOptions,
    /// Integration.
    pub depth: DepthOptions,
    /// Near-light iterations: how often near lamps light the depth found so far; distant lamps need one.
    pub rounds: usize,
}

impl Default for ShapeOptions {
    fn default() -> Self {
        Self { normals: NormalsOptions::default(), depth: DepthOptions::default(), rounds: 3 }
    }
}

impl ShapeOptions {
    /// Whether every option is in its range.
    pub fn check(&self) -> Result<(), ShapeError> {
        self.normals.check()?;
        self.depth.check()?;
        Ok(check_range("rounds", self.rounds as f64, (1..=MAX_ROUNDS).contains(&self.rounds), "from 1 to 100")?)
    }
}

/// Lamps that are placed anew so often have long come to rest.
const MAX_ROUNDS: usize = 100;

/// Why there is no surface.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum ShapeError {
    /// Photometric stereo failed.
    #[error(transparent)]
    Normals(#[from] NormalsError),
    /// Integration failed.
    #[error(transparent)]
    Depth(#[from] DepthError),
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
}

impl ShapeError {
    /// Whether the watch cancelled.
    pub fn is_cancelled(&self) -> bool {
        matches!(self, Self::Normals(NormalsError::Cancelled) | Self::Depth(DepthError::Cancelled))
    }
}

/// A surface and what is known of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// Normals, albedo, noise.
    pub normals: Normals,
    /// Depth, where there are normals.
    pub depth: Depth,
    /// The report of the last round.
    pub report: ShapeReport,
}

/// What the recovery reports.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeReport {
    /// Photometric stereo, last round.
    pub normals: NormalsReport,
    /// For each round after the first, how much the depth changed (root mean square), in the depth's unit.
    pub depth_changes: Vec<f64>,
}

/// Recovers normals and depth from the direct light of three or more lamps.
///
/// The first round takes a near lamp's direction and distance over the plane z = 0, each further one over the depth of
/// the round before (Queau, Durix, Wu, Cremers, Lauze and Durou, "LED-based photometric stereo", JMIV 2018, section 3).
pub fn recover_shape(
    lights: &[DirectLight],
    mask: &Mask,
    camera: &Camera,
    options: &ShapeOptions,
    watch: &dyn Watch,
) -> Result<Shape, ShapeError> {
    options.check()?;
    let near = lights.iter().any(|light| matches!(light.lamp, Lamp::Near(_)));
    let rounds = if near { options.rounds } else { 1 };
    let mut shape = round(lights, mask, camera, None, options, &Portion::of(watch, 0, rounds))?;
    for index in 1..rounds {
        let better =
            round(lights, mask, camera, Some(&shape.depth.depth_mm), options, &Portion::of(watch, index, rounds))?;
        let mut depth_changes = shape.report.depth_changes;
        depth_changes.push(root_mean_square_change(&shape.depth, &better.depth));
        shape = Shape { report: ShapeReport { depth_changes, ..better.report }, ..better };
    }
    Ok(shape)
}

fn round(
    lights: &[DirectLight],
    mask: &Mask,
    camera: &Camera,
    depth_mm: Option<&Plane>,
    options: &ShapeOptions,
    watch: &dyn Watch,
) -> Result<Shape, ShapeError> {
    let (normals, report) = normals(lights, mask, Surface { camera, depth_mm }, &options.normals, watch)?;
    let depth = integrate(&normals.map, &normals.solved(), None, camera, &options.depth, watch)?;
    Ok(Shape { normals, depth, report: ShapeReport { normals: report, depth_changes: Vec::new() } })
}

fn root_mean_square_change(before: &Depth, after: &Depth) -> f64 {
    crate::image::evaluate::rmse_without_offset(&before.depth_mm, &after.depth_mm, &after.mask, &after.mask)
        .unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use nalgebra::{Point3, Vector3};

    use super::*;
    use crate::{Marks, NormalMap, Projection, Unwatched};

    /// A bowl under three near lamps and a pinhole: the shape comes back although every pixel sees the lamps
    /// from its own place.
    #[test]
    fn near_lamps_converge_in_three_rounds() {
        let size = (160, 120);
        let projection = Projection::Perspective {
            focal_length_px: 800.0,
            principal_point_px: (80.0, 60.0),
            working_distance_mm: 400.0,
        };
        let camera = Camera { projection, size };
        // z = 0.01 (x^2 + y^2) - mean: intersect each pixel's ray with it by fixed-point steps.
        let surface = |p: Point3<f64>| 0.01 * (p.x * p.x + p.y * p.y) - 8.3;
        let point = |x: usize, y: usize| {
            (0..30).fold(camera.point_mm(x as f64 + 0.5, y as f64 + 0.5, 0.0), |p, _| {
                camera.point_mm(x as f64 + 0.5, y as f64 + 0.5, surface(p))
            })
        };
        let normal = |p: Point3<f64>| Vector3::new(-0.02 * p.x, -0.02 * p.y, 1.0).normalize();
        let plane =
            |value: &dyn Fn(Point3<f64>) -> f64| Plane::from_fn(size.0, size.1, |x, y| value(point(x, y)) as f32);
        let truth = [0, 1, 2].map(|axis| plane(&|p| normal(p)[axis]));
        let [x, y, z] = truth;
        let truth = NormalMap::from_planes(x, y, z).unwrap();

        let lamps = [(150.0, 20.0), (-90.0, 120.0), (-70.0, -130.0)].map(|(x, y)| Lamp::Near(Point3::new(x, y, 350.0)));
        let photos = lamps.map(|lamp| plane(&|p| 0.5 * normal(p).dot(&lamp.irradiance_vector(p))));
        let marks = Marks::filled(size.0, size.1, 0);
        let lights: Vec<_> = photos
            .iter()
            .zip(lamps)
            .map(|(direct, lamp)| DirectLight { direct, noise: None, marks: &marks, lamp, intensity: 1.0 })
            .collect();
        let mask = Mask::filled(size.0, size.1, true);
        let solve = |rounds| {
            let options = ShapeOptions { rounds, ..ShapeOptions::default() };
            recover_shape(&lights, &mask, &camera, &options, &Unwatched).unwrap()
        };
        let error = |shape: &Shape| shape.normals.map.angular_error(&truth, &mask).unwrap().mean_deg;
        let (one, four) = (solve(1), solve(4));
        assert!(error(&four) < 0.3, "{} degrees", error(&four));
        assert!(error(&four) < 0.3 * error(&one), "{} then {}", error(&one), error(&four));
        let changes = &four.report.depth_changes;
        assert!(changes.windows(2).all(|pair| pair[1] < 0.5 * pair[0]), "{changes:?}");
    }
}
