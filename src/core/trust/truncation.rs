//! Truncation: light that bounced more often than m times.
//!
//! An m-bounce fit charges it to L_1 .. L_m. In a spherical cap of area fraction f every bounce after the first is
//! q = rho f times the one before (L = rho E + rho^2 f E_mean / (1 - rho f)), and so is the mean of the second over the mean
//! of the first. Mean photos then go as N_c / alpha_c = L_1 beta_c / (1 - beta_c q): two colours are enough to find q, and q
//! gives what any fit makes of the truncation. Other shapes follow this law less exactly; on rendered corners, grooves and bowls
//! it gives the mean error of bounce 1 to a factor of two or better.

use super::LightLevels;
use crate::interval::Estimate;
use crate::separate::BounceSystem;

/// Where q is looked for: below 0 colours contradict each other, near 1 no light would ever leave.
const SHARES: std::ops::RangeInclusive<f64> = -0.5..=0.98;
/// Shares tried before the best is refined.
const STEPS: usize = 149;
/// Each round narrows the share to 0.62 of its range.
const ROUNDS: usize = 24;

/// The share q of its light that the object sends back to itself, by least squares over the colours weighted with their
/// noise; `None` for one colour.
pub(super) fn return_share(light: &LightLevels, beta: &[Estimate]) -> Option<f64> {
    if beta.len() < 2 {
        return None;
    }
    let misfit = |share: f64| misfit(light, beta, share);
    let (low, high) = SHARES.into_inner();
    let step = (high - low) / (STEPS - 1) as f64;
    let tried = (0..STEPS).map(|i| low + step * i as f64);
    let coarse = tried.min_by(|a, b| misfit(*a).total_cmp(&misfit(*b)))?;
    Some(golden_section((coarse - step).max(low), (coarse + step).min(high), misfit))
}

/// Weighted sum of squares that the law leaves when L_1 is the best possible.
fn misfit(light: &LightLevels, beta: &[Estimate], share: f64) -> f64 {
    let (mut ww, mut wx, mut xx) = (0.0, 0.0, 0.0);
    for (c, beta) in beta.iter().enumerate() {
        let alpha = light.alpha[c].value;
        let sigma = if light.sigma[c] > 0.0 { light.sigma[c] } else { 1.0 };
        let (law, mean) = (alpha * beta.value / (1.0 - beta.value * share) / sigma, light.mean[c] / sigma);
        ww += law * law;
        wx += law * mean;
        xx += mean * mean;
    }
    xx - wx * wx / ww
}

fn golden_section(mut low: f64, mut high: f64, value: impl Fn(f64) -> f64) -> f64 {
    let golden = (5.0_f64.sqrt() - 1.0) / 2.0;
    for _ in 0..ROUNDS {
        let (a, b) = (high - golden * (high - low), low + golden * (high - low));
        if value(a) < value(b) { high = b } else { low = a }
    }
    (low + high) / 2.0
}

/// What a fit makes of the truncation: the error of L_1 over the true L_1.
pub(super) fn charge(system: &BounceSystem, alpha: &[f64], beta: &[f64], share: f64) -> f64 {
    let photo = |c: usize| alpha[c] * beta[c] / (1.0 - beta[c] * share);
    (0..beta.len()).map(|c| system.operator[(0, c)] * photo(c)).sum::<f64>() - 1.0
}
