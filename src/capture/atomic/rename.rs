//! The one way in which files and folders are moved, so that tests can stop the program at every move.

use std::fs;
use std::io;
use std::path::Path;

/// What becomes of that which is in the new place already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Move {
    /// It is replaced.
    Replacing,
    /// There is nothing, else the move fails.
    New,
    /// It comes to the old place.
    Exchange,
}

/// How a file or a folder is moved from one path to another.
pub(super) type Rename = fn(&Path, &Path, Move) -> io::Result<()>;

/// As the system moves them.
pub(super) fn rename(from: &Path, to: &Path, how: Move) -> io::Result<()> {
    match how {
        Move::Replacing => fs::rename(from, to),
        Move::New => match flagged(from, to, how) {
            Err(reason) if is_unknown(&reason) => rename_to_free(from, to),
            outcome => outcome,
        },
        Move::Exchange => flagged(from, to, how),
    }
}

/// Some disks know plain renames only.
fn is_unknown(reason: &io::Error) -> bool {
    matches!(reason.kind(), io::ErrorKind::InvalidInput | io::ErrorKind::Unsupported)
}

fn rename_to_free(from: &Path, to: &Path) -> io::Result<()> {
    if to.symlink_metadata().is_ok() {
        return Err(io::ErrorKind::AlreadyExists.into());
    }
    fs::rename(from, to)
}

#[cfg(any(target_os = "linux", target_os = "android", target_vendor = "apple"))]
fn flagged(from: &Path, to: &Path, how: Move) -> io::Result<()> {
    use rustix::fs::{CWD, RenameFlags, renameat_with};
    let flags = if how == Move::Exchange { RenameFlags::EXCHANGE } else { RenameFlags::NOREPLACE };
    Ok(renameat_with(CWD, from, CWD, to, flags)?)
}

#[cfg(not(any(target_os = "linux", target_os = "android", target_vendor = "apple")))]
fn flagged(_from: &Path, _to: &Path, _how: Move) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}
