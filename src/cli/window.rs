//! The window as commands reach it; a build without the feature `window` refuses in one line.

use std::path::PathBuf;

/// Opens the window on a capture set, or on the set of the last run, and returns when it is closed.
#[cfg(feature = "window")]
pub fn open(set: Option<PathBuf>) -> anyhow::Result<()> {
    use crate::app::{Start, run};
    run(set.map_or(Start::Nothing, Start::Set))
}

/// The same on what comes out of the set.
#[cfg(feature = "window")]
pub fn show_result(set: PathBuf) -> anyhow::Result<()> {
    use crate::app::{Start, run};
    run(Start::Result(set))
}

/// Refuses, as [`open`].
#[cfg(not(feature = "window"))]
pub fn show_result(_: PathBuf) -> anyhow::Result<()> {
    open(None)
}

/// Refuses: there is no window to open.
#[cfg(not(feature = "window"))]
pub fn open(_: Option<PathBuf>) -> anyhow::Result<()> {
    anyhow::bail!(
        "this build has no window; \"firstbounce solve SET\" works without one, and \"cargo build --release\" with its \
         default features makes one"
    )
}

/// Whether this build has a window, and a display to open it on.
#[cfg(feature = "window")]
pub use crate::app::has_display as can_open;

/// Whether this build has a window: it does not.
#[cfg(not(feature = "window"))]
pub fn can_open() -> bool {
    false
}
