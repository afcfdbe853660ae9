//! Single files, each put in place by one rename.

use std::fs::{self, File, Permissions};
use std::io::{self, Write};
use std::path::Path;

use tempfile::{Builder, NamedTempFile};

use super::error::{WriteError, refused};
use super::links::file_below;
use super::staging::{PREFIX, SUFFIX};

/// Puts `bytes` in place of the file that the user named, or makes it. Until all of it lies safely on the disk, and on any
/// error, the old file stays untouched. A link is followed; permissions of an old file are kept.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    if target.is_dir() {
        return Err(WriteError::FolderInTheWay { path: path.to_owned() });
    }
    replace(&target, bytes).map_err(refused(path))
}

/// As [`write_file`], for a file that the program keeps beside a set: a link is refused, and so is anything but a file.
pub fn write_kept_file(path: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    kept_file_is_there(path)?;
    replace(path, bytes).map_err(refused(path))
}

/// Whether there is a file that the program keeps beside a set.
///
/// # Errors
/// Where a link, a folder or anything else has its name.
pub fn kept_file_is_there(path: &Path) -> Result<bool, WriteError> {
    file_below(folder_of(path), Path::new(path.file_name().unwrap_or_default()))
}

/// Writes a file that was not there. Returns false, and writes nothing, where anything of its name is.
pub fn write_new_file(path: &Path, bytes: &[u8]) -> Result<bool, WriteError> {
    if path.symlink_metadata().is_ok() {
        return Ok(false);
    }
    let file = draft(path, bytes, None).map_err(refused(path))?;
    match file.persist_noclobber(path) {
        Ok(_) => {
            sync_folder(folder_of(path));
            Ok(true)
        }
        Err(error) if error.error.kind() == io::ErrorKind::AlreadyExists => Ok(false),
        Err(error) => Err(refused(path)(error.error)),
    }
}

fn replace(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let permissions = fs::metadata(path).ok().map(|old| old.permissions());
    draft(path, bytes, permissions)?.persist(path).map_err(|error| error.error)?;
    sync_folder(folder_of(path));
    Ok(())
}

/// The contents of the file at `path`, safe on the disk under another name.
fn draft(path: &Path, bytes: &[u8], permissions: Option<Permissions>) -> io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    if let Some(permissions) = new_permissions() {
        builder.permissions(permissions);
    }
    let mut file = builder.tempfile_in(folder_of(path))?;
    file.write_all(bytes)?;
    if let Some(permissions) = permissions {
        file.as_file().set_permissions(permissions)?;
    }
    file.as_file().sync_all()?;
    Ok(file)
}

pub(super) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Makes a rename last through a loss of power, where the system can.
pub(super) fn sync_folder(folder: &Path) {
    if let Ok(folder) = File::open(folder) {
        let _ = folder.sync_all();
    }
}

/// What the process's own mask makes of these is what any other new file has; temporary files would be private.
#[cfg(unix)]
fn new_permissions() -> Option<Permissions> {
    Some(std::os::unix::fs::PermissionsExt::from_mode(0o666))
}

#[cfg(not(unix))]
fn new_permissions() -> Option<Permissions> {
    None
}
