//! The views in the centre: tiles that show any plane of the pipeline, or surfaces in 3D.

pub mod canvas;
mod canvases;
mod overlay;
mod pane;
mod picker;
mod picture;
mod preview;
mod saving;
mod scale;
mod statistics;
mod strip;
pub mod surface;
mod tiles;

pub use canvases::Canvases;
pub use overlay::{Over, Overlay};
pub use picker::ui as picker;
pub use picture::{Picture, PictureError, layer, picture};
pub use tiles::ui;
