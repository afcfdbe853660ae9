//! The verdict on a separation in words and numbers.

use firstbounce_core::trust::{LightTrust, Names, Trust};
use indexmap::IndexMap;
use serde::Serialize;

use crate::set::CaptureSet;

/// How far the bounces can be trusted, and why.
#[derive(Clone, Debug, Serialize)]
pub struct TrustRecord {
    /// "fine", "take care" or "do not trust".
    pub level: &'static str,
    /// Why it is not simply fine, the worst first.
    pub reasons: Vec<ReasonRecord>,
    /// What would be better.
    pub advice: Vec<String>,
    /// By light.
    pub light: IndexMap<String, LightTrustRecord>,
    /// Absent where the lights do not tell normals.
    pub normal: Option<NormalTrustRecord>,
}

/// One reason.
#[derive(Clone, Debug, Serialize)]
pub struct ReasonRecord {
    /// "take care" or "do not trust".
    pub level: &'static str,
    /// One sentence.
    pub words: String,
}

/// Expected errors of one light's bounce 1, in percent of its mean.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct LightTrustRecord {
    /// Noise of a pixel.
    pub noise_percent: f64,
    /// The same once the noise of indirect light is averaged away.
    pub quiet_noise_percent: f64,
    /// By the intervals of alpha and beta.
    pub calibration_percent: f64,
    /// By light of more than m bounces; negative where it makes bounce 1 darker.
    pub tail_percent: Option<f64>,
    /// The share of its light that the object sends back to itself at each bounce.
    pub return_share: Option<f64>,
}

/// Expected errors of normals in degrees.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct NormalTrustRecord {
    /// By noise, from bounce 1 as it is separated.
    pub noise_deg: f64,
    /// By noise, once the noise of indirect light is averaged away.
    pub quiet_noise_deg: f64,
    /// By the intervals of alpha and beta.
    pub calibration_deg: f64,
}

impl TrustRecord {
    /// Of a set's verdict.
    pub fn of(set: &CaptureSet, trust: &Trust) -> Self {
        let colours: Vec<_> = set.colours.iter().map(|colour| colour.name.clone()).collect();
        let lights: Vec<_> = set.lights.iter().map(|light| light.name.clone()).collect();
        let names = Names { colours: &colours, lights: &lights };
        let reasons = trust.reasons.iter();
        Self {
            level: trust.level.words(),
            reasons: reasons
                .map(|(level, why)| ReasonRecord { level: level.words(), words: why.words(&names) })
                .collect(),
            advice: trust.advice.iter().map(|advice| advice.words(&names)).collect(),
            light: lights.iter().cloned().zip(trust.lights.iter().map(LightTrustRecord::of)).collect(),
            normal: trust.normal.map(|normal| NormalTrustRecord {
                noise_deg: normal.noise_deg,
                quiet_noise_deg: normal.denoised_noise_deg,
                calibration_deg: normal.calibration_deg,
            }),
        }
    }

    /// The reasons as warnings.
    pub fn warnings(&self) -> impl Iterator<Item = String> + '_ {
        self.reasons.iter().map(|reason| format!("{}: {}", reason.level, reason.words))
    }
}

impl LightTrustRecord {
    fn of(light: &LightTrust) -> Self {
        Self {
            noise_percent: light.noise_percent,
            quiet_noise_percent: light.denoised_noise_percent,
            calibration_percent: light.calibration_percent,
            tail_percent: light.truncation_percent,
            return_share: light.return_share,
        }
    }
}
