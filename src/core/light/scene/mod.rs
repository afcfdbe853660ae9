//! A virtual lab: a surface of one paint under lamps, seen by a camera, each bounce of light apart.
//!
//! `Shape` or any `Mesh` becomes `radiosity::Patches`, whose form factors serve every lamp, albedo and camera; `render`
//! puts lamps and camera to them.

mod anchor;
mod framing;
mod gather;
mod lamp;
mod linear;
mod refine;
mod render;
mod shape;

use thiserror::Error;

use crate::Camera;
use crate::light::radiosity::RadiosityError;
use crate::options::OptionError;

pub use framing::{Lens, directions_on_ring, framed, framed_through, mean_height_seen, seen_from_behind};
pub use lamp::{Lamp, irradiances};
pub(crate) use linear::{Linear, linear_over_patches};
pub use refine::refined;
pub use render::{LitPlanes, RenderOptions, RenderReport, Rendering, render, seen_at};
pub use shape::Shape;

/// Why the scene could not be lit or seen.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SceneError {
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// A mesh that shows nothing from the front.
    #[error("the surface has no width and height seen along z; turn it so that it faces +z")]
    NothingToSee,
    /// Darkness.
    #[error("the scene has no lamp; add one")]
    NoLamp,
    /// A camera that sees nothing.
    #[error("the camera has a size or length that is not positive: {camera:?}")]
    BadCamera {
        /// The camera.
        camera: Camera,
    },
    /// The light could not be bounced.
    #[error(transparent)]
    Radiosity(RadiosityError),
    /// The watcher asked to stop.
    #[error("cancelled")]
    Cancelled,
}

impl From<RadiosityError> for SceneError {
    fn from(error: RadiosityError) -> Self {
        match error {
            RadiosityError::Cancelled => Self::Cancelled,
            other => Self::Radiosity(other),
        }
    }
}

#[cfg(test)]
mod tests;
