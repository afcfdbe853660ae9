//! All that is known of a rig and a paint, and the evidence for it.

use firstbounce_core::calibrate::{Highlight, HighlightReport, RatioReport};
use firstbounce_core::sphere::{BallError, CircleReport};

use super::super::PipelineError;
use super::super::crosstalk::{self, KnownCrosstalk};
use super::{DirectionDoubt, Known, Source};
use crate::set::{Calibration, CaptureSet, Sphere, SphereKind, Subject};

/// The circle of a ball in the pictures of a subject.
#[derive(Clone, Debug, PartialEq)]
pub struct BallCircle {
    /// Which ball, where.
    pub sphere: Sphere,
    /// How well it was found; `None` where the capture file gives it.
    pub found: Option<CircleReport>,
    /// The edge that shows near a circle that the file gives; `None` where none shows.
    pub edge: Option<CircleReport>,
}

/// A ball whose circle is not known.
#[derive(Clone, Debug, PartialEq)]
pub struct BallNotFound {
    /// Which ball.
    pub kind: SphereKind,
    /// In which shots.
    pub subject: Subject,
    /// Why.
    pub reason: BallError,
}

impl BallNotFound {
    /// As an error, for where the ball cannot be done without.
    pub fn error(&self) -> PipelineError {
        PipelineError::Ball { subject: self.subject, reason: self.reason.clone() }
    }
}

/// What one colour's photo of a ball says against the reference colour's: alpha on the grey ball, alpha times beta on the
/// ball of the paint. For the histogram and the tinted pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct RatioEvidence {
    /// Which ball.
    pub ball: SphereKind,
    /// Index of the light.
    pub light: usize,
    /// Index of the colour.
    pub colour: usize,
    /// The ratio in every pixel, and the pixels used and refused.
    pub report: RatioReport,
}

/// All that is known of a rig and a paint. Lights and colours in the order of the set.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Calibrated {
    /// By light, then colour: intensity over the reference colour's. `None` where nothing tells.
    pub alpha: Vec<Option<Vec<Known<f64>>>>,
    /// By colour: albedo over the reference colour's. `None` where nothing tells.
    pub beta: Option<Vec<Known<f64>>>,
    /// By channel, then lamp: the crosstalk that was undone before anything was measured; empty where nothing tells.
    pub crosstalk: KnownCrosstalk,
    /// By light: strength in the reference colour relative to the first light.
    pub intensity: Vec<Known<f64>>,
    /// Linear light of the grey ball's paint square to a lamp of intensity 1, in the reference colour; `None` where the
    /// ball was not looked at for intensities.
    pub grey_light: Option<f64>,
    /// By light: unit vector from the object to the light. `None` where nothing tells.
    pub direction: Vec<Option<Known<[f64; 3]>>>,
    /// By light: where it is, in mm, as several mirror balls in one picture or one in two places say; `None` where there are
    /// fewer, or the lamp is too far away for them.
    pub position: Vec<Option<Known<[f64; 3]>>>,
    /// By light: the share of its light on the balls that does not come from the lamp; `None` where it is too little to
    /// matter, or unknown.
    pub room_light: Vec<Option<f64>>,
    /// By light: what makes its measured direction doubtful; also among the warnings.
    pub direction_doubts: Vec<Vec<DirectionDoubt>>,
    /// By light: the bright spots on the mirror ball, the chosen one first; `None` where there is no mirror ball.
    pub highlights: Vec<Option<HighlightReport>>,
    /// Every ratio that was measured. What the file gives is too, where its ball is looked at anyway.
    pub ratios: Vec<RatioEvidence>,
    /// The balls' circles.
    pub circles: Vec<BallCircle>,
    /// The balls that were looked for in vain.
    pub not_found: Vec<BallNotFound>,
    /// What the user should know before trusting the values.
    pub warnings: Vec<String>,
}

impl Calibrated {
    /// alpha of every colour under light `l`.
    pub fn alpha_values(&self, set: &CaptureSet, l: usize) -> Result<Vec<f64>, PipelineError> {
        let alpha = self.alpha.get(l).and_then(Option::as_ref);
        let missing = || PipelineError::NoAlpha { light: set.lights[l].name.clone() };
        let alpha = alpha.ok_or_else(|| self.error_of(SphereKind::Grey).unwrap_or_else(missing))?;
        Ok(alpha.iter().map(|known| known.value).collect())
    }

    /// The crosstalk that was undone, as the capture file gives it; `None` where nothing tells.
    pub fn crosstalk_rows(&self) -> Option<Vec<Vec<f64>>> {
        (!self.crosstalk.is_empty()).then(|| crosstalk::values(&self.crosstalk))
    }

    /// Why this ball was not found; `None` where it was, or is not there.
    fn error_of(&self, kind: SphereKind) -> Option<PipelineError> {
        self.not_found.iter().find(|ball| ball.kind == kind).map(BallNotFound::error)
    }

    /// beta of every colour.
    pub fn beta_values(&self) -> Result<Vec<f64>, PipelineError> {
        let missing = || self.error_of(SphereKind::Material).unwrap_or(PipelineError::NoBeta);
        Ok(self.beta.as_ref().ok_or_else(missing)?.iter().map(|known| known.value).collect())
    }

    /// The positions that mirror balls gave, by the name of the light.
    pub fn positions_mm<'a>(&'a self, set: &'a CaptureSet) -> impl Iterator<Item = (&'a str, &'a Known<[f64; 3]>)> {
        let by_light = set.lights.iter().zip(&self.position);
        by_light.filter_map(|(light, known)| Some((light.name.as_str(), known.as_ref()?)))
    }

    /// The values in force, by the words of the file. A light whose position or direction the file gives keeps that alone.
    pub fn values(&self, set: &CaptureSet) -> Calibration {
        let lights = || set.lights.iter();
        let values = |known: &Vec<Known<f64>>| known.iter().map(|known| known.value).collect();
        let by_light = lights().zip(&self.alpha);
        Calibration {
            beta: self.beta.as_ref().map(values),
            alpha: by_light.filter_map(|(l, known)| Some((l.name.clone(), values(known.as_ref()?)))).collect(),
            direction: lights()
                .zip(&self.direction)
                .filter(|(light, _)| light.direction.is_none() && light.position_mm.is_none())
                .filter_map(|(light, known)| Some((light.name.clone(), known.as_ref()?.value)))
                .collect(),
            intensity: lights().zip(&self.intensity).map(|(l, known)| (l.name.clone(), known.value)).collect(),
            grey_albedo: set.calibration.grey_albedo,
            white_light: set.calibration.white_light,
        }
    }

    /// The same with what `set` gives put in force, at once and without looking at a ball again: for a value that is being
    /// typed. Lights and colours must be those that were calibrated.
    pub fn with_given(mut self, set: &CaptureSet) -> Self {
        let lights = set.lights.len();
        let typed = |values: &Vec<f64>, before: Option<&Vec<Known<f64>>>| -> Vec<Known<f64>> {
            let before = |c: usize| before.and_then(|before| before.get(c));
            values.iter().enumerate().map(|(c, &value)| Known::from_file(value).beside(before(c))).collect()
        };
        self.alpha.resize(lights, None);
        self.direction.resize(lights, None);
        self.intensity.resize(lights, Known::new(1.0, Source::Assumed));
        for (l, light) in set.lights.iter().enumerate() {
            if let Some(alpha) = set.calibration.alpha.get(&light.name) {
                self.alpha[l] = Some(typed(alpha, self.alpha[l].as_ref()));
            }
            if let Some(direction) = set.given_direction(&light.name) {
                self.direction[l] = Some(Known::from_file(direction).beside(self.direction[l].as_ref()));
            }
            if let Some(intensity) = set.calibration.intensity.get(&light.name) {
                self.intensity[l] = Known::from_file(*intensity).beside(Some(&self.intensity[l]));
            }
        }
        if let Some(beta) = &set.calibration.beta {
            self.beta = Some(typed(beta, self.beta.as_ref()));
        }
        self
    }

    /// The likeliest highlight of light `l` that is not among those that the user deleted, by their place in the report.
    pub fn highlight_without(&self, l: usize, deleted: &[usize]) -> Option<&Highlight> {
        let candidates = &self.highlights.get(l)?.as_ref()?.candidates;
        candidates.iter().enumerate().find(|(index, _)| !deleted.contains(index)).map(|(_, highlight)| highlight)
    }
}
