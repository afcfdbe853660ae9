//! The window: a document, results computed from it, and panels and views that show both.
//!
//! The floors, each of which imports only from those below it: [`window`] (with its commands), [`panels`], [`views`], [`state`].
//! Beside them are `widgets`, which know nothing of a set, and [`base`]: jobs and dialogs. [`state::session::Session`] is the
//! open set; [`window::Window`] is the window around it.

pub mod base;
mod launch;
pub mod panels;
pub mod state;
pub mod views;
mod widgets;
pub mod window;

pub use launch::{Start, has_display, run};
