//! alpha and beta: how much stronger a ball shines in one photo than in another.

use super::{
    BallPixels, CalibrateError, PixelOptions, PixelUse,
    pixels::{REGIONS, choose_pixels, require_enough},
};
use crate::Photo;
use crate::interval::{Estimate, Interval, coverage_factor, jackknife, median, robust_sd};
use crate::options::check_range;
use crate::sphere::Ball;
use nalgebra::Vector2;

/// How to measure a ratio.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RatioOptions {
    /// Which pixels are good enough.
    pub pixels: PixelOptions,
    /// Standard deviation of the black level that was subtracted, in linear light. It shifts both photos of a ratio and
    /// no scatter between pixels shows it. Default: one step of a 14-bit sensor.
    pub black_level_sd: f64,
    /// A ratio that is off that of the light that changes over the ball by a larger share is spoiled by light that does not
    /// change.
    pub max_offset: f64,
}

impl Default for RatioOptions {
    fn default() -> Self {
        Self { pixels: PixelOptions::default(), black_level_sd: 1.0 / 16384.0, max_offset: 0.003 }
    }
}

impl RatioOptions {
    /// Whether every option is in its range.
    pub fn check(&self) -> Result<(), CalibrateError> {
        let noise = self.black_level_sd;
        check_range("black_level_sd", noise, (0.0..0.1).contains(&noise), "between 0 and 0.1")?;
        check_range("max_offset", self.max_offset, (0.0..1.0).contains(&self.max_offset), "from 0 to below 1")?;
        self.pixels.check()
    }
}

/// A ratio through the origin and the pixels behind it.
#[derive(Clone, Debug, PartialEq)]
pub struct RatioReport {
    /// Light in the second photo over light in the first.
    pub ratio: Estimate,
    /// The ratio of the light that changes over the ball. Light that is the same everywhere, as that of a room or a black
    /// level that is off, changes the other ratio, but not this one, which is noisier.
    pub slope: Estimate,
    /// Whether the two differ by more than noise allows. Light from one side changes over the ball too: as much of it may
    /// still be in the slope as it leaves out.
    pub offset: bool,
    /// The ratio in each pixel used, in the order of the pixels; for a histogram.
    pub pixel_ratios: Vec<f32>,
    /// Scatter of one pixel's ratio, relative, robust against outliers.
    pub scatter: f64,
    /// The pixels used and refused.
    pub pixels: BallPixels,
}

/// Measures alpha: the light of a grey ball in `photo` over its light in `reference`, same lamp, same place.
///
/// Both photos are noisy, and photon noise grows with the square root of the light: the likeliest slope through the
/// origin is then the ratio of the sums. Pixels off it by more than `max_deviations` are refused.
pub fn measure_ratio(
    reference: &Photo,
    photo: &Photo,
    ball: &Ball,
    options: &RatioOptions,
) -> Result<RatioReport, CalibrateError> {
    options.check()?;
    let mut pixels = choose_pixels(&[reference, photo], ball, &options.pixels)?;
    refuse_off_slope(&mut pixels, reference, photo, options.pixels.max_deviations);
    require_enough(&pixels, &options.pixels)?;

    let used = pixels.used();
    let mut sums = [(0usize, 0.0, 0.0); REGIONS];
    for pixel in &used {
        let (count, x, y) = &mut sums[pixel.region];
        *count += 1;
        *x += pixel.value(reference);
        *y += pixel.value(photo);
    }
    let ratios = |left_out: Option<usize>| {
        let kept = sums.iter().enumerate().filter(|&(region, _)| Some(region) != left_out).map(|(_, sum)| *sum);
        ratio_and_slope(kept)
    };
    let too_few = || CalibrateError::TooFewPixels { counts: pixels.counts(), needed: options.pixels.min_pixels };
    let found = jackknife(&sums.map(|sum| sum.0), ratios).ok_or_else(too_few)?;
    let value = found.value[0];
    if !(value.is_finite() && value > 0.0) {
        return Err(CalibrateError::Impossible { quantity: "the ratio of two photos", value });
    }
    let mean_reference = sums.iter().map(|sum| sum.1).sum::<f64>() / used.len() as f64;
    let black_level_sd = options.black_level_sd / mean_reference * (1.0 + value * value).sqrt();
    let sd = found.covariance[(0, 0)].sqrt().hypot(black_level_sd);
    let slope_sd = found.covariance[(1, 1)].sqrt();
    let off = (found.value[1] - value).abs();
    let offset = off > options.max_offset * value + 3.0 * slope_sd;
    let pixel_ratios: Vec<f32> = used.iter().map(|p| (p.value(photo) / p.value(reference)) as f32).collect();
    let scatter = robust_sd(pixel_ratios.iter().map(|&ratio| f64::from(ratio) / value - 1.0));
    Ok(RatioReport {
        ratio: Estimate::with_sd(value, sd, found.groups),
        slope: Estimate::with_sd(found.value[1], slope_sd, found.groups),
        offset,
        pixel_ratios,
        scatter,
        pixels,
    })
}

/// y over x of all regions together, and by how much y grows with x from region to region (least squares of the regions'
/// means, weighted by their pixels; the noise of a mean is too small to flatten the line).
pub(super) fn ratio_and_slope(regions: impl Iterator<Item = (usize, f64, f64)>) -> Option<Vector2<f64>> {
    let (mut count, mut x, mut y, mut xx, mut xy) = (0.0, 0.0, 0.0, 0.0, 0.0);
    for (pixels, sum_x, sum_y) in regions.filter(|&(pixels, ..)| pixels > 0) {
        let pixels = pixels as f64;
        count += pixels;
        x += sum_x;
        y += sum_y;
        xx += sum_x * sum_x / pixels;
        xy += sum_x * sum_y / pixels;
    }
    let spread = xx - x * x / count;
    (x > 0.0 && spread > 0.0).then(|| Vector2::new(y / x, (xy - x * y / count) / spread))
}

fn refuse_off_slope(pixels: &mut BallPixels, reference: &Photo, photo: &Photo, max_deviations: f64) {
    let used = pixels.used();
    let slope = median(&mut used.iter().map(|p| p.value(photo) / p.value(reference)).collect::<Vec<_>>());
    let off = |x: f64, y: f64| (y - slope * x) / (y + slope * x).abs().max(f64::MIN_POSITIVE).sqrt();
    let residuals: Vec<f64> = used.iter().map(|p| off(p.value(reference), p.value(photo))).collect();
    // Noise-free light still is rounded to f32.
    let sd = robust_sd(residuals.iter().copied()).max(1e-5);
    for (pixel, residual) in used.iter().zip(residuals) {
        if residual.abs() > max_deviations * sd {
            pixels.uses[pixel.index] = PixelUse::Outlier;
        }
    }
}

/// beta of a colour: for each light, the ratio on a ball of the paint over that light's alpha; pooled over the lights.
///
/// Lights are weighted by their variances, alpha's included. If the lights differ by more than their intervals allow,
/// the interval is widened by as much (Birge ratio).
pub fn pool_beta(paint_over_alpha: &[(Estimate, Estimate)]) -> Result<Estimate, CalibrateError> {
    let of_lights: Vec<(f64, f64)> = paint_over_alpha
        .iter()
        .map(|(paint, alpha)| {
            let value = paint.value / alpha.value;
            let half_width = value * paint.relative_half_width().hypot(alpha.relative_half_width());
            (value, half_width.max(1e-9 * value))
        })
        .collect();
    if of_lights.is_empty() {
        return Err(CalibrateError::NothingMeasured { quantity: "beta" });
    }
    let weight: f64 = of_lights.iter().map(|(_, half)| half.powi(-2)).sum();
    let value = of_lights.iter().map(|(value, half)| value / half.powi(2)).sum::<f64>() / weight;
    // Half widths are 95 %: about two standard deviations.
    let chi_squared: f64 = of_lights.iter().map(|(v, half)| (coverage_factor(60) * (v - value) / half).powi(2)).sum();
    let birge = (chi_squared / (of_lights.len() - 1).max(1) as f64).sqrt().max(1.0);
    Ok(Estimate { value, interval: Interval::around(value, birge / weight.sqrt()) })
}
