//! The real window on a virtual display, spoken to as a screen reader does: over AT-SPI, by accessible names. Where the
//! display server or the accessibility bus is missing each test reports itself skipped by name.

#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

mod desktop;
mod device;
mod idle;
mod large;
mod screen_reader;
