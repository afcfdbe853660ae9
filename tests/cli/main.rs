//! The command line on real files.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

mod bad_input;
mod calibrate;
#[path = "../../src/capture/tests/pictures/codecs.rs"]
mod codecs;
mod damaged_pictures;
mod export;
#[cfg(unix)]
mod hostile;
mod huge_png;
mod killed;
mod lab;
mod memory;
mod nayar;
mod numbers;
#[cfg(unix)]
mod readers;
mod run;
mod shared_sets;
#[cfg(unix)]
mod signals;
mod solve;
mod tiny_set;
