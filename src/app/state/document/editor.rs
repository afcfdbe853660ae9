//! The one way to change the document: named edits that can be undone.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use firstbounce_capture::WriteError;
use firstbounce_capture::set::{Problem, Reading, SetError};
use undo::{Edit, Merged, Record};

use super::disk::{self, FileOnDisk, SaveError};
use super::{Document, Settings};

/// A document with its history and its file.
#[derive(Debug, Default)]
pub struct Editor {
    document: Arc<Document>,
    saved: Arc<Document>,
    history: Record<Change>,
    gesture: u64,
    file: FileOnDisk,
    /// What the file says that could not be read: it is lost when the file is written.
    unread: Vec<Problem>,
    problems: Vec<Problem>,
}

/// One edit, as the documents before and after it.
#[derive(Debug)]
struct Change {
    name: String,
    gesture: u64,
    before: Arc<Document>,
    after: Arc<Document>,
}

impl Edit for Change {
    type Target = Arc<Document>;
    type Output = ();

    fn edit(&mut self, document: &mut Arc<Document>) {
        *document = self.after.clone();
    }

    fn undo(&mut self, document: &mut Arc<Document>) {
        *document = self.before.clone();
    }

    fn merge(&mut self, next: Self) -> Merged<Self> {
        if self.gesture != next.gesture || self.name != next.name {
            return Merged::No(next);
        }
        self.after = next.after;
        if self.after == self.before { Merged::Annul } else { Merged::Yes }
    }
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}

/// Wherever the program is started next, a path leads to the same place.
fn whole(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_owned())
}

impl Editor {
    /// Opens the set at `path`, its folder or its capture.toml, as far as it can be read.
    pub fn open(path: &Path) -> Result<Self, SetError> {
        let reading = Reading::open(whole(path))?;
        let file = FileOnDisk::of(reading.set.file_path());
        let settings = disk::read_settings(&reading.set.folder);
        Ok(Self::of(reading, settings, file))
    }

    /// A new set in `folder`, of which nothing is on the disk yet.
    pub fn untitled(folder: &Path) -> Self {
        let mut editor = Self::default();
        let document = Arc::make_mut(&mut editor.document);
        document.set.folder = whole(folder);
        editor.saved = editor.document.clone();
        editor.file = FileOnDisk::of(editor.document.set.file_path());
        editor.judge();
        editor
    }

    /// A document that was never saved, from the text that recovery kept.
    pub fn recovered(text: &str, path: PathBuf, settings: Settings) -> Self {
        let reading = Reading::of(text, &path);
        let mut editor = Self::of(reading, settings, FileOnDisk::of(path));
        editor.saved = Arc::default();
        editor
    }

    fn of(reading: Reading, settings: Settings, file: FileOnDisk) -> Self {
        let unread = if reading.complete { Vec::new() } else { reading.problems };
        let mut document = Document { set: reading.set, settings: settings.within_ranges() };
        document.settings.take_over(&mut document.set);
        let document = Arc::new(document);
        let mut editor = Self { saved: document.clone(), document, file, unread, ..Self::default() };
        editor.judge();
        editor
    }

    /// The document as it is now; cheap to keep.
    pub fn document(&self) -> Arc<Document> {
        self.document.clone()
    }

    /// Changes the document under a name that the menu shows: "Move grey ball". Edits of one name within one gesture
    /// (a drag, the typing in one field) are undone together. An edit that changes nothing leaves no trace.
    pub fn edit(&mut self, name: &str, change: impl FnOnce(&mut Document)) {
        let before = self.document.clone();
        let mut after = Document::clone(&before);
        change(&mut after);
        if after == *before {
            return;
        }
        let change = Change { name: name.to_owned(), gesture: self.gesture, before, after: Arc::new(after) };
        self.history.edit(&mut self.document, change);
        self.judge();
    }

    /// From here on edits are undone apart from those before.
    pub fn begin_gesture(&mut self) {
        self.gesture += 1;
    }

    /// Takes the last edit back.
    pub fn undo(&mut self) {
        self.begin_gesture();
        self.history.undo(&mut self.document);
        self.stay_in_folder();
        self.judge();
    }

    /// Makes the last edit that was taken back again.
    pub fn redo(&mut self) {
        self.begin_gesture();
        self.history.redo(&mut self.document);
        self.stay_in_folder();
        self.judge();
    }

    /// What undo would take back.
    pub fn undo_name(&self) -> Option<String> {
        self.history.undo_string()
    }

    /// What redo would make again.
    pub fn redo_name(&self) -> Option<String> {
        self.history.redo_string()
    }

    /// Whether there is something to save.
    pub fn is_dirty(&self) -> bool {
        !Arc::ptr_eq(&self.document, &self.saved) && self.document != self.saved
    }

    /// Everything that keeps the set from being solved: what was wrong in the file where it still counts, and what is
    /// wrong now.
    pub fn problems(&self) -> &[Problem] {
        &self.problems
    }

    /// What the file says that could not be read.
    pub fn unread(&self) -> &[Problem] {
        &self.unread
    }

    /// Where the document is saved.
    pub fn path(&self) -> &Path {
        &self.file.path
    }

    /// Whether another program has changed the file.
    pub fn changed_on_disk(&self) -> bool {
        self.file.changed()
    }

    /// Takes the file as it is now for the one that was opened: saving will replace it.
    pub fn ignore_change_on_disk(&mut self) {
        self.file = FileOnDisk::of(self.file.path.clone());
    }

    /// Reads the file again. Undo brings back what was there before.
    pub fn reload(&mut self) -> Result<(), SetError> {
        let reading = Reading::open(&self.file.path)?;
        self.file = FileOnDisk::of(self.file.path.clone());
        self.unread = if reading.complete { Vec::new() } else { reading.problems };
        self.begin_gesture();
        self.edit("Reload from disk", |document| document.set = reading.set);
        // What only the window knows was not in that file.
        let settings = self.saved.settings.clone();
        self.saved = Arc::new(Document { set: self.document.set.clone(), settings });
        self.judge();
        Ok(())
    }

    /// Saves the document in its file. Returns why the window's settings are not kept, if they are not.
    pub fn save(&mut self) -> Result<Option<WriteError>, SaveError> {
        let not_kept = self.file.write(&self.document, !self.unread.is_empty())?;
        self.saved = self.document.clone();
        self.unread.clear();
        self.judge();
        Ok(not_kept)
    }

    /// Saves the document into another folder, whose set it is from now on. Photos stay where they are; a set that lies
    /// there already is not replaced. Returns as [`Editor::save`].
    pub fn save_as(&mut self, folder: &Path) -> Result<Option<WriteError>, SaveError> {
        let document =
            Document { set: disk::relocated(&self.document.set, folder)?, settings: self.document.settings.clone() };
        let mut file = FileOnDisk::of(document.set.file_path());
        if file.is_taken() && file.path != self.file.path {
            return Err(SaveError::OtherSet { path: file.path });
        }
        let not_kept = file.write(&document, false)?;
        self.file = file;
        self.unread.clear();
        self.begin_gesture();
        self.edit("Save as", |old| *old = document);
        self.saved = self.document.clone();
        self.judge();
        Ok(not_kept)
    }

    /// A step from before "Save as" names its files as seen from the folder of then.
    fn stay_in_folder(&mut self) {
        let Some(folder) = self.file.path.parent() else { return };
        if self.document.set.folder != folder
            && let Ok(set) = disk::relocated(&self.document.set, folder)
        {
            Arc::make_mut(&mut self.document).set = set;
        }
    }

    fn judge(&mut self) {
        self.problems = self.unread.iter().cloned().chain(self.document.set.check()).collect();
    }
}
