//! Two colours by themselves: the noise gain against their albedo ratio (the paper's Figure 3).

/// Two colours of a set as if they were all there is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourPair {
    /// The colour that the ratio is over.
    pub first: usize,
    /// The other.
    pub second: usize,
    /// Albedo of the second over the first: below 1 where the first is the brighter.
    pub ratio: f64,
    /// Noise of bounce 1 in the first colour's light, for unit noise on both photos.
    pub gain: f64,
}

/// The gain of bounce 1 for two colours and two bounces: `sqrt(1 + r^4) / (r |1 - r|)`, the norm of the first row of the
/// inverse of ((1, 1), (r, r^2)). Infinite at 0 and at 1; its minimum below 1 is 4.1 near 0.48.
pub fn gain_of_ratio(ratio: f64) -> f64 {
    (1.0 + ratio.powi(4)).sqrt() / (ratio * (1.0 - ratio).abs())
}

/// Every two colours, each over the earlier one.
pub fn pairs(beta: &[f64]) -> Vec<ColourPair> {
    let every = (0..beta.len()).flat_map(|first| (first + 1..beta.len()).map(move |second| (first, second)));
    every
        .map(|(first, second)| {
            let ratio = beta[second] / beta[first];
            ColourPair { first, second, ratio, gain: gain_of_ratio(ratio) }
        })
        .collect()
}
