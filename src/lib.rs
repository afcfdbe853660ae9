//! The program: its command line, its window and the graphics behind it.

pub mod app;
pub mod cli;
pub mod demo;
pub mod gpu;
