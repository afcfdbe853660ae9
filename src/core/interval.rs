//! Values with 95 % intervals, and the jackknife that finds them.
//!
//! Residuals of a ball are alike in neighbouring pixels (dust, gloss, a lamp that is not quite a point), so pixels must
//! not be counted as independent. The jackknife leaves out one region of the ball at a time instead and sees how far
//! the answer moves; that takes in what a noise model does not know of.

use nalgebra::{SMatrix, SVector};

/// A closed range that holds the true value in 95 of 100 cases.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// The range `value` plus or minus `half_width`.
    pub fn around(value: f64, half_width: f64) -> Self {
        Self { low: value - half_width, high: value + half_width }
    }

    /// Whether `value` lies inside.
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

/// A measured value and its 95 % interval, in the value's own unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The most likely value.
    pub value: f64,
    /// Where the true value lies in 95 of 100 cases.
    pub interval: Interval,
}

impl Estimate {
    /// A value known by definition, such as the alpha of the reference colour.
    pub fn exact(value: f64) -> Self {
        Self { value, interval: Interval { low: value, high: value } }
    }

    /// A value with a standard deviation found from `groups` independent parts.
    pub fn with_sd(value: f64, sd: f64, groups: usize) -> Self {
        Self { value, interval: Interval::around(value, sd * coverage_factor(groups)) }
    }

    /// Standard deviation of the normal distribution whose 95 % lie in the interval.
    pub fn sd(&self) -> f64 {
        (self.interval.high - self.interval.low) / (2.0 * 1.96)
    }

    /// The same value with an interval that holds what a disturbance did to it, of which `without` leaves out a half or
    /// more.
    pub fn widened_to(&self, without: &Self) -> Self {
        let far = 2.0 * without.value - self.value;
        let ends = [self.interval.low, self.interval.high, without.interval.low, without.interval.high, far];
        let [low, high] = [ends.into_iter().fold(far, f64::min), ends.into_iter().fold(far, f64::max)];
        Self { value: self.value, interval: Interval { low, high } }
    }

    /// Half of the interval's width over the value.
    pub fn relative_half_width(&self) -> f64 {
        (self.interval.high - self.interval.low) / (2.0 * self.value.abs())
    }
}

/// Standard deviations in half a 95 % interval when the deviation was found from `groups` parts: Student's t with
/// `groups - 1` degrees of freedom, to 5 % from four groups on.
pub fn coverage_factor(groups: usize) -> f64 {
    1.96 + 2.6 / (groups.max(2) - 1) as f64
}

/// What the jackknife found: the estimate from everything and the covariance of its error.
#[derive(Clone, Copy, Debug)]
pub struct Jackknifed<const N: usize> {
    /// The estimate from all groups.
    pub value: SVector<f64, N>,
    /// Covariance of its error.
    pub covariance: SMatrix<f64, N, N>,
    /// Groups that held anything.
    pub groups: usize,
}

/// Delete-a-group jackknife for groups of unequal size (Busing, Meijer, van der Leeden, Statistics and Computing 1999,
/// equation 3). `sizes` counts the data in each group; `estimate(Some(j))` answers without group `j`, `estimate(None)`
/// from all. `None` where an estimate cannot be made or fewer than three groups hold data.
pub fn jackknife<const N: usize>(
    sizes: &[usize],
    estimate: impl Fn(Option<usize>) -> Option<SVector<f64, N>>,
) -> Option<Jackknifed<N>> {
    let total: usize = sizes.iter().sum();
    let value = estimate(None)?;
    let mut pseudo_values = Vec::with_capacity(sizes.len());
    for (group, &size) in sizes.iter().enumerate().filter(|&(_, &size)| size > 0) {
        let share = total as f64 / size as f64;
        pseudo_values.push((share, value * share - estimate(Some(group))? * (share - 1.0)));
    }
    let groups = pseudo_values.len();
    if groups < 3 {
        return None;
    }
    let centre: SVector<f64, N> = pseudo_values.iter().map(|(share, pseudo)| pseudo / *share).sum();
    let covariance = pseudo_values
        .iter()
        .map(|(share, pseudo)| (pseudo - centre) * (pseudo - centre).transpose() / (share - 1.0))
        .sum::<SMatrix<f64, N, N>>()
        / groups as f64;
    Some(Jackknifed { value, covariance, groups })
}

/// The median; reorders `values`. Zero for none.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    quantile(values, 0.5)
}

/// The value below which the fraction `at` of `values` lies; reorders them. Zero for none.
pub(crate) fn quantile(values: &mut [f64], at: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let index = ((values.len() - 1) as f64 * at).round() as usize;
    *values.select_nth_unstable_by(index, f64::total_cmp).1
}

/// Standard deviation of normal noise whose median absolute value is that of `residuals`.
pub(crate) fn robust_sd(residuals: impl Iterator<Item = f64>) -> f64 {
    1.4826 * median(&mut residuals.map(f64::abs).collect::<Vec<_>>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector1;

    #[test]
    fn the_jackknife_of_a_mean_is_its_standard_error() {
        let data = [3.0, 5.0, 1.0, 8.0, 2.0, 7.0];
        let mean = |left_out: Option<usize>| {
            let kept: Vec<f64> =
                data.iter().enumerate().filter(|&(i, _)| Some(i) != left_out).map(|(_, &x)| x).collect();
            Some(Vector1::new(kept.iter().sum::<f64>() / kept.len() as f64))
        };
        let found = jackknife(&[1; 6], mean).unwrap();
        let centre = data.iter().sum::<f64>() / 6.0;
        let squared_error = data.iter().map(|x| (x - centre).powi(2)).sum::<f64>() / (5.0 * 6.0);
        assert!((found.covariance[0] - squared_error).abs() < 1e-12);
    }

    #[test]
    fn two_groups_are_too_few_for_an_interval() {
        assert!(jackknife(&[4, 4, 0], |_| Some(Vector1::new(1.0))).is_none());
    }

    #[test]
    fn a_quantile_lies_at_its_rank() {
        assert_eq!(quantile(&mut [5.0, 1.0, 3.0, 2.0, 4.0], 0.75), 4.0);
        assert_eq!(median(&mut []), 0.0);
    }
}
