//! The document's file.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Weak};
use std::time::{Duration, SystemTime};

use firstbounce_capture::CaptureSet;
use firstbounce_capture::atomic::{WriteError, write_file};
use firstbounce_capture::open::read_text;
use firstbounce_capture::set::update_text;
use thiserror::Error;

use super::{Document, Settings};
use crate::app::jobs::Wake;

/// The file beside capture.toml that keeps what only the window knows.
pub const VIEW_FILE: &str = "firstbounce-view.json";

const WATCH_EVERY: Duration = Duration::from_secs(1);

/// Why the document was not saved.
#[derive(Debug, Error)]
pub enum SaveError {
    /// Nobody has said where.
    #[error("this set has no folder yet: choose \"Save as\"")]
    NoFolder,
    /// Another program wrote the file since it was read.
    #[error("{}: another program has changed this file: reload it, save over it, or choose \"Save as\"", path.display())]
    ChangedOnDisk {
        /// The file.
        path: PathBuf,
    },
    /// "Save as" into the folder of another set.
    #[error("{}: another set lies here: choose a new or empty folder", path.display())]
    OtherSet {
        /// Its file.
        path: PathBuf,
    },
    /// The folder of the set is gone.
    #[error("{}: this folder is gone: choose \"Save as\"", folder.display())]
    FolderGone {
        /// The folder.
        folder: PathBuf,
    },
    /// The system refused.
    #[error("{0}; the set is kept for recovery: choose \"Save as\"")]
    Write(#[from] WriteError),
}

/// A file as it was when the document was last read from it or written to it.
#[derive(Debug, Default)]
pub(super) struct FileOnDisk {
    pub path: PathBuf,
    text: Option<String>,
}

impl FileOnDisk {
    /// The file at `path` as it is now, or as something still to be made.
    pub fn of(path: PathBuf) -> Self {
        let text = read_text(&path).ok();
        Self { path, text }
    }

    /// Whether there was a file.
    pub fn is_there(&self) -> bool {
        self.text.is_some()
    }

    /// Whether the file says something else now, or something stands in its place that is no text. A file that is gone is no
    /// change: saving makes it again.
    pub fn changed(&self) -> bool {
        match read_text(&self.path) {
            Ok(text) => self.text.as_ref() != Some(&text),
            Err(error) => !error.is_not_found(),
        }
    }

    /// Writes the document, keeping comments and layout of the text that was there. With `keep_old` the old text stays
    /// beside it: not all of it could be read.
    pub fn write(&mut self, document: &Document, keep_old: bool) -> Result<(), SaveError> {
        let folder = &document.set.folder;
        if folder.as_os_str().is_empty() {
            return Err(SaveError::NoFolder);
        }
        if !folder.is_dir() {
            if self.text.is_some() {
                return Err(SaveError::FolderGone { folder: folder.clone() });
            }
            fs::create_dir_all(folder).map_err(|reason| WriteError::Refused { path: folder.clone(), reason })?;
        }
        if self.changed() {
            return Err(SaveError::ChangedOnDisk { path: self.path.clone() });
        }
        let new = match &self.text {
            Some(old) => update_text(old, &document.set),
            None => document.set.to_toml(),
        };
        if let (true, Some(old)) = (keep_old, &self.text) {
            write_file(&self.path.with_extension("toml.unread"), old.as_bytes())?;
        }
        write_file(&self.path, new.as_bytes())?;
        self.text = Some(new);
        write_view(folder, "settings", serde_json::to_value(&document.settings).unwrap_or_default())
    }
}

/// What the window keeps beside a set, by its key there; absent where there is none or it cannot be read.
pub(crate) fn read_view<T: serde::de::DeserializeOwned>(folder: &Path, key: &str) -> Option<T> {
    let text = read_text(&folder.join(VIEW_FILE)).ok()?;
    let mut kept: serde_json::Map<String, serde_json::Value> = serde_json::from_str(&text).ok()?;
    serde_json::from_value(kept.remove(key)?).ok()
}

/// Keeps a value beside a set under `key`; other keys stay.
pub(crate) fn write_view(folder: &Path, key: &str, value: serde_json::Value) -> Result<(), SaveError> {
    let path = folder.join(VIEW_FILE);
    let old = read_text(&path).unwrap_or_default();
    let mut kept: serde_json::Map<String, serde_json::Value> = serde_json::from_str(&old).unwrap_or_default();
    if kept.insert(key.to_owned(), value.clone()) == Some(value) {
        return Ok(());
    }
    let text = serde_json::to_string_pretty(&kept).unwrap_or_default();
    Ok(write_file(&path, text.as_bytes())?)
}

pub(super) fn read_settings(folder: &Path) -> Settings {
    read_view(folder, "settings").unwrap_or_default()
}

/// `set` as it must be written in `folder`: files within that folder by relative path, all others by their whole path.
pub fn relocated(set: &CaptureSet, folder: &Path) -> Result<CaptureSet, SaveError> {
    let absolute =
        |path: &Path| std::path::absolute(path).map_err(|_| SaveError::FolderGone { folder: path.to_owned() });
    let target = absolute(folder)?;
    let source = absolute(&set.folder)?;
    let moved = |written: &str| {
        let place = source.join(written);
        place.strip_prefix(&target).unwrap_or(&place).to_string_lossy().replace('\\', "/")
    };
    let mut set = CaptureSet { folder: target.clone(), ..set.clone() };
    set.mask = set.mask.as_deref().map(moved);
    set.shots.iter_mut().flat_map(|shot| &mut shot.files).for_each(|file| *file = moved(file));
    if source != target {
        for path in [&mut set.truth.normals, &mut set.truth.depth, &mut set.truth.bounce] {
            *path = moved(path);
        }
    }
    Ok(set)
}

/// Looks once a second whether a file was written, on its own thread, for as long as it is kept.
pub struct DiskWatch {
    written: Arc<AtomicBool>,
}

impl DiskWatch {
    /// Watches the file at `path`; `wake` is called when it was written.
    pub fn new(path: PathBuf, wake: Wake) -> Self {
        let written = Arc::new(AtomicBool::new(false));
        let kept = Arc::downgrade(&written);
        // Without a thread nobody notices, and saving still asks.
        let _ = std::thread::Builder::new().name("disk watch".into()).spawn(move || watch(&path, &kept, &wake));
        Self { written }
    }

    /// Whether the file was written since the last call.
    pub fn take_written(&self) -> bool {
        self.written.swap(false, Ordering::Relaxed)
    }
}

fn watch(path: &Path, written: &Weak<AtomicBool>, wake: &Wake) {
    let mut seen = stamp(path);
    loop {
        std::thread::sleep(WATCH_EVERY);
        let Some(written) = written.upgrade() else { return };
        let now = stamp(path);
        if now != seen {
            seen = now;
            written.store(true, Ordering::Relaxed);
            wake();
        }
    }
}

fn stamp(path: &Path) -> Option<(SystemTime, u64)> {
    let metadata = fs::metadata(path).ok()?;
    Some((metadata.modified().ok()?, metadata.len()))
}
