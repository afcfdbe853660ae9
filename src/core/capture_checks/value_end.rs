//! The value at which stored values end: a pile of pixels at one value that the values around it do not have.

use rayon::prelude::*;

use crate::Plane;

/// A pile is this share of all pixels at least: fewer clipped pixels move no result.
const MIN_SHARE: f64 = 0.0005;
/// A pile has as many pixels at least.
const MIN_PIXELS: usize = 20;
/// A pile has so many times the mean of the values beside it. The brightest pixels of a photo that does not clip thin out
/// toward the last value: there this is below 1.
const MIN_OVER_BESIDE: f64 = 5.0;
/// And so many times the most frequent other value: walls of a picture without noise are piles too, but not the only ones.
const MIN_OVER_OTHERS: f64 = 3.0;
/// Values are counted one by one up to here; larger and fractional ones in as many steps.
const MAX_COUNTED: f32 = 65535.0;
/// Bits of sensors whose values end before those of the file that holds them.
const SENSOR_BITS: std::ops::Range<u32> = 8..16;

/// A value at which the values of a picture end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValueEnd {
    /// The stored value.
    pub value: f32,
    /// The share of pixels that have it.
    pub share: f64,
}

/// The value at which a picture's stored values end, where pixels pile up at it: their largest, or 2^n - 1 below it.
pub fn find_value_end(stored: &Plane, are_integers: bool) -> Option<ValueEnd> {
    let values = stored.data();
    let top = values.par_iter().copied().reduce(|| 0.0, f32::max);
    if top <= 0.0 || !top.is_finite() {
        return None;
    }
    let counts_integers = are_integers && top <= MAX_COUNTED;
    let scale = if counts_integers { 1.0 } else { MAX_COUNTED / top };
    let counts = Counts::of(values, scale, (top * scale).round() as usize);
    let below_top = |value: &usize| counts_integers && *value < counts.counts.len() - 1;
    let sensors = SENSOR_BITS.map(|bits| (1 << bits) - 1).filter(below_top);
    let ends = sensors.chain([counts.counts.len() - 1]).filter(|value| counts.is_pile(*value));
    let most = ends.max_by_key(|value| counts.counts[*value])?;
    let share = counts.counts[most] as f64 / values.len() as f64;
    Some(ValueEnd { value: if counts_integers { most as f32 } else { top }, share })
}

/// How many pixels have each value.
struct Counts {
    counts: Vec<usize>,
    pixels: usize,
}

impl Counts {
    fn of(values: &[f32], scale: f32, last: usize) -> Self {
        // A cast from float clamps: what is below zero is counted there.
        let count = |values: &[f32]| {
            let mut counts = vec![0; last + 1];
            values.iter().for_each(|value| counts[((value * scale).round() as usize).min(last)] += 1);
            counts
        };
        let part = values.len().div_ceil(rayon::current_num_threads()).max(1);
        let sums = values.par_chunks(part).map(count).reduce_with(|mut left, right| {
            left.iter_mut().zip(right).for_each(|(left, right)| *left += right);
            left
        });
        Self { counts: sums.unwrap_or_else(|| vec![0; last + 1]), pixels: values.len() }
    }

    fn is_pile(&self, value: usize) -> bool {
        let count = self.counts[value] as f64;
        let reach = (value / 10).max(1);
        let below = &self.counts[value - reach.min(value)..value];
        let above = &self.counts[value + 1..(value + 1 + reach).min(self.counts.len())];
        let mean = |beside: &[usize]| beside.iter().sum::<usize>() as f64 / beside.len().max(1) as f64;
        // Without light there is a pile too.
        let lit = &self.counts[reach..];
        let others = lit.iter().enumerate().filter(|(index, _)| index + reach != value);
        let most_of_others = others.map(|(_, count)| *count).max().unwrap_or_default() as f64;
        count >= MIN_PIXELS as f64
            && count >= MIN_SHARE * self.pixels as f64
            && [below, above].iter().all(|beside| count >= MIN_OVER_BESIDE * mean(beside))
            && count >= MIN_OVER_OTHERS * most_of_others
    }
}

#[cfg(test)]
mod tests {
    use rand::rngs::StdRng;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    use super::*;

    /// A shaded wall with noise, as a sensor of so many bits stores it that clips `over` its range.
    fn photo(bits: i32, over: f64) -> Plane {
        let mut random = StdRng::seed_from_u64(3);
        let white = 2_f64.powi(bits) - 1.0;
        Plane::from_fn(200, 150, |x, y| {
            let light = over * (0.2 + 0.8 * x as f64 / 200.0 * (0.6 + 0.4 * y as f64 / 150.0));
            let noise = 0.003 * random.sample::<f64, _>(StandardNormal);
            ((light + noise) * white).round().clamp(0.0, white) as f32
        })
    }

    #[test]
    fn values_of_twelve_bits_end_where_their_sensor_clips() {
        let end = find_value_end(&photo(12, 1.2), true).unwrap();
        assert_eq!(end.value, 4095.0);
        assert!((0.02..0.3).contains(&end.share), "{}", end.share);
    }

    #[test]
    fn a_few_values_beyond_the_end_do_not_hide_it() {
        let mut photo = photo(12, 1.2);
        (0..9).for_each(|x| photo.set(x * 20, 3, 4200.0 + 7.0 * x as f32));
        assert_eq!(find_value_end(&photo, true).unwrap().value, 4095.0);
    }

    #[test]
    fn fractions_end_too() {
        let mut photo = photo(12, 1.2);
        photo.data_mut().iter_mut().for_each(|value| *value /= 4095.0);
        assert_eq!(find_value_end(&photo, false).unwrap().value, 1.0);
    }

    #[test]
    fn a_photo_that_does_not_clip_has_no_end() {
        for bits in [8, 12, 16] {
            assert_eq!(find_value_end(&photo(bits, 0.9), true), None, "{bits} bits");
        }
        assert_eq!(find_value_end(&Plane::filled(50, 50, 0.0), true), None, "no light");
    }

    #[test]
    fn walls_without_noise_are_no_end() {
        let walls = Plane::from_fn(60, 60, |x, y| if x + y < 60 { 80.0 } else { 160.0 });
        assert_eq!(find_value_end(&walls, true), None);
    }
}
