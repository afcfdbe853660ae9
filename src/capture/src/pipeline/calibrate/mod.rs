//! Balls to alpha, beta, intensity and direction; what the capture file gives can win over what is measured.

mod balls;
mod direction;
mod measure;

use firstbounce_core::ball::CircleReport;
use firstbounce_core::calibrate::{BallPixels, HighlightReport};
use firstbounce_core::interval::Estimate;

use super::{PipelineError, PipelineWatch};
use crate::set::{CaptureSet, Sphere};

/// Where a value comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The reference colour's alpha and beta, the first light's intensity: 1 by definition.
    Definition,
    /// capture.toml, where a person typed it or the program wrote it.
    File,
    /// The grey ball.
    GreyBall,
    /// The ball of the object's paint.
    MaterialBall,
    /// The highlight on the mirror ball.
    MirrorBall,
    /// The grey ball's shading.
    Shading,
    /// Mirror ball and shading, which agree.
    MirrorAndShading,
    /// Nothing: an assumption, named in a warning.
    Assumed,
}

impl Source {
    /// For people.
    pub fn words(self) -> &'static str {
        match self {
            Self::Definition => "by definition",
            Self::File => "capture.toml",
            Self::GreyBall => "grey ball",
            Self::MaterialBall => "ball of the paint",
            Self::MirrorBall => "mirror ball",
            Self::Shading => "grey ball's shading",
            Self::MirrorAndShading => "mirror ball and grey ball's shading",
            Self::Assumed => "assumed",
        }
    }
}

/// A calibration value, and how well it is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Known<T> {
    /// The value in force.
    pub value: T,
    /// Ends of the 95 % interval; `None` for what was typed or assumed.
    pub interval: Option<[T; 2]>,
    /// Where it comes from.
    pub source: Source,
    /// The ball's pixels, used and refused by reason; `None` where none were looked at, or for a highlight.
    pub pixels: Option<BallPixels>,
}

impl<T> Known<T> {
    fn from_file(value: T) -> Self {
        Self { value, interval: None, source: Source::File, pixels: None }
    }
}

impl Known<f64> {
    fn by_definition() -> Self {
        Self { value: 1.0, interval: Some([1.0; 2]), source: Source::Definition, pixels: None }
    }

    fn measured(estimate: Estimate, source: Source, pixels: Option<BallPixels>) -> Self {
        let interval = [estimate.interval.low, estimate.interval.high];
        Self { value: estimate.value, interval: Some(interval), source, pixels }
    }

    /// As the core's formulas take it; a typed value counts as exact.
    pub(super) fn estimate(&self) -> Estimate {
        let [low, high] = self.interval.unwrap_or([self.value; 2]);
        Estimate { value: self.value, interval: firstbounce_core::interval::Interval { low, high } }
    }
}

/// The circle of a ball in the pictures of a subject.
#[derive(Clone, Debug, PartialEq)]
pub struct BallCircle {
    /// Which ball, where.
    pub sphere: Sphere,
    /// How well it was found; `None` where the capture file gives it.
    pub found: Option<CircleReport>,
}

/// All that is known of a rig and a paint. Lights and colours in the order of the set.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Calibrated {
    /// By light, then colour: intensity over the reference colour's. `None` where nothing tells.
    pub alpha: Vec<Option<Vec<Known<f64>>>>,
    /// By colour: albedo over the reference colour's. `None` where nothing tells.
    pub beta: Option<Vec<Known<f64>>>,
    /// By light: strength in the reference colour relative to the first light.
    pub intensity: Vec<Known<f64>>,
    /// By light: unit vector from the object to the light. `None` where nothing tells.
    pub direction: Vec<Option<Known<[f64; 3]>>>,
    /// By light: the bright spots on the mirror ball, the chosen one first; `None` where there is no mirror ball.
    pub highlights: Vec<Option<HighlightReport>>,
    /// The balls' circles.
    pub circles: Vec<BallCircle>,
    /// What a person should know before trusting the values.
    pub warnings: Vec<String>,
}

impl Calibrated {
    /// alpha of every colour under light `l`.
    pub fn alpha_values(&self, set: &CaptureSet, l: usize) -> Result<Vec<f64>, PipelineError> {
        let alpha = self.alpha.get(l).and_then(Option::as_ref);
        let missing = || PipelineError::NoAlpha { light: set.lights[l].name.clone() };
        Ok(alpha.ok_or_else(missing)?.iter().map(|known| known.value).collect())
    }

    /// beta of every colour.
    pub fn beta_values(&self) -> Result<Vec<f64>, PipelineError> {
        Ok(self.beta.as_ref().ok_or(PipelineError::NoBeta)?.iter().map(|known| known.value).collect())
    }
}

/// Which value wins where a capture file gives one and a ball gives another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preference {
    /// The file's: what a person typed or accepted. Balls are measured for what the file leaves out.
    File,
    /// The balls': to see, or to write, what they say.
    Balls,
}

/// Calibrates a set from its file and its balls. Missing balls leave their values open; a ball that is there and cannot
/// be used is an error.
pub fn calibrate(
    set: &CaptureSet,
    preference: Preference,
    watch: &dyn PipelineWatch,
) -> Result<Calibrated, PipelineError> {
    measure::Measuring::new(set, preference, watch)?.run()
}

/// Calibrates a set for the separation of `bounces` bounces, and makes sure that its colours can tell them apart.
pub fn calibrate_for(set: &CaptureSet, bounces: usize, watch: &dyn PipelineWatch) -> Result<Calibrated, PipelineError> {
    let calibrated = calibrate(set, Preference::File, watch)?;
    let beta = calibrated.beta_values()?;
    if bounces > 1
        && let Some(problem) = set.check_beta_distances(&beta).into_iter().next()
    {
        return Err(PipelineError::Beta(problem));
    }
    Ok(calibrated)
}
