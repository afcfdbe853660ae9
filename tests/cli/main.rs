//! The command line on real files.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

mod bad_input;
mod calibrate;
mod export;
#[cfg(unix)]
mod hostile;
mod killed;
mod lab;
mod nayar;
mod numbers;
mod run;
mod shared_sets;
mod solve;
mod tiny_set;
