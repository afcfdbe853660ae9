//! Many values, counted into the bars of a histogram.

const BARS: usize = 48;
/// Values beyond this share at either end are left out of the range.
const LEFT_OUT: f64 = 0.005;

/// How many values lie where.
#[derive(Clone, Debug, PartialEq)]
pub struct Bars {
    low: f64,
    width: f64,
    counts: Vec<usize>,
}

impl Bars {
    /// Counts values; what is not finite is left out. It sorts them all: not for every frame.
    pub fn of(values: impl Iterator<Item = f64>) -> Self {
        let mut sorted: Vec<f64> = values.filter(|value| value.is_finite()).collect();
        sorted.sort_by(f64::total_cmp);
        let at = |share: f64| sorted.get((share * sorted.len() as f64) as usize).or(sorted.last()).copied();
        let (Some(low), Some(high)) = (at(LEFT_OUT), at(1.0 - LEFT_OUT)) else {
            return Self { low: 0.0, width: 1.0, counts: Vec::new() };
        };
        let width = ((high - low) / BARS as f64).max(1e-9);
        let mut counts = vec![0; BARS];
        for value in sorted {
            if let Some(count) = counts.get_mut(((value - low) / width).floor() as usize).filter(|_| value >= low) {
                *count += 1;
            }
        }
        Self { low, width, counts }
    }

    /// The least and the largest value of the range.
    pub fn range(&self) -> [f64; 2] {
        [self.low, self.low + self.width * BARS as f64]
    }

    /// Their width, and the middle and count of each.
    pub fn bars(&self) -> (f64, impl Iterator<Item = (f64, usize)>) {
        let middle = |index: usize| self.low + (index as f64 + 0.5) * self.width;
        (self.width, self.counts.iter().enumerate().map(move |(index, count)| (middle(index), *count)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_value_of_the_range_is_in_one_bar_and_far_ones_do_not_widen_it() {
        let values = (0..1000).map(f64::from).chain([f64::NAN, 1e9]);
        let bars = Bars::of(values);
        let [low, high] = bars.range();
        assert!((4.0..7.0).contains(&low) && (990.0..1001.0).contains(&high), "{low} {high}");
        let counted: usize = bars.counts.iter().sum();
        assert!((985..=996).contains(&counted), "{counted}");
        assert!(Bars::of(std::iter::empty()).counts.is_empty());
    }
}
