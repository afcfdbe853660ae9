//! The surface in 3D: before, after and a reference as layers, an eye to walk around them, and tools that measure on them.

mod canvas;
mod lamp;
mod menus;
mod navigation;
mod overlay;
mod pairs;
mod pane;
mod profile;
mod scene;
mod tool;

pub use menus::{eye_menu, look_from, toolbar};
pub use pane::ui;
pub use tool::{Cut, Picked, Tool, ViewState};
