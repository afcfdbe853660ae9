//! A folder of output that appears when it is complete.

use std::collections::HashSet;
use std::fs::{self, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};

use super::error::{WriteError, refused};
use super::file::{folder_of, sync_folder};
use super::journal::{Journal, recover};
use super::links::{file_below, kind_of, resolve, stays_within};
use super::lock::FolderLock;
use super::rename::{Move, Rename, rename};
use super::staging::Staging;

/// How many folders above the target may hold what a killed run left: it begins in the nearest one that exists.
const STAGING_DEPTH: usize = 3;

/// What an output folder holds, and which links on the way to it are refused.
#[derive(Clone, Copy, Debug)]
pub struct OutputRules<'p> {
    /// A folder that may come from a stranger: no link inside it leads to the target.
    pub guarded: Option<&'p Path>,
    /// Whether this kind of output has files of that name. Of what a killed run left, only such files are moved.
    pub is_output: fn(&str) -> bool,
}

impl Default for OutputRules<'_> {
    /// For single files, which need nothing that a later run would have to finish.
    fn default() -> Self {
        Self { guarded: None, is_output: |_| false }
    }
}

/// A folder of output that appears when it is complete.
///
/// Files are staged in a hidden folder on the same disk. [`OutputFolder::commit`] moves them to the target, under a lock:
/// as a whole where the target does not exist or holds nothing but what is replaced, else file by file over those of the
/// same name, by a journal that the next run finishes if this one is killed; other files there stay untouched. Dropped
/// before that, as on an error or when the user cancels, it takes the staged files away and leaves the target as it was.
#[derive(Debug)]
pub struct OutputFolder {
    target: PathBuf,
    staging: Staging,
    is_output: fn(&str) -> bool,
}

impl OutputFolder {
    /// Begins output of a single file for the folder `target`, which need not exist.
    ///
    /// # Errors
    /// As [`OutputFolder::stage_with`].
    pub fn stage(target: impl AsRef<Path>) -> Result<Self, WriteError> {
        Self::stage_with(target, OutputRules::default())
    }

    /// Begins output for the folder `target`, which need not exist; what a killed run left there is finished first.
    ///
    /// # Errors
    /// For a link inside a capture set, for a file in place of the folder, and what the system says.
    pub fn stage_with(target: impl AsRef<Path>, rules: OutputRules) -> Result<Self, WriteError> {
        Self::stage_moving(target.as_ref(), rules, rename)
    }

    pub(super) fn stage_moving(target: &Path, rules: OutputRules, rename: Rename) -> Result<Self, WriteError> {
        let OutputRules { guarded, is_output } = rules;
        let target = resolve(target, guarded)?;
        for above in target.ancestors().skip(1).take(STAGING_DEPTH) {
            remove_left_behind(above, rename);
        }
        // Inside the target if it exists, for it may be a disk of its own; else beside where it will be.
        let place = target.ancestors().find(|place| place.exists()).unwrap_or(Path::new("."));
        if !place.is_dir() {
            return Err(WriteError::NotAFolder { path: place.to_owned() });
        }
        let _lock = FolderLock::of(place)?;
        if place == target {
            recover(&target, is_output, rename)?;
        }
        let staging = Staging::new_in(place, rename).map_err(refused(&target))?;
        Ok(Self { target, staging, is_output })
    }

    /// The folder that files are written into until they are committed.
    pub fn path(&self) -> PathBuf {
        self.staging.new_files()
    }

    /// The folder that the files will be in.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Where to write the file that will be `relative` in the target; folders on the way are made.
    pub fn file(&self, relative: impl AsRef<Path>) -> Result<PathBuf, WriteError> {
        let relative = relative.as_ref();
        if !stays_within(relative) {
            return Err(WriteError::BadName { name: relative.to_owned() });
        }
        let path = self.path().join(relative);
        fs::create_dir_all(folder_of(&path)).map_err(refused(&path))?;
        Ok(path)
    }

    /// Moves every staged file to the target. On an error the target is as it was before.
    pub fn commit(self) -> Result<(), WriteError> {
        self.commit_after(|_| Ok(Vec::new()))
    }

    /// As [`OutputFolder::commit`], after a look at a target that exists, while no other run writes into it: `look` refuses
    /// what must not be replaced, and lists what to take away: what an earlier run left would else be taken for this one's.
    pub fn commit_after<E: From<WriteError>>(self, look: impl Fn(&Path) -> Result<Vec<String>, E>) -> Result<(), E> {
        let staged = self.synced_files()?;
        loop {
            let there = kind_of(&self.target)?;
            if there.is_none() {
                if self.appear()? {
                    return Ok(());
                }
                continue;
            }
            if !there.is_some_and(|kind| kind.is_dir()) {
                return Err(WriteError::NotAFolder { path: self.target }.into());
            }
            let Some(_lock) = FolderLock::of(&self.target)? else { continue };
            recover(&self.target, self.is_output, self.staging.way())?;
            for name in &staged {
                file_below(&self.target, name)?;
            }
            let retired = self.retired(look(&self.target)?, &staged);
            return Ok(self.replace(&staged, &retired)?);
        }
    }

    /// The staged files, all safe on the disk.
    fn synced_files(&self) -> Result<Vec<PathBuf>, WriteError> {
        let files = files_under(&self.path()).map_err(refused(&self.target))?;
        for file in &files {
            let opened = OpenOptions::new().write(true).open(self.path().join(file));
            opened.and_then(|file| file.sync_all()).map_err(refused(&self.target.join(file)))?;
        }
        sync_folder(&self.path());
        Ok(files)
    }

    /// Makes the target out of the staged files; returns false where somebody else made it meanwhile.
    fn appear(&self) -> Result<bool, WriteError> {
        fs::create_dir_all(folder_of(&self.target)).map_err(refused(&self.target))?;
        match self.staging.rename(&self.path(), &self.target, Move::New) {
            Ok(()) => {
                sync_folder(folder_of(&self.target));
                Ok(true)
            }
            Err(_) if self.target.is_dir() => Ok(false),
            Err(reason) => Err(refused(&self.target)(reason)),
        }
    }

    /// Of these names, the files that are there and that no staged one replaces. What is no plain file is left alone.
    fn retired(&self, names: Vec<String>, staged: &[PathBuf]) -> Vec<PathBuf> {
        let names = names.into_iter().map(PathBuf::from).filter(|name| stays_within(name) && !staged.contains(name));
        names.filter(|name| file_below(&self.target, name).is_ok_and(|is_there| is_there)).collect()
    }

    fn replace(mut self, staged: &[PathBuf], retired: &[PathBuf]) -> Result<(), WriteError> {
        if let ([name], []) = (staged, retired) {
            let path = self.target.join(name);
            fs::create_dir_all(folder_of(&path)).map_err(refused(&path))?;
            self.staging.rename(&self.path().join(name), &path, Move::Replacing).map_err(refused(&path))?;
            sync_folder(folder_of(&path));
            return Ok(());
        }
        let ours: HashSet<_> = staged.iter().chain(retired).map(PathBuf::as_path).collect();
        if self.exchange(&ours).unwrap_or(false) {
            sync_folder(folder_of(&self.target));
            return Ok(());
        }
        // A journal is about the folder that it lies in.
        self.staging.move_into(&self.target).map_err(refused(&self.target))?;
        Journal::new(staged, retired).commit(self.staging, &self.target)?;
        sync_folder(&self.target);
        Ok(())
    }

    /// Exchanges the whole target in one move, if it holds nothing but files that are `ours`; returns whether it did.
    fn exchange(&mut self, ours: &HashSet<&Path>) -> io::Result<bool> {
        let Some(beside) = self.target.parent() else { return Ok(false) };
        // A shell that works inside the folder would be left in the old one.
        let is_worked_in = std::env::current_dir().is_ok_and(|place| place.starts_with(&self.target));
        if is_worked_in || !same_owner(&self.target, &self.path())? {
            return Ok(false);
        }
        let Some(folders) = self.folders_of_nothing_but(ours)? else { return Ok(false) };
        for folder in folders {
            let (old, new) = (self.target.join(&folder), self.path().join(&folder));
            if new.is_dir() {
                fs::set_permissions(new, fs::metadata(old)?.permissions())?;
            }
        }
        self.staging.move_into(beside)?;
        self.staging.rename(&self.path(), &self.target, Move::Exchange)?;
        self.move_late_arrivals(ours);
        Ok(true)
    }

    /// The target's folders, itself among them, by their paths from there; `None` where anything but `ours` is in one. Ends at
    /// the first such thing: the target may be a folder of any size.
    fn folders_of_nothing_but(&self, ours: &HashSet<&Path>) -> io::Result<Option<Vec<PathBuf>>> {
        let mut folders = vec![PathBuf::new()];
        let mut next = 0;
        while let Some(inner) = folders.get(next).cloned() {
            next += 1;
            for entry in fs::read_dir(self.target.join(&inner))? {
                let entry = entry?;
                let path = inner.join(entry.file_name());
                if entry.path() == self.staging.path() {
                    continue;
                }
                let is_folder = entry.file_type()?.is_dir();
                if is_folder && ours.iter().any(|file| file.starts_with(&path)) {
                    folders.push(path);
                } else if is_folder || !ours.contains(path.as_path()) {
                    return Ok(None);
                }
            }
        }
        Ok(Some(folders))
    }

    /// Between the look into the old folder and the exchange the user may have put a file there.
    fn move_late_arrivals(&self, ours: &HashSet<&Path>) {
        let files = files_under(&self.path()).unwrap_or_default();
        for file in files.iter().filter(|file| !ours.contains(file.as_path())) {
            let path = self.target.join(file);
            // Nothing more can be done where this fails.
            let _ = fs::create_dir_all(folder_of(&path));
            let _ = self.staging.rename(&self.path().join(file), &path, Move::New);
        }
    }
}

/// Removes what killed runs left that holds no journal: of those nothing was moved yet, or everything was.
fn remove_left_behind(place: &Path, rename: Rename) {
    if !Staging::may_be_in(place) {
        return;
    }
    let Ok(Some(_lock)) = FolderLock::of(place) else { return };
    for staging in Staging::left_behind_in(place, rename) {
        if staging.journal().symlink_metadata().is_ok() {
            staging.leave();
        }
    }
}

#[cfg(unix)]
fn same_owner(a: &Path, b: &Path) -> io::Result<bool> {
    use std::os::unix::fs::MetadataExt;
    let (a, b) = (fs::metadata(a)?, fs::metadata(b)?);
    Ok((a.uid(), a.gid()) == (b.uid(), b.gid()))
}

#[cfg(not(unix))]
fn same_owner(_a: &Path, _b: &Path) -> io::Result<bool> {
    Ok(true)
}

/// Every file and link under `folder`, by its path from there, in the order of their names.
fn files_under(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    let mut pending = vec![PathBuf::new()];
    while let Some(inner) = pending.pop() {
        for entry in fs::read_dir(folder.join(&inner))? {
            let entry = entry?;
            let path = inner.join(entry.file_name());
            if entry.file_type()?.is_dir() { pending.push(path) } else { files.push(path) }
        }
    }
    files.sort();
    Ok(files)
}
