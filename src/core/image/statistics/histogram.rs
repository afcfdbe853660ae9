//! The histogram of a plane.

use rayon::prelude::*;

use crate::{Mask, Plane};

/// Values of one job of a core.
const JOB: usize = 1 << 16;

/// How the bins part the range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// Bins of one width.
    #[default]
    Linear,
    /// Bins of one ratio; only positive values have a place.
    Logarithmic,
}

/// Counts of values in bins.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// How the bins part the range.
    pub scale: Scale,
    /// Lower end of the first bin and upper end of the last.
    pub range: [f64; 2],
    /// Values in each bin; the last bin holds its upper end.
    pub counts: Vec<u64>,
    /// Values below the range; with a logarithmic scale all that are not positive.
    pub below: u64,
    /// Values above the range.
    pub above: u64,
    /// Values that are no number.
    pub not_a_number: u64,
}

impl Histogram {
    /// Of the values inside `mask` (of all without one), in `bins` bins over their whole range; with a logarithmic scale
    /// over at most `DECADES` decades below the largest.
    pub fn new(plane: &Plane, mask: Option<&Mask>, bins: usize, scale: Scale) -> Self {
        let chosen = |pixel: usize| mask.is_none_or(|mask| mask.data().get(pixel) == Some(&true));
        let (low, high) = extent(plane, scale, &chosen);
        let mut histogram = Self { scale, range: [low, high], ..Self::empty(bins.max(1)) };
        let jobs = plane.data().par_chunks(JOB).enumerate();
        let counted = jobs
            .map(|(job, values)| {
                let mut part = Self { scale, range: [low, high], ..Self::empty(histogram.counts.len()) };
                let inside = values.iter().enumerate().filter(|(at, _)| chosen(job * JOB + at));
                inside.for_each(|(_, value)| part.count(f64::from(*value)));
                part
            })
            .reduce(|| Self::empty(histogram.counts.len()), Self::join);
        let Self { counts, below, above, not_a_number, .. } = counted;
        (histogram.counts, histogram.below, histogram.above) = (counts, below, above);
        histogram.not_a_number = not_a_number;
        histogram
    }

    /// Lower and upper end of bin `bin`.
    pub fn bin(&self, bin: usize) -> [f64; 2] {
        [self.edge(bin), self.edge(bin + 1)]
    }

    /// Values in all bins.
    pub fn total(&self) -> u64 {
        self.counts.iter().sum()
    }

    fn empty(bins: usize) -> Self {
        Self { scale: Scale::Linear, range: [0.0, 1.0], counts: vec![0; bins], below: 0, above: 0, not_a_number: 0 }
    }

    fn edge(&self, edge: usize) -> f64 {
        let at = edge as f64 / self.counts.len() as f64;
        let [low, high] = self.range;
        match self.scale {
            Scale::Linear => low + (high - low) * at,
            Scale::Logarithmic => low * (high / low).powf(at),
        }
    }

    fn count(&mut self, value: f64) {
        let [low, high] = self.range;
        let at = match self.scale {
            Scale::Linear => (value - low) / (high - low),
            Scale::Logarithmic if value > 0.0 => (value / low).ln() / (high / low).ln(),
            Scale::Logarithmic => f64::NEG_INFINITY,
        };
        let bins = self.counts.len();
        match value {
            value if value.is_nan() => self.not_a_number += 1,
            value if value > high => self.above += 1,
            _ if at < 0.0 => self.below += 1,
            _ => self.counts[((at * bins as f64) as usize).min(bins - 1)] += 1,
        }
    }

    fn join(mut self, other: Self) -> Self {
        self.counts.iter_mut().zip(other.counts).for_each(|(sum, more)| *sum += more);
        self.below += other.below;
        self.above += other.above;
        self.not_a_number += other.not_a_number;
        self
    }
}

/// Decades of a logarithmic histogram: more than a photo has.
const DECADES: i32 = 6;

/// The finite range of the chosen values, never empty.
fn extent(plane: &Plane, scale: Scale, chosen: &(impl Fn(usize) -> bool + Sync)) -> (f64, f64) {
    let usable = |value: f32| value.is_finite() && (scale == Scale::Linear || value > 0.0);
    let values = plane.data().par_iter().enumerate();
    let (low, high) = values
        .filter(|(pixel, value)| usable(**value) && chosen(*pixel))
        .map(|(_, value)| *value)
        .fold(|| (f32::INFINITY, f32::NEG_INFINITY), |range, value| (range.0.min(value), range.1.max(value)))
        .reduce(|| (f32::INFINITY, f32::NEG_INFINITY), |a, b| (a.0.min(b.0), a.1.max(b.1)));
    let (low, high) = (f64::from(low), f64::from(high));
    match scale {
        _ if low > high => (
            match scale {
                Scale::Linear => 0.0,
                Scale::Logarithmic => 0.1,
            },
            1.0,
        ),
        Scale::Linear if low == high => (low - 0.5, high + 0.5),
        Scale::Linear => (low, high),
        Scale::Logarithmic if low == high => (low / 2.0, high * 2.0),
        Scale::Logarithmic => (low.max(high * 10f64.powi(-DECADES)), high),
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_ramp_fills_linear_bins_alike() {
        let ramp = Plane::from_fn(1000, 200, |x, _| x as f32);
        let histogram = Histogram::new(&ramp, None, 10, Scale::Linear);
        assert_eq!(histogram.range, [0.0, 999.0]);
        assert!(histogram.counts.iter().all(|count| (*count as f64 / 20_000.0 - 1.0).abs() < 0.02));
    }

    #[test]
    fn powers_of_two_fill_logarithmic_bins_alike() {
        let powers = Plane::from_fn(8, 50, |x, _| 2f32.powi(x as i32));
        let histogram = Histogram::new(&powers, None, 7, Scale::Logarithmic);
        assert_eq!(histogram.counts.iter().sum::<u64>(), 400);
        assert!((histogram.bin(3)[0] - 8.0).abs() < 1e-9);
    }

    #[test]
    fn what_has_no_place_is_counted_apart() {
        let plane = Plane::from_vec(5, 1, vec![f32::NAN, -1.0, 0.0, 1.0, 10.0]).unwrap();
        let histogram = Histogram::new(&plane, None, 4, Scale::Logarithmic);
        assert_eq!((histogram.not_a_number, histogram.below, histogram.total()), (1, 2, 2));
        let mask = Mask::from_vec(5, 1, vec![false, true, false, true, false]).unwrap();
        assert_eq!(Histogram::new(&plane, Some(&mask), 2, Scale::Linear).counts, [1, 1]);
    }

    proptest! {
        #[test]
        fn every_value_is_counted_once(values in prop::collection::vec(prop::num::f32::ANY, 1..300), bins in 1usize..40) {
            for scale in [Scale::Linear, Scale::Logarithmic] {
                let plane = Plane::from_vec(values.len(), 1, values.clone()).unwrap();
                let h = Histogram::new(&plane, None, bins, scale);
                prop_assert_eq!(h.total() + h.below + h.above + h.not_a_number, values.len() as u64);
            }
        }
    }
}
