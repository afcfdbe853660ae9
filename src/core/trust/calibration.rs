//! Calibration errors: what an error of alpha or beta does to the bounces, to first order.
//!
//! L = W N' with N'_c = N_c / alpha_c, and V L = N' with V_ck = beta_c^k. An alpha that is off by d moves N'_c by
//! -N'_c d / alpha_c; a beta that is off by d moves V L by d sum_k k beta_c^(k-1) L_k, which the fit takes for light. For
//! two colours and two bounces these are -d/(1-beta) of L_1 and a leak of L_2 of -d beta/(1-beta), and twice that leak for
//! beta. Where there are more colours than bounces the little that the fit leaves over is neglected.

use super::{LightLevels, Rig};
use crate::interval::Estimate;
use crate::separate::BounceSystem;

/// One uncertain value and its effect on the bounces of a light.
#[derive(Clone, Debug)]
pub(super) struct ErrorSource {
    pub colour: usize,
    /// Beta is one number for all lights, alpha is measured for each.
    pub is_beta: bool,
    /// Change of each bounce for one standard deviation of the value.
    effect: Vec<f64>,
}

impl ErrorSource {
    /// Signed change of bounce `k`, counted from 0, for one standard deviation.
    pub fn effect(&self, k: usize) -> f64 {
        self.effect[k]
    }

    /// Standard deviation of bounce `k`, counted from 0.
    pub fn sd(&self, k: usize) -> f64 {
        self.effect[k].abs()
    }
}

/// The uncertain values of a light: alpha of every colour, then beta of every colour.
pub(super) fn sources<'a>(
    rig: &'a Rig,
    light: &'a LightLevels,
    system: &'a BounceSystem,
    bounces: &'a [f64],
) -> impl Iterator<Item = ErrorSource> + 'a {
    let effect =
        move |colour: usize, on_photo: f64| system.operator.column(colour).iter().map(|w| -w * on_photo).collect();
    let alpha = move |(colour, alpha): (usize, &Estimate)| ErrorSource {
        colour,
        is_beta: false,
        effect: effect(colour, light.mean[colour] * alpha.sd() / alpha.value),
    };
    let beta = move |(colour, beta): (usize, &Estimate)| {
        let slope: f64 = (1..).zip(bounces).map(|(k, bounce)| f64::from(k) * beta.value.powi(k - 1) * bounce).sum();
        ErrorSource { colour, is_beta: true, effect: effect(colour, light.alpha[colour].value * slope * beta.sd()) }
    };
    light.alpha.iter().enumerate().map(alpha).chain(rig.beta.iter().enumerate().map(beta))
}
