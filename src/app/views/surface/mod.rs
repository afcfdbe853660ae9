//! The surface in 3D: before, after and a reference as layers, an eye to walk around them, and tools that measure on them.

mod canvas;
mod layers;
mod look;
mod menus;
mod navigation;
mod overlay;
mod pairs;
mod pane;
mod prepared;
mod profile;
mod scene;
mod session;
mod tool;

pub use layers::Surfaces;
pub use look::{LayerColours, LayerLook, LayerName, Shade, SurfaceLook};
pub use menus::{eye_menu, toolbar};
pub use pane::ui;
pub use prepared::{Prepared, Source, thousands};
pub use tool::{Cut, Picked, Tool, ViewState};
