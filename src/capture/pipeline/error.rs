//! Why a run of the pipeline stopped.

use std::path::PathBuf;
use std::sync::Arc;

use firstbounce_core::calibrate::CalibrateError;
use firstbounce_core::denoise::DenoiseError;
use firstbounce_core::image::mixing::MixingError;
use firstbounce_core::mesh::MeshError;
use firstbounce_core::mesh::decimate::DecimateError;
use firstbounce_core::methods::by_shape::ByShapeError;
use firstbounce_core::methods::colours_and_shape::ColoursAndShapeError;
use firstbounce_core::options::OptionError;
use firstbounce_core::separate::SeparateError;
use firstbounce_core::sphere::BallError;
use firstbounce_core::stereo::depth::DepthError;
use firstbounce_core::stereo::normals::NormalsError;
use firstbounce_core::stereo::shape::ShapeError;
use thiserror::Error;

use super::MemoryShortage;
use crate::atomic::WriteError;
use crate::image_file::ImageError;
use crate::mesh_file::MeshFileError;
use crate::set::{Problem, SetError, SphereKind, Subject};

/// Why a run of the pipeline stopped, in one line that says what to do.
#[derive(Debug, Error)]
pub enum PipelineError {
    /// The capture set file.
    #[error(transparent)]
    Set(#[from] SetError),
    /// A picture.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// A photo, which several shots may be of.
    #[error(transparent)]
    Photo(Arc<ImageError>),
    /// A mesh.
    #[error(transparent)]
    Mesh(#[from] MeshFileError),
    /// Output.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Memory.
    #[error("{0}: close other programs or crop the photos")]
    Memory(#[from] MemoryShortage),
    /// The set has no light.
    #[error("the set has no light: add a [[light]] and its shots to capture.toml")]
    NoLights,
    /// The object was not photographed under a light in a colour.
    #[error("light \"{light}\" has no \"{colour}\" object shot: add it, or remove the light or the colour")]
    NoShot {
        /// The light.
        light: String,
        /// The colour.
        colour: String,
    },
    /// A photo of another size than the first of its subject.
    #[error("{}: {} x {} pixels, the others {} x {}: all photos of a subject must have one size", path.display(), found.0, found.1, expected.0, expected.1)]
    PhotoSize {
        /// The file.
        path: PathBuf,
        /// Its width and height in pixels.
        found: (usize, usize),
        /// Those of the first photo.
        expected: (usize, usize),
    },
    /// A mask of another size than the photos.
    #[error("{}: {} x {} pixels, the photos {} x {}: paint the mask over one of the photos", path.display(), found.0, found.1, expected.0, expected.1)]
    MaskSize {
        /// The file.
        path: PathBuf,
        /// Its width and height in pixels.
        found: (usize, usize),
        /// Those of the photos.
        expected: (usize, usize),
    },
    /// The capture checks were asked for something impossible.
    #[error("cannot check the captures: {0}")]
    CheckOption(OptionError),
    /// No pixel belongs to the object.
    #[error("{}", match path {
        Some(path) => format!("{}: the mask is empty: paint the object white", path.display()),
        None => "no pixel is brighter than the rest: give a mask in capture.toml".into(),
    })]
    EmptyMask {
        /// The mask's file, if there is one.
        path: Option<PathBuf>,
    },
    /// A ball that was not found.
    #[error("{subject}: {reason} (calibrate --circle, or Calibrate in the window)")]
    Ball {
        /// In which shots.
        subject: Subject,
        /// Why.
        reason: BallError,
    },
    /// A ball that cannot be used.
    #[error("light {light}, {ball} ball: {reason}")]
    Calibrate {
        /// Under which light.
        light: String,
        /// Which ball.
        ball: SphereKind,
        /// Why.
        reason: CalibrateError,
    },
    /// A ball that the set does not show.
    #[error("the set has no {ball} ball: add its shots")]
    NoBall {
        /// Which.
        ball: SphereKind,
    },
    /// Crosstalk between channels.
    #[error("crosstalk: {0}")]
    Crosstalk(MixingError),
    /// Nothing tells a light's alpha.
    #[error(
        "nothing tells alpha of light \"{light}\": photograph a grey ball under it in every colour, or type [calibration.alpha]"
    )]
    NoAlpha {
        /// The light.
        light: String,
    },
    /// Nothing tells beta.
    #[error(
        "nothing tells beta: photograph a ball of the object's paint in every colour, or type beta under [calibration]"
    )]
    NoBeta,
    /// Colours that cannot tell bounces apart.
    #[error("{0}")]
    Beta(Problem),
    /// Nothing tells where a lamp is.
    #[error(
        "nothing tells the direction of light \"{light}\": photograph a mirror or grey ball under it, or type its direction"
    )]
    NoDirection {
        /// The light.
        light: String,
    },
    /// Separation.
    #[error("cannot separate: {0}")]
    Separate(SeparateError),
    /// The noise of the indirect light.
    #[error("cannot denoise the direct light: {0}")]
    Denoise(DenoiseError),
    /// Photometric stereo.
    #[error("no normals: {0}")]
    Normals(NormalsError),
    /// Integration.
    #[error("no depth: {0}")]
    Depth(DepthError),
    /// Shape recovery was asked for something impossible.
    #[error("no shape: {0}")]
    Shape(ShapeError),
    /// Nayar's method without a scale for the albedo.
    #[error(
        "Nayar's method needs the paint's absolute albedo, and nothing scales it: photograph a grey ball and type its \
         albedo as grey_albedo under [calibration], or type white_light there"
    )]
    NoWhiteLight,
    /// A method that starts from a surface was given none.
    #[error(
        "this method starts from the surface that the photos show before separation, and there is none: recover it first"
    )]
    NoSurfaceBefore,
    /// A grey ball of unknown albedo.
    #[error(
        "Nayar's method needs the paint's absolute albedo: type the grey ball's albedo (0 to 1, as its maker states it) as \
         grey_albedo under [calibration], or give --grey-albedo"
    )]
    NoGreyAlbedo,
    /// An albedo or a light of white that cannot be.
    #[error("{what} is {value}; it must be {expected}")]
    Scale {
        /// Which of the two.
        what: &'static str,
        /// What was given.
        value: f64,
        /// What it may be.
        expected: &'static str,
    },
    /// Nayar's method.
    #[error("Nayar's method: {0}")]
    Nayar(ByShapeError),
    /// Colours and shape together failed.
    #[error(transparent)]
    ColoursAndShape(ColoursAndShapeError),
    /// Triangles.
    #[error("no mesh: {0}")]
    Triangles(#[from] MeshError),
    /// Fewer triangles.
    #[error("cannot decimate: {0}")]
    Decimate(DecimateError),
    /// A set without truth.
    #[error("{}: no true {what} to compare with; this set was photographed, not rendered, or its truth is elsewhere: see [truth]", path.display())]
    NoTruth {
        /// "normals" or "depth".
        what: &'static str,
        /// Where they were looked for.
        path: PathBuf,
    },
    /// True normals or depth of a strange form.
    #[error("{}: expected an EXR of three channels for normals, one for depth and bounces", path.display())]
    TruthChannels {
        /// The file.
        path: PathBuf,
    },
    /// No pixel has both a result and a truth.
    #[error("no pixel has both a true normal and a normal from every method: check the mask and the truth")]
    NothingToCompare,
    /// A report that cannot be written down.
    #[error("the report could not be written as JSON: {0}")]
    Json(serde_json::Error),
    /// Somebody cancelled.
    #[error("cancelled; nothing was written")]
    Cancelled,
}

impl PipelineError {
    /// A ball under a light that cannot be used.
    pub(super) fn calibrate(light: &str, ball: SphereKind, reason: CalibrateError) -> Self {
        Self::Calibrate { light: light.to_owned(), ball, reason }
    }
}

impl From<SeparateError> for PipelineError {
    fn from(error: SeparateError) -> Self {
        match error {
            SeparateError::Cancelled => Self::Cancelled,
            error => Self::Separate(error),
        }
    }
}

impl From<DenoiseError> for PipelineError {
    fn from(error: DenoiseError) -> Self {
        match error {
            DenoiseError::Cancelled => Self::Cancelled,
            error => Self::Denoise(error),
        }
    }
}

impl From<DecimateError> for PipelineError {
    fn from(error: DecimateError) -> Self {
        match error {
            DecimateError::Cancelled => Self::Cancelled,
            error => Self::Decimate(error),
        }
    }
}

impl From<ByShapeError> for PipelineError {
    fn from(error: ByShapeError) -> Self {
        match error {
            ByShapeError::Cancelled => Self::Cancelled,
            ByShapeError::Shape(error) => error.into(),
            error => Self::Nayar(error),
        }
    }
}

impl From<ShapeError> for PipelineError {
    fn from(error: ShapeError) -> Self {
        match error {
            error if error.is_cancelled() => Self::Cancelled,
            ShapeError::Normals(error) => Self::Normals(error),
            ShapeError::Depth(error) => Self::Depth(error),
            error => Self::Shape(error),
        }
    }
}
