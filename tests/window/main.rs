//! The whole window, by its accessible names. No test here draws, so none needs a graphics adapter.

mod captures;
mod disk;
mod edits;
mod harness;
mod keyboard;
mod results;
mod rig;
mod start;
