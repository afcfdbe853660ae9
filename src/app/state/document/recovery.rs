//! Recovery after a crash: the unsaved document, in a folder of this run that is locked while the run lives; and the note of a
//! set that is being opened.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use firstbounce_capture::atomic::write_file;
use firstbounce_capture::open::{MAX_TEXT_BYTES, open_file, read_text};
use serde::{Deserialize, Serialize};

use super::{Document, Settings};

const LOCK: &str = "lock";
const DOCUMENT: &str = "document.json";
const EVERY: Duration = Duration::from_secs(1);

/// A document as recovery keeps it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Recovered {
    /// Where it would have been saved.
    pub path: PathBuf,
    /// The text of capture.toml.
    pub text: String,
    /// How the window solved it.
    pub settings: Settings,
    /// The set's title, to offer it by.
    pub title: String,
}

/// Keeps the unsaved document of this run.
#[derive(Debug)]
pub struct Recovery {
    root: PathBuf,
    pub(super) folder: PathBuf,
    noted: Sender<()>,
    stays: AtomicBool,
    /// Held, not read: its lock says that this run lives.
    _lock: Option<File>,
}

/// What the panic hook writes.
static UNSAVED: Mutex<Option<(PathBuf, Arc<Document>)>> = Mutex::new(None);

impl Recovery {
    /// Recovery below `root`.
    pub fn new(root: PathBuf) -> Self {
        let folder = free_folder(&root);
        let lock = fs::create_dir_all(&folder).and_then(|()| File::create(folder.join(LOCK)));
        // Without a lock the document is kept all the same; another run may offer it too early.
        let _lock = lock.ok().filter(|file| file.try_lock().is_ok());
        let (noted, news) = mpsc::channel();
        let place = folder.join(DOCUMENT);
        std::thread::spawn(move || keep_while_noted(&news, &place));
        Self { root, folder, noted, stays: AtomicBool::new(false), _lock }
    }

    /// Documents that earlier runs did not get to save, with the folders that keep them.
    pub fn found(&self) -> Vec<(PathBuf, Recovered)> {
        let read = |folder: PathBuf| {
            let text = read_text(&folder.join(DOCUMENT)).ok()?;
            Some((folder, serde_json::from_str(&text).ok()?))
        };
        self.abandoned().filter_map(read).collect()
    }

    /// The folders of runs that live no more.
    pub(super) fn abandoned(&self) -> impl Iterator<Item = PathBuf> {
        let folders = fs::read_dir(&self.root).into_iter().flatten().flatten().map(|entry| entry.path());
        folders.filter(|folder| {
            let lock = || open_file(&folder.join(LOCK), MAX_TEXT_BYTES);
            *folder != self.folder && lock().is_ok_and(|(file, _)| file.try_lock().is_ok())
        })
    }

    /// Leaves what was noted to the next run: this one must end, and the user did not ask for it.
    pub fn leave_to_next_run(&self) {
        self.stays.store(true, Ordering::Relaxed);
        save_everything_now();
    }

    /// Forgets the document that an earlier run kept.
    pub fn discard(&self, folder: &Path) {
        self.forget(folder, DOCUMENT);
    }

    /// Removes one thing that an earlier run left, and its folder when nothing is left but the lock. What cannot be removed
    /// is offered again: bearable.
    pub(super) fn forget(&self, run: &Path, name: &str) {
        let _ = fs::remove_file(run.join(name));
        let others = fs::read_dir(run).into_iter().flatten().flatten();
        if others.filter(|entry| entry.file_name() != LOCK).count() == 0 {
            let _ = fs::remove_dir_all(run);
        }
    }

    /// Notes the document as it is, for the panic hook. `None` when all is saved.
    pub fn note(&self, unsaved: Option<Arc<Document>>) {
        let place = self.folder.join(DOCUMENT);
        *UNSAVED.lock().unwrap_or_else(PoisonError::into_inner) = unsaved.map(|document| (place, document));
    }

    /// Has what was noted written soon, off this thread.
    pub fn keep(&self) {
        // The thread lives as long as this; were it gone, the panic hook still writes.
        let _ = self.noted.send(());
    }
}

/// A folder that no run has, and none has left behind: in a container every run has the same number.
fn free_folder(root: &Path) -> PathBuf {
    let id = std::process::id();
    let mut folder = root.join(id.to_string());
    let mut others = 1..;
    while let Some(other) = others.next().filter(|_| folder.exists()) {
        folder = root.join(format!("{id}-{other}"));
    }
    folder
}

impl Drop for Recovery {
    /// A run that ends in order leaves nothing to recover.
    fn drop(&mut self) {
        if std::thread::panicking() || self.stays.load(Ordering::Relaxed) {
            return;
        }
        UNSAVED.lock().unwrap_or_else(PoisonError::into_inner).take_if(|(place, _)| place.starts_with(&self.folder));
        let _ = fs::remove_dir_all(&self.folder);
    }
}

/// Writes at most once a second: a drag edits the document every frame.
fn keep_while_noted(news: &Receiver<()>, place: &Path) {
    while news.recv().is_ok() {
        while news.try_recv().is_ok() {}
        if !save_everything_now() {
            // All is saved; if the file stays, the document is offered once too often.
            let _ = fs::remove_file(place);
        }
        std::thread::sleep(EVERY);
    }
}

/// Writes the unsaved document into the recovery folder; returns whether there was one. For the panic hook, too.
pub fn save_everything_now() -> bool {
    let unsaved = UNSAVED.lock().unwrap_or_else(PoisonError::into_inner).clone();
    let Some((place, document)) = unsaved else { return false };
    let Document { set, settings } = &*document;
    let (path, text, title) = (set.file_path(), set.to_toml(), set.title());
    let kept = Recovered { path, text, settings: settings.clone(), title };
    match serde_json::to_vec(&kept) {
        // Recovery that fails must not stop the work; saving will name the reason.
        Ok(bytes) => write_file(&place, &bytes).is_ok(),
        Err(_) => false,
    }
}
