//! The hidden folder in which a run prepares its files, and those that killed runs left behind.

use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

use tempfile::Builder;

use super::links::is_plain_file;
use super::rename::{Move, Rename};

/// How names of what is being written begin.
pub(super) const PREFIX: &str = ".firstbounce-";
/// How they end.
pub(super) const SUFFIX: &str = ".partial";

/// Locked by the run that the folder belongs to, for as long as it lives.
const LOCK: &str = "lock";
const NEW: &str = "new";
const REPLACED: &str = "replaced";
const JOURNAL: &str = "journal.json";
const JOURNAL_DRAFT: &str = "journal.json.draft";

/// A staging folder of this run. Dropped, it is removed with all that is in it.
#[derive(Debug)]
pub(super) struct Staging {
    path: PathBuf,
    /// Held, not read.
    lock: Option<File>,
    rename: Rename,
    stays: bool,
}

impl Staging {
    /// A new one in the folder `place`, which is locked: one without a lock of its own is then never another run's that has
    /// just begun.
    pub fn new_in(place: &Path, rename: Rename) -> io::Result<Self> {
        let folder = Builder::new().prefix(PREFIX).suffix(SUFFIX).tempdir_in(place)?;
        let lock = File::create(folder.path().join(LOCK))?;
        // On a disk that knows no locks, none is ever taken for one that was left behind.
        let _ = lock.try_lock();
        fs::create_dir(folder.path().join(NEW))?;
        Ok(Self { path: folder.keep(), lock: Some(lock), rename, stays: false })
    }

    /// Whether anything in `place` may have been left behind.
    pub fn may_be_in(place: &Path) -> bool {
        named_as_staging(place).next().is_some()
    }

    /// Those in `place`, which is locked, whose run is gone. Only folders that hold what a staging folder holds and nothing
    /// else.
    pub fn left_behind_in(place: &Path, rename: Rename) -> Vec<Self> {
        let mut paths: Vec<_> = named_as_staging(place).collect();
        paths.sort();
        paths.into_iter().filter_map(|path| Self::left_behind(path, rename)).collect()
    }

    fn left_behind(path: PathBuf, rename: Rename) -> Option<Self> {
        const KNOWN: [&str; 5] = [LOCK, NEW, REPLACED, JOURNAL, JOURNAL_DRAFT];
        if !path.symlink_metadata().ok()?.is_dir() {
            return None;
        }
        let names: Vec<_> = fs::read_dir(&path).ok()?.flatten().map(|entry| entry.file_name()).collect();
        if names.is_empty() {
            // Killed before it had a lock; the system removes no folder that holds anything.
            let _ = fs::remove_dir(&path);
            return None;
        }
        let lock = path.join(LOCK);
        if !is_plain_file(&lock) || !names.iter().all(|name| KNOWN.iter().any(|known| name == known)) {
            return None;
        }
        let lock = OpenOptions::new().read(true).write(true).open(lock).ok()?;
        lock.try_lock().ok()?;
        // Between the look and the lock its run may have removed it.
        path.is_dir().then_some(Self { path, lock: Some(lock), rename, stays: false })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The folder of the files that are to be moved to the target.
    pub fn new_files(&self) -> PathBuf {
        self.path.join(NEW)
    }

    /// The folder of the files that the new ones replace.
    pub fn replaced(&self) -> PathBuf {
        self.path.join(REPLACED)
    }

    pub fn journal(&self) -> PathBuf {
        self.path.join(JOURNAL)
    }

    pub fn journal_draft(&self) -> PathBuf {
        self.path.join(JOURNAL_DRAFT)
    }

    /// Moves a file or a folder, as every commit does.
    pub fn rename(&self, from: &Path, to: &Path, how: Move) -> io::Result<()> {
        (self.rename)(from, to, how)
    }

    /// How it moves.
    pub fn way(&self) -> Rename {
        self.rename
    }

    /// Moves the whole staging folder into the folder `place`.
    pub fn move_into(&mut self, place: &Path) -> io::Result<()> {
        let moved = place.join(self.path.file_name().unwrap_or_default());
        if moved != self.path {
            self.rename(&self.path, &moved, Move::New)?;
            self.path = moved;
        }
        Ok(())
    }

    /// Leaves it where it is: to a later run, or to the user.
    pub fn leave(mut self) {
        self.stays = true;
    }
}

impl Drop for Staging {
    fn drop(&mut self) {
        if self.stays {
            return;
        }
        // What cannot be removed is harmless without a journal. The lock goes last: a later run knows the rest by it.
        let _ = fs::remove_file(self.journal());
        if self.journal().symlink_metadata().is_ok() {
            return;
        }
        let _ = fs::remove_dir_all(self.new_files());
        let _ = fs::remove_dir_all(self.replaced());
        self.lock = None;
        let _ = fs::remove_dir_all(&self.path);
    }
}

fn named_as_staging(place: &Path) -> impl Iterator<Item = PathBuf> {
    let is_staging = |name: &str| name.starts_with(PREFIX) && name.ends_with(SUFFIX);
    let entries = fs::read_dir(place).into_iter().flatten().flatten();
    entries.filter(move |entry| is_staging(&entry.file_name().to_string_lossy())).map(|entry| entry.path())
}
