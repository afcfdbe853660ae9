//! The camera: the projection, its rays, and the way from a depth to a point.

use nalgebra::{Point3, Unit, Vector3};

use crate::length::LengthUnit;

/// The kind of lens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// All rays run along z.
    Orthographic {
        /// Object-space pixel pitch; `None` where no scale is known, and then lengths are in pixels.
        mm_per_pixel: Option<f64>,
    },
    /// A pinhole on the z axis, looking along -z.
    Perspective {
        /// Focal length.
        focal_length_px: f64,
        /// Where the optical axis meets the image: x right, y down.
        principal_point_px: (f64, f64),
        /// From the pinhole to z = 0.
        working_distance_mm: f64,
    },
}

/// A camera without lens distortion in the object frame: x right, y up, z toward the camera, z = 0 at the object.
///
/// The origin lies under the image centre (orthographic) or on the optical axis (perspective).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// The kind of lens.
    pub projection: Projection,
    /// `(width, height)` of its images in pixels.
    pub size: (usize, usize),
}

impl Camera {
    /// Whether every length of the projection is a finite positive number.
    pub fn is_valid(&self) -> bool {
        let positive = |length: f64| length.is_finite() && length > 0.0;
        match self.projection {
            Projection::Orthographic { mm_per_pixel } => mm_per_pixel.is_none_or(positive),
            Projection::Perspective { focal_length_px, principal_point_px: (x, y), working_distance_mm } => {
                positive(focal_length_px) && positive(working_distance_mm) && x.is_finite() && y.is_finite()
            }
        }
    }

    /// What lengths in the object frame are measured in.
    pub fn unit(&self) -> LengthUnit {
        match self.projection {
            Projection::Orthographic { mm_per_pixel: None } => LengthUnit::Pixel,
            _ => LengthUnit::Millimetre,
        }
    }

    /// The direction from the camera into the scene through the pixel position `(x_px, y_px)`: against the light that
    /// reaches the pixel.
    pub fn view_ray(&self, x_px: f64, y_px: f64) -> Unit<Vector3<f64>> {
        match self.projection {
            Projection::Orthographic { .. } => -Vector3::z_axis(),
            Projection::Perspective { focal_length_px, principal_point_px: (x0, y0), .. } => {
                Unit::new_normalize(Vector3::new((x_px - x0) / focal_length_px, (y0 - y_px) / focal_length_px, -1.0))
            }
        }
    }

    /// The point at height `z_mm` seen at the pixel position `(x_px, y_px)`. In and out in mm, or both in pixels where
    /// no scale is known (`unit`).
    pub fn point_mm(&self, x_px: f64, y_px: f64, z_mm: f64) -> Point3<f64> {
        match self.projection {
            Projection::Orthographic { mm_per_pixel } => {
                let scale = mm_per_pixel.unwrap_or(1.0);
                let (width, height) = (self.size.0 as f64, self.size.1 as f64);
                Point3::new((x_px - width / 2.0) * scale, (height / 2.0 - y_px) * scale, z_mm)
            }
            Projection::Perspective { focal_length_px, principal_point_px: (x0, y0), working_distance_mm } => {
                let per_pixel = (working_distance_mm - z_mm) / focal_length_px;
                Point3::new((x_px - x0) * per_pixel, (y0 - y_px) * per_pixel, z_mm)
            }
        }
    }

    /// The pixel position `(x_px, y_px)` at which a point is seen: the inverse of [`Camera::point_mm`]. Not finite for a
    /// point in the pinhole's own plane.
    pub fn pixel_px(&self, point_mm: &Point3<f64>) -> (f64, f64) {
        match self.projection {
            Projection::Orthographic { mm_per_pixel } => {
                let scale = mm_per_pixel.unwrap_or(1.0);
                let (width, height) = (self.size.0 as f64, self.size.1 as f64);
                (point_mm.x / scale + width / 2.0, height / 2.0 - point_mm.y / scale)
            }
            Projection::Perspective { focal_length_px, principal_point_px: (x0, y0), working_distance_mm } => {
                let per_pixel = (working_distance_mm - point_mm.z) / focal_length_px;
                (x0 + point_mm.x / per_pixel, y0 - point_mm.y / per_pixel)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_lies_on_the_ray_of_its_pixel() {
        let projection = Projection::Perspective {
            focal_length_px: 3400.0,
            principal_point_px: (240.0, 230.0),
            working_distance_mm: 1200.0,
        };
        let camera = Camera { projection, size: (480, 480) };
        let pinhole = Point3::new(0.0, 0.0, 1200.0);
        for (x, y, z) in [(240.0, 230.0, 0.0), (0.5, 0.5, 35.0), (479.5, 100.0, -80.0)] {
            let point = camera.point_mm(x, y, z);
            assert!((point.z - z).abs() < 1e-12);
            assert!((point - pinhole).normalize().cross(&camera.view_ray(x, y)).norm() < 1e-12);
            let seen = camera.pixel_px(&point);
            assert!((seen.0 - x).abs() < 1e-9 && (seen.1 - y).abs() < 1e-9, "{seen:?}");
        }
    }

    #[test]
    fn an_orthographic_image_is_centred_and_y_runs_up() {
        let camera = Camera { projection: Projection::Orthographic { mm_per_pixel: Some(0.2) }, size: (100, 50) };
        assert!((camera.point_mm(50.0, 25.0, 3.0) - Point3::new(0.0, 0.0, 3.0)).norm() < 1e-12);
        assert!((camera.point_mm(60.0, 20.0, 3.0) - Point3::new(2.0, 1.0, 3.0)).norm() < 1e-12);
        let seen = camera.pixel_px(&Point3::new(2.0, 1.0, 3.0));
        assert!((seen.0 - 60.0).abs() < 1e-12 && (seen.1 - 20.0).abs() < 1e-12, "{seen:?}");
        assert_eq!(camera.view_ray(3.0, 4.0).into_inner(), Vector3::new(0.0, 0.0, -1.0));
    }

    #[test]
    fn without_a_scale_lengths_are_pixels() {
        let camera = Camera { projection: Projection::Orthographic { mm_per_pixel: None }, size: (10, 10) };
        assert_eq!(camera.unit(), LengthUnit::Pixel);
        assert!((camera.point_mm(6.0, 5.0, 2.0) - Point3::new(1.0, 0.0, 2.0)).norm() < 1e-12);
    }
}
