//! The slope residual: by how much normals miss being those of a surface.

use nalgebra::Vector3;

use super::photometric::median;
use crate::stereo::depth::{DepthOptions, integrate};
use crate::stereo::normals::{DirectLight, Lamp, NormalsOptions, Surface, normals};
use crate::{Camera, Marks, Mask, Plane, Projection, Unwatched};

/// Steeper slopes say little of a surface and would outweigh all others.
const MAX_SLOPE: f64 = 5.0;
/// As exact as a comparison needs it.
const TOLERANCE: f64 = 1e-3;
/// A normal that points away from the camera is that of no surface in view.
const MIN_TOWARD_CAMERA: f32 = 0.05;

/// By how much normals miss being those of a surface, in degrees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Misfit {
    pub mean_deg: f64,
    pub median_deg: f64,
}

/// Of the normals that distant lamps show; `None` where they show none.
pub(super) fn misfit<'a>(photos: &[&'a Plane], toward: &[Vector3<f64>], inside: &Mask) -> Option<Misfit> {
    let size = inside.size();
    let marks = Marks::filled(size.0, size.1, 0);
    let camera = Camera { projection: Projection::Orthographic { mm_per_pixel: None }, size };
    let light = |(direct, toward): (&&'a Plane, &Vector3<f64>)| DirectLight {
        direct,
        noise: None,
        marks: &marks,
        lamp: Lamp::Distant(*toward),
        intensity: toward.norm(),
    };
    let lights: Vec<DirectLight> = photos.iter().zip(toward).map(light).collect();
    let surface = Surface { camera: &camera, depth_mm: None };
    let (normals, _) = normals(&lights, inside, surface, &NormalsOptions::default(), &Unwatched).ok()?;
    let options = DepthOptions { max_slope: MAX_SLOPE, tolerance: TOLERANCE, ..DepthOptions::default() };
    let depth = integrate(&normals.map, &normals.solved(), None, &camera, &options, &Unwatched).ok()?;
    let angle = |pixel: usize| {
        let normal = normals.map.at_index(pixel)?;
        let slope = f64::from(depth.slope_residual.data()[pixel]);
        // A difference of slopes turns a steep normal less.
        let turned = (slope * f64::from(normal.z)).atan().to_degrees();
        Some(if normal.z < MIN_TOWARD_CAMERA { 90.0 } else { turned })
    };
    let angles: Vec<f64> = (0..size.0 * size.1).filter(|pixel| depth.mask.data()[*pixel]).filter_map(angle).collect();
    let mean_deg = angles.iter().sum::<f64>() / angles.len().max(1) as f64;
    Some(Misfit { mean_deg, median_deg: median(angles)? })
}
