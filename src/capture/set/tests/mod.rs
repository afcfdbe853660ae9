//! The capture set file as its authors meet it: what is read, what is refused and where, what a save keeps.

mod format_page;
mod names;
mod random;
mod refusals;
mod shared_sets;
mod subjects;
mod texts;

use std::path::Path;

use super::CaptureSet;

/// Two colours, two lights, every subject, every part and comments in most places that allow one.
const FULL: &str = include_str!("full.toml");

fn parse(text: &str) -> CaptureSet {
    CaptureSet::parse(text, Path::new("set/capture.toml")).unwrap_or_else(|error| panic!("{error}\n{text}"))
}
