//! Pictures on the graphics card: planes as textures, and the shader that turns them into colours.
//!
//! A [`Source`] says which numbers are shown, a [`Display`] how they become colours, a [`Placement`] where on the
//! target. [`CanvasGpu`] draws them with the shader `canvas.wgsl`; [`Twin`] computes the same in plain Rust.

mod callback;
mod card;
mod colour;
mod difference;
mod display;
mod drawing;
pub mod mesh;
mod pyramid;
mod shader;
mod source;
mod textures;
mod transfer;
mod twin;
mod uniforms;
mod values;

pub use callback::{CanvasCallback, CanvasStatus, install};
pub use card::{Bound, CanvasGpu};
pub use colour::{colour_of_value, shade};
pub use difference::{Difference, DifferenceError, difference};
pub use display::{ColourMap, Display, Encoding, Tint};
pub use drawing::{Drawing, Placement, Sampling};
pub use shader::Output;
pub use source::{CanvasMarks, CanvasPlane, Kind, Layer, MAX_PLANES, PlaneKey, Source, SourceError};
pub use textures::Resolution;
pub use transfer::Wake;
pub use twin::Twin;
