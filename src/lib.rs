//! The program: its window and the graphics behind it.

pub mod app;
pub mod gpu;
