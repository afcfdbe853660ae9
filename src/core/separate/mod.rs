//! Separation: what each pixel's colours say about light that bounced once, twice, ... m times.

mod apply;
mod polynomial;
mod system;

use thiserror::Error;

pub use polynomial::PixelPolynomial;
pub use system::{BounceSystem, MIN_BETA_DISTANCE, check_order, closest_pair};

use crate::image::noise::NoiseModel;
use crate::{Marks, Mask, Photo, Plane, Watch};

/// Mark of a pixel with fewer usable colours than bounces: all its bounces are zero.
pub const UNSOLVED: u8 = 4;
/// Mark of a pixel outside the mask: all its bounces are zero.
pub const OUTSIDE: u8 = 8;

/// More colours than any rig has; every subset of them must fit a 32-bit key.
const MAX_COLOURS: usize = 32;

/// How to separate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SeparateOptions {
    /// The order m: how many bounces to separate, 1 to the number of colours.
    pub bounces: usize,
}

impl Default for SeparateOptions {
    /// Two bounces: a good model of many scenes (Funt and Drew), and the least noisy that removes interreflections.
    fn default() -> Self {
        Self { bounces: 2 }
    }
}

impl SeparateOptions {
    /// Whether `alpha` and `beta` (one of each per colour, the reference first) can separate this many bounces.
    pub fn check(&self, alpha: &[f64], beta: &[f64]) -> Result<(), SeparateError> {
        check_order(alpha, beta, self.bounces)
    }
}

/// Why photos were not separated. Colours are counted from 0, in the order of the capture set.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum SeparateError {
    /// The order m is zero or larger than the number of colours.
    #[error("{bounces} bounces need at least {bounces} colours and at least one bounce; there are {colours} colours")]
    Order {
        /// The order asked for.
        bounces: usize,
        /// The colours there are.
        colours: usize,
    },
    /// Two colours see the same paint: the system has no solution worth the name.
    #[error(
        "beta of colours {} and {} is {:.3} and {:.3}: closer than {MIN_BETA_DISTANCE}, so they cannot tell bounces apart; \
         leave one of them out or separate fewer bounces",
        first + 1, second + 1, beta[0], beta[1]
    )]
    SameAlbedo {
        /// One colour.
        first: usize,
        /// The other.
        second: usize,
        /// Both beta.
        beta: [f64; 2],
    },
    /// A ratio that is zero, negative or not a number.
    #[error("{what} of colour {} is {value}: a positive number is needed", colour + 1)]
    NotPositive {
        /// "alpha" or "beta".
        what: &'static str,
        /// Which colour.
        colour: usize,
        /// Its value.
        value: f64,
    },
    /// Not one alpha for each beta.
    #[error("{alpha} values of alpha for {beta} of beta: give one of each per colour")]
    ColourCount {
        /// How many alpha.
        alpha: usize,
        /// How many beta.
        beta: usize,
    },
    /// Photos, noise models and calibration do not count the same colours, or too many.
    #[error("{photos} photos and {noise} noise models for {colours} colours (at most {MAX_COLOURS})")]
    PhotoCount {
        /// How many photos.
        photos: usize,
        /// How many noise models.
        noise: usize,
        /// How many colours were calibrated.
        colours: usize,
    },
    /// A photo or the mask has another size than the first photo.
    #[error("{what} is {found:?} pixels, the first photo {expected:?}: all must have one size")]
    Size {
        /// "a photo" or "the mask".
        what: &'static str,
        /// Its width and height.
        found: (usize, usize),
        /// Those of the first photo.
        expected: (usize, usize),
    },
    /// The matrix beta_c^k is singular to working precision.
    #[error("{bounces} bounces cannot be separated (condition number {condition_number:.1e}); separate fewer")]
    Singular {
        /// The order asked for.
        bounces: usize,
        /// The condition number met.
        condition_number: f64,
    },
    /// The watch cancelled.
    #[error("cancelled")]
    Cancelled,
}

/// The bounces of one light.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Separation {
    /// L_1 .. L_m in linear light of the reference colour.
    pub bounces: Vec<Plane>,
    /// Predicted noise (standard deviation) of L_1.
    pub direct_noise: Option<Plane>,
    /// Root mean square over the colours of what the bounces leave of N_c / alpha_c; `None` when n = m leaves nothing.
    pub residual: Option<Plane>,
    /// Marks of the colours' photos together, and `UNSOLVED` or `OUTSIDE`. A mark without `UNSOLVED` is a pixel that was
    /// fitted without its clipped or dark colours.
    pub marks: Marks,
}

/// What the separation of one light reports. Means run over the solved pixels.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct SeparateReport {
    /// The order m.
    pub bounces: usize,
    /// The number n of colours.
    pub colours: usize,
    /// Gain of each bounce: its noise for unit noise on every N_c / alpha_c.
    pub gain: Vec<f64>,
    /// Condition number of the matrix beta_c^k; `None` where another method than bounces made the report, as the residuals.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub condition_number: Option<f64>,
    /// Predicted noise (standard deviation) of each bounce at the object's typical light.
    pub noise: Vec<f64>,
    /// Mean of each bounce.
    pub mean: Vec<f64>,
    /// Root mean square residual over pixels and colours; 0 when n = m.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub residual_rms: Option<f64>,
    /// The residual that noise alone would leave; 0 when n = m.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub residual_expected: Option<f64>,
    /// Pixels inside the mask that were solved, with all colours or with enough of them.
    pub solved_pixels: usize,
    /// Of those, the pixels fitted without a clipped or dark colour.
    pub reduced_pixels: usize,
    /// Pixels left unsolved because of clipped colours (perhaps dark ones too).
    pub unsolved_clipped_pixels: usize,
    /// Pixels left unsolved because of dark colours alone.
    pub unsolved_dark_pixels: usize,
}

/// Everything known of one light: a photo, its noise and alpha for each colour, the paint's beta, the object's mask.
#[derive(Clone, Copy, Debug)]
pub struct LightPhotos<'a> {
    /// One photo for each colour, the reference colour first.
    pub photos: &'a [&'a Photo],
    /// The noise of each photo.
    pub noise: &'a [NoiseModel],
    /// Lamp ratio of each colour over the reference colour.
    pub alpha: &'a [f64],
    /// Albedo ratio of each colour over the reference colour.
    pub beta: &'a [f64],
    /// The object.
    pub mask: &'a Mask,
}

impl LightPhotos<'_> {
    pub(crate) fn check(&self) -> Result<(), SeparateError> {
        let (photos, noise, colours) = (self.photos.len(), self.noise.len(), self.beta.len());
        if photos != colours || noise != colours || colours > MAX_COLOURS {
            return Err(SeparateError::PhotoCount { photos, noise, colours });
        }
        let expected = self.photos.first().map_or((0, 0), |photo| photo.linear.size());
        let sizes = self.photos.iter().map(|photo| ("a photo", photo.linear.size()));
        match sizes.chain([("the mask", self.mask.size())]).find(|&(_, size)| size != expected) {
            Some((what, found)) => Err(SeparateError::Size { what, found, expected }),
            None => Ok(()),
        }
    }

    /// The noise of each colour at the object's typical light, in that photo's linear light: the weights of the fit.
    pub fn typical_sigma(&self) -> Vec<f64> {
        let light = self.photos.iter().map(|photo| typical_light(photo, self.mask));
        light.zip(self.noise).map(|(light, noise)| noise.sigma(light)).collect()
    }
}

/// Mean linear light of the object's good pixels.
pub fn typical_light(photo: &Photo, mask: &Mask) -> f64 {
    // A sparse sample is enough for a mean, and spares a pass over memory.
    let step = (photo.linear.data().len() / 50_000).max(1);
    let good = (0..photo.linear.data().len())
        .step_by(step)
        .filter(|&pixel| mask.data()[pixel] && photo.marks.data()[pixel] == 0)
        .map(|pixel| f64::from(photo.linear.data()[pixel]));
    let (sum, count) = good.fold((0.0, 0usize), |(sum, count), light| (sum + light, count + 1));
    sum / count.max(1) as f64
}

/// Separates the light of one lamp into `options.bounces` bounces (CVPR 2011, equation 25, for any m <= n by
/// noise-weighted least squares).
pub fn separate(
    light: &LightPhotos,
    options: &SeparateOptions,
    watch: &dyn Watch,
) -> Result<(Separation, SeparateReport), SeparateError> {
    let mut separation = Separation::default();
    let report = separate_into(&mut separation, light, options, watch)?;
    Ok((separation, report))
}

/// Like `separate`, writing into planes that are already there when they have the right size.
pub fn separate_into(
    separation: &mut Separation,
    light: &LightPhotos,
    options: &SeparateOptions,
    watch: &dyn Watch,
) -> Result<SeparateReport, SeparateError> {
    options.check(light.alpha, light.beta)?;
    light.check()?;
    let sigma = light.typical_sigma();
    let system = BounceSystem::new(light.alpha, light.beta, &sigma, options.bounces)?;
    separation.fit_shape(light.mask.size(), options.bounces, light.beta.len());
    let tally = apply::apply(separation, light, &system, &sigma, watch).ok_or(SeparateError::Cancelled)?;
    Ok(report(&tally, system, &sigma, light))
}

impl Separation {
    fn fit_shape(&mut self, size: (usize, usize), bounces: usize, colours: usize) {
        let empty = || Plane::filled(size.0, size.1, 0.0);
        self.bounces.retain(|plane| plane.size() == size);
        self.bounces.resize_with(bounces, empty);
        if self.direct_noise.as_ref().is_none_or(|plane| plane.size() != size) {
            self.direct_noise = Some(empty());
        }
        if colours == bounces {
            self.residual = None;
        } else if self.residual.as_ref().is_none_or(|plane| plane.size() != size) {
            self.residual = Some(empty());
        }
        if self.marks.size() != size {
            self.marks = Marks::filled(size.0, size.1, 0);
        }
    }
}

fn report(tally: &apply::Tally, system: BounceSystem, sigma: &[f64], light: &LightPhotos) -> SeparateReport {
    let (colours, bounces) = system.mixing.shape();
    let solved = tally.solved.max(1) as f64;
    SeparateReport {
        bounces,
        colours,
        noise: system.noise(sigma),
        mean: tally.sums.iter().map(|sum| sum / solved).collect(),
        residual_rms: Some((tally.residual_squares / solved).sqrt()),
        residual_expected: Some(expected_residual(&system, sigma, light.alpha)),
        gain: system.gain,
        condition_number: Some(system.condition_number),
        solved_pixels: tally.solved,
        reduced_pixels: tally.reduced,
        unsolved_clipped_pixels: tally.unsolved_clipped,
        unsolved_dark_pixels: tally.unsolved_dark,
    }
}

/// Root mean square over the colours of (1 - V W) applied to the noise of N_c / alpha_c.
fn expected_residual(system: &BounceSystem, sigma: &[f64], alpha: &[f64]) -> f64 {
    let (colours, bounces) = system.mixing.shape();
    if colours == bounces {
        return 0.0;
    }
    let left = apply::residual_operator(system, alpha);
    let square = |c: usize| (0..colours).map(|from| (left[(c, from)] * sigma[from]).powi(2)).sum::<f64>();
    ((0..colours).map(square).sum::<f64>() / colours as f64).sqrt()
}

#[cfg(test)]
mod tests;
