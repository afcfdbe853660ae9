//! The verdict on a separation in words and numbers.

use firstbounce_core::trust::{LightTrust, Names, NormalTrust, Trust};
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
    pub light: IndexMap<String, LightTrust>,
    /// Absent where the lights do not tell normals.
    pub normal: Option<NormalTrust>,
}

/// One reason.
#[derive(Clone, Debug, Serialize)]
pub struct ReasonRecord {
    /// "take care" or "do not trust".
    pub level: &'static str,
    /// One sentence.
    pub words: String,
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
            light: lights.iter().cloned().zip(trust.lights.iter().cloned()).collect(),
            normal: trust.normal,
        }
    }

    /// The reasons as warnings.
    pub fn warnings(&self) -> impl Iterator<Item = String> + '_ {
        self.reasons.iter().map(|reason| format!("{}: {}", reason.level, reason.words))
    }
}
