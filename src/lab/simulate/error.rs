//! The errors of a simulation.

use std::path::PathBuf;

use crate::LabError;
use firstbounce_core::light::radiosity::RadiosityError;
use firstbounce_core::light::scene::SceneError;
use firstbounce_core::options::OptionError;
use thiserror::Error;

use firstbounce_capture::atomic::WriteError;
use firstbounce_capture::image_file::ImageError;
use firstbounce_capture::set::Problem;

/// Why nothing was simulated, in one line that says what to do.
#[derive(Debug, Error)]
pub enum SimulateError {
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// An albedo no paint has.
    #[error("albedo {albedo} is not between 0 and 1; no paint reflects that much")]
    BadAlbedo {
        /// The albedo.
        albedo: f64,
    },
    /// Lists that do not go together.
    #[error("{found} {what} for {expected} albedos; give one for each colour")]
    Count {
        /// What was counted.
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many albedos there are.
        expected: usize,
    },
    /// A lamp at the origin, or beyond all places.
    #[error("{light} stands nowhere: give {expected}")]
    LampPlace {
        /// The light.
        light: String,
        /// What its place or direction must be.
        expected: String,
    },
    /// A lamp that shines on the back of things.
    #[error(
        "{light} is behind the object ({elevation_deg:.0} degrees above its plane); its z must be positive, toward the camera"
    )]
    LampBehind {
        /// The light.
        light: String,
        /// Its height over the plane z = 0 as an angle.
        elevation_deg: f64,
    },
    /// A value of a lamp out of its range.
    #[error("{light}: {what} is {value:?}; give a number from {low:?} to {high:?}")]
    LampValue {
        /// The light.
        light: String,
        /// Which value.
        what: &'static str,
        /// Its value.
        value: f64,
        /// The smallest that it may be.
        low: f64,
        /// The largest.
        high: f64,
    },
    /// alpha counts by the reference colour.
    #[error("{light}: the first alpha is {value}; it is that of the reference colour and must be 1")]
    ReferenceAlpha {
        /// The light.
        light: String,
        /// What was given.
        value: f64,
    },
    /// A lamp that lights nothing that the camera sees.
    #[error("{light} lights nothing that the camera sees: move it toward the camera's side")]
    LampLightsNothing {
        /// The light.
        light: String,
    },
    /// A mesh with more triangles than can exchange light.
    #[error("{name} has {triangles} triangles; light goes from each to each, so give a mesh of at most {most}")]
    TooManyTriangles {
        /// The scene.
        name: String,
        /// How many triangles it has.
        triangles: usize,
        /// How many it may have.
        most: usize,
    },
    /// Faces that turn away from the camera.
    #[error(
        "{name}: the camera sees {percent:.0} % of the surface from behind; its faces are turned the wrong way round: \
         flip them, or turn the object"
    )]
    InsideOut {
        /// The scene.
        name: String,
        /// How much of what is visible.
        percent: f64,
    },
    /// The lab.
    #[error(transparent)]
    Lab(LabError),
    /// The capture set would break its own rules.
    #[error("{0}")]
    Set(Problem),
    /// A picture.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// Output.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// A folder that holds something else.
    #[error("{} holds {found}, which is no part of this simulated set; name a new or empty folder", folder.display())]
    ForeignFiles {
        /// The folder.
        folder: PathBuf,
        /// One of its files.
        found: String,
    },
    /// The watch cancelled.
    #[error("cancelled; nothing was written")]
    Cancelled,
}

impl From<LabError> for SimulateError {
    fn from(error: LabError) -> Self {
        match error {
            LabError::Cancelled => Self::Cancelled,
            other => Self::Lab(other),
        }
    }
}

impl From<SceneError> for SimulateError {
    fn from(error: SceneError) -> Self {
        LabError::from(error).into()
    }
}

impl From<RadiosityError> for SimulateError {
    fn from(error: RadiosityError) -> Self {
        LabError::from(error).into()
    }
}
