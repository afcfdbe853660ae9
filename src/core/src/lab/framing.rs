//! Where lamps and camera stand.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{Unit, Vector3};
use rayon::prelude::*;

use super::LabError;
use crate::{Camera, Mesh, Projection, radiosity::Patches, scene::seen_at};

/// The surface's larger side in a picture, as a fraction of the picture's.
const FILLED: f64 = 0.96;
/// Rays along each side of the picture that look for faces that are turned away, and how high the surface lies.
const LOOKS_PER_SIDE: usize = 64;

/// From there a surface of any size is seen by parallel rays.
const MAX_DISTANCE_MM: f64 = 1e9;
/// From a pinhole that sees almost everything before it to parallel rays.
const FOCAL_LENGTHS_PX: std::ops::RangeInclusive<f64> = 1.0..=1e7;

/// The camera's lens.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Lens {
    /// All rays run along z.
    #[default]
    Orthographic,
    /// A pinhole over the middle of the surface.
    Perspective {
        /// From the pinhole to z = 0.
        working_distance_mm: f64,
    },
}

/// Directions to `count` distant lamps, evenly about the z axis and `tilt_deg` from it, the first one above the object.
pub fn directions_on_ring(count: usize, tilt_deg: f64) -> Vec<Unit<Vector3<f64>>> {
    let (sine, cosine) = tilt_deg.to_radians().sin_cos();
    let direction = |k: usize| {
        let turn = FRAC_PI_2 + TAU * k as f64 / count as f64;
        Unit::new_normalize(Vector3::new(sine * turn.cos(), sine * turn.sin(), cosine))
    };
    (0..count).map(direction).collect()
}

/// The surface moved along x and y to the middle of an orthographic picture of `size_px` pixels square that it fills.
pub fn framed(mesh: Mesh, size_px: usize) -> Result<(Mesh, Camera), LabError> {
    framed_through(mesh, Lens::Orthographic, size_px)
}

/// The same through any lens.
pub fn framed_through(mut mesh: Mesh, lens: Lens, size_px: usize) -> Result<(Mesh, Camera), LabError> {
    let (low, high) = mesh.bounds().ok_or(LabError::NothingToSee)?;
    let middle = nalgebra::center(&low, &high);
    for position in &mut mesh.positions {
        position.x -= middle.x;
        position.y -= middle.y;
    }
    let filled_px = FILLED * size_px as f64;
    let projection = match lens {
        Lens::Orthographic => {
            let extent_mm = f64::from((high.x - low.x).max(high.y - low.y));
            Projection::Orthographic { mm_per_pixel: Some(extent_mm / filled_px) }
        }
        Lens::Perspective { working_distance_mm } => {
            if working_distance_mm.is_nan() || working_distance_mm <= f64::from(high.z) {
                let range = "more than the height of the surface over z = 0";
                return Err(LabError::BadOption { option: "working_distance_mm", value: working_distance_mm, range });
            }
            if working_distance_mm > MAX_DISTANCE_MM {
                let range = "at most 1e9; leave it out for parallel rays";
                return Err(LabError::BadOption { option: "working_distance_mm", value: working_distance_mm, range });
            }
            let slope = |p: &nalgebra::Point3<f32>| {
                f64::from(p.x.abs().max(p.y.abs())) / (working_distance_mm - f64::from(p.z))
            };
            let steepest = mesh.positions.iter().map(slope).fold(0.0, f64::max);
            let middle_px = size_px as f64 / 2.0;
            let focal_length_px = filled_px / 2.0 / steepest;
            if !FOCAL_LENGTHS_PX.contains(&focal_length_px) {
                let range = "near enough to see a slope, and farther than the surface is wide";
                return Err(LabError::BadOption { option: "working_distance_mm", value: working_distance_mm, range });
            }
            Projection::Perspective { focal_length_px, principal_point_px: (middle_px, middle_px), working_distance_mm }
        }
    };
    let camera = Camera { projection, size: (size_px, size_px) };
    if camera.is_valid() { Ok((mesh, camera)) } else { Err(LabError::NothingToSee) }
}

/// The height z in mm that depth from normals takes for 0 ([`crate::depth::integrate`]): the mean over what the camera sees,
/// before a pinhole that of the geometric mean distance. `None` where the camera sees no surface at all.
pub fn mean_height_seen(patches: &Patches, camera: &Camera) -> Option<f64> {
    let heights: Vec<f64> = looks(camera)
        .filter_map(|(x_px, y_px)| Some(seen_at(patches, camera, x_px, y_px)?.1))
        .filter(|height| height.is_finite())
        .collect();
    let mean = |of: &dyn Fn(f64) -> f64| heights.iter().map(|&height| of(height)).sum::<f64>() / heights.len() as f64;
    (!heights.is_empty()).then(|| match camera.projection {
        Projection::Orthographic { .. } => mean(&|height| height),
        Projection::Perspective { working_distance_mm: far, .. } => far - mean(&|height| (far - height).ln()).exp(),
    })
}

/// Image positions evenly over the picture.
fn looks(camera: &Camera) -> impl ParallelIterator<Item = (f64, f64)> {
    let (width, height) = (camera.size.0 as f64, camera.size.1 as f64);
    (0..LOOKS_PER_SIDE * LOOKS_PER_SIDE).into_par_iter().map(move |look| {
        let at = |k: usize| (k as f64 + 0.5) / LOOKS_PER_SIDE as f64;
        (width * at(look % LOOKS_PER_SIDE), height * at(look / LOOKS_PER_SIDE))
    })
}

/// The share of the visible surface that turns its back to the camera, and so reflects nothing: a mesh that is inside
/// out, or open. `None` where the camera sees no surface at all.
pub fn seen_from_behind(patches: &Patches, camera: &Camera) -> Option<f64> {
    let looks = looks(camera).filter_map(|(x_px, y_px)| {
        let (hit, _) = seen_at(patches, camera, x_px, y_px)?;
        let facing = -patches.as_slice()[hit.patch].normal.dot(&camera.view_ray(x_px, y_px));
        Some((1_usize, usize::from(facing <= 0.0)))
    });
    let (seen, behind) = looks.reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    (seen > 0).then(|| behind as f64 / seen as f64)
}
