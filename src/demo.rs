//! The demo: a rendered capture set that the program carries within itself.

use std::path::Path;

use firstbounce_capture::OutputFolder;
use firstbounce_capture::atomic::WriteError;
use include_dir::{Dir, include_dir};

static DEMO: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/assets/demo");

/// Puts the demo set into `folder`, where the user can look at it and change it: what is there already stays. Returns the
/// folder.
pub fn unpack(folder: &Path) -> Result<&Path, WriteError> {
    let output = OutputFolder::stage(folder)?;
    let mut pending = vec![&DEMO];
    while let Some(dir) = pending.pop() {
        for file in dir.files().filter(|file| !folder.join(file.path()).exists()) {
            let path = output.file(file.path())?;
            std::fs::write(&path, file.contents()).map_err(|reason| WriteError::Refused { path, reason })?;
        }
        pending.extend(dir.dirs());
    }
    output.commit()?;
    Ok(folder)
}
