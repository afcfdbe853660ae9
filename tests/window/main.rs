//! The whole window, by its accessible names. No test here draws, so none needs a graphics adapter; only the screenshots,
//! which are made on request, do.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

mod around;
mod captures;
mod design;
mod disk;
mod edits;
mod files;
mod harness;
mod hostile;
#[path = "../cli/huge_png.rs"]
mod huge_png;
mod inspector;
mod intake;
mod keyboard;
mod methods;
mod nayar;
mod numbers;
mod results;
mod rig;
mod screenshots;
mod separate;
mod simulate;
mod start;
mod surface;
mod views;
mod whole;
