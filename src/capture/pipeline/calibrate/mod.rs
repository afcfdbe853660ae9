//! Balls to alpha, beta, intensity and direction; what the capture file gives can win over what is measured.

mod balls;
mod depth;
mod direction;
mod doubt;
mod measure;
mod position;
mod scale;
mod unknown_crosstalk;
mod verdict;
mod warning;

use firstbounce_core::calibrate::{BallPixels, Highlight, HighlightReport, RatioReport};
use firstbounce_core::interval::Estimate;
use firstbounce_core::sphere::{BallError, CircleReport};

use balls::BallPhotos;

use super::crosstalk::{self, KnownCrosstalk, with_crosstalk};
use super::methods::add_beta_of_object;
use super::{ObjectPhotos, PhotoStore, PipelineError, PipelineWatch, SolveOptions, Stage, load_object};
use crate::set::{Calibration, CaptureSet, Sphere, SphereKind, Subject};

pub use balls::circle_of;
pub(in crate::pipeline) use balls::{needed_subjects, view};
pub use doubt::{CircleDoubt, DirectionDoubt};
pub use scale::ScaleSource;
pub use verdict::{Evidence, Verdict};

/// Where a value comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// The reference colour's alpha and beta, the first light's intensity: 1 by definition.
    Definition,
    /// capture.toml, where the user typed it or the program wrote it.
    File,
    /// A light file (.lp).
    LightFile,
    /// The grey ball.
    GreyBall,
    /// The ball of the object's paint.
    MaterialBall,
    /// The object itself: the end of its colour ratios, and the amount of its indirect light.
    Object,
    /// The highlight on the mirror ball.
    MirrorBall,
    /// The grey ball's shading.
    Shading,
    /// Mirror ball and shading, which agree.
    MirrorAndShading,
    /// What a rendered set knows of itself.
    Truth,
    /// Nothing: an assumption, named in a warning.
    Assumed,
}

impl Source {
    /// For people.
    pub fn words(self) -> &'static str {
        match self {
            Self::Definition => "by definition",
            Self::File => "capture.toml",
            Self::LightFile => "light file",
            Self::GreyBall => "grey ball",
            Self::MaterialBall => "ball of the paint",
            Self::Object => "measured on the object",
            Self::MirrorBall => "mirror ball",
            Self::Shading => "grey ball's shading",
            Self::MirrorAndShading => "mirror ball and grey ball's shading",
            Self::Truth => "the set's truth",
            Self::Assumed => "assumed",
        }
    }

    /// Whether a value of this source was measured on a ball of this kind.
    pub(super) fn uses_ball(self, kind: SphereKind) -> bool {
        match self {
            Self::GreyBall | Self::Shading => kind == SphereKind::Grey,
            Self::MaterialBall => kind == SphereKind::Material,
            Self::MirrorBall => kind == SphereKind::Mirror,
            Self::MirrorAndShading => kind != SphereKind::Material,
            _ => false,
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
    /// The ball's pixels, used and refused by reason; `None` where none were looked at. Of a direction, the grey ball's.
    pub pixels: Option<BallPixels>,
    /// What the balls say, where the file's value is in force and they were looked at.
    pub measured: Option<Measured<T>>,
}

/// What the balls say of a value that is not in force.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured<T> {
    /// The value.
    pub value: T,
    /// Ends of its 95 % interval.
    pub interval: [T; 2],
}

/// A typed value and a measured one that cannot both be right.
pub(super) struct Contradicted {
    /// What the balls say.
    pub measured: Estimate,
    /// How far the typed value is off it, relative to it.
    pub share: f64,
}

/// A typed value may be off what the balls say by this many half widths of their interval, and by this share: users round.
const MAX_HALF_WIDTHS: f64 = 2.0;
const MAX_TYPED_SHARE: f64 = 0.01;

impl<T> Known<T> {
    pub(super) fn new(value: T, source: Source) -> Self {
        Self { value, interval: None, source, pixels: None, measured: None }
    }

    pub(super) fn from_file(value: T) -> Self {
        Self::new(value, Source::File)
    }
}

impl<T: Copy> Known<T> {
    /// The file's value, with what the balls say or said of it.
    fn beside(mut self, balls: Option<&Self>) -> Self {
        self.measured = balls.and_then(|balls| match (balls.source, balls.interval) {
            (Source::File, _) => balls.measured.clone(),
            (_, interval) => Some(Measured { value: balls.value, interval: interval? }),
        });
        self
    }
}

impl Known<f64> {
    pub(super) fn by_definition() -> Self {
        Self { interval: Some([1.0; 2]), ..Self::new(1.0, Source::Definition) }
    }

    pub(super) fn measured(estimate: Estimate, source: Source, pixels: Option<BallPixels>) -> Self {
        let interval = [estimate.interval.low, estimate.interval.high];
        Self { interval: Some(interval), pixels, ..Self::new(estimate.value, source) }
    }

    /// What the balls say instead, where this was typed and is farther off than both can be right.
    pub(super) fn contradicted(&self) -> Option<Contradicted> {
        let Measured { value, interval: [low, high] } = *self.measured.as_ref()?;
        let measured = Estimate { value, interval: firstbounce_core::interval::Interval { low, high } };
        let share = (self.value / value - 1.0).abs();
        let allowed = (MAX_HALF_WIDTHS * measured.relative_half_width()).max(MAX_TYPED_SHARE);
        (share > allowed).then_some(Contradicted { measured, share })
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

/// Which value wins where a capture file gives one and a ball gives another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preference {
    /// The file's: what the user typed or accepted. Balls are measured for what the file leaves out.
    File,
    /// The balls': to see, or to write, what they say.
    Balls,
    /// The balls', but for directions that a light file put into the set.
    BallsUnderGivenLights,
}

/// Calibrates a set from its file and its balls. Missing balls leave their values open, and so does a ball whose circle is
/// not found where its values come from elsewhere; any other ball that is there and cannot be used is an error.
pub fn calibrate(
    set: &CaptureSet,
    preference: Preference,
    watch: &dyn PipelineWatch,
) -> Result<Calibrated, PipelineError> {
    calibrate_with(set, preference, &PhotoStore::default(), watch)
}

/// The same with photos that are kept.
pub fn calibrate_with(
    set: &CaptureSet,
    preference: Preference,
    store: &PhotoStore,
    watch: &dyn PipelineWatch,
) -> Result<Calibrated, PipelineError> {
    let typed = set.camera.crosstalk.as_ref();
    let (set, crosstalk) = with_crosstalk(set, preference, store, watch)?;
    let photos = BallPhotos::load(&set, preference, store, watch)?;
    watch.progress(Stage::Calibrate, 0.5);
    let mut calibrated = measure::Measuring::new(&set, preference, &photos)?.run()?;
    let of_typed = typed.map_or_else(Vec::new, |typed| warning::typed_crosstalk(&set, typed, &crosstalk));
    calibrated.warnings.extend(of_typed.iter().map(ToString::to_string));
    calibrated.crosstalk = crosstalk;
    let coarse = depth::coarse_balls(&set, photos.by_subject(), store, watch)?;
    calibrated.warnings.extend(coarse.iter().map(ToString::to_string));
    Ok(calibrated)
}

/// As [`calibrate_with`]; beta that no ball and no file gives is measured on the object where that is possible.
pub fn calibrate_also_on_object(
    set: &CaptureSet,
    preference: Preference,
    store: &PhotoStore,
    watch: &dyn PipelineWatch,
) -> Result<Calibrated, PipelineError> {
    let mut calibrated = calibrate_with(set, preference, store, watch)?;
    if calibrated.beta.is_none() && calibrated.alpha.iter().all(Option::is_some) {
        // Balls are of use without an object too.
        let mut set = set.clone();
        set.camera.crosstalk = calibrated.crosstalk_rows();
        match load_object(&set, store, watch) {
            Ok(object) => add_beta_of_object(&set, &object, &mut calibrated, &SolveOptions::of(&set), watch)?,
            Err(PipelineError::Cancelled) => return Err(PipelineError::Cancelled),
            Err(error) => calibrated.warnings.push(format!("beta is not known: no ball of the paint, and {error}")),
        }
    }
    Ok(calibrated)
}

/// Calibrates a set to be solved as `options` say, and makes sure that its colours can tell the bounces apart. A beta that no ball
/// and no file gives is measured on the object.
pub fn calibrate_for(
    set: &CaptureSet,
    object: &ObjectPhotos,
    options: &SolveOptions,
    store: &PhotoStore,
    watch: &dyn PipelineWatch,
) -> Result<Calibrated, PipelineError> {
    let mut calibrated = calibrate_with(set, Preference::File, store, watch)?;
    if !options.method.needs().all_colours && set.colours.len() > 1 {
        // The other colours are there for their share in the reference colour's channel alone.
        return Ok(calibrated);
    }
    add_beta_of_object(set, object, &mut calibrated, options, watch)?;
    let beta = calibrated.beta_values()?;
    if options.calibrated_bounces_of(set) > 1
        && let Some(problem) = set.check_beta_distances(&beta).into_iter().next()
    {
        return Err(PipelineError::Beta(problem));
    }
    Ok(calibrated)
}
