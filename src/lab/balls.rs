//! Calibration balls under a lamp, in closed form.

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use firstbounce_core::Plane;
use firstbounce_core::sphere::{Ball, SurfacePoint};
use firstbounce_core::stereo::normals::Lamp;

/// A picture that holds one ball and nothing else. A ball is convex: no light bounces from it to itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BallPicture {
    /// The ball.
    pub ball: Ball,
    /// The ball's radius: a near lamp lights each point of it from elsewhere. Its centre is the frame's origin.
    pub radius_mm: f64,
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
    /// A Lambertian ball; `facing` is the linear light of a facet at the origin that faces the lamp: albedo times
    /// intensity.
    pub fn matt(&self, lamp: &Lamp, facing: f64) -> Plane {
        self.render(|surface| facing * surface.normal.dot(&self.toward(lamp, surface)).max(0.0))
    }

    /// A mirror ball in a dim room.
    pub fn mirror(&self, lamp: &Lamp, spot: &LampSpot) -> Plane {
        let rim = spot.half_angle_deg.to_radians().cos();
        self.render(|surface| {
            let direction = self.toward(lamp, surface).normalize();
            if surface.direction_mirrored().dot(&direction) >= rim { spot.light } else { spot.room }
        })
    }

    /// From a point of the ball to the lamp, as long as the lamp is strong there.
    fn toward(&self, lamp: &Lamp, surface: &SurfacePoint) -> Vector3<f64> {
        lamp.irradiance_vector(Point3::from(surface.normal * self.radius_mm))
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
