//! What lies under a name when a program comes to it, and what lies in a folder afterwards.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// What lies under one name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum There {
    /// Nothing.
    Nothing,
    /// A file of its own.
    File,
    /// An empty folder.
    Folder,
    /// A link to a file elsewhere.
    LinkToFile,
    /// A link to the folder of that file.
    LinkToFolder,
    /// A link that leads nowhere.
    LinkToNothing,
    /// A second name of a file elsewhere.
    SecondName,
}

impl There {
    /// Every kind.
    pub const ALL: [Self; 7] = [
        Self::Nothing,
        Self::File,
        Self::Folder,
        Self::LinkToFile,
        Self::LinkToFolder,
        Self::LinkToNothing,
        Self::SecondName,
    ];

    /// Puts it at a path: a file with this text, or what leads to `elsewhere`.
    #[cfg(unix)]
    pub fn put(self, at: &Path, text: &str, elsewhere: &Path) {
        let link = |to: &Path| std::os::unix::fs::symlink(to, at).unwrap();
        match self {
            Self::Nothing => {}
            Self::File => fs::write(at, text).unwrap(),
            Self::Folder => fs::create_dir(at).unwrap(),
            Self::LinkToFile => link(elsewhere),
            Self::LinkToFolder => link(elsewhere.parent().unwrap()),
            Self::LinkToNothing => link(&elsewhere.with_file_name("not there")),
            Self::SecondName => fs::hard_link(elsewhere, at).unwrap(),
        }
    }
}

/// Every file and folder below a folder, with what it holds and when it was changed; links are not followed.
pub fn everything_in(folder: &Path) -> BTreeMap<PathBuf, (Option<Vec<u8>>, SystemTime)> {
    let mut found = BTreeMap::new();
    let mut pending = vec![folder.to_owned()];
    while let Some(path) = pending.pop() {
        let facts = path.symlink_metadata().unwrap();
        if facts.is_dir() {
            pending.extend(fs::read_dir(&path).unwrap().map(|entry| entry.unwrap().path()));
        }
        let contents = facts.is_file().then(|| fs::read(&path).unwrap());
        found.insert(path, (contents, facts.modified().unwrap()));
    }
    found
}
