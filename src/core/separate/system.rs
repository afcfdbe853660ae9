//! The linear system between what the colours see and what each bounce brings, and how far it can be trusted.
//!
//! Liao, Huang and Yang, "Interreflection Removal for Photometric Stereo by Using Spectrum-dependent Albedo",
//! CVPR 2011, equations 12 to 25: `N_c / alpha_c = sum_k beta_c^k L_k`, k = 1..m.

use nalgebra::{DMatrix, DVector};

use super::SeparateError;
use crate::linear_algebra;

/// Two colours whose beta lie closer than this separate the bounces by noise alone.
pub const MIN_BETA_DISTANCE: f64 = 0.02;

/// Below this share of the largest singular value a bounce cannot be told from another at all.
const MIN_SINGULAR: f64 = 1e-13;

/// The least-squares solution of the bounce equations of one light, the same for all its pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct BounceSystem {
    /// m x n: L = `operator` N, with N in the photos' own linear light (1/alpha is inside).
    pub operator: DMatrix<f64>,
    /// Gain of each bounce: the noise on L_k for unit noise on every N_c / alpha_c.
    pub gain: Vec<f64>,
    /// The largest over the smallest singular value of the n x m matrix beta_c^k.
    pub condition_number: f64,
    /// n x m: beta_c^k, what L_k contributes to N_c / alpha_c.
    pub mixing: DMatrix<f64>,
}

impl BounceSystem {
    /// Solves for `bounces` bounces from n colours with the given `alpha` and `beta`.
    ///
    /// `sigma` is the noise of each colour's photo in its own linear light; it weights the fit when there are more
    /// colours than bounces. Errors: as `check_order`.
    pub fn new(alpha: &[f64], beta: &[f64], sigma: &[f64], bounces: usize) -> Result<Self, SeparateError> {
        check_order(alpha, beta, bounces)?;
        let colours = beta.len();
        let mixing = DMatrix::from_fn(colours, bounces, |c, k| beta[c].powi(k as i32 + 1));
        let condition_number =
            linear_algebra::singular_values(&mixing).map_or(f64::INFINITY, |singular| singular.max() / singular.min());

        // Whiten: divide each colour's equation by the noise of N_c / alpha_c, then undo it in the operator.
        let least_noise = (0..colours).map(|c| sigma[c] / alpha[c]).fold(f64::INFINITY, f64::min);
        let weight = DVector::from_fn(colours, |c, _| match sigma[c] / alpha[c] {
            noise if noise > 0.0 && least_noise > 0.0 => least_noise / noise,
            _ => 1.0,
        });
        let weighted = DMatrix::from_fn(colours, bounces, |c, k| weight[c] * mixing[(c, k)]);
        let inverse = linear_algebra::pseudo_inverse_of_regular(&weighted, MIN_SINGULAR)
            .ok_or(SeparateError::Singular { bounces, condition_number })?;
        let on_normalised = DMatrix::from_fn(bounces, colours, |k, c| inverse[(k, c)] * weight[c]);
        let gain = on_normalised.row_iter().map(|row| row.norm()).collect();
        let operator = DMatrix::from_fn(bounces, colours, |k, c| on_normalised[(k, c)] / alpha[c]);
        Ok(Self { operator, gain, condition_number, mixing })
    }

    /// The noise on each bounce for the given noise of each colour's photo in its own linear light.
    pub fn noise(&self, sigma: &[f64]) -> Vec<f64> {
        let row_noise =
            |k: usize| sigma.iter().enumerate().map(|(c, s)| (self.operator[(k, c)] * s).powi(2)).sum::<f64>().sqrt();
        (0..self.operator.nrows()).map(row_noise).collect()
    }
}

/// Whether these colours can separate `bounces` bounces at all. The first colour is the reference.
pub fn check_order(alpha: &[f64], beta: &[f64], bounces: usize) -> Result<(), SeparateError> {
    let colours = beta.len();
    if alpha.len() != colours {
        return Err(SeparateError::ColourCount { alpha: alpha.len(), beta: colours });
    }
    if bounces == 0 || bounces > colours {
        return Err(SeparateError::Order { bounces, colours });
    }
    if let Some(colour) = (0..colours).find(|&c| !(alpha[c] > 0.0 && alpha[c].is_finite())) {
        return Err(SeparateError::NotPositive { what: "alpha", colour, value: alpha[colour] });
    }
    if let Some(colour) = (0..colours).find(|&c| !(beta[c] > 0.0 && beta[c].is_finite())) {
        return Err(SeparateError::NotPositive { what: "beta", colour, value: beta[colour] });
    }
    match closest_pair(beta) {
        Some((first, second)) if bounces > 1 && (beta[first] - beta[second]).abs() < MIN_BETA_DISTANCE => {
            Err(SeparateError::SameAlbedo { first, second, beta: [beta[first], beta[second]] })
        }
        _ => Ok(()),
    }
}

/// The two colours whose beta are closest; `None` for fewer than two colours.
pub fn closest_pair(beta: &[f64]) -> Option<(usize, usize)> {
    let pairs = (0..beta.len()).flat_map(|first| (first + 1..beta.len()).map(move |second| (first, second)));
    let distance = |&(first, second): &(usize, usize)| (beta[first] - beta[second]).abs();
    pairs.min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn gain_of_direct(beta: &[f64], bounces: usize) -> f64 {
        let ones = vec![1.0; beta.len()];
        BounceSystem::new(&ones, beta, &ones, bounces).unwrap().gain[0]
    }

    #[test]
    fn gain_of_two_colours_follows_the_closed_form() {
        for beta in [0.2_f64, 0.28, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95] {
            let closed_form = (1.0 + beta.powi(4)).sqrt() / (beta * (1.0 - beta));
            assert!((gain_of_direct(&[1.0, beta], 2) / closed_form - 1.0).abs() < 1e-9, "beta {beta}");
        }
    }

    #[test]
    fn fewer_bounces_than_colours_are_less_noisy() {
        let beta = [0.78, 0.59, 0.39, 0.2].map(|albedo| albedo / 0.78);
        let gains = [4, 3, 2].map(|bounces| gain_of_direct(&beta, bounces));
        for (gain, known) in gains.iter().zip([21.0, 8.1, 3.0]) {
            assert!((gain / known - 1.0).abs() < 0.03, "{gain} for a known {known}");
        }
    }

    #[test]
    fn a_noisy_colour_weighs_less() {
        let system = |sigma: &[f64]| BounceSystem::new(&[1.0; 3], &[1.0, 0.6, 0.3], sigma, 2).unwrap();
        let sigma = [0.01, 0.1, 0.01];
        let (plain, weighted) = (system(&[1.0; 3]), system(&sigma));
        assert!(weighted.noise(&sigma)[0] < plain.noise(&sigma)[0]);
    }

    #[test]
    fn colours_of_one_albedo_are_refused_by_name() {
        let refused = BounceSystem::new(&[1.0; 3], &[1.0, 0.5, 0.515], &[1.0; 3], 2);
        assert!(matches!(refused, Err(SeparateError::SameAlbedo { first: 1, second: 2, .. })));
    }

    proptest! {
        #[test]
        fn what_was_mixed_is_unmixed(
            bounces in prop::collection::vec(0.0..1.0_f64, 1..4),
            alpha in prop::collection::vec(0.3..4.0_f64, 4),
            sigma in prop::collection::vec(0.1..2.0_f64, 4),
        ) {
            let beta = [1.0, 0.75, 0.5, 0.25];
            let system = BounceSystem::new(&alpha, &beta, &sigma, bounces.len()).unwrap();
            let light = DVector::from_fn(4, |c, _| {
                alpha[c] * bounces.iter().enumerate().map(|(k, l)| beta[c].powi(k as i32 + 1) * l).sum::<f64>()
            });
            let unmixed = &system.operator * light;
            for (k, truth) in bounces.iter().enumerate() {
                prop_assert!((unmixed[k] - truth).abs() < 1e-9);
            }
        }
    }
}
