//! Values of planes along a line.

use rayon::prelude::*;

use crate::Plane;

/// More samples than any screen has columns for.
const MAX_SAMPLES: usize = 20_000;

/// Values along a line from one point to another.
#[derive(Clone, Debug, PartialEq)]
pub struct Profile {
    /// Distance of each sample from the first point, in pixels.
    pub distance_px: Vec<f64>,
    /// For each plane, its value at each sample.
    pub values: Vec<Vec<f64>>,
}

/// Samples every plane from `from_px` to `to_px` (pixel centres at .5), bilinear, about one sample a pixel and both ends
/// included. Beyond a plane its border goes on.
pub fn profile(planes: &[&Plane], from_px: [f64; 2], to_px: [f64; 2]) -> Profile {
    let [dx, dy] = [to_px[0] - from_px[0], to_px[1] - from_px[1]];
    let length = dx.hypot(dy);
    let steps = (length.ceil() as usize).clamp(1, MAX_SAMPLES - 1);
    let at = |i: usize| i as f64 / steps as f64;
    let sample = |plane: &&Plane| {
        let value = |i: usize| plane.sample(from_px[0] + at(i) * dx, from_px[1] + at(i) * dy);
        (0..=steps).map(value).collect()
    };
    Profile {
        distance_px: (0..=steps).map(|i| at(i) * length).collect(),
        values: planes.par_iter().map(sample).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_profile_across_a_ramp_is_a_straight_line() {
        let ramp = Plane::from_fn(60, 40, |x, y| 3.0 * (x as f32 + 0.5) + 2.0 * (y as f32 + 0.5));
        let flat = Plane::filled(60, 40, 7.0);
        let found = profile(&[&ramp, &flat], [5.0, 30.0], [45.0, 10.0]);
        assert!((found.distance_px.last().unwrap() - 2000f64.sqrt()).abs() < 1e-9);
        // Along (40, -20): 3 * 40 - 2 * 20 over the whole length.
        for (distance, value) in found.distance_px.iter().zip(&found.values[0]) {
            assert!((value - (75.0 + 80.0 * distance / 2000f64.sqrt())).abs() < 1e-3);
        }
        assert!(found.values[1].iter().all(|value| *value == 7.0));
    }

    #[test]
    fn a_point_is_a_profile_too() {
        let found = profile(&[&Plane::filled(3, 3, 1.0)], [1.0, 1.0], [1.0, 1.0]);
        assert_eq!(found.distance_px, [0.0, 0.0]);
    }
}
