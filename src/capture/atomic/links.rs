//! Which links are followed: those that the user named, and none that may have come with a set.

use std::ffi::OsString;
use std::fs::{self, FileType};
use std::io;
use std::path::{Component, Path, PathBuf};

use super::error::{WriteError, refused};

/// The name of the file in a capture set's folder: what lies beside it came with the set.
pub const FILE_NAME: &str = "capture.toml";

/// As many as systems follow.
const MAX_LINKS: usize = 40;

/// Where `path` leads, by a path without links. Links that the user named are followed; those inside a capture set, or
/// inside the folder `guarded`, are refused. What does not exist yet is taken as it is written.
pub(super) fn resolve(path: &Path, guarded: Option<&Path>) -> Result<PathBuf, WriteError> {
    let guarded = guarded.and_then(|folder| folder.canonicalize().ok());
    let is_guarded = |place: &Path| {
        let is_set = |folder: &Path| folder.join(FILE_NAME).symlink_metadata().is_ok();
        let is_given = |folder: &Path| guarded.is_some() && folder.canonicalize().ok() == guarded;
        place.ancestors().any(|folder| is_set(folder) || is_given(folder))
    };
    let mut pending = reversed_parts(&std::path::absolute(path).map_err(refused(path))?);
    let mut place = PathBuf::new();
    let mut followed = 0;
    while let Some(part) = pending.pop() {
        match Path::new(&part).components().next() {
            Some(Component::ParentDir) => {
                place.pop();
            }
            Some(Component::CurDir) | None => {}
            Some(Component::Prefix(_) | Component::RootDir) => place.push(part),
            Some(Component::Normal(_)) => {
                let next = place.join(part);
                if !next.is_symlink() {
                    place = next;
                } else if is_guarded(&place) || followed == MAX_LINKS {
                    return Err(WriteError::Link { path: next });
                } else {
                    followed += 1;
                    pending.extend(reversed_parts(&fs::read_link(&next).map_err(refused(&next))?));
                }
            }
        }
    }
    Ok(place)
}

fn reversed_parts(path: &Path) -> Vec<OsString> {
    path.components().rev().map(|part| part.as_os_str().to_owned()).collect()
}

/// Refuses a place that the user did not name where a link lies on the way from `base` to `inner` below it.
///
/// # Errors
/// [`WriteError::Link`].
pub fn refuse_links(base: &Path, inner: &Path) -> Result<(), WriteError> {
    resolve(&base.join(inner), Some(base)).map(drop)
}

/// Whether there is a file at `path` itself, not at the end of a link.
pub fn is_plain_file(path: &Path) -> bool {
    path.symlink_metadata().is_ok_and(|facts| facts.is_file())
}

/// Whether `name` stays within the folder that it is joined to.
pub(super) fn stays_within(name: &Path) -> bool {
    let mut parts = name.components();
    parts.clone().next().is_some() && parts.all(|part| matches!(part, Component::Normal(_)))
}

/// Whether there is a file `name` in `folder`.
///
/// # Errors
/// Where a link lies on the way, or anything else that a file cannot take the place of.
pub(super) fn file_below(folder: &Path, name: &Path) -> Result<bool, WriteError> {
    let whole = folder.join(name);
    let mut path = folder.to_owned();
    for part in name.components() {
        path.push(part);
        let Some(kind) = kind_of(&path)? else { return Ok(false) };
        match (kind, path == whole) {
            (kind, _) if kind.is_symlink() => return Err(WriteError::Link { path }),
            (kind, false) if kind.is_dir() => {}
            (_, false) => return Err(refused(&whole)(io::ErrorKind::NotADirectory.into())),
            (kind, true) if kind.is_dir() => return Err(WriteError::FolderInTheWay { path }),
            (kind, true) if kind.is_file() => return Ok(true),
            (_, true) => return Err(WriteError::NotAFile { path }),
        }
    }
    Ok(false)
}

/// What lies at `path` itself.
pub(super) fn kind_of(path: &Path) -> Result<Option<FileType>, WriteError> {
    match path.symlink_metadata() {
        Ok(facts) => Ok(Some(facts.file_type())),
        Err(reason) if matches!(reason.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => Ok(None),
        Err(reason) => Err(refused(path)(reason)),
    }
}
