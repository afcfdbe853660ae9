//! The command line on real files.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

mod bad_input;
mod calibrate;
mod compare;
mod export;
mod format_page;
mod lab;
mod nayar;
mod no_window;
mod run;
mod shared_sets;
mod solve;
mod tiny_set;
