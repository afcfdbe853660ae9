//! Smoothing by a Gaussian.

use rayon::prelude::*;

use crate::Plane;

/// The kernel ends at this many standard deviations.
const REACH: f64 = 4.0;

/// The plane convolved with a Gaussian of this standard deviation whose weights sum to 1. Beyond its edges the plane counts as
/// zero: divide by the smoothed mask, or one smoothed plane by another.
pub fn gaussian(plane: &Plane, sigma_px: f64) -> Plane {
    let half = half_kernel(sigma_px);
    let (width, height) = plane.size();
    let mut rows = Plane::filled(width, height, 0.0);
    rows.data_mut().par_chunks_mut(width.max(1)).enumerate().for_each(|(y, out)| along(plane.row(y), &half, out));
    let mut smooth = Plane::filled(width, height, 0.0);
    smooth.data_mut().par_chunks_mut(width.max(1)).enumerate().for_each(|(y, out)| {
        for (k, weight) in half.iter().enumerate() {
            let above = y.checked_sub(k).filter(|_| k > 0);
            for row in [above, Some(y + k).filter(|&row| row < height)].into_iter().flatten() {
                out.iter_mut().zip(rows.row(row)).for_each(|(out, value)| *out += weight * value);
            }
        }
    });
    smooth
}

/// One row: every weight to the left and to the right at once.
fn along(row: &[f32], half: &[f32], out: &mut [f32]) {
    out.iter_mut().zip(row).for_each(|(out, value)| *out = half[0] * value);
    for (k, weight) in half.iter().enumerate().skip(1).take_while(|(k, _)| *k < row.len()) {
        out[k..].iter_mut().zip(row).for_each(|(out, value)| *out += weight * value);
        out.iter_mut().zip(&row[k..]).for_each(|(out, value)| *out += weight * value);
    }
}

/// The middle of the kernel and one side of it.
fn half_kernel(sigma_px: f64) -> Vec<f32> {
    let reach = (REACH * sigma_px).round() as usize;
    let weight = |k: usize| if k == 0 { 1.0 } else { (-0.5 * (k as f64 / sigma_px).powi(2)).exp() };
    let sum = (1..=reach).map(|k| 2.0 * weight(k)).sum::<f64>() + 1.0;
    (0..=reach).map(|k| (weight(k) / sum) as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_becomes_a_gaussian_of_the_same_sum() {
        let mut point = Plane::filled(61, 41, 0.0);
        point.set(30, 20, 1.0);
        let smooth = gaussian(&point, 3.0);
        assert!((smooth.data().iter().sum::<f32>() - 1.0).abs() < 1e-5);
        let expected = |x: f32, y: f32| (-(x * x + y * y) / 18.0).exp() / (std::f32::consts::TAU * 9.0);
        for (x, y) in [(0, 0), (4, 0), (0, 5), (3, 3)] {
            assert!((smooth.at(30 + x, 20 + y) - expected(x as f32, y as f32)).abs() < 2e-5);
        }
    }

    #[test]
    fn a_sigma_of_zero_changes_nothing() {
        let plane = Plane::from_fn(5, 4, |x, y| (x * 3 + y) as f32);
        assert_eq!(gaussian(&plane, 0.0), plane);
    }

    #[test]
    fn kernels_wider_than_the_picture_stay_inside() {
        assert!(gaussian(&Plane::filled(3, 2, 1.0), 20.0).data().iter().all(|value| (0.0..0.1).contains(value)));
    }
}
