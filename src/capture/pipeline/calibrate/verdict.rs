//! The verdict on a calibration value: a level by the limits of [`firstbounce_core::trust`], and its evidence.

use std::fmt;

use firstbounce_core::interval::Estimate;
use firstbounce_core::trust::{Level, Limits, TwoLimits, gain_of_ratio};

use super::direction::contradiction;
use super::{BallCircle, Calibrated, CircleDoubt, DirectionDoubt, Known, RatioEvidence, Source};
use crate::set::{CaptureSet, SphereKind};

/// A judgement and what it stands on.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// The judgement.
    pub level: Level,
    /// What spoils the value most; `None` where it is fine.
    pub evidence: Option<Evidence>,
}

/// What spoils a calibration value.
#[derive(Clone, Debug, PartialEq)]
pub enum Evidence {
    /// The interval of alpha or beta.
    Interval {
        /// How far its ends move bounce 1, in percent.
        percent: f64,
    },
    /// Two colours that see the paint alike.
    Alike {
        /// Both colours, by name.
        colours: [String; 2],
        /// Both beta.
        beta: [f64; 2],
    },
    /// Noise that two colours do not share.
    Gain {
        /// Noise of bounce 1 over that of a photo.
        gain: f64,
    },
    /// Clipped pixels of the ball.
    Clipped {
        /// Percent of the ball.
        percent: f64,
    },
    /// A ball that is not of one paint.
    Scatter {
        /// Scatter of a pixel's ratio in percent.
        percent: f64,
    },
    /// An intensity that was not measured.
    AssumedIntensity,
    /// The interval of an intensity.
    Intensity {
        /// Half of it, in percent.
        percent: f64,
    },
    /// The interval of a direction.
    Direction {
        /// Half of it, in degrees.
        degrees: f64,
    },
    /// Something about the balls' directions.
    Doubt(DirectionDoubt),
    /// Light that does not come from the lamp.
    RoomLight {
        /// Its share of the lamp's light, in percent.
        percent: f64,
    },
    /// A given circle that does not lie on the edge of its ball.
    Circle(CircleDoubt),
    /// A typed value that the balls contradict.
    Typed {
        /// What the balls say.
        measured: f64,
        /// Half of its 95 % interval.
        half_width: f64,
    },
}

impl fmt::Display for Evidence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Interval { percent } => write!(f, "its interval alone moves bounce 1 by {percent:.1} %"),
            Self::Alike { colours: [one, other], beta } => write!(
                f,
                "{other} ({}) and {one} ({}) are too alike to tell bounces apart; take lamp colours that the paint \
                 reflects more differently",
                beta[1], beta[0]
            ),
            Self::Gain { gain } => write!(
                f,
                "bounce 1 has {gain:.0} times the noise of a photo: the paint reflects both colours too much alike"
            ),
            Self::Clipped { percent } => write!(f, "{percent:.0} % of the ball is clipped; shorten the exposure"),
            Self::Scatter { percent } => {
                write!(f, "its pixels scatter by {percent:.0} %; is the ball clean and of one paint?")
            }
            Self::AssumedIntensity => f.write_str("taken as 1: lamps of unequal strength would bend the normals"),
            Self::Intensity { percent } => write!(f, "known to {percent:.1} % only"),
            Self::Direction { degrees } => write!(f, "known to {degrees:.1} degrees only"),
            Self::Doubt(doubt) => doubt.fmt(f),
            Self::RoomLight { percent } => write!(f, "{percent:.1} % of the light on the ball is not the lamp's"),
            Self::Circle(doubt) => doubt.fmt(f),
            Self::Typed { measured, half_width } => write!(f, "the ball says {measured:.4} \u{b1} {half_width:.4}"),
        }
    }
}

impl Verdict {
    /// Why; empty where nothing stands out.
    pub fn reason(&self) -> String {
        self.evidence.as_ref().map(ToString::to_string).unwrap_or_default()
    }

    fn new(level: Level, evidence: Evidence) -> Self {
        Self { level, evidence: (level > Level::Fine).then_some(evidence) }
    }

    fn by(limits: TwoLimits, value: f64, evidence: Evidence) -> Self {
        Self::new(limits.level(value), evidence)
    }

    /// The worse of two, the first of equals.
    fn worse(self, other: Self) -> Self {
        if other.level > self.level { other } else { self }
    }
}

impl Calibrated {
    /// Of alpha of colour `c` under light `l`: an error of alpha moves bounce 1 by as much over 1 - beta (METHOD.md: the
    /// inverse of a 2 x 2 Vandermonde system).
    pub fn judge_alpha(&self, l: usize, c: usize) -> Option<Verdict> {
        let known = self.alpha.get(l)?.as_ref()?.get(c)?;
        let beta = self.beta.as_ref().and_then(|beta| beta.get(c)).map(|known| known.value);
        let percent = 100.0 * relative_half_width(known) / distance_from_one(beta);
        let verdict = Verdict::by(Limits::default().light_percent, percent, Evidence::Interval { percent });
        let verdict = verdict.worse(judge_typed(known, distance_from_one(beta)));
        let evidence = self.evidence(SphereKind::Grey, l, c).filter(|_| known.source == Source::GreyBall);
        let verdict = evidence.into_iter().fold(verdict, |verdict, evidence| verdict.worse(judge_ball(evidence)));
        Some(verdict.worse(self.judge_room_light(l, known)).worse(self.judge_circle(SphereKind::Grey, known)))
    }

    /// Of beta of colour `c`: its error moves bounce 1 by as much over 1 - beta, and colours too alike cannot be told
    /// apart. Of two colours the gain is that of the separation.
    pub fn judge_beta(&self, set: &CaptureSet, c: usize) -> Option<Verdict> {
        let betas = self.beta.as_ref()?;
        let known = betas.get(c)?;
        let values: Vec<f64> = betas.iter().map(|known| known.value).collect();
        let alike = set.colours_alike(&values).into_iter().find(|pair| c > 0 && pair.contains(&c));
        if let Some([one, other]) = alike {
            let name = |c: usize| set.colours[c].name.clone();
            let evidence = Evidence::Alike { colours: [name(one), name(other)], beta: [values[one], values[other]] };
            return Some(Verdict::new(Level::DoNotTrust, evidence));
        }
        let limits = Limits::default();
        let half_width = known.interval.map_or(0.0, |[low, high]| (high - low) / 2.0);
        let distance = distance_from_one((c > 0).then_some(known.value));
        let percent = 100.0 * half_width / distance;
        let verdict = Verdict::by(limits.light_percent, percent, Evidence::Interval { percent });
        let verdict = match set.colours.len() {
            2 if c > 0 && set.bounces() > 1 => {
                let gain = gain_of_ratio(known.value);
                verdict.worse(Verdict::by(limits.gain, gain, Evidence::Gain { gain }))
            }
            _ => verdict,
        };
        let measured = self.ratios.iter().filter(|ratio| ratio.ball == SphereKind::Material && ratio.colour == c);
        let measured = measured.filter(|_| known.source == Source::MaterialBall);
        let verdict = measured.fold(verdict, |verdict, evidence| verdict.worse(judge_ball(evidence)));
        let room_light = (0..self.room_light.len()).map(|l| self.judge_room_light(l, known));
        let verdict = room_light.fold(verdict.worse(judge_typed(known, distance)), Verdict::worse);
        Some(verdict.worse(self.judge_circle(SphereKind::Material, known)))
    }

    /// Of the strength of light `l`.
    pub fn judge_intensity(&self, l: usize) -> Option<Verdict> {
        let known = self.intensity.get(l)?;
        if known.source == Source::Assumed {
            return Some(Verdict::new(Level::TakeCare, Evidence::AssumedIntensity));
        }
        let percent = 100.0 * relative_half_width(known);
        let verdict = Verdict::by(Limits::default().light_percent, percent, Evidence::Intensity { percent });
        let verdict = verdict.worse(judge_typed(known, 1.0)).worse(self.judge_room_light(l, known));
        Some(verdict.worse(self.judge_circle(SphereKind::Grey, known)))
    }

    /// Of the direction to light `l`.
    pub fn judge_direction(&self, l: usize) -> Option<Verdict> {
        let known = self.direction.get(l)?.as_ref()?;
        let half_width =
            |[low, high]: [[f64; 3]; 2]| low.iter().zip(high).map(|(low, high)| (high - low) / 2.0).fold(0.0, f64::max);
        let degrees = known.interval.map_or(0.0, half_width).to_degrees();
        let verdict = Verdict::by(Limits::default().normal_deg, degrees, Evidence::Direction { degrees });
        let typed = contradiction(known);
        let doubts = self.direction_doubts.get(l).into_iter().flatten();
        // What is doubtful about the balls' direction does not matter where another is in force.
        let doubts = doubts.filter(|doubt| known.source != Source::File || doubt.is_of_any_source()).chain(&typed);
        let verdict = doubts
            .fold(verdict, |verdict, doubt| verdict.worse(Verdict::new(doubt.level(), Evidence::Doubt(doubt.clone()))));
        let verdict = verdict.worse(self.judge_room_light(l, known));
        let kinds = [SphereKind::Mirror, SphereKind::Grey].into_iter();
        Some(kinds.fold(verdict, |verdict, kind| verdict.worse(self.judge_circle(kind, known))))
    }

    /// Of a value that was measured in light that is not the lamp's.
    fn judge_room_light<T>(&self, l: usize, known: &Known<T>) -> Verdict {
        match self.room_light.get(l).copied().flatten() {
            Some(share) if known.source.uses_ball(SphereKind::Grey) || known.source.uses_ball(SphereKind::Material) => {
                Verdict::new(Level::TakeCare, Evidence::RoomLight { percent: 100.0 * share })
            }
            _ => Verdict { level: Level::Fine, evidence: None },
        }
    }

    /// Of a value that was measured within a given circle.
    fn judge_circle<T>(&self, kind: SphereKind, known: &Known<T>) -> Verdict {
        let ball = self.circles.iter().find(|ball| ball.sphere.kind == kind && known.source.uses_ball(kind));
        match ball.and_then(BallCircle::doubt) {
            Some(doubt) => Verdict::new(doubt.level(), Evidence::Circle(doubt)),
            None => Verdict { level: Level::Fine, evidence: None },
        }
    }

    /// The ratio of colour `c` over the reference colour under light `l` on a ball.
    pub fn evidence(&self, ball: SphereKind, l: usize, c: usize) -> Option<&RatioEvidence> {
        self.ratios.iter().find(|ratio| (ratio.ball, ratio.light, ratio.colour) == (ball, l, c))
    }
}

fn judge_ball(evidence: &RatioEvidence) -> Verdict {
    let limits = Limits::default();
    let counts = evidence.report.pixels.counts();
    let clipped = 100.0 * counts.clipped as f64 / counts.inside().max(1) as f64;
    let scatter = 100.0 * evidence.report.scatter;
    let verdict = Verdict::by(limits.ball_clipped_percent, clipped, Evidence::Clipped { percent: clipped });
    verdict.worse(Verdict::by(limits.ball_scatter_percent, scatter, Evidence::Scatter { percent: scatter }))
}

/// Of a typed value, by how far it moves bounce 1 from where the balls put it: its relative error over `distance`.
fn judge_typed(known: &Known<f64>, distance: f64) -> Verdict {
    match known.contradicted() {
        None => Verdict { level: Level::Fine, evidence: None },
        Some(off) => {
            let Estimate { value, .. } = off.measured;
            let half_width = value.abs() * off.measured.relative_half_width();
            let level = Limits::default().light_percent.level(100.0 * off.share / distance).max(Level::TakeCare);
            Verdict::new(level, Evidence::Typed { measured: value, half_width })
        }
    }
}

fn relative_half_width(known: &Known<f64>) -> f64 {
    known.interval.map_or(0.0, |[low, high]| (high - low) / (2.0 * known.value.abs()))
}

/// |1 - beta|; one where beta is not known.
fn distance_from_one(beta: Option<f64>) -> f64 {
    beta.map_or(1.0, |beta| (1.0 - beta).abs().max(1e-3))
}

#[cfg(test)]
mod tests {
    use firstbounce_core::trust::{LightLevels, Rig, TrustOptions, judge};
    use nalgebra::DMatrix;

    use super::*;

    /// Beta between 0.5 and 1 whose gain is this.
    fn beta_of_gain(gain: f64) -> f64 {
        let (mut low, mut high) = (0.5, 1.0);
        for _ in 0..60 {
            let middle = (low + high) / 2.0;
            if gain_of_ratio(middle) < gain { low = middle } else { high = middle }
        }
        low
    }

    #[test]
    fn calibrate_and_separate_judge_one_gain_alike() {
        let mut set =
            CaptureSet::open(std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/demo")).unwrap();
        set.separation.bounces = Some(2);
        for (gain, level) in [
            (5.0, Level::Fine),
            (9.0, Level::Fine),
            (12.0, Level::TakeCare),
            (20.0, Level::TakeCare),
            (30.0, Level::DoNotTrust),
        ] {
            let beta = beta_of_gain(gain);
            let calibrated =
                Calibrated { beta: Some([1.0, beta].map(Known::from_file).to_vec()), ..Calibrated::default() };
            assert_eq!(calibrated.judge_beta(&set, 1).unwrap().level, level, "Calibrate at gain {gain}");

            let exact = |values: [f64; 2]| values.map(Estimate::exact).to_vec();
            let light =
                LightLevels { alpha: exact([1.0; 2]), mean: vec![0.5, 0.5 * beta], sigma: vec![1e-9; 2], toward: None };
            let rig = Rig { beta: exact([1.0, beta]), lights: vec![light], products: DMatrix::zeros(0, 0), frames: 1 };
            let trust = judge(&rig, &TrustOptions::default()).unwrap();
            assert_eq!(trust.level, level, "Separate at gain {gain}: {:?}", trust.reasons);
        }
    }
}
