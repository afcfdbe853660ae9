//! Why something was not written.

use std::io;
use std::path::{Path, PathBuf};

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
    /// A link where none is followed.
    #[error(
        "{} is a link, and nothing is written through a link here: take it away, or name another folder",
        path.display()
    )]
    Link {
        /// The link.
        path: PathBuf,
    },
    /// A pipe, a socket or a device stands where a file is to be written.
    #[error("cannot write {}: it is not a file; take it away, or choose another folder", path.display())]
    NotAFile {
        /// What is there.
        path: PathBuf,
    },
    /// A name that leads out of the folder.
    #[error("cannot write a file named {}: results stay within their folder; choose another name", name.display())]
    BadName {
        /// The name.
        name: PathBuf,
    },
    /// Another run does not finish writing into the folder.
    #[error("another run is writing into {}: wait until it is done, or choose another folder", path.display())]
    Busy {
        /// The folder.
        path: PathBuf,
    },
    /// A file that the program keeps holds something else.
    #[error("{} does not hold what this program keeps there and stays as it is: give it another name", path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// Every name for a copy is taken.
    #[error("{} and the {others} names after it are taken: take old copies away", path.display())]
    NoFreeName {
        /// The first name that was tried.
        path: PathBuf,
        /// How many more were tried.
        others: usize,
    },
}

fn advice(reason: &io::Error) -> &'static str {
    match reason.kind() {
        io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => "; free some space or choose another folder",
        io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => "; choose another folder",
        _ => "",
    }
}

pub(super) fn refused(path: &Path) -> impl FnOnce(io::Error) -> WriteError {
    let path = path.to_owned();
    move |reason| WriteError::Refused { path, reason }
}
