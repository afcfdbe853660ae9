//! Balls to alpha, beta, intensity and direction; what the capture file gives can win over what is measured.

mod balls;
mod calibrated;
mod depth;
mod direction;
mod doubt;
mod known;
mod measure;
mod position;
mod scale;
mod unknown_crosstalk;
mod verdict;
mod warning;

use balls::BallPhotos;

use super::crosstalk::{KnownCrosstalk, with_crosstalk};
use super::methods::add_beta_of_object;
use super::{ObjectPhotos, PhotoStore, PipelineError, PipelineWatch, SolveOptions, Stage, load_object};
use crate::set::CaptureSet;

pub use balls::circle_of;
pub(in crate::pipeline) use balls::{needed_subjects, view};
pub use calibrated::{BallCircle, BallNotFound, Calibrated, RatioEvidence};
pub use doubt::{CircleDoubt, DirectionDoubt};
use known::MAX_HALF_WIDTHS;
pub use known::{Known, Measured, Source};
pub use scale::ScaleSource;
pub use verdict::{Evidence, Verdict};

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
