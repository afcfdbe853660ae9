//! Where lamps and camera stand.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{Unit, Vector3};

use super::LabError;
use crate::{Camera, Mesh, Projection};

/// The surface's larger side in a picture, as a fraction of the picture's.
const FILLED: f64 = 0.96;

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
pub fn framed(mut mesh: Mesh, size_px: usize) -> Result<(Mesh, Camera), LabError> {
    let (low, high) = mesh.bounds().ok_or(LabError::NothingToSee)?;
    let middle = nalgebra::center(&low, &high);
    let extent_mm = f64::from((high.x - low.x).max(high.y - low.y));
    let camera = Camera {
        projection: Projection::Orthographic { mm_per_pixel: Some(extent_mm / (FILLED * size_px as f64)) },
        size: (size_px, size_px),
    };
    if !camera.is_valid() {
        return Err(LabError::NothingToSee);
    }
    for position in &mut mesh.positions {
        position.x -= middle.x;
        position.y -= middle.y;
    }
    Ok((mesh, camera))
}
