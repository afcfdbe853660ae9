//! Advice: another order, other colours, more frames.

use nalgebra::DMatrix;

use super::reason::rounded;
use super::{ColourPair, LightLevels, Names, Reason, Rig, Trust, TrustOptions, assess, pairs, values};
use crate::interval::Estimate;

/// Advice is given where it takes at least this share off the expected error.
const WORTH_IT: f64 = 0.2;
/// More frames than this take too long to be advised.
const MAX_FRAMES: usize = 1024;
/// Albedo ratios tried for another colour.
const RATIO_STEPS: usize = 18;

/// One thing that would be better. Percentages are the error of bounce 1 to be expected.
#[derive(Clone, Debug, PartialEq)]
pub enum Advice {
    /// Another order m.
    Order {
        /// The better order.
        bounces: usize,
        /// The order in force.
        instead: usize,
        /// Error with the better order.
        percent: f64,
        /// Error now.
        instead_percent: f64,
    },
    /// Colours that see the paint alike: do without one of them.
    LeaveOut {
        /// The colour to leave out.
        colour: usize,
        /// The gain of bounce 1 without it.
        gain: f64,
    },
    /// Of several colours, the two that are best where only two can be photographed.
    Pair {
        /// The best pair.
        best: ColourPair,
        /// The worst pair.
        worst: ColourPair,
    },
    /// More frames of each photo.
    Frames {
        /// How many would do.
        frames: usize,
        /// How many there are.
        instead: usize,
        /// Angle of normals by noise, then.
        degrees: f64,
        /// Angle of normals by noise, now.
        instead_degrees: f64,
    },
    /// A further colour.
    AnotherColour {
        /// Its best albedo over the reference colour's.
        ratio: f64,
        /// The order to separate with it.
        bounces: usize,
        /// Error with it.
        percent: f64,
        /// Error now.
        instead_percent: f64,
    },
}

impl Advice {
    /// One sentence.
    pub fn words(&self, names: &Names) -> String {
        match self {
            Self::Order { bounces, instead, percent, instead_percent } => format!(
                "m = {bounces} instead of {instead}: bounce 1 to about {} % instead of {}",
                rounded(*percent),
                error_words(*instead_percent)
            ),
            Self::LeaveOut { colour, gain } => {
                format!("leave out {}: gain {} without it", names.colour(*colour), rounded(*gain))
            }
            Self::Pair { best, worst } => format!(
                "with two colours only, take {} + {}: gain {} instead of {} with {} + {}",
                names.colour(best.first),
                names.colour(best.second),
                rounded(best.gain),
                rounded(worst.gain),
                names.colour(worst.first),
                names.colour(worst.second)
            ),
            Self::Frames { frames, instead, degrees, instead_degrees } => format!(
                "{frames} frames instead of {instead}: noise turns normals by {degrees:.1} instead of \
                 {instead_degrees:.1} degrees"
            ),
            Self::AnotherColour { ratio, bounces, percent, instead_percent } => format!(
                "one more colour, in which the paint has {ratio:.2} of its albedo in {}, and m = {bounces}: bounce 1 to \
                 about {} % instead of {}",
                names.colour(0),
                rounded(*percent),
                error_words(*instead_percent)
            ),
        }
    }
}

/// A percentage, or that there is no bounce 1 to take it of.
fn error_words(percent: f64) -> String {
    if percent.is_finite() { format!("{} %", rounded(percent)) } else { "no bounce 1 at all".into() }
}

/// All advice on a verdict.
pub(super) fn advise(rig: &Rig, trust: &Trust, options: &TrustOptions) -> Vec<Advice> {
    // What the photos contradict cannot be forecast: first the calibration must be right.
    let unpredictable = |reason: &Reason| {
        matches!(reason, Reason::Contradicted { .. } | Reason::ReturnsTooMuch { .. } | Reason::Negative { .. })
    };
    if trust.reasons.iter().any(|(_, reason)| unpredictable(reason)) {
        return another_pair(rig).into_iter().collect();
    }
    let all = [
        leave_out(rig, trust, options),
        better_order(rig, trust, options),
        more_frames(rig, trust, options),
        another_colour(rig, trust, options),
        another_pair(rig),
    ];
    all.into_iter().flatten().collect()
}

/// Whether `better` is a step up from `now`.
fn is_worth_it(better: &Trust, now: &Trust) -> bool {
    better.level <= now.level && better.error_percent() < (1.0 - WORTH_IT) * now.error_percent()
}

fn best_of(verdicts: impl Iterator<Item = Trust>) -> Option<Trust> {
    verdicts.min_by(|a, b| {
        (a.level, a.error_percent()).partial_cmp(&(b.level, b.error_percent())).unwrap_or(std::cmp::Ordering::Equal)
    })
}

fn better_order(rig: &Rig, trust: &Trust, options: &TrustOptions) -> Option<Advice> {
    let others = (1..=rig.beta.len()).filter(|bounces| *bounces != trust.bounces);
    let best = best_of(others.filter_map(|bounces| assess(rig, &TrustOptions { bounces, ..*options }).ok()))?;
    is_worth_it(&best, trust).then(|| Advice::Order {
        bounces: best.bounces,
        instead: trust.bounces,
        percent: best.error_percent(),
        instead_percent: trust.error_percent(),
    })
}

/// Where two colours are alike, the one of them whose loss hurts least. The reference colour stays: all is measured in it.
fn leave_out(rig: &Rig, trust: &Trust, options: &TrustOptions) -> Option<Advice> {
    let Some((_, Reason::SameAlbedo { first, second, .. })) = trust.reasons.first() else { return None };
    let without = |colour: usize| {
        let rest = assess(&rig.without_colour(colour), options).ok()?;
        let gain = rest.worst(|light| light.gain[0])?;
        Some(Advice::LeaveOut { colour, gain }).map(|advice| (gain, advice))
    };
    let candidates = [*first, *second].into_iter().filter(|colour| *colour > 0).filter_map(without);
    candidates.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, advice)| advice)
}

fn another_pair(rig: &Rig) -> Option<Advice> {
    let pairs = pairs(&values(&rig.beta));
    let best = *pairs.iter().min_by(|a, b| a.gain.total_cmp(&b.gain))?;
    let worst = *pairs.iter().max_by(|a, b| a.gain.total_cmp(&b.gain))?;
    (pairs.len() > 1).then_some(Advice::Pair { best, worst })
}

/// Noise falls with the root of the frames: how many bring it under the limit for care.
fn more_frames(rig: &Rig, trust: &Trust, options: &TrustOptions) -> Option<Advice> {
    let now = trust.normal?.denoised_noise_deg;
    if now <= options.limits.normal_deg.care || !now.is_finite() {
        return None;
    }
    let instead = rig.frames.max(1);
    let frames = (instead as f64 * (now / options.limits.normal_deg.care).powi(2)).ceil() as usize;
    let frames = frames.next_power_of_two();
    let degrees = now * (instead as f64 / frames as f64).sqrt();
    (frames <= MAX_FRAMES).then_some(Advice::Frames { frames, instead, degrees, instead_degrees: now })
}

fn another_colour(rig: &Rig, trust: &Trust, options: &TrustOptions) -> Option<Advice> {
    let ratios = (1..=RATIO_STEPS).map(|i| 0.05 + 0.05 * i as f64);
    let with = ratios.flat_map(|ratio| (2..=rig.beta.len() + 1).map(move |bounces| (ratio, bounces)));
    let verdicts = with.filter_map(|(ratio, bounces)| {
        let more = rig.with_colour(ratio, trust)?;
        Some((ratio, assess(&more, &TrustOptions { bounces, ..*options }).ok()?))
    });
    let rank = |trust: &Trust| (trust.level, trust.error_percent());
    let (ratio, best) =
        verdicts.min_by(|a, b| rank(&a.1).partial_cmp(&rank(&b.1)).unwrap_or(std::cmp::Ordering::Equal))?;
    is_worth_it(&best, trust).then(|| Advice::AnotherColour {
        ratio,
        bounces: best.bounces,
        percent: best.error_percent(),
        instead_percent: trust.error_percent(),
    })
}

impl Rig {
    fn without_colour(&self, colour: usize) -> Self {
        let mut rig = self.clone();
        let colours = rig.beta.len();
        let kept: Vec<_> = (0..rig.products.nrows()).filter(|photo| photo % colours != colour).collect();
        rig.products = rig.products.select_rows(&kept).select_columns(&kept);
        rig.beta.remove(colour);
        for LightLevels { alpha, mean, sigma, .. } in &mut rig.lights {
            alpha.remove(colour);
            mean.remove(colour);
            sigma.remove(colour);
        }
        rig
    }

    /// With a colour of this albedo, as bright and noisy as the reference colour would be, lit as the law of truncation says.
    fn with_colour(&self, ratio: f64, trust: &Trust) -> Option<Self> {
        let mut rig = self.clone();
        rig.beta.push(Estimate::exact(ratio));
        let mut factors = Vec::with_capacity(rig.lights.len());
        for (l, light) in rig.lights.iter_mut().enumerate() {
            let share = trust.lights.get(l)?.return_share?;
            let factor = ratio * (1.0 - share) / (1.0 - ratio * share);
            factors.push(factor);
            light.alpha.push(Estimate::exact(1.0));
            light.mean.push(light.mean[0] * factor);
            light.sigma.push(light.sigma[0]);
        }
        // Pixel by pixel its photo is taken to be as the reference colour's.
        let (colours, more) = (self.beta.len(), rig.beta.len());
        if self.products.nrows() == colours * factors.len() {
            let from = |photo: usize| match (photo / more, photo % more) {
                (light, colour) if colour < colours => (light * colours + colour, 1.0),
                (light, _) => (light * colours, factors[light]),
            };
            rig.products = DMatrix::from_fn(more * factors.len(), more * factors.len(), |a, b| {
                let ((a, by), (b, and)) = (from(a), from(b));
                by * and * self.products[(a, b)]
            });
        }
        Some(rig)
    }
}
