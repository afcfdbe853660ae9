//! The list of a commit's moves, by which a later run finishes or undoes what a killed one began.
//!
//! Both directions look at what is where and do only what is left to do, so that either may be killed at any move as well.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::error::{WriteError, refused};
use super::file::{folder_of, sync_folder};
use super::links::{file_below, is_plain_file, stays_within};
use super::rename::{Move, Rename};
use super::staging::Staging;
use crate::open::read_file;

const MAX_BYTES: u64 = 16 << 20;
const MAX_FILES: usize = 100_000;

/// What a commit moves, by names from the target folder, in which the staging folder lies.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Journal {
    /// Whether the old files are put back.
    undo: bool,
    /// Moved from the staging folder to the target.
    staged: Vec<PathBuf>,
    /// Taken away from the target.
    retired: Vec<PathBuf>,
}

impl Journal {
    pub fn new(staged: &[PathBuf], retired: &[PathBuf]) -> Self {
        Self { undo: false, staged: staged.to_vec(), retired: retired.to_vec() }
    }

    /// Makes the moves. On an error the old files are put back; where not even that works, a later run does it.
    pub fn commit(mut self, staging: Staging, target: &Path) -> Result<(), WriteError> {
        self.write(&staging).map_err(refused(target))?;
        let Err(reason) = self.move_in(&staging, target) else { return Ok(()) };
        self.undo = true;
        // Where it cannot be written, a later run finishes what this one failed to: the folder is whole either way.
        let _ = self.write(&staging);
        if self.move_back(&staging, target).is_err() {
            staging.leave();
        }
        Err(reason)
    }

    fn write(&self, staging: &Staging) -> io::Result<()> {
        let draft = staging.journal_draft();
        let mut file = fs::File::create(&draft)?;
        file.write_all(&serde_json::to_vec(self)?)?;
        file.sync_all()?;
        staging.rename(&draft, &staging.journal(), Move::Replacing)?;
        sync_folder(staging.path());
        Ok(())
    }

    /// The journal of a staging folder that was left behind, if it is one that this program could have written: a set that
    /// was downloaded may hold anything of that name.
    fn read(staging: &Staging, target: &Path, is_output: fn(&str) -> bool) -> Option<Self> {
        if !is_plain_file(&staging.journal()) {
            return None;
        }
        let journal: Self = serde_json::from_slice(&read_file(&staging.journal(), MAX_BYTES).ok()?).ok()?;
        let folders = [target.to_owned(), staging.new_files(), staging.replaced()];
        let is_sound = |name: &PathBuf| {
            let is_ours = stays_within(name) && name.to_str().is_some_and(|name| is_output(&name.replace('\\', "/")));
            is_ours && folders.iter().all(|folder| file_below(folder, name).is_ok())
        };
        let is_right = journal.staged.len() + journal.retired.len() <= MAX_FILES
            && folders.iter().all(|folder| !folder.is_symlink())
            && journal.staged.iter().chain(&journal.retired).all(is_sound);
        is_right.then_some(journal)
    }

    fn move_in(&self, staging: &Staging, target: &Path) -> Result<(), WriteError> {
        for name in &self.staged {
            let (path, new) = (target.join(name), staging.new_files().join(name));
            let move_in = || {
                if !is_there(&new) {
                    return Ok(());
                }
                fs::create_dir_all(folder_of(&path))?;
                keep_old(staging, &path, name, true)?;
                staging.rename(&new, &path, Move::Replacing)
            };
            move_in().map_err(refused(&path))?;
        }
        for name in &self.retired {
            let path = target.join(name);
            keep_old(staging, &path, name, false).map_err(refused(&path))?;
        }
        Ok(())
    }

    fn move_back(&self, staging: &Staging, target: &Path) -> Result<(), WriteError> {
        for name in self.retired.iter().chain(&self.staged) {
            let (path, old) = (target.join(name), staging.replaced().join(name));
            let new = staging.new_files().join(name);
            let move_back = || {
                if self.staged.contains(name) && !is_there(&new) && is_there(&path) {
                    fs::create_dir_all(folder_of(&new))?;
                    staging.rename(&path, &new, Move::Replacing)?;
                }
                if is_there(&old) { staging.rename(&old, &path, Move::Replacing) } else { Ok(()) }
            };
            move_back().map_err(refused(&path))?;
        }
        Ok(())
    }
}

/// Puts the file that lies at `path` among the replaced ones, once. With `stays` it is in both places where the disk knows
/// second names, until the new one takes its place.
fn keep_old(staging: &Staging, path: &Path, name: &Path, stays: bool) -> io::Result<()> {
    let old = staging.replaced().join(name);
    if !is_there(path) || is_there(&old) {
        return Ok(());
    }
    fs::create_dir_all(folder_of(&old))?;
    if stays && fs::hard_link(path, &old).is_ok() {
        return Ok(());
    }
    staging.rename(path, &old, Move::Replacing)
}

fn is_there(path: &Path) -> bool {
    path.symlink_metadata().is_ok()
}

/// Finishes or undoes what killed runs left in the folder `target`, which is locked. What this program could not have
/// written stays as it is.
pub(super) fn recover(target: &Path, is_output: fn(&str) -> bool, rename: Rename) -> Result<(), WriteError> {
    for staging in Staging::left_behind_in(target, rename) {
        if !is_there(&staging.journal()) {
            continue;
        }
        let Some(journal) = Journal::read(&staging, target, is_output) else {
            staging.leave();
            continue;
        };
        let outcome =
            if journal.undo { journal.move_back(&staging, target) } else { journal.move_in(&staging, target) };
        sync_folder(target);
        if let Err(reason) = outcome {
            staging.leave();
            return Err(reason);
        }
    }
    Ok(())
}
