//! Placement of lamps and camera.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{Unit, Vector3};
use rayon::prelude::*;

use super::{SceneError, seen_at};
use crate::light::radiosity::Patches;
use crate::options::check_range;
use crate::{Camera, Mesh, Projection};

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
pub fn framed(mesh: Mesh, size_px: usize) -> Result<(Mesh, Camera), SceneError> {
    framed_through(mesh, Lens::Orthographic, size_px)
}

/// The same through any lens.
pub fn framed_through(mut mesh: Mesh, lens: Lens, size_px: usize) -> Result<(Mesh, Camera), SceneError> {
    let (low, high) = mesh.bounds().ok_or(SceneError::NothingToSee)?;
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
            let distance = |in_range, range| check_range("working_distance_mm", working_distance_mm, in_range, range);
            distance(working_distance_mm > f64::from(high.z), "more than the height of the surface over z = 0")?;
            distance(working_distance_mm <= MAX_DISTANCE_MM, "at most 1e9; leave it out for parallel rays")?;
            let slope = |p: &nalgebra::Point3<f32>| {
                f64::from(p.x.abs().max(p.y.abs())) / (working_distance_mm - f64::from(p.z))
            };
            let steepest = mesh.positions.iter().map(slope).fold(0.0, f64::max);
            let middle_px = size_px as f64 / 2.0;
            let focal_length_px = filled_px / 2.0 / steepest;
            let range = "near enough to see a slope, and farther than the surface is wide";
            distance(FOCAL_LENGTHS_PX.contains(&focal_length_px), range)?;
            Projection::Perspective { focal_length_px, principal_point_px: (middle_px, middle_px), working_distance_mm }
        }
    };
    let camera = Camera { projection, size: (size_px, size_px) };
    if camera.is_valid() { Ok((mesh, camera)) } else { Err(SceneError::NothingToSee) }
}

/// The height z in mm that depth from normals takes for 0 ([`crate::stereo::depth::integrate`]): the mean over what the camera sees,
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

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::*;
    use crate::light::scene::Shape;
    use crate::options::OptionError;

    #[test]
    fn a_framed_surface_fills_the_picture_and_stays_inside() {
        let mesh = Shape::Corner { wall_mm: 60.0, roll_deg: 20.0 }.mesh(60).unwrap();
        let (mesh, camera) = framed(mesh, 120).unwrap();
        let (low, high) = mesh.bounds().unwrap();
        let (left_top, right_bottom) = (camera.point_mm(0.0, 0.0, 0.0), camera.point_mm(120.0, 120.0, 0.0));
        assert!(f64::from(low.x) > left_top.x && f64::from(high.x) < right_bottom.x);
        assert!(f64::from(low.y) > right_bottom.y && f64::from(high.y) < left_top.y);
        let filled = f64::from((high.x - low.x).max(high.y - low.y)) / (right_bottom.x - left_top.x);
        assert!((0.9..1.0).contains(&filled), "{filled}");
    }

    #[test]
    fn a_pinhole_is_as_far_as_asked_for_and_filled_to_the_same_share() {
        let mesh = Shape::Groove { wall_mm: 60.0, length_mm: 90.0, angle_deg: 90.0 }.mesh(60).unwrap();
        let (mesh, camera) =
            framed_through(mesh.clone(), Lens::Perspective { working_distance_mm: 300.0 }, 200).unwrap();
        let Projection::Perspective { focal_length_px, working_distance_mm, .. } = camera.projection else {
            panic!("{camera:?}")
        };
        assert_eq!(working_distance_mm, 300.0);
        let off_axis_px =
            |p: &Point3<f32>| focal_length_px * f64::from(p.x.abs().max(p.y.abs())) / (300.0 - f64::from(p.z));
        let farthest_px = mesh.positions.iter().map(off_axis_px).fold(0.0, f64::max);
        assert!((farthest_px - 96.0).abs() < 0.01, "{farthest_px}");
        let inside = framed_through(mesh, Lens::Perspective { working_distance_mm: 20.0 }, 200);
        assert!(matches!(inside, Err(SceneError::Option(OptionError { option: "working_distance_mm", .. }))));
    }

    #[test]
    fn the_mean_height_is_that_of_a_tilted_plane() {
        // A square of 20 mm whose height runs from 3 to 7 mm.
        let mut mesh = Shape::Groove { wall_mm: 10.0, length_mm: 20.0, angle_deg: 180.0 }.mesh(2).unwrap();
        mesh.positions.iter_mut().for_each(|position| position.z = 5.0 + 0.2 * position.x);
        let patches = Patches::from_mesh(&mesh).unwrap();
        let (_, camera) = framed(mesh.clone(), 100).unwrap();
        assert!((mean_height_seen(&patches, &camera).unwrap() - 5.0).abs() < 1e-3);
        let (_, camera) = framed_through(mesh, Lens::Perspective { working_distance_mm: 100.0 }, 100).unwrap();
        let found = mean_height_seen(&patches, &camera).unwrap();
        // A pinhole 100 mm high sees the slope u = x / (100 - z) where z = 5 + 0.2 x, so 95 / (1 + 0.2 u) mm away.
        let (first, last) = (-10.0 / 97.0, 10.0 / 93.0);
        let log = |k: u32| (95.0 / (1.0 + 0.2 * (first + (last - first) * f64::from(k) / 1000.0))).ln();
        let expected = 100.0 - ((0..=1000).map(log).sum::<f64>() / 1001.0).exp();
        assert!((found - expected).abs() < 0.06, "{found} for {expected}");
    }

    #[test]
    fn a_surface_is_seen_from_the_side_it_shows() {
        let (mesh, camera) = framed(Shape::Tray { side_mm: 80.0 }.mesh(200).unwrap(), 100).unwrap();
        let behind = |mesh: &Mesh| seen_from_behind(&Patches::from_mesh(mesh).unwrap(), &camera);
        assert!(behind(&mesh).unwrap() < 0.01);
        let mut turned = mesh.clone();
        turned.triangles.iter_mut().for_each(|[_, b, c]| std::mem::swap(b, c));
        assert!(behind(&turned).unwrap() > 0.99);
        let mut away = mesh;
        away.positions.iter_mut().for_each(|position| position.x += 1000.0);
        assert_eq!(behind(&away), None);
    }
}
