//! One run at a time writes into a folder.

use std::fs::{File, TryLockError};
use std::io;
use std::path::Path;
use std::time::{Duration, Instant};

use super::error::{WriteError, refused};

/// Longer than any commit takes.
const MAX_WAIT: Duration = Duration::from_secs(60);
const ASK_EVERY: Duration = Duration::from_millis(10);

/// Holds a folder against other runs of this program. The system lets go of it when the process ends, however it ends.
/// A disk that knows no locks and a folder that cannot be looked into go without.
#[derive(Debug)]
pub(super) struct FolderLock {
    /// Held, not read.
    _file: Option<File>,
}

impl FolderLock {
    /// Waits for the folder; `None` where there is no such folder.
    pub fn of(folder: &Path) -> Result<Option<Self>, WriteError> {
        let since = Instant::now();
        loop {
            let file = match open(folder) {
                Ok(file) => file,
                Err(reason) if reason.kind() == io::ErrorKind::NotFound => return Ok(None),
                Err(reason) if reason.kind() == io::ErrorKind::PermissionDenied => {
                    return Ok(Some(Self { _file: None }));
                }
                Err(reason) => return Err(refused(folder)(reason)),
            };
            match file.try_lock() {
                // A run that exchanged the whole folder has left this lock on the old one.
                Ok(()) if !is_still(folder, &file) => {}
                Ok(()) | Err(TryLockError::Error(_)) => return Ok(Some(Self { _file: Some(file) })),
                Err(TryLockError::WouldBlock) if since.elapsed() < MAX_WAIT => std::thread::sleep(ASK_EVERY),
                Err(TryLockError::WouldBlock) => return Err(WriteError::Busy { path: folder.to_owned() }),
            }
        }
    }
}

#[cfg(unix)]
fn open(folder: &Path) -> io::Result<File> {
    File::open(folder)
}

#[cfg(unix)]
fn is_still(folder: &Path, file: &File) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |facts: std::fs::Metadata| (facts.dev(), facts.ino());
    match (folder.symlink_metadata(), file.metadata()) {
        (Ok(now), Ok(then)) => identity(now) == identity(then),
        _ => false,
    }
}

/// Where folders cannot be opened, a file in the user's own temporary folder, named after the folder, is locked for it.
#[cfg(not(unix))]
fn open(folder: &Path) -> io::Result<File> {
    use std::hash::{DefaultHasher, Hash, Hasher};
    folder.symlink_metadata()?;
    let mut hasher = DefaultHasher::new();
    folder.hash(&mut hasher);
    File::create(std::env::temp_dir().join(format!("firstbounce-{:016x}.lock", hasher.finish())))
}

#[cfg(not(unix))]
fn is_still(folder: &Path, _file: &File) -> bool {
    folder.is_dir()
}
