//! The command line on real files.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

mod bad_input;
mod calibrate;
#[path = "../../src/capture/tests/pictures/codecs.rs"]
mod codecs;
mod damaged_pictures;
mod export;
mod lab;
mod nayar;
mod run;
mod shared_sets;
mod solve;
mod tiny_set;
