//! Crosstalk: what each channel sees of the lamp of another colour, on a matte ball under one lamp colour at a time.

use super::pixels::{REGIONS, choose_pixels, require_enough};
use super::ratio::ratio_and_slope;
use super::{BallPixels, CalibrateError, PixelUse, RatioOptions};
use crate::Photo;
use crate::image::photo::CLIPPED;
use crate::interval::{Estimate, coverage_factor, jackknife};
use crate::sphere::Ball;

/// How to measure crosstalk.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct CrosstalkOptions {
    /// Which pixels are good enough, how well the black level is known, and from which difference on light that does not change over
    /// the ball is one: as of a ratio of two photos, `max_offset` as a share of the lamp's own light.
    pub ratio: RatioOptions,
}

impl CrosstalkOptions {
    /// Whether every option is in its range.
    ///
    /// # Errors
    /// Which is not.
    pub fn check(&self) -> Result<(), CalibrateError> {
        self.ratio.check()
    }
}

/// What the channels see of one lamp colour.
#[derive(Clone, Debug, PartialEq)]
pub struct CrosstalkReport {
    /// By channel: its light over that of the lamp's own channel, which is 1. Noise may make a small one negative.
    pub shares: Vec<Estimate>,
    /// The pixels used and refused.
    pub pixels: BallPixels,
}

/// Measures what each channel sees of the one lamp that was on, whose own channel is the one with index `lit`.
///
/// The likeliest share is the ratio of the sums over the ball, as of [`super::measure_ratio`]; a dark pixel of another channel
/// counts, for it says that there is little crosstalk.
///
/// # Errors
/// Photos of several sizes, a ball that leaves them, and too few good pixels.
pub fn measure_crosstalk(
    channels: &[&Photo],
    lit: usize,
    ball: &Ball,
    options: &CrosstalkOptions,
) -> Result<CrosstalkReport, CalibrateError> {
    options.check()?;
    let own = *channels.get(lit).ok_or(CalibrateError::NothingMeasured { quantity: "crosstalk" })?;
    let first = own.linear.size();
    if let Some(other) = channels.iter().map(|photo| photo.linear.size()).find(|size| *size != first) {
        return Err(CalibrateError::SizesDiffer { first, other });
    }
    let pixel_options = &options.ratio.pixels;
    let mut pixels = choose_pixels(&[own], ball, pixel_options)?;
    for pixel in pixels.used() {
        let is_clipped = channels.iter().any(|photo| photo.marks.at(pixel.x, pixel.y) & CLIPPED != 0);
        let is_finite = channels.iter().all(|photo| photo.linear.at(pixel.x, pixel.y).is_finite());
        if is_clipped || !is_finite {
            pixels.uses[pixel.index] = if is_clipped { PixelUse::Clipped } else { PixelUse::Outlier };
        }
    }
    require_enough(&pixels, pixel_options)?;
    let used = pixels.used();
    let share = |channel: usize| {
        if channel == lit {
            return Some(Estimate::exact(1.0));
        }
        let mut sums = [(0usize, 0.0, 0.0); REGIONS];
        for pixel in &used {
            let (count, x, y) = &mut sums[pixel.region];
            *count += 1;
            *x += pixel.value(own);
            *y += pixel.value(channels[channel]);
        }
        let mean = sums.iter().map(|sum| sum.1).sum::<f64>() / used.len() as f64;
        let found = jackknife(&sums.map(|sum| sum.0), |left_out| {
            let kept = sums.iter().enumerate().filter(|&(region, _)| Some(region) != left_out).map(|(_, sum)| *sum);
            ratio_and_slope(kept)
        })?;
        let (value, slope) = (found.value[0], found.value[1]);
        let black_level_sd = options.ratio.black_level_sd / mean * (1.0 + value * value).sqrt();
        let sd = found.covariance[(0, 0)].sqrt().hypot(black_level_sd);
        let estimate = Estimate::with_sd(value, sd, found.groups);
        let slope_sd = found.covariance[(1, 1)].sqrt();
        // Light that is the same everywhere, as a room's, is in the ratio and not in the slope.
        let is_offset = (slope - value).abs() > options.ratio.max_offset + 3.0 * slope_sd;
        let of_slope = Estimate::with_sd(slope, slope_sd, found.groups);
        Some(if is_offset { estimate.widened_to(&of_slope) } else { estimate })
    };
    let shares: Option<Vec<_>> = (0..channels.len()).map(share).collect();
    let too_few = || CalibrateError::TooFewPixels { counts: pixels.counts(), needed: pixel_options.min_pixels };
    Ok(CrosstalkReport { shares: shares.ok_or_else(too_few)?, pixels })
}

/// One share of several lamps of the same colour, weighted by their variances; widened where they differ by more than their intervals
/// allow (Birge ratio).
///
/// # Errors
/// No share at all.
pub fn pool_shares(shares: &[Estimate]) -> Result<Estimate, CalibrateError> {
    if shares.is_empty() {
        return Err(CalibrateError::NothingMeasured { quantity: "crosstalk" });
    }
    let half = |share: &Estimate| ((share.interval.high - share.interval.low) / 2.0).max(1e-9);
    let weight: f64 = shares.iter().map(|share| half(share).powi(-2)).sum();
    let value = shares.iter().map(|share| share.value / half(share).powi(2)).sum::<f64>() / weight;
    let deviations = shares.iter().map(|share| (coverage_factor(60) * (share.value - value) / half(share)).powi(2));
    let birge = (deviations.sum::<f64>() / (shares.len() - 1).max(1) as f64).sqrt().max(1.0);
    Ok(Estimate { value, interval: crate::interval::Interval::around(value, birge / weight.sqrt()) })
}
