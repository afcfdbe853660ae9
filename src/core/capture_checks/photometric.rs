//! The photometric residual: light that no normal explains, where four lamps or more light a pixel.

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use crate::linear_algebra;

/// A lamp is in shadow where its light is below this share of the brightest lamp's.
const SHADOW_SHARE: f64 = 0.08;
/// Lamps of a pixel that say more than its normal.
const MIN_LIT: usize = 4;
/// Steps in which unknown intensities are found.
const GAIN_STEPS: usize = 15;
/// No lamp is so many times stronger than another.
const MAX_GAIN: f64 = 10.0;

/// By lamp, the light of one pixel.
pub(super) type Sample = Vec<f64>;

/// The light that no normal explains, as a share of the albedo: the median over pixels of its root mean square; `None` where
/// too few lamps light a pixel.
pub(super) fn residual(samples: &[Sample], toward: &[Vector3<f64>]) -> Option<f64> {
    let of_pixel = |sample: &Sample| {
        let (misses, lit) = misses(sample, toward)?;
        Some((misses.iter().map(|miss| miss * miss).sum::<f64>() / lit as f64).sqrt())
    };
    median(samples.par_iter().filter_map(of_pixel).collect())
}

/// By lamp, the median of the light that no normal explains.
pub(super) fn residual_of_lamps(samples: &[Sample], toward: &[Vector3<f64>]) -> Vec<f64> {
    let all: Vec<Vec<f64>> = samples.iter().filter_map(|sample| Some(misses(sample, toward)?.0)).collect();
    (0..toward.len()).map(|l| median(all.iter().map(|misses| misses[l].abs()).collect()).unwrap_or_default()).collect()
}

/// The lamps with the intensities that explain the light best, where the real ones are not known.
pub(super) fn with_fitted_intensities(samples: &[Sample], toward: &[Vector3<f64>]) -> Vec<Vector3<f64>> {
    let mut fitted = toward.to_vec();
    for _ in 0..GAIN_STEPS {
        let scaled: Vec<_> = samples.iter().map(|sample| fit(sample, &fitted, |_| true)).collect();
        let gain = |l: usize| {
            let lit = samples.iter().zip(&scaled).filter_map(|(sample, scaled)| {
                let expected = fitted[l].dot(scaled.as_ref()?);
                (expected > SHADOW_SHARE * fitted[l].norm() * scaled.as_ref()?.norm()).then(|| sample[l] / expected)
            });
            median(lit.collect()).unwrap_or(1.0)
        };
        let gains: Vec<f64> = (0..fitted.len()).map(gain).collect();
        for ((fitted, toward), gain) in fitted.iter_mut().zip(toward).zip(gains) {
            let whole = (fitted.norm() * gain / toward.norm()).clamp(1.0 / MAX_GAIN, MAX_GAIN);
            *fitted = toward * if whole.is_finite() { whole } else { 1.0 };
        }
    }
    fitted
}

/// By lamp, light less what the best normal explains, over the albedo, zero in shadow; and how many lamps light the pixel.
fn misses(sample: &Sample, toward: &[Vector3<f64>]) -> Option<(Vec<f64>, usize)> {
    let relative = |l: usize| sample[l] / toward[l].norm();
    let brightest = (0..toward.len()).map(relative).fold(0.0, f64::max);
    let is_lit = |l: usize| relative(l) >= SHADOW_SHARE * brightest;
    let lit = (0..toward.len()).filter(|l| is_lit(*l)).count();
    let scaled = if lit < MIN_LIT { None } else { fit(sample, toward, is_lit) }?;
    let albedo = scaled.norm();
    let miss = |l: usize| (sample[l] - toward[l].dot(&scaled)) / (toward[l].norm() * albedo);
    let all = (0..toward.len()).map(|l| if is_lit(l) { miss(l) } else { 0.0 }).collect();
    (albedo > 0.0).then_some((all, lit))
}

/// Albedo times normal from the lamps that are used.
fn fit(sample: &Sample, toward: &[Vector3<f64>], is_used: impl Fn(usize) -> bool) -> Option<Vector3<f64>> {
    let used = || (0..toward.len()).filter(|l| is_used(*l));
    let matrix: Matrix3<f64> = used().map(|l| toward[l] * toward[l].transpose()).sum();
    let right: Vector3<f64> = used().map(|l| toward[l] * sample[l]).sum();
    Some(linear_algebra::inverse(&matrix)? * right)
}

/// The middle of some numbers.
pub(super) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.retain(|value| value.is_finite());
    let middle = values.len() / 2;
    if values.is_empty() { None } else { Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1) }
}
