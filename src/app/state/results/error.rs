//! The error of a stage.

use std::sync::Arc;

use firstbounce_capture::pipeline::{Method, PipelineError};
use firstbounce_capture::set::Problem;
use thiserror::Error;

use super::Step;
use crate::app::base::jobs::JobError;

/// Why a stage has no result, in one line that says what to do.
#[derive(Clone, Debug, Error)]
pub enum StageError {
    /// The set is empty.
    #[error("no photos yet: add them in Captures")]
    NoPhotos,
    /// The set contradicts itself.
    #[error("{0}")]
    Set(Problem),
    /// A shot without a file.
    #[error("this shot has no file")]
    NoFile,
    /// The pipeline failed.
    #[error("{}", .0.to_string().replace('\n', " "))]
    Pipeline(Arc<PipelineError>),
    /// The stage before failed.
    #[error("{step} failed: {reason}")]
    Before {
        /// Which one.
        step: Step,
        /// Why.
        reason: Box<StageError>,
    },
    /// beta is unknown.
    #[error("beta is unknown: photograph a ball of the object's paint in every colour, or type it in Calibrate")]
    NoBeta,
    /// alpha of a light is unknown.
    #[error(
        "alpha of light \"{light}\" is unknown: photograph a grey ball under it in every colour, or type it in Calibrate"
    )]
    NoAlpha {
        /// The light.
        light: String,
    },
    /// A light that is not in the set.
    #[error("there is no light \"{light}\"")]
    NoLight {
        /// Its name.
        light: String,
    },
    /// The photos are not there yet.
    #[error("the photos are being read")]
    Reading,
    /// A pixel without photos.
    #[error("the pixel lies outside the object's photos")]
    Outside,
    /// A method that nothing asked for.
    #[error("tick \"Also solve by {}\" in the Shape step", .method.title())]
    NotAsked {
        /// Which one.
        method: Method,
    },
    /// What makes albedos absolute is missing; where it is typed in this window.
    #[error(
        "Nayar's method needs the paint's absolute albedo: type the grey ball's albedo, as its maker states it, in Separate or Shape"
    )]
    NoGreyAlbedo,
    /// A method that is compared with itself.
    #[error("{} is the method in force: its results are those after separation", .method.title())]
    InForce {
        /// Which one.
        method: Method,
    },
    /// A stage before is on its way.
    #[error("the step before is not done yet")]
    TooEarly,
    /// The user cancelled.
    #[error("cancelled; \"Retry\" (F9) starts it again")]
    Cancelled,
    /// The job ended without a word.
    #[error("{0}")]
    Lost(JobError),
}

impl From<PipelineError> for StageError {
    fn from(error: PipelineError) -> Self {
        match error {
            PipelineError::NoGreyAlbedo => Self::NoGreyAlbedo,
            error => Self::Pipeline(Arc::new(error)),
        }
    }
}
