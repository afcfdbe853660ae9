//! Why a run of the pipeline stopped.

use std::path::PathBuf;

use firstbounce_core::normals::NormalsError;
use firstbounce_core::separate::SeparateError;
use thiserror::Error;

use crate::atomic::WriteError;
use crate::image_file::ImageError;
use crate::mesh_file::MeshFileError;
use crate::set::SetError;

/// Why a run of the pipeline stopped, in one line that says what to do.
#[derive(Debug, Error)]
pub enum PipelineError {
    /// The capture set file.
    #[error(transparent)]
    Set(#[from] SetError),
    /// A picture.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// A mesh.
    #[error(transparent)]
    Mesh(#[from] MeshFileError),
    /// Output.
    #[error(transparent)]
    Write(#[from] WriteError),
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
    /// No pixel belongs to the object.
    #[error("{}", match path {
        Some(path) => format!("{}: the mask is empty: paint the object white", path.display()),
        None => "no pixel is brighter than the rest: give a mask in capture.toml".into(),
    })]
    EmptyMask {
        /// The mask's file, if there is one.
        path: Option<PathBuf>,
    },
    /// Separation.
    #[error("cannot separate: {0}")]
    Separate(#[from] SeparateError),
    /// Photometric stereo.
    #[error("no normals: {0}")]
    Normals(#[from] NormalsError),
    /// Somebody cancelled.
    #[error("cancelled; nothing was written")]
    Cancelled,
}
