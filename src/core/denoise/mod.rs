//! Denoising of the direct light: indirect light varies slowly over a surface, so most of its noise can be averaged away.
//!
//! The sum T of all bounces is hardly noisier than a photo; what is noisy is how T divides into direct and indirect light.
//! Indirect light arrives from the whole object, so over a few pixels it follows T by a straight line: I = a T + b. The line
//! is fitted in a window around every pixel and the lines of all windows over a pixel are averaged (K. He, J. Sun, X. Tang,
//! "Guided Image Filtering", ECCV 2010), with the part of the covariances that is noise taken out, since T and I come from
//! the same photos. A crease, where both jump, stays sharp. Then L_1 = T - I.

mod window;

use rayon::prelude::*;
use thiserror::Error;

use crate::options::{OptionError, check_range};
use crate::separate::{BounceSystem, LightPhotos, OUTSIDE, SeparateError, Separation, UNSOLVED};
use crate::{Plane, Watch};

/// How to denoise the direct light.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct DenoiseOptions {
    /// Half the width of the window in pixels; 0 leaves the direct light as it was separated.
    pub radius_px: usize,
    /// Light that varies in the window by less than this share of its mean counts as even: there I is averaged.
    pub evenness: f64,
}

impl Default for DenoiseOptions {
    fn default() -> Self {
        Self { radius_px: 3, evenness: 0.02 }
    }
}

/// The widest window: beyond it indirect light is not slow any more.
pub const MAX_RADIUS_PX: usize = 64;

impl DenoiseOptions {
    /// Whether every option is in its range.
    pub fn check(&self) -> Result<(), DenoiseError> {
        let (radius_px, evenness) = (self.radius_px, self.evenness);
        check_range("radius_px", radius_px as f64, radius_px <= MAX_RADIUS_PX, "0 to 64")?;
        Ok(check_range("evenness", evenness, evenness > 0.0 && evenness < 1.0, "between 0 and 1")?)
    }
}

/// Why the direct light was not denoised.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum DenoiseError {
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// The photos do not fit together.
    #[error(transparent)]
    Separate(#[from] SeparateError),
    /// The watch cancelled.
    #[error("cancelled")]
    Cancelled,
}

/// Direct light with less noise.
#[derive(Clone, Debug, PartialEq)]
pub struct DenoisedDirect {
    /// L_1 in linear light of the reference colour; zero where the separation solved nothing.
    pub direct: Plane,
    /// Predicted noise (standard deviation) of `direct`.
    pub noise: Plane,
    /// Mean predicted noise of L_1 over solved pixels before, and after.
    pub report: DenoiseReport,
}

/// What denoising reports. Means run over the solved pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DenoiseReport {
    /// Mean predicted noise of L_1 as it was separated.
    pub noise_before: f64,
    /// Mean predicted noise of L_1 now.
    pub noise_after: f64,
}

/// Noise of the sum T, of the indirect light I, and what they share, at the object's typical light.
#[derive(Clone, Copy, Debug)]
struct TypicalNoise {
    total: f64,
    indirect: f64,
    shared: f64,
    direct: f64,
}

impl TypicalNoise {
    fn of(system: &BounceSystem, sigma: &[f64]) -> Self {
        let column = |c: usize| system.operator.column(c);
        let (mut total, mut indirect, mut shared, mut direct) = (0.0, 0.0, 0.0, 0.0);
        for (c, sigma) in sigma.iter().enumerate() {
            let (sum, first) = (column(c).sum(), column(c)[0]);
            let variance = sigma * sigma;
            total += sum * sum * variance;
            indirect += (sum - first).powi(2) * variance;
            shared += sum * (sum - first) * variance;
            direct += first * first * variance;
        }
        Self { total, indirect, shared, direct }
    }
}

/// Predicted noise (standard deviation) of the denoised L_1 where the indirect light is even: a pixel in the middle of a wall.
/// `sigma` is the noise of each colour's photo in its own linear light.
pub fn denoised_noise(system: &BounceSystem, sigma: &[f64], options: &DenoiseOptions) -> f64 {
    let typical = TypicalNoise::of(system, sigma);
    if options.radius_px == 0 {
        return typical.direct.sqrt();
    }
    (typical.total + averaged_share(options) * typical.indirect).min(typical.direct).sqrt()
}

/// What is left of a variance that two window means in a row average: a triangle of this width in x and in y.
fn averaged_share(options: &DenoiseOptions) -> f64 {
    let side = (2 * options.radius_px + 1) as f64;
    ((2.0 * side * side + 1.0) / (3.0 * side.powi(3))).powi(2)
}

/// Takes most of the noise of the indirect light out of L_1 of a light that was separated.
pub fn denoise_direct(
    light: &LightPhotos,
    separation: &Separation,
    options: &DenoiseOptions,
    watch: &dyn Watch,
) -> Result<DenoisedDirect, DenoiseError> {
    options.check()?;
    let sigma = light.typical_sigma();
    let system = BounceSystem::new(light.alpha, light.beta, &sigma, separation.bounces.len())?;
    let typical = TypicalNoise::of(&system, &sigma);
    let size = separation.bounces[0].size();
    let solved = |pixel: usize| separation.marks.data()[pixel] & (UNSOLVED | OUTSIDE) == 0;
    let plain_noise = separation.direct_noise.clone().unwrap_or_else(|| Plane::filled(size.0, size.1, 0.0));
    let noise_before = mean_where(&plain_noise, solved);
    if options.radius_px == 0 || separation.bounces.len() == 1 {
        let report = DenoiseReport { noise_before, noise_after: noise_before };
        return Ok(DenoisedDirect { direct: separation.bounces[0].clone(), noise: plain_noise, report });
    }

    let total = total_of(separation);
    let lines = window::lines(separation, &total, &typical, options, &solved);
    if watch.cancelled() {
        return Err(DenoiseError::Cancelled);
    }
    watch.progress(0.5);
    let (slope, offset) = window::average(&lines, options.radius_px);
    let (direct, noise) = apply(separation, &total, &slope, &offset, &plain_noise, &typical, options);
    watch.progress(1.0);
    let noise_after = mean_where(&noise, solved);
    Ok(DenoisedDirect { direct, noise, report: DenoiseReport { noise_before, noise_after } })
}

/// T, the sum of all bounces.
fn total_of(separation: &Separation) -> Plane {
    let mut total = separation.bounces[0].clone();
    for bounce in &separation.bounces[1..] {
        total.data_mut().par_iter_mut().zip(bounce.data()).for_each(|(sum, light)| *sum += light);
    }
    total
}

/// L_1 = T - a T - b, and its noise.
fn apply(
    separation: &Separation,
    total: &Plane,
    slope: &Plane,
    offset: &Plane,
    plain_noise: &Plane,
    typical: &TypicalNoise,
    options: &DenoiseOptions,
) -> (Plane, Plane) {
    let (width, height) = total.size();
    let averaged = averaged_share(options) * typical.indirect;
    let mut direct = Plane::filled(width, height, 0.0);
    let mut noise = Plane::filled(width, height, 0.0);
    (direct.data_mut(), noise.data_mut()).into_par_iter().enumerate().for_each(|(pixel, (direct, noise))| {
        if separation.marks.data()[pixel] & (UNSOLVED | OUTSIDE) != 0 {
            return;
        }
        let keep = 1.0 - slope.data()[pixel];
        *direct = keep * total.data()[pixel] - offset.data()[pixel];
        // This pixel's noise relative to the typical one scales all parts alike.
        let plain = plain_noise.data()[pixel];
        let relative = f64::from(plain).powi(2) / typical.direct.max(f64::MIN_POSITIVE);
        let variance = relative * (f64::from(keep).powi(2) * typical.total + averaged);
        *noise = plain.min(variance.sqrt() as f32);
    });
    (direct, noise)
}

fn mean_where(plane: &Plane, keep: impl Fn(usize) -> bool + Sync) -> f64 {
    let values = plane.data().par_iter().enumerate().filter(|(pixel, _)| keep(*pixel));
    let (sum, count) =
        values.map(|(_, &value)| (f64::from(value), 1usize)).reduce(|| (0.0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    sum / count.max(1) as f64
}

#[cfg(test)]
mod tests;
