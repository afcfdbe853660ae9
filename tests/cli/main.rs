//! The command line on real files.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

mod bad_input;
mod calibrate;
#[path = "../../src/capture/tests/files/codecs.rs"]
mod codecs;
mod compare;
mod damaged_pictures;
mod export;
mod format_page;
#[cfg(unix)]
mod hostile;
mod huge_png;
mod killed;
mod lab;
mod memory;
mod nayar;
mod no_window;
mod numbers;
mod object_beta;
#[cfg(unix)]
mod readers;
mod run;
mod shared_sets;
#[cfg(unix)]
mod signals;
mod solve;
mod solve_many;
mod tiny_set;
mod watch;
