//! Reasons against a separation, as data and in words.

use super::calibration::sources;
use super::{Level, LightTrust, NormalTrust, Rig, TrustOptions, TwoLimits, values};
use crate::methods::colours_and_shape::ClosureFinding;
use crate::separate::{BounceSystem, closest_pair};

/// A colour darker than this share of the reference sends too little light to measure bounces by.
const DARK_BETA: f64 = 0.3;
/// A mean that contradicts the law of truncation by less than this may be noise.
const MIN_CONTRADICTION: f64 = 0.05;
/// Root mean square angles beyond this are no angles of normals that face the camera.
pub const NO_DIRECTION_DEG: f64 = 60.0;

/// What the colours and lights of a set are called.
#[derive(Clone, Copy, Debug)]
pub struct Names<'a> {
    /// By colour, the reference first.
    pub colours: &'a [String],
    /// By light.
    pub lights: &'a [String],
}

impl Names<'_> {
    pub(super) fn colour(&self, colour: usize) -> &str {
        self.colours.get(colour).map_or("?", String::as_str)
    }

    fn light(&self, light: usize) -> &str {
        self.lights.get(light).map_or("?", String::as_str)
    }
}

/// One thing that spoils bounce 1. Colours and lights are counted from 0.
#[derive(Clone, Debug, PartialEq)]
pub enum Reason {
    /// Two colours see the same paint.
    SameAlbedo {
        /// One colour.
        first: usize,
        /// The other.
        second: usize,
        /// Both beta.
        beta: [f64; 2],
    },
    /// The bounces cannot be separated.
    Singular {
        /// The order m.
        bounces: usize,
    },
    /// The object's mean bounce 1 comes out negative.
    Negative {
        /// Under which light.
        light: usize,
    },
    /// Noise, and anything else that two colours do not share, grows too much.
    Gain {
        /// Gain of bounce 1.
        gain: f64,
        /// The order m.
        bounces: usize,
        /// The two colours that are most alike, the darker one last.
        closest: (usize, usize),
        /// Beta of the darker one.
        beta: f64,
    },
    /// Noise bends the normals.
    NormalNoise {
        /// Root mean square angle.
        degrees: f64,
    },
    /// Bounce 1 is noisy.
    LightNoise {
        /// Noise in percent of bounce 1.
        percent: f64,
        /// Under which light most.
        light: usize,
    },
    /// The intervals of alpha and beta are wide enough to bend the normals.
    CalibrationBend {
        /// Root mean square angle.
        degrees: f64,
    },
    /// The intervals of alpha and beta are wide enough to matter.
    CalibrationError {
        /// Standard deviation in percent of bounce 1.
        percent: f64,
        /// Under which light most.
        light: usize,
        /// The colour that matters most.
        colour: usize,
        /// Whether its beta (else its alpha) does.
        is_beta: bool,
    },
    /// The interval of beta is wide enough to bend the normals, by the method that uses the shape.
    BetaBend {
        /// Mean angle.
        degrees: f64,
        /// The colour that matters most.
        colour: usize,
    },
    /// What the amount of indirect light and the ends of the colour ratios say of beta.
    Closure(ClosureFinding),
    /// Light of more than m bounces.
    Truncation {
        /// What it adds to bounce 1, in percent of it.
        percent: f64,
        /// The order m.
        bounces: usize,
        /// Under which light most.
        light: usize,
    },
    /// The photos would need more light between the walls than walls can hold.
    ReturnsTooMuch {
        /// The share that would come back.
        share: f64,
        /// Under which light most.
        light: usize,
    },
    /// The photos would need negative indirect light.
    Contradicted {
        /// Under which light most.
        light: usize,
    },
    /// One colour says nothing about bounces.
    OneColour,
}

impl Reason {
    /// One sentence.
    pub fn words(&self, names: &Names) -> String {
        match self {
            Self::SameAlbedo { first, second, beta } => format!(
                "beta of {} and {} is {:.3} and {:.3}: they see the paint alike and cannot separate bounces",
                names.colour(*first),
                names.colour(*second),
                beta[0],
                beta[1]
            ),
            Self::Singular { bounces } => format!("{bounces} bounces cannot be separated with these beta"),
            Self::Negative { light } => {
                format!("under light {} bounce 1 comes out negative: alpha or beta is wrong", names.light(*light))
            }
            Self::Gain { gain, bounces, closest, beta } => gain_words(*gain, *bounces, *closest, *beta, names),
            Self::NormalNoise { degrees } if *degrees > NO_DIRECTION_DEG => {
                "noise leaves normals without a direction".into()
            }
            Self::NormalNoise { degrees } => format!("noise turns normals by about {degrees:.1} degrees"),
            Self::LightNoise { percent, light } => {
                format!("under light {} the noise of bounce 1 is {percent:.0} % of it", names.light(*light))
            }
            Self::CalibrationBend { degrees } if *degrees > NO_DIRECTION_DEG => {
                "the intervals of alpha and beta leave normals without a direction".into()
            }
            Self::CalibrationBend { degrees } => {
                format!("the intervals of alpha and beta leave normals uncertain by {degrees:.1} degrees")
            }
            Self::CalibrationError { percent, light, colour, is_beta } => format!(
                "the interval of {} of {} leaves bounce 1 under light {} uncertain by {percent:.0} %",
                if *is_beta { "beta" } else { "alpha" },
                names.colour(*colour),
                names.light(*light)
            ),
            Self::BetaBend { degrees, colour } => format!(
                "the interval of beta of {} leaves normals uncertain by {degrees:.1} degrees",
                names.colour(*colour)
            ),
            Self::Closure(finding) => finding.words(names.colours),
            Self::Truncation { percent, bounces, light } => truncation_words(*percent, *bounces, names.light(*light)),
            Self::ReturnsTooMuch { share, light } => format!(
                "with these alpha and beta the object would send {:.0} % of its light back to itself under light {}: \
                 beta is probably too large",
                100.0 * share,
                names.light(*light)
            ),
            Self::Contradicted { light } => format!(
                "under light {} the darker colours are brighter than beta allows: alpha or beta is wrong, or the \
                 object is of another paint than the ball",
                names.light(*light)
            ),
            Self::OneColour => "one colour cannot separate direct light from light between the walls".into(),
        }
    }
}

fn gain_words(gain: f64, bounces: usize, closest: (usize, usize), beta: f64, names: &Names) -> String {
    let noise = format!("noise on bounce 1 is {} times that of a photo", rounded(gain));
    let (first, second) = (names.colour(closest.0), names.colour(closest.1));
    if bounces > 2 {
        format!("{bounces} bounces ask much of these colours: {noise}")
    } else if beta < DARK_BETA {
        format!("beta of {second} is {beta:.3}: the paint is nearly black in it, so {noise}")
    } else {
        format!("beta of {second} is {beta:.3}: {first} and {second} see the paint alike, so {noise}")
    }
}

fn truncation_words(percent: f64, bounces: usize, light: &str) -> String {
    let by = percent.abs();
    if bounces == 1 {
        return format!(
            "one bounce leaves light between the walls in: bounce 1 under light {light} is {by:.0} % too bright"
        );
    }
    let sign = if percent < 0.0 { "dark" } else { "bright" };
    format!("light of more than {bounces} bounces makes bounce 1 under light {light} about {by:.0} % too {sign}")
}

/// Two digits where they matter.
pub(super) fn rounded(value: f64) -> String {
    if value < 9.95 { format!("{value:.1}") } else { format!("{value:.0}") }
}

impl TwoLimits {
    /// A reason with its level, and how many times the limit of care its value is.
    pub(super) fn judged(self, value: f64, reason: Reason) -> Found {
        Found { level: self.level(value), excess: value / self.care, reason }
    }
}

/// A reason before it is sorted.
pub(super) struct Found {
    level: Level,
    excess: f64,
    reason: Reason,
}

impl Found {
    fn hopeless(reason: Reason) -> Self {
        Self { level: Level::DoNotTrust, excess: f64::INFINITY, reason }
    }

    pub(super) fn care(reason: Reason) -> Self {
        Self { level: Level::TakeCare, excess: 1.0, reason }
    }
}

/// Every reason above `Fine`, the worst first.
pub(super) fn reasons(
    rig: &Rig,
    lights: &[LightTrust],
    normal: Option<&NormalTrust>,
    options: &TrustOptions,
) -> Vec<(Level, Reason)> {
    let mut found = Vec::new();
    let worst = |value: &dyn Fn(&LightTrust) -> f64| {
        (0..lights.len()).max_by(|a, b| value(&lights[*a]).total_cmp(&value(&lights[*b])))
    };
    let negative = lights.iter().position(|light| light.bounces[0] <= 0.0);
    found.extend(negative.map(|light| Found::hopeless(Reason::Negative { light })));
    found.extend(worst(&|light| light.gain[0]).and_then(|l| gain_reason(rig, lights[l].gain[0], options)));
    if let Some(normal) = normal {
        let noise = normal.denoised_noise_deg;
        found.push(options.limits.normal_deg.judged(noise, Reason::NormalNoise { degrees: noise }));
        let bend = normal.calibration_deg;
        found.push(options.limits.normal_deg.judged(bend, Reason::CalibrationBend { degrees: bend }));
    }
    // There are no percents of a bounce 1 that is not there.
    if negative.is_none() {
        if let Some(light) = worst(&|light| light.noise_percent) {
            let percent = lights[light].noise_percent;
            found.push(options.limits.light_percent.judged(percent, Reason::LightNoise { percent, light }));
        }
        let calibration = worst(&|light| light.calibration_percent.unwrap_or(0.0));
        found.extend(calibration.and_then(|l| calibration_reason(rig, lights, l, options)));
    }
    found.extend(truncation_reason(lights, options));
    if rig.beta.len() == 1 {
        found.push(Found::care(Reason::OneColour));
    }
    sorted(found)
}

/// Those above `Fine`, the worst first.
pub(super) fn sorted(mut found: Vec<Found>) -> Vec<(Level, Reason)> {
    found.retain(|found| found.level > Level::Fine);
    found.sort_by(|a, b| b.level.cmp(&a.level).then(b.excess.total_cmp(&a.excess)));
    found.into_iter().map(|found| (found.level, found.reason)).collect()
}

fn gain_reason(rig: &Rig, gain: f64, options: &TrustOptions) -> Option<Found> {
    let beta = values(&rig.beta);
    let (a, b) = closest_pair(&beta)?;
    let closest = if beta[a] < beta[b] { (b, a) } else { (a, b) };
    let reason = Reason::Gain { gain, bounces: options.bounces, closest, beta: beta[closest.1] };
    (options.bounces > 1).then(|| options.limits.gain.judged(gain, reason))
}

fn calibration_reason(rig: &Rig, lights: &[LightTrust], light: usize, options: &TrustOptions) -> Option<Found> {
    let levels = &rig.lights[light];
    let (alpha, beta) = (values(&levels.alpha), values(&rig.beta));
    let system = BounceSystem::new(&alpha, &beta, &levels.sigma, options.bounces).ok()?;
    let most = sources(rig, levels, &system, &lights[light].bounces).max_by(|a, b| a.sd(0).total_cmp(&b.sd(0)))?;
    let percent = lights[light].calibration_percent?;
    let reason = Reason::CalibrationError { percent, light, colour: most.colour, is_beta: most.is_beta };
    Some(options.limits.light_percent.judged(percent, reason))
}

/// Either the photos fit no object, or they give its truncation error.
fn truncation_reason(lights: &[LightTrust], options: &TrustOptions) -> Option<Found> {
    let shares =
        || lights.iter().map(|light| light.return_share).enumerate().filter_map(|(l, share)| Some((l, share?)));
    let (most_light, most) = shares().max_by(|a, b| a.1.total_cmp(&b.1))?;
    let (least_light, least) = shares().min_by(|a, b| a.1.total_cmp(&b.1))?;
    if least < -MIN_CONTRADICTION {
        return Some(Found::hopeless(Reason::Contradicted { light: least_light }));
    }
    if most > options.limits.return_share.care {
        let reason = Reason::ReturnsTooMuch { share: most, light: most_light };
        return Some(options.limits.return_share.judged(most, reason));
    }
    let errors = lights.iter().enumerate().filter_map(|(l, light)| Some((l, light.truncation_percent?)));
    let (light, percent) = errors.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    let reason = Reason::Truncation { percent, bounces: options.bounces, light };
    Some(options.limits.light_percent.judged(percent.abs(), reason))
}
