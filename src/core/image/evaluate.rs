//! The error of a result, where the truth is known.

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

/// Root mean square difference over the mask after the mean difference over each connected part of `integrated`, the mask of
/// the depth, is taken away: a depth from normals knows no offset, and none between its parts. In the unit of the planes.
/// `None` for other sizes or an empty mask.
pub fn rmse_without_offset(found: &Plane, truth: &Plane, mask: &Mask, integrated: &Mask) -> Option<f64> {
    if [truth.size(), mask.size(), integrated.size()].iter().any(|&size| size != found.size()) {
        return None;
    }
    let islands = integrated.islands();
    let most = islands.iter().copied().max().unwrap_or(0) as usize;
    // By island, 0 for what lies in none: sum, sum of squares, count.
    let none = || vec![(0.0, 0.0, 0usize); most + 1];
    let add = |sum: &mut (f64, f64, usize), more: (f64, f64, usize)| {
        *sum = (sum.0 + more.0, sum.1 + more.1, sum.2 + more.2);
    };
    let sums = (islands.par_iter(), mask.data(), found.data(), truth.data())
        .into_par_iter()
        .filter(|(_, inside, ..)| **inside)
        .fold(none, |mut sums, (&island, _, &found, &truth)| {
            let difference = f64::from(found) - f64::from(truth);
            add(&mut sums[island as usize], (difference, difference * difference, 1));
            sums
        })
        .reduce(none, |mut sums, others| {
            sums.iter_mut().zip(others).for_each(|(sum, more)| add(sum, more));
            sums
        });
    let with_pixels = || sums.iter().filter(|(.., count)| *count > 0);
    let squares: f64 = with_pixels().map(|&(sum, squares, count)| (squares - sum * sum / count as f64).max(0.0)).sum();
    let count: usize = with_pixels().map(|(.., count)| count).sum();
    (count > 0).then(|| (squares / count as f64).sqrt())
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
        assert!(rmse_without_offset(&found, &truth, &mask, &mask).unwrap() < 1e-9);
        assert_eq!(rmse_without_offset(&found, &truth, &Mask::filled(2, 2, false), &mask), None);
    }

    #[test]
    fn an_offset_between_islands_is_no_error_of_a_depth() {
        // Two columns with a gap between, the right one 50 too high and tilted by 2 from row to row.
        let islands = Mask::from_fn(3, 2, |x, _| x != 1);
        let truth = Plane::filled(3, 2, 7.0);
        let found = Plane::from_fn(3, 2, |x, y| if x == 2 { 57.0 + 2.0 * y as f32 } else { 7.0 });
        // Of four pixels two are off by 1.
        let rmse = rmse_without_offset(&found, &truth, &islands, &islands).unwrap();
        assert!((rmse - 0.5_f64.sqrt()).abs() < 1e-6, "{rmse}");
        // One surface has one offset, and what is not compared is bridged all the same.
        let bridged = Mask::filled(3, 2, true);
        assert!(rmse_without_offset(&found, &truth, &islands, &bridged).unwrap() > 20.0);
    }

    #[test]
    fn relative_error_is_relative_to_the_mean_truth() {
        let all = Mask::filled(2, 2, true);
        let error = relative_error(&plane([1.1, 0.9, 2.0, 2.0]), &plane([1.0, 1.0, 2.0, 2.0]), &all).unwrap();
        assert!((error - 0.2 / 6.0).abs() < 1e-6);
        assert_eq!(relative_error(&plane([1.0; 4]), &plane([0.0; 4]), &all), None);
    }
}
