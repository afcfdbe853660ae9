//! The demo: a rendered capture set that the program carries within itself.

use std::path::Path;

use firstbounce_capture::atomic::{OutputFolder, OutputRules, WriteError};
use include_dir::{Dir, include_dir};

static DEMO: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/assets/demo");

/// Puts the demo set into `folder`, where the user can look at it and change it: what is there already stays. Returns the
/// folder.
pub fn unpack(folder: &Path) -> Result<&Path, WriteError> {
    // The folder of the set is this program's idea, not the user's: a link of its name is not followed.
    let rules = OutputRules { guarded: folder.parent(), is_output: |name| DEMO.get_file(name).is_some() };
    let output = OutputFolder::stage_with(folder, rules)?;
    let mut pending = vec![&DEMO];
    while let Some(dir) = pending.pop() {
        for file in dir.files().filter(|file| !output.target().join(file.path()).exists()) {
            let path = output.file(file.path())?;
            std::fs::write(&path, file.contents()).map_err(|reason| WriteError::Refused { path, reason })?;
        }
        pending.extend(dir.dirs());
    }
    output.commit()?;
    Ok(folder)
}
