//! Calibration balls under a distant lamp, in closed form.

use nalgebra::{Unit, Vector3};
use rayon::prelude::*;

use crate::{
    Plane,
    ball::{Ball, SurfacePoint},
};

/// A picture that holds one ball and nothing else. A ball is convex: no light bounces from it to itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallPicture {
    /// The ball.
    pub ball: Ball,
    /// Width and height in pixels.
    pub size: (usize, usize),
    /// Samples along each side of a pixel, which is the mean over their square.
    pub samples_per_pixel_side: usize,
}

/// A round lamp as a mirror ball shows it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LampSpot {
    /// From its centre to its rim, seen from the ball.
    pub half_angle_deg: f64,
    /// Linear light of the lamp in the mirror.
    pub light: f64,
    /// Linear light of everything else in the mirror.
    pub room: f64,
}

impl BallPicture {
    /// A Lambertian ball; `facing` is the linear light of a facet that faces the lamp: albedo times intensity.
    pub fn matt(&self, direction_to_light: &Unit<Vector3<f64>>, facing: f64) -> Plane {
        self.render(|surface| facing * surface.normal.dot(direction_to_light).max(0.0))
    }

    /// A mirror ball in a dim room.
    pub fn mirror(&self, direction_to_light: &Unit<Vector3<f64>>, lamp: &LampSpot) -> Plane {
        let rim = lamp.half_angle_deg.to_radians().cos();
        self.render(
            |surface| {
                if surface.direction_mirrored().dot(direction_to_light) >= rim { lamp.light } else { lamp.room }
            },
        )
    }

    fn render(&self, light: impl Fn(&SurfacePoint) -> f64 + Sync) -> Plane {
        let (width, height) = self.size;
        let side = self.samples_per_pixel_side.max(1);
        let mut plane = Plane::filled(width, height, 0.0);
        plane.data_mut().par_chunks_mut(width.max(1)).enumerate().for_each(|(y, row)| {
            for (x, pixel) in row.iter_mut().enumerate() {
                let at = |pixel: usize, sample: usize| pixel as f64 + (sample as f64 + 0.5) / side as f64;
                let samples = (0..side * side).map(|k| self.ball.surface_at(at(x, k % side), at(y, k / side)));
                *pixel = (samples.flatten().map(|surface| light(&surface)).sum::<f64>() / (side * side) as f64) as f32;
            }
        });
        plane
    }
}
