//! The whole window, by its accessible names. No test here draws, so none needs a graphics adapter; only the screenshots,
//! which are made on request, do.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

mod captures;
mod disk;
mod edits;
mod harness;
mod inspector;
mod keyboard;
mod results;
mod rig;
mod screenshots;
mod separate;
mod start;
mod surface;
