//! How far a result is from the truth, where the truth is known.

use rayon::prelude::*;

use crate::{Mask, Plane};

/// A pixel's normal is determined by light where at least this many lamps reach it directly.
const LIGHTS_FOR_A_NORMAL: usize = 3;

/// The pixels of `mask` that three or more lamps light directly, by the true direct light of every lamp: where any
/// method of photometric stereo has a fair chance. `None` if a plane has another size.
pub fn lit_by_three(true_direct: &[Plane], mask: &Mask) -> Option<Mask> {
    if true_direct.iter().any(|plane| plane.size() != mask.size()) {
        return None;
    }
    let lit = |pixel: usize| true_direct.iter().filter(|plane| plane.data()[pixel] > 0.0).count();
    let enough = LIGHTS_FOR_A_NORMAL.min(true_direct.len());
    let data = mask.data().par_iter().enumerate().map(|(pixel, &inside)| inside && lit(pixel) >= enough).collect();
    Mask::from_vec(mask.width(), mask.height(), data)
}

/// Mean absolute difference over the mask, relative to the mean of the truth. `None` for other sizes or a truth of zero.
pub fn relative_error(found: &Plane, truth: &Plane, mask: &Mask) -> Option<f64> {
    if found.size() != truth.size() || found.size() != mask.size() {
        return None;
    }
    let (difference, mean) = found
        .data()
        .par_iter()
        .zip(truth.data())
        .zip(mask.data())
        .filter(|(_, inside)| **inside)
        .map(|((&found, &truth), _)| (f64::from((found - truth).abs()), f64::from(truth)))
        .reduce(|| (0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
    (mean > 0.0).then(|| difference / mean)
}

/// Root mean square difference over the mask after the mean difference is taken away: a depth from normals knows no
/// offset. In the unit of the planes. `None` for other sizes or an empty mask.
pub fn rmse_without_offset(found: &Plane, truth: &Plane, mask: &Mask) -> Option<f64> {
    if found.size() != truth.size() || found.size() != mask.size() {
        return None;
    }
    let (sum, squares, count) = found
        .data()
        .par_iter()
        .zip(truth.data())
        .zip(mask.data())
        .filter(|(_, inside)| **inside)
        .map(|((&found, &truth), _)| f64::from(found) - f64::from(truth))
        .map(|difference| (difference, difference * difference, 1usize))
        .reduce(|| (0.0, 0.0, 0), |a, b| (a.0 + b.0, a.1 + b.1, a.2 + b.2));
    let mean = sum / count as f64;
    (count > 0).then(|| (squares / count as f64 - mean * mean).max(0.0).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(values: [f32; 4]) -> Plane {
        Plane::from_vec(2, 2, values.to_vec()).unwrap()
    }

    #[test]
    fn two_lamps_do_not_determine_a_normal() {
        let direct = [plane([1.0, 0.0, 1.0, 1.0]), plane([1.0, 1.0, 0.0, 1.0]), plane([1.0; 4]), plane([0.0; 4])];
        let lit = lit_by_three(&direct, &Mask::from_fn(2, 2, |x, y| (x, y) != (1, 1))).unwrap();
        assert_eq!(lit.data(), [true, false, false, false]);
    }

    #[test]
    fn an_offset_is_no_error_of_a_depth() {
        let (found, truth) = (plane([5.0, 6.0, 7.0, 90.0]), plane([1.0, 2.0, 3.0, 0.0]));
        let mask = Mask::from_fn(2, 2, |x, y| (x, y) != (1, 1));
        assert!(rmse_without_offset(&found, &truth, &mask).unwrap() < 1e-9);
        assert_eq!(rmse_without_offset(&found, &truth, &Mask::filled(2, 2, false)), None);
    }

    #[test]
    fn relative_error_is_relative_to_the_mean_truth() {
        let all = Mask::filled(2, 2, true);
        let error = relative_error(&plane([1.1, 0.9, 2.0, 2.0]), &plane([1.0, 1.0, 2.0, 2.0]), &all).unwrap();
        assert!((error - 0.2 / 6.0).abs() < 1e-6);
        assert_eq!(relative_error(&plane([1.0; 4]), &plane([0.0; 4]), &all), None);
    }
}
