//! The window: a document, results computed from it, and panels and views that show both.
//!
//! [`session::Session`] holds everything that panels and views may reach; [`window::Window`] is the window around it.

mod bars;
pub mod canvas;
pub mod commands;
mod device;
pub mod dialogs;
pub mod document;
pub mod jobs;
mod launch;
pub mod log;
mod name_field;
mod number_field;
pub mod panels;
pub mod path_field;
mod plate;
pub mod preferences;
pub mod reference;
pub mod results;
pub mod session;
pub mod simulate;
mod start;
pub mod surface;
pub mod theme;
pub mod views;
pub mod window;

pub use launch::{Start, has_display, run};
