//! The verdict on a separation, from a few small matrices: no pixel is looked at, so that a verdict follows every
//! change of the order m, of alpha and of beta at once.
//!
//! Four things can spoil bounce 1: noise, errors of calibration, light that bounced more often than m times, and anything
//! else that makes the colours disagree. Each is judged by itself; the worst one gives the verdict.

mod advice;
mod calibration;
mod lamps;
mod options;
mod pair;
mod reason;
mod shape;
mod truncation;

use nalgebra::{DMatrix, DVector, Vector3};

pub use advice::Advice;
pub use options::{Limits, TrustOptions, TwoLimits};
pub use pair::{ColourPair, gain_of_ratio, pairs};
pub use reason::{NO_DIRECTION_DEG, Names, Reason};
pub use shape::{ColoursAndShapeLevels, judge_colours_and_shape};

use crate::denoise::denoised_noise;
use crate::interval::Estimate;
use crate::separate::{BounceSystem, SeparateError, check_order};
use lamps::Lamps;

/// Every verdict is one of three levels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// Nothing stands out.
    #[default]
    Fine,
    /// Usable, with an error that the user should know of.
    TakeCare,
    /// The numbers are mostly error.
    DoNotTrust,
}

impl Level {
    /// "fine", "take care" or "do not trust".
    pub fn words(self) -> &'static str {
        match self {
            Self::Fine => "fine",
            Self::TakeCare => "take care",
            Self::DoNotTrust => "do not trust",
        }
    }
}

/// What is known of one light and of what it does to the object.
#[derive(Clone, Debug, PartialEq)]
pub struct LightLevels {
    /// By colour: lamp intensity over the reference colour's.
    pub alpha: Vec<Estimate>,
    /// By colour: mean linear light of the object.
    pub mean: Vec<f64>,
    /// By colour: noise of a pixel at that light, in the same unit.
    pub sigma: Vec<f64>,
    /// Intensity times unit direction to the light; `None` where it is not known.
    pub toward: Option<Vector3<f64>>,
}

/// The paint, the lamps and the photos in numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Rig {
    /// By colour: albedo over the reference colour's, the reference first.
    pub beta: Vec<Estimate>,
    /// By light.
    pub lights: Vec<LightLevels>,
    /// Mean over the object's pixels of the product of every two photos, light by light and in each colour by colour:
    /// how bright single pixels are, whatever their normals. Of another size: all pixels count as alike.
    pub products: DMatrix<f64>,
    /// Frames averaged in each photo.
    pub frames: usize,
}

/// How far the bounces of one light can be trusted. Percentages are of the mean bounce 1.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct LightTrust {
    /// L_1 .. L_m of the mean light.
    pub bounces: Vec<f64>,
    /// Noise of each bounce for unit noise on every N_c / alpha_c.
    pub gain: Vec<f64>,
    /// Of the matrix beta_c^k; `None` where no such matrix was solved.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub condition_number: Option<f64>,
    /// Expected noise of a pixel of bounce 1; infinite, as all percentages, where bounce 1 comes out negative.
    pub noise_percent: f64,
    /// The same once the noise of indirect light is averaged away ([`crate::denoise`]).
    #[cfg_attr(feature = "serde", serde(rename = "quiet_noise_percent"))]
    pub denoised_noise_percent: f64,
    /// What the intervals of alpha and beta make of bounce 1 (standard deviation); `None` where only their effect on normals is known.
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "Option::is_none"))]
    pub calibration_percent: Option<f64>,
    /// What light of more than m bounces adds to bounce 1 (negative: takes from it); `None` with one colour.
    #[cfg_attr(feature = "serde", serde(rename = "tail_percent"))]
    pub truncation_percent: Option<f64>,
    /// The share of its light that the object sends back to itself at each bounce, by the mean photos.
    pub return_share: Option<f64>,
}

/// What the errors do to normals: root mean square angles over the object's pixels, with the noise of its mean light.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct NormalTrust {
    /// By noise, bounce 1 as it is separated.
    pub noise_deg: f64,
    /// By noise, once the noise of indirect light is averaged away: what the normals are made from.
    #[cfg_attr(feature = "serde", serde(rename = "quiet_noise_deg"))]
    pub denoised_noise_deg: f64,
    /// By the intervals of alpha and beta.
    pub calibration_deg: f64,
}

/// The verdict on a separation.
#[derive(Clone, Debug, PartialEq)]
pub struct Trust {
    /// The order m.
    pub bounces: usize,
    /// The worst of the reasons' levels.
    pub level: Level,
    /// Everything worth knowing, the worst first; empty where all is fine.
    pub reasons: Vec<(Level, Reason)>,
    /// What would be better.
    pub advice: Vec<Advice>,
    /// By light; empty where the colours cannot be separated at all.
    pub lights: Vec<LightTrust>,
    /// `None` for fewer than three lights of known direction, or lights in a plane.
    pub normal: Option<NormalTrust>,
}

impl Trust {
    /// The worst light by `value`; `None` without a light.
    pub fn worst(&self, value: impl Fn(&LightTrust) -> f64) -> Option<f64> {
        self.lights.iter().map(value).reduce(f64::max)
    }

    /// The error of bounce 1 to be expected, as a percentage of it: noise and calibration at random, truncation on top.
    pub fn error_percent(&self) -> f64 {
        let of = |light: &LightTrust| {
            light.denoised_noise_percent.hypot(light.calibration_percent.unwrap_or(0.0))
                + light.truncation_percent.unwrap_or(0.0).abs()
        };
        match self.lights.len() {
            0 => f64::INFINITY,
            lights => self.lights.iter().map(of).sum::<f64>() / lights as f64,
        }
    }
}

/// Judges the separation of `options.bounces` bounces. Errors: an order that the colours do not allow, alpha or beta that
/// are not positive. Colours that are too much alike are no error but a verdict.
pub fn judge(rig: &Rig, options: &TrustOptions) -> Result<Trust, SeparateError> {
    let mut trust = assess(rig, options)?;
    trust.advice = advice::advise(rig, &trust, options);
    Ok(trust)
}

/// The verdict without advice: advice is made of other verdicts.
fn assess(rig: &Rig, options: &TrustOptions) -> Result<Trust, SeparateError> {
    let beta = values(&rig.beta);
    let mut lights = Vec::with_capacity(rig.lights.len());
    let mut systems = Vec::with_capacity(rig.lights.len());
    for light in &rig.lights {
        let alpha = values(&light.alpha);
        match check_order(&alpha, &beta, options.bounces)
            .and_then(|()| BounceSystem::new(&alpha, &beta, &light.sigma, options.bounces))
        {
            Ok(system) => {
                lights.push(light_trust(rig, light, &system, options));
                systems.push(system);
            }
            Err(SeparateError::SameAlbedo { first, second, beta }) => {
                return Ok(Trust::hopeless(options.bounces, Reason::SameAlbedo { first, second, beta }));
            }
            Err(SeparateError::Singular { bounces, .. }) => {
                return Ok(Trust::hopeless(bounces, Reason::Singular { bounces }));
            }
            Err(error) => return Err(error),
        }
    }
    let normal = Lamps::of(rig, &lights, &systems).map(|lamps| lamps.normal_trust(rig, &lights, &systems, options));
    let reasons = reason::reasons(rig, &lights, normal.as_ref(), options);
    let level = reasons.first().map_or(Level::Fine, |(level, _)| *level);
    Ok(Trust { bounces: options.bounces, level, reasons, advice: Vec::new(), lights, normal })
}

impl Trust {
    fn hopeless(bounces: usize, reason: Reason) -> Self {
        let level = Level::DoNotTrust;
        Self { bounces, level, reasons: vec![(level, reason)], advice: Vec::new(), lights: Vec::new(), normal: None }
    }
}

fn light_trust(rig: &Rig, light: &LightLevels, system: &BounceSystem, options: &TrustOptions) -> LightTrust {
    let bounces: Vec<f64> = (&system.operator * DVector::from_column_slice(&light.mean)).iter().copied().collect();
    let percent = |error: f64| if bounces[0] > 0.0 { 100.0 * error / bounces[0] } else { f64::INFINITY };
    let noise = system.noise(&light.sigma)[0];
    let denoised = denoised_noise(system, &light.sigma, &options.denoise);
    let calibration =
        calibration::sources(rig, light, system, &bounces).map(|source| source.sd(0).powi(2)).sum::<f64>();
    let return_share = truncation::return_share(light, &rig.beta);
    let beta = values(&rig.beta);
    LightTrust {
        noise_percent: percent(noise),
        denoised_noise_percent: percent(denoised),
        calibration_percent: Some(percent(calibration.sqrt())),
        truncation_percent: return_share
            .map(|share| 100.0 * truncation::charge(system, &values(&light.alpha), &beta, share)),
        return_share,
        gain: system.gain.clone(),
        condition_number: Some(system.condition_number),
        bounces,
    }
}

fn values(estimates: &[Estimate]) -> Vec<f64> {
    estimates.iter().map(|estimate| estimate.value).collect()
}

#[cfg(test)]
mod tests;
