//! The surface's direction at each pixel.

use nalgebra::Vector3;
use rayon::prelude::*;

use crate::{Mask, Plane};

/// Unit normals, a plane for each component, in the object frame (x right, y up, z toward the camera); zero where
/// there is none.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalMap {
    x: Plane,
    y: Plane,
    z: Plane,
}

/// How far one normal map is from another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngularError {
    /// Mean angle in degrees.
    pub mean_deg: f64,
    /// Median angle in degrees (the upper one of two middle values).
    pub median_deg: f64,
    /// Pixels compared: inside the mask, with a normal in both maps.
    pub pixels: usize,
}

impl NormalMap {
    /// Takes the three components as they are; `None` if their shapes differ.
    pub fn from_planes(x: Plane, y: Plane, z: Plane) -> Option<Self> {
        (x.size() == y.size() && y.size() == z.size()).then_some(Self { x, y, z })
    }

    /// `(width, height)` in pixels.
    pub fn size(&self) -> (usize, usize) {
        self.x.size()
    }

    /// The components toward the right.
    pub fn x(&self) -> &Plane {
        &self.x
    }

    /// The components upward.
    pub fn y(&self) -> &Plane {
        &self.y
    }

    /// The components toward the camera.
    pub fn z(&self) -> &Plane {
        &self.z
    }

    /// The components x, y and z, to be written in place.
    pub(crate) fn planes_mut(&mut self) -> [&mut Plane; 3] {
        [&mut self.x, &mut self.y, &mut self.z]
    }

    /// A map without any normal.
    pub fn empty(width: usize, height: usize) -> Self {
        let zero = Plane::filled(width, height, 0.0);
        Self { x: zero.clone(), y: zero.clone(), z: zero }
    }

    /// The components x, y and z, without the map.
    pub fn into_planes(self) -> [Plane; 3] {
        [self.x, self.y, self.z]
    }

    /// The normal at column `x`, row `y`; `None` where there is none or it is not finite. Panics outside the map, like
    /// a slice.
    pub fn at(&self, x: usize, y: usize) -> Option<Vector3<f32>> {
        debug_assert!(x < self.x.width());
        self.at_index(y * self.x.width() + x)
    }

    /// The normal at a position in the row-by-row order of the planes' data; as `at`.
    pub fn at_index(&self, index: usize) -> Option<Vector3<f32>> {
        let normal = Vector3::new(self.x.data()[index], self.y.data()[index], self.z.data()[index]);
        let squared = normal.norm_squared();
        (squared.is_finite() && squared > 0.0).then_some(normal)
    }

    /// The angles between these normals and the `truth` over the mask. `None` if the shapes differ or no pixel has a
    /// normal in both.
    pub fn angular_error(&self, truth: &NormalMap, mask: &Mask) -> Option<AngularError> {
        if self.size() != truth.size() || self.size() != mask.size() {
            return None;
        }
        let mut angles_deg: Vec<f64> = (0..mask.data().len())
            .into_par_iter()
            .filter(|&i| mask.data()[i])
            .filter_map(|i| Some(angle_deg(self.at_index(i)?, truth.at_index(i)?)))
            .collect();
        let pixels = angles_deg.len();
        if pixels == 0 {
            return None;
        }
        let mean_deg = angles_deg.iter().sum::<f64>() / pixels as f64;
        let (_, &mut median_deg, _) = angles_deg.select_nth_unstable_by(pixels / 2, f64::total_cmp);
        Some(AngularError { mean_deg, median_deg, pixels })
    }
}

/// The angle between two vectors; the arc tangent keeps small angles, which the arc cosine rounds away.
fn angle_deg(a: Vector3<f32>, b: Vector3<f32>) -> f64 {
    let (a, b) = (a.cast::<f64>(), b.cast::<f64>());
    a.cross(&b).norm().atan2(a.dot(&b)).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tilted(width: usize, height: usize, tilt_deg: impl Fn(usize, usize) -> f32) -> NormalMap {
        NormalMap::from_planes(
            Plane::from_fn(width, height, |x, y| tilt_deg(x, y).to_radians().sin()),
            Plane::filled(width, height, 0.0),
            Plane::from_fn(width, height, |x, y| tilt_deg(x, y).to_radians().cos()),
        )
        .unwrap()
    }

    #[test]
    fn planes_of_different_shapes_are_refused() {
        let (a, b) = (Plane::filled(3, 2, 0.0), Plane::filled(2, 3, 0.0));
        assert!(NormalMap::from_planes(a.clone(), a, b).is_none());
    }

    #[test]
    fn the_error_of_known_tilts_is_those_tilts() {
        let found = tilted(5, 1, |x, _| [1.0, 2.0, 3.0, 10.0, 80.0][x]);
        let truth = tilted(5, 1, |_, _| 0.0);
        let error = found.angular_error(&truth, &Mask::from_fn(5, 1, |x, _| x < 4)).unwrap();
        assert_eq!(error.pixels, 4);
        assert!((error.mean_deg - 4.0).abs() < 1e-5);
        assert!((error.median_deg - 3.0).abs() < 1e-5);
    }

    #[test]
    fn tiny_angles_survive() {
        let error = tilted(1, 1, |_, _| 1e-4).angular_error(&tilted(1, 1, |_, _| 0.0), &Mask::filled(1, 1, true));
        assert!((error.unwrap().mean_deg - 1e-4).abs() < 1e-9);
    }

    #[test]
    fn pixels_without_a_normal_are_not_compared() {
        let zero = || Plane::filled(2, 1, 0.0);
        let none = NormalMap::from_planes(zero(), zero(), zero()).unwrap();
        assert_eq!(none.at(0, 0), None);
        assert_eq!(none.angular_error(&tilted(2, 1, |_, _| 5.0), &Mask::filled(2, 1, true)), None);
    }
}
