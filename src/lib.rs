//! The program: its command line, and with the feature `window` (a default) its window and the graphics behind it.

#[cfg(feature = "window")]
pub mod app;
pub mod cli;
pub mod demo;
#[cfg(feature = "window")]
pub mod gpu;
