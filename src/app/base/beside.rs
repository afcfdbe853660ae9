//! Files that are written beside others, none of which they replace.

use std::path::{Path, PathBuf};

use firstbounce_capture::atomic::{WriteError, write_new_file};

/// Files of one name that are tried.
const MAX_FILES: usize = 1000;

/// Writes `STEM.png` into the folder; where there is anything of that name, be it a link that leads nowhere, the next number is
/// taken.
///
/// # Errors
/// Where the system refuses, and where no number is free.
pub fn write_png(folder: &Path, stem: &str, png: &[u8]) -> Result<PathBuf, WriteError> {
    let first = folder.join(format!("{stem}.png"));
    let numbered = (2..=MAX_FILES).map(|number| folder.join(format!("{stem}-{number}.png")));
    for path in std::iter::once(first.clone()).chain(numbered) {
        if write_new_file(&path, png)? {
            return Ok(path);
        }
    }
    Err(WriteError::NoFreeName { path: first, others: MAX_FILES - 1 })
}
