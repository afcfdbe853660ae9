//! The demo: a rendered capture set that the program carries within itself.

use std::path::Path;

use firstbounce_capture::OutputFolder;
use include_dir::{Dir, include_dir};

static FILES: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/assets/demo");

/// Puts the demo set into `folder`, where the user can look at it and change it: what is there already stays. Returns the
/// folder.
pub fn unpack(folder: &Path) -> anyhow::Result<&Path> {
    let output = OutputFolder::stage(folder)?;
    let mut pending = vec![&FILES];
    while let Some(dir) = pending.pop() {
        for file in dir.files().filter(|file| !folder.join(file.path()).exists()) {
            std::fs::write(output.file(file.path())?, file.contents())?;
        }
        pending.extend(dir.dirs());
    }
    output.commit()?;
    Ok(folder)
}
