//! The lab: photos of rendered scenes by a camera that errs, balls whose pictures are known in closed form, a planner that
//! predicts the errors of a rig, and the experiments of Liao, Huang and Yang, CVPR 2011, on synthetic scenes.

mod balls;
mod crosstalk;
mod direct;
mod paper;
mod plan;
mod sensor;
pub mod simulate;

use thiserror::Error;

use firstbounce_core::denoise::DenoiseError;
use firstbounce_core::light::radiosity::RadiosityError;
use firstbounce_core::light::scene::SceneError;
use firstbounce_core::methods::colours_and_shape::ColoursAndShapeError;
use firstbounce_core::options::OptionError;
use firstbounce_core::separate::SeparateError;
use firstbounce_core::stereo::normals::NormalsError;

pub use balls::{BallPicture, LampSpot};
pub use crosstalk::Crosstalk;
pub use paper::{
    AllBouncesPoint, ColoursAndShapeErrors, Figure3Point, MADE_FOR_ALL_BOUNCES, PUBLISHED, Paper, PaperErrors,
    PaperOptions, PaperRecord, PaperRowRecord, PublishedRecord, TableRow, paper, paper_html,
};
pub use plan::{Plan, PlanMethod, PlanOptions, PlanPoint, plan};
pub use sensor::Sensor;

/// Why the lab could not do what was asked.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum LabError {
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// A matrix that does not fit the colours.
    #[error("the crosstalk matrix is {rows} x {columns} for {colours} colours; give one row and one column a colour")]
    CrosstalkShape {
        /// Rows of the matrix.
        rows: usize,
        /// Columns of the matrix.
        columns: usize,
        /// Colours there are.
        colours: usize,
    },
    /// Photos without a pixel to judge by.
    #[error(
        "at this exposure no pixel that three lamps light keeps enough colours that do not clip; lower the exposure"
    )]
    Overexposed,
    /// The scene could not be lit or seen.
    #[error(transparent)]
    Scene(SceneError),
    /// An experiment's separation.
    #[error("cannot separate: {0}")]
    Separate(SeparateError),
    /// An experiment's photometric stereo.
    #[error("no normals: {0}")]
    Normals(NormalsError),
    /// An experiment's denoised direct light.
    #[error("cannot denoise the direct light: {0}")]
    Denoise(DenoiseError),
    /// The watcher asked to stop.
    #[error("cancelled")]
    Cancelled,
}

impl From<SceneError> for LabError {
    fn from(error: SceneError) -> Self {
        match error {
            SceneError::Cancelled => Self::Cancelled,
            other => Self::Scene(other),
        }
    }
}

impl From<RadiosityError> for LabError {
    fn from(error: RadiosityError) -> Self {
        SceneError::from(error).into()
    }
}

impl From<SeparateError> for LabError {
    fn from(error: SeparateError) -> Self {
        match error {
            SeparateError::Cancelled => Self::Cancelled,
            other => Self::Separate(other),
        }
    }
}

impl From<ColoursAndShapeError> for LabError {
    fn from(error: ColoursAndShapeError) -> Self {
        match error {
            ColoursAndShapeError::Cancelled => Self::Cancelled,
            ColoursAndShapeError::Photos(error) => error.into(),
            ColoursAndShapeError::Option(error) => error.into(),
        }
    }
}

impl From<DenoiseError> for LabError {
    fn from(error: DenoiseError) -> Self {
        match error {
            DenoiseError::Cancelled => Self::Cancelled,
            DenoiseError::Separate(error) => error.into(),
            other => Self::Denoise(other),
        }
    }
}

impl From<NormalsError> for LabError {
    fn from(error: NormalsError) -> Self {
        match error {
            NormalsError::Cancelled => Self::Cancelled,
            other => Self::Normals(other),
        }
    }
}

#[cfg(test)]
mod tests;
