//! Whether the surface itself stands between two of its points, by its depth along the way: nothing is known of what the camera
//! does not see.

use nalgebra::Point3;

use super::pyramid::{Level, Pyramid};
use crate::{Camera, Plane};

/// Points along the way at which the depth is looked up.
const STEPS: usize = 10;
/// Of the way, what is left out at either end.
const ENDS: f32 = 0.08;
/// The surface must stand above the way by this share of the way's length, and by so many cells.
const SHARE: f32 = 0.02;
const CELLS: f32 = 1.5;
/// At most so many patches on a side exchange light for a first look.
const FIRST_LOOK_SIDE: usize = 32;
/// Less than this share of the light blocked is not worth the time to find out where.
const NOTHING_BLOCKED: f64 = 2e-3;

/// The depth of every cell.
pub(super) struct Visibility<'a> {
    camera: &'a Camera,
    /// Minus infinity where there is no surface.
    depth: &'a Plane,
    clearance: f32,
}

impl<'a> Visibility<'a> {
    /// `None` where hardly any light is blocked: in a corner, a groove, a bowl with a flat rim.
    pub(super) fn new(pyramid: &Pyramid, camera: &'a Camera, depth: &'a Plane) -> Option<Self> {
        let (x, y) = (camera.size.0 as f64 / 2.0, camera.size.1 as f64 / 2.0);
        let cell = (camera.point_mm(x + 1.0, y, 0.0) - camera.point_mm(x, y, 0.0)).norm();
        let visibility = Self { camera, depth, clearance: CELLS * cell as f32 };
        let small_enough = |level: &&Level| level.width.max(level.height) <= FIRST_LOOK_SIDE;
        let patches = pyramid.levels.iter().find(small_enough)?;
        (visibility.blocked_share(patches) > NOTHING_BLOCKED).then_some(visibility)
    }

    /// Of the light that patches exchange, the share that the surface blocks.
    fn blocked_share(&self, patches: &Level) -> f64 {
        use rayon::prelude::*;
        let count = patches.area.len();
        let from = |a: usize| {
            let (mut all, mut blocked) = (0.0, 0.0);
            for b in (a + 1..count).filter(|&b| patches.area[a] > 0.0 && patches.area[b] > 0.0) {
                let (p, q) = (patches.centre_of(a), patches.centre_of(b));
                let across = q - p;
                let squared = across.norm_squared();
                let facing = patches.facing_of(a).dot(&across).max(0.0) * (-patches.facing_of(b).dot(&across)).max(0.0);
                let near = squared < 4.0 * (patches.radius[a] + patches.radius[b]).powi(2);
                let exchange = if near { 0.0 } else { f64::from(facing / (squared * squared)) };
                all += exchange;
                blocked += if exchange > 0.0 && !self.is_clear(&p, &q) { exchange } else { 0.0 };
            }
            (all, blocked)
        };
        let add = |a: (f64, f64), b: (f64, f64)| (a.0 + b.0, a.1 + b.1);
        let (all, blocked) = (0..count).into_par_iter().map(from).reduce(|| (0.0, 0.0), add);
        blocked / f64::max(all, f64::MIN_POSITIVE)
    }

    /// Whether nothing stands between two points.
    pub(super) fn is_clear(&self, from: &Point3<f32>, to: &Point3<f32>) -> bool {
        let across = to - from;
        let above = SHARE * across.amax() + self.clearance;
        (0..STEPS).all(|step| {
            let t = ENDS + (1.0 - 2.0 * ENDS) * step as f32 / (STEPS - 1) as f32;
            let point = from + across * t;
            let (x, y) = self.camera.pixel_px(&point.cast::<f64>());
            let (width, height) = self.depth.size();
            let inside = x >= 0.0 && y >= 0.0 && x < width as f64 && y < height as f64;
            !inside || self.depth.at(x as usize, y as usize) <= point.z + above
        })
    }
}
