//! Files that appear whole or not at all.

use std::fs::{self, File, OpenOptions, Permissions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::{Builder, TempDir};
use thiserror::Error;

/// Why something could not be written.
#[derive(Debug, Error)]
pub enum WriteError {
    /// The system refused.
    #[error("cannot write {}: {reason}{}", path.display(), advice(reason))]
    Refused {
        /// What was to be written.
        path: PathBuf,
        /// What the system said.
        reason: io::Error,
    },
    /// A file stands where a folder is needed.
    #[error("cannot write into {}: it is a file; name a folder", path.display())]
    NotAFolder {
        /// The file.
        path: PathBuf,
    },
    /// A file that was never written by the program stands where one is to be written.
    #[error("{} is a file of yours, which the results would replace: choose another folder", path.display())]
    NotOurs {
        /// The file.
        path: PathBuf,
    },
    /// A folder stands where a file is to be written.
    #[error("cannot write {}: a folder of this name is in the way", path.display())]
    FolderInTheWay {
        /// The folder.
        path: PathBuf,
    },
}

fn advice(reason: &io::Error) -> &'static str {
    match reason.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => "; free some space or choose another folder",
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => "; choose another folder",
        _ => "",
    }
}

fn refused(path: &Path) -> impl FnOnce(io::Error) -> WriteError {
    let path = path.to_owned();
    move |reason| WriteError::Refused { path, reason }
}

/// Puts `bytes` in place of the file at `path`, or makes it. Until all of it lies safely on the disk, and on any error,
/// the old file stands untouched. A link is followed; permissions of an old file are kept.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if target.is_dir() {
        return Err(WriteError::FolderInTheWay { path: path.to_owned() });
    }
    let write = || {
        let mut builder = Builder::new();
        builder.prefix(".firstbounce-").suffix(".partial");
        if let Some(permissions) = new_permissions(FILE_MODE) {
            builder.permissions(permissions);
        }
        let mut file = builder.tempfile_in(folder_of(&target))?;
        file.write_all(bytes)?;
        if let Ok(old) = fs::metadata(&target) {
            file.as_file().set_permissions(old.permissions())?;
        }
        file.as_file().sync_all()?;
        file.persist(&target).map_err(|error| error.error)?;
        Ok(())
    };
    write().map_err(refused(path))?;
    sync_folder(folder_of(&target));
    Ok(())
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Makes a rename last through a loss of power, where the system can.
fn sync_folder(folder: &Path) {
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
}

/// What the process's own mask makes of these is what any other new file has; temporary files would be private.
#[cfg(unix)]
fn new_permissions(mode: u32) -> Option<Permissions> {
    Some(std::os::unix::fs::PermissionsExt::from_mode(mode))
}

#[cfg(not(unix))]
fn new_permissions(_mode: u32) -> Option<Permissions> {
    None
}

const FILE_MODE: u32 = 0o666;

/// A folder of output that appears when it is complete.
///
/// Files are staged in a hidden folder on the same disk. [`OutputFolder::commit`] moves them to the target: as a whole
/// where the target does not exist, else file by file over those of the same name; other files there stay untouched.
/// Dropped before that, as on an error or when a person cancels, it takes the staged files away and leaves the target
/// as it was.
#[derive(Debug)]
pub struct OutputFolder {
    target: PathBuf,
    staging: TempDir,
    retired: Vec<PathBuf>,
}

impl OutputFolder {
    /// Begins output for the folder `target`, which need not exist.
    pub fn stage(target: impl Into<PathBuf>) -> Result<Self, WriteError> {
        let target: PathBuf = target.into();
        // Inside the target if it exists, for it may be a disk of its own; else beside where it will be.
        let place = target.ancestors().find(|place| place.symlink_metadata().is_ok());
        let place = place.unwrap_or(Path::new("."));
        if !place.is_dir() {
            return Err(WriteError::NotAFolder { path: place.to_owned() });
        }
        let mut builder = Builder::new();
        builder.prefix(".firstbounce-").suffix(".partial");
        let staging = builder.tempdir_in(place).map_err(refused(&target))?;
        let output = Self { target, staging, retired: Vec::new() };
        fs::create_dir(output.path()).map_err(refused(&output.target))?;
        Ok(output)
    }

    /// The folder that files are written into until they are committed.
    pub fn path(&self) -> PathBuf {
        self.staging.path().join("new")
    }

    /// The folder that the files will be in.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Where to write the file that will be `relative` in the target; folders on the way are made.
    pub fn file(&self, relative: impl AsRef<Path>) -> Result<PathBuf, WriteError> {
        let path = self.path().join(relative);
        fs::create_dir_all(folder_of(&path)).map_err(refused(&path))?;
        Ok(path)
    }

    /// Has the commit take the file `relative` of the target away, unless a staged one takes its place: what an earlier run
    /// left would else be taken for this one's.
    pub fn retire(&mut self, relative: impl Into<PathBuf>) {
        self.retired.push(relative.into());
    }

    /// Moves every staged file to the target. On an error the target is as it was before.
    pub fn commit(self) -> Result<(), WriteError> {
        let files = files_under(&self.path()).map_err(refused(&self.target))?;
        for file in &files {
            let path = self.path().join(file);
            OpenOptions::new()
                .write(true)
                .open(&path)
                .and_then(|file| file.sync_all())
                .map_err(refused(&self.target.join(file)))?;
        }
        if self.target.symlink_metadata().is_ok() {
            self.move_files(&files)?;
        } else {
            fs::create_dir_all(folder_of(&self.target)).map_err(refused(&self.target))?;
            fs::rename(self.path(), &self.target).map_err(refused(&self.target))?;
        }
        sync_folder(folder_of(&self.target));
        sync_folder(&self.target);
        Ok(())
    }

    fn move_files(&self, files: &[PathBuf]) -> Result<(), WriteError> {
        for file in files {
            let path = self.target.join(file);
            if path.is_dir() {
                return Err(WriteError::FolderInTheWay { path });
            }
        }
        let mut moved: Vec<&PathBuf> = Vec::new();
        let retired = self.retired.iter().filter(|file| !files.contains(file) && self.target.join(file).is_file());
        let moves = files.iter().map(|file| (file, true)).chain(retired.map(|file| (file, false)));
        for (file, is_new) in moves {
            let outcome = if is_new { self.move_file(file) } else { self.move_aside(file) };
            if let Err(reason) = outcome {
                moved.iter().rev().for_each(|file| self.move_back(file));
                return Err(WriteError::Refused { path: self.target.join(file), reason });
            }
            moved.push(file);
        }
        Ok(())
    }

    fn move_aside(&self, file: &Path) -> io::Result<()> {
        let replaced = self.replaced(file);
        fs::create_dir_all(folder_of(&replaced))?;
        fs::rename(self.target.join(file), replaced)
    }

    fn replaced(&self, file: &Path) -> PathBuf {
        self.staging.path().join("replaced").join(file)
    }

    fn move_file(&self, file: &Path) -> io::Result<()> {
        let (path, replaced) = (self.target.join(file), self.replaced(file));
        fs::create_dir_all(folder_of(&path))?;
        if path.symlink_metadata().is_ok() {
            fs::create_dir_all(folder_of(&replaced))?;
            // A second name leaves the old file in place until the new one takes it over; some disks know none.
            fs::hard_link(&path, &replaced).or_else(|_| fs::rename(&path, &replaced))?;
        }
        fs::rename(self.path().join(file), &path).inspect_err(|_| self.restore(file))
    }

    fn move_back(&self, file: &Path) {
        let _ = fs::remove_file(self.target.join(file));
        self.restore(file);
    }

    /// Nothing more can be done where this fails: the first error is the one to tell.
    fn restore(&self, file: &Path) {
        let _ = fs::rename(self.replaced(file), self.target.join(file));
    }
}

/// Every file under `folder`, by its path from there, in the order of their names.
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

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_written_file_takes_the_place_of_the_old_one_and_leaves_nothing_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("capture.toml");
        write_file(&path, b"one").unwrap();
        write_file(&path, b"two").unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"two");
        assert_eq!(names(folder.path()), ["capture.toml"]);
    }

    #[cfg(unix)]
    #[test]
    fn others_may_read_a_new_file_and_an_old_one_keeps_its_permissions() {
        use std::os::unix::fs::PermissionsExt;
        let folder = tempfile::tempdir().unwrap();
        let (path, plain) = (folder.path().join("saved"), folder.path().join("plain"));
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode() & 0o777;
        write_file(&path, b"one").unwrap();
        fs::write(&plain, b"one").unwrap();
        assert_eq!(mode(&path), mode(&plain));
        fs::set_permissions(&path, Permissions::from_mode(0o640)).unwrap();
        write_file(&path, b"two").unwrap();
        assert_eq!(mode(&path), 0o640);
    }

    #[cfg(unix)]
    #[test]
    fn writing_through_a_link_keeps_the_link() {
        let folder = tempfile::tempdir().unwrap();
        let (path, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&path, b"one").unwrap();
        std::os::unix::fs::symlink(&path, &link).unwrap();
        write_file(&link, b"two").unwrap();
        assert!(link.is_symlink());
        assert_eq!(fs::read(&path).unwrap(), b"two");
    }

    #[test]
    fn a_file_that_cannot_be_written_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, b"old").unwrap();
        let message = write_file(&file.join("capture.toml"), b"new").unwrap_err().to_string();
        assert!(message.starts_with(&format!("cannot write {}", file.join("capture.toml").display())), "{message}");
        assert!(matches!(write_file(folder.path(), b"new"), Err(WriteError::FolderInTheWay { .. })));
        assert_eq!(fs::read(&file).unwrap(), b"old");
        assert_eq!(names(folder.path()), ["file"]);
    }

    #[test]
    fn dropped_output_leaves_no_trace() {
        let folder = tempfile::tempdir().unwrap();
        for target in [folder.path().join("a/b/out"), folder.path().to_owned()] {
            let output = OutputFolder::stage(target).unwrap();
            fs::write(output.file("mesh/object.obj").unwrap(), b"v").unwrap();
            drop(output);
            assert!(names(folder.path()).is_empty());
        }
    }

    #[test]
    fn committed_output_is_all_there_and_open_to_others() {
        let folder = tempfile::tempdir().unwrap();
        let target = folder.path().join("a/out");
        let output = OutputFolder::stage(&target).unwrap();
        fs::write(output.file("report.json").unwrap(), b"{}").unwrap();
        fs::write(output.file("mesh/object.obj").unwrap(), b"v").unwrap();
        assert!(!target.exists());
        output.commit().unwrap();
        assert_eq!(names(folder.path()), ["a"]);
        assert_eq!(names(&target), ["mesh", "report.json"]);
        assert_eq!(fs::read(target.join("mesh/object.obj")).unwrap(), b"v");
        let plain = folder.path().join("plain");
        fs::create_dir(&plain).unwrap();
        assert_eq!(fs::metadata(&target).unwrap().permissions(), fs::metadata(&plain).unwrap().permissions());
    }

    #[test]
    fn commit_replaces_its_own_files_and_no_others() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("notes.txt"), b"mine").unwrap();
        fs::write(folder.path().join("report.json"), b"old").unwrap();
        let output = OutputFolder::stage(folder.path()).unwrap();
        fs::write(output.file("report.json").unwrap(), b"new").unwrap();
        fs::write(output.file("mesh/object.obj").unwrap(), b"v").unwrap();
        assert_eq!(fs::read(folder.path().join("report.json")).unwrap(), b"old");
        output.commit().unwrap();
        assert_eq!(names(folder.path()), ["mesh", "notes.txt", "report.json"]);
        assert_eq!(fs::read(folder.path().join("report.json")).unwrap(), b"new");
        assert_eq!(fs::read(folder.path().join("notes.txt")).unwrap(), b"mine");
    }

    #[test]
    fn a_retired_file_goes_with_the_commit_and_stays_without_it() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("mesh.stl"), b"old").unwrap();
        fs::write(folder.path().join("mesh.obj"), b"old").unwrap();
        let staged = || {
            let mut output = OutputFolder::stage(folder.path()).unwrap();
            fs::write(output.file("mesh.obj").unwrap(), b"new").unwrap();
            ["mesh.stl", "mesh.obj", "never.ply"].into_iter().for_each(|file| output.retire(file));
            output
        };
        drop(staged());
        assert_eq!(names(folder.path()), ["mesh.obj", "mesh.stl"]);
        staged().commit().unwrap();
        assert_eq!(names(folder.path()), ["mesh.obj"]);
        assert_eq!(fs::read(folder.path().join("mesh.obj")).unwrap(), b"new");
    }

    #[test]
    fn a_commit_that_fails_midway_puts_the_old_files_back() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.exr"), b"old").unwrap();
        // A file where a folder is needed stops the second move, not the first.
        fs::write(folder.path().join("mesh"), b"mine").unwrap();
        let output = OutputFolder::stage(folder.path()).unwrap();
        fs::write(output.file("a.exr").unwrap(), b"new").unwrap();
        fs::write(output.file("b.exr").unwrap(), b"new").unwrap();
        fs::write(output.file("mesh/object.obj").unwrap(), b"v").unwrap();
        let message = output.commit().unwrap_err().to_string();
        assert!(message.contains("object.obj"), "{message}");
        assert_eq!(names(folder.path()), ["a.exr", "mesh"]);
        assert_eq!(fs::read(folder.path().join("a.exr")).unwrap(), b"old");
    }

    #[test]
    fn a_file_in_place_of_the_folder_is_refused_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("out");
        fs::write(&file, b"mine").unwrap();
        for target in [file.clone(), file.join("inner")] {
            let message = OutputFolder::stage(target).unwrap_err().to_string();
            assert!(message.contains("it is a file"), "{message}");
        }
        assert_eq!(fs::read(&file).unwrap(), b"mine");
    }
}
