//! How far a calibration value can be trusted, in words.

use super::{Calibrated, Known, RatioEvidence, Source};
use crate::set::{CaptureSet, SphereKind};

/// A judgement with its reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Nothing stands out.
    Good,
    /// Usable, with an error that a person should know of.
    TakeCare(String),
    /// Mostly error.
    DoNotTrust(String),
}

/// Errors of bounce 1, in percent, above which a value is no longer good, and no longer to be trusted. The camera's own
/// noise in a good photo is about one percent.
const CARE_PERCENT: f64 = 2.0;
const DISTRUST_PERCENT: f64 = 6.0;
/// The same for directions, in degrees of the normal.
const CARE_DEG: f64 = 1.0;
const DISTRUST_DEG: f64 = 3.0;
/// How many times the noise of a photo bounce 1 may have.
const CARE_GAIN: f64 = 8.0;
const DISTRUST_GAIN: f64 = 16.0;
/// Share of a ball's pixels that may be clipped before one should look.
const CARE_CLIPPED: f64 = 0.05;
/// Scatter of one pixel's ratio from which the ball is hardly one paint under one lamp.
const CARE_SCATTER: f64 = 0.05;

impl Verdict {
    /// "good", "take care" or "do not trust".
    pub fn words(&self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::TakeCare(_) => "take care",
            Self::DoNotTrust(_) => "do not trust",
        }
    }

    /// Why; empty where nothing stands out.
    pub fn reason(&self) -> &str {
        match self {
            Self::Good => "",
            Self::TakeCare(reason) | Self::DoNotTrust(reason) => reason,
        }
    }

    fn severity(&self) -> u8 {
        match self {
            Self::Good => 0,
            Self::TakeCare(_) => 1,
            Self::DoNotTrust(_) => 2,
        }
    }

    /// The worse of two, the first of equals.
    pub fn worse(self, other: Self) -> Self {
        if other.severity() > self.severity() { other } else { self }
    }

    fn of(value: f64, care: f64, distrust: f64, reason: impl FnOnce() -> String) -> Self {
        match value {
            value if value <= care => Self::Good,
            value if value <= distrust => Self::TakeCare(reason()),
            _ => Self::DoNotTrust(reason()),
        }
    }
}

impl Calibrated {
    /// Of alpha of colour `c` under light `l`: an error of alpha moves bounce 1 by as much over 1 - beta (METHOD.md: the
    /// inverse of a 2 x 2 Vandermonde system).
    pub fn judge_alpha(&self, l: usize, c: usize) -> Option<Verdict> {
        let known = self.alpha.get(l)?.as_ref()?.get(c)?;
        let beta = self.beta.as_ref().and_then(|beta| beta.get(c)).map(|known| known.value);
        let error = 100.0 * relative_half_width(known) / distance_from_one(beta);
        let reason = || format!("its interval alone moves bounce 1 by {error:.1} %");
        let verdict = Verdict::of(error, CARE_PERCENT, DISTRUST_PERCENT, reason);
        let evidence = self.evidence(SphereKind::Grey, l, c).filter(|_| known.source == Source::GreyBall);
        Some(evidence.map_or(verdict.clone(), |evidence| verdict.worse(judge_ball(evidence))))
    }

    /// Of beta of colour `c`: its error moves bounce 1 by as much over 1 - beta, and colours too alike cannot be told
    /// apart: of two colours, bounce 1 has sqrt(1 + beta^4) / (beta (1 - beta)) times the noise of a photo.
    pub fn judge_beta(&self, set: &CaptureSet, c: usize) -> Option<Verdict> {
        let betas = self.beta.as_ref()?;
        let known = betas.get(c)?;
        let values: Vec<f64> = betas.iter().map(|known| known.value).collect();
        let name = format!("{:?}", set.colours.get(c)?.name);
        let alike = set.check_beta_distances(&values).into_iter().find(|problem| problem.message.contains(&name));
        if let Some(problem) = alike.filter(|_| c > 0) {
            return Some(Verdict::DoNotTrust(problem.message));
        }
        let half_width = known.interval.map_or(0.0, |[low, high]| (high - low) / 2.0);
        let error = 100.0 * half_width / distance_from_one((c > 0).then_some(known.value));
        let reason = || format!("its interval alone moves bounce 1 by {error:.1} %");
        let verdict = Verdict::of(error, CARE_PERCENT, DISTRUST_PERCENT, reason);
        let verdict = match set.colours.len() {
            2 if c > 0 => verdict.worse(judge_gain(known.value)),
            _ => verdict,
        };
        let measured = self.ratios.iter().filter(|ratio| ratio.ball == SphereKind::Material && ratio.colour == c);
        let measured = measured.filter(|_| known.source == Source::MaterialBall);
        Some(measured.fold(verdict, |verdict, evidence| verdict.worse(judge_ball(evidence))))
    }

    /// Of the strength of light `l`.
    pub fn judge_intensity(&self, l: usize) -> Option<Verdict> {
        let known = self.intensity.get(l)?;
        if known.source == Source::Assumed {
            return Some(Verdict::TakeCare("taken as 1: lamps of unequal strength would bend the normals".into()));
        }
        let error = 100.0 * relative_half_width(known);
        Some(Verdict::of(error, CARE_PERCENT, DISTRUST_PERCENT, || format!("known to {error:.1} % only")))
    }

    /// Of the direction to light `l`.
    pub fn judge_direction(&self, set: &CaptureSet, l: usize) -> Option<Verdict> {
        let known = self.direction.get(l)?.as_ref()?;
        let half_width =
            |[low, high]: [[f64; 3]; 2]| low.iter().zip(high).map(|(low, high)| (high - low) / 2.0).fold(0.0, f64::max);
        let error_deg = known.interval.map_or(0.0, half_width).to_degrees();
        let verdict =
            Verdict::of(error_deg, CARE_DEG, DISTRUST_DEG, || format!("known to {error_deg:.1} degrees only"));
        let about = format!("light {}: ", set.lights.get(l)?.name);
        let warned = self.warnings.iter().find_map(|warning| warning.strip_prefix(&about)).map(str::to_owned);
        Some(warned.map_or(verdict.clone(), |warning| verdict.worse(Verdict::TakeCare(warning))))
    }

    /// The ratio of colour `c` over the reference colour under light `l` on a ball.
    pub fn evidence(&self, ball: SphereKind, l: usize, c: usize) -> Option<&RatioEvidence> {
        self.ratios.iter().find(|ratio| (ratio.ball, ratio.light, ratio.colour) == (ball, l, c))
    }
}

fn judge_gain(beta: f64) -> Verdict {
    let gain = (1.0 + beta.powi(4)).sqrt() / (beta * distance_from_one(Some(beta)));
    Verdict::of(gain, CARE_GAIN, DISTRUST_GAIN, || {
        format!("bounce 1 has {gain:.0} times the noise of a photo: the paint reflects both colours too much alike")
    })
}

fn judge_ball(evidence: &RatioEvidence) -> Verdict {
    let counts = evidence.report.pixels.counts();
    let clipped = counts.clipped as f64 / counts.inside().max(1) as f64;
    if clipped > CARE_CLIPPED {
        return Verdict::TakeCare(format!("{:.0} % of the ball is clipped; shorten the exposure", 100.0 * clipped));
    }
    let scatter = evidence.report.scatter;
    if scatter > CARE_SCATTER {
        return Verdict::TakeCare(format!(
            "its pixels scatter by {:.0} %; is the ball clean and of one paint?",
            100.0 * scatter
        ));
    }
    Verdict::Good
}

fn relative_half_width(known: &Known<f64>) -> f64 {
    known.interval.map_or(0.0, |[low, high]| (high - low) / (2.0 * known.value.abs()))
}

/// |1 - beta|; one where beta is not known.
fn distance_from_one(beta: Option<f64>) -> f64 {
    beta.map_or(1.0, |beta| (1.0 - beta).abs().max(1e-3))
}
