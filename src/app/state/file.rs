//! The file of the open set: recovery of what is unsaved, and what other programs do to it.

use std::path::Path;
use std::sync::Arc;

use super::document::{DiskWatch, Document, Editor, Recovery};
use super::preferences::Folders;
use crate::app::base::jobs::Wake;

/// The open set seen from the disk; without a set it keeps nothing.
pub struct SetFile {
    pub(in crate::app) recovery: Recovery,
    /// Whether another program has changed the file.
    pub(in crate::app) changed_on_disk: bool,
    /// Whether it was said that nothing is kept beside this set.
    pub(super) said_not_kept: bool,
    disk: Option<DiskWatch>,
    is_open: bool,
    /// Whether it is noted that the set is being opened.
    is_opening: bool,
    opened: u64,
    /// The document that recovery knows.
    noted: Arc<Document>,
}

impl SetFile {
    /// Without a set.
    pub fn new(folders: &Folders) -> Self {
        Self {
            recovery: Recovery::new(folders.recovery.clone()),
            changed_on_disk: false,
            said_not_kept: false,
            disk: None,
            is_open: false,
            is_opening: false,
            opened: 0,
            noted: Arc::default(),
        }
    }

    /// Whether a set is open.
    pub fn is_open(&self) -> bool {
        self.is_open
    }

    /// Counts the sets that were opened: what the window keeps from frame to frame belongs to one of them.
    pub fn opened_sets(&self) -> u64 {
        self.opened
    }

    /// Notes, before anything of it is read, that the set in `folder` is being opened: what ends this run is not opened by the
    /// next one without asking.
    pub(super) fn opening(&self, folder: &Path) {
        self.recovery.note_opening(folder);
    }

    /// The set that was to be opened is not; the one that is open stays.
    pub(super) fn opening_failed(&self, open: &Editor) {
        if self.is_opening {
            self.recovery.note_opening(&open.document().set.folder);
        } else {
            self.recovery.opened_well();
        }
    }

    /// What the open set gave was drawn, or the program ends in order: nothing of the set ends the next run.
    pub(in crate::app) fn opened_well(&mut self) {
        if std::mem::take(&mut self.is_opening) {
            self.recovery.opened_well();
        }
    }

    pub(super) fn opened(&mut self, editor: &Editor, wake: Wake) {
        self.is_open = true;
        self.is_opening = true;
        self.opened += 1;
        self.watch(editor, wake);
        self.note(editor);
    }

    pub(super) fn closed(&mut self, editor: &Editor) {
        self.noted = editor.document();
        self.recovery.note(None);
        self.disk = None;
        self.is_open = false;
        self.changed_on_disk = false;
        self.said_not_kept = false;
    }

    /// Nothing is left to recover.
    pub(super) fn saved(&mut self, editor: &Editor) {
        self.noted = editor.document();
        self.recovery.note(None);
        self.recovery.keep();
        self.changed_on_disk = false;
    }

    pub(super) fn saved_elsewhere(&mut self, editor: &Editor, wake: Wake) {
        self.watch(editor, wake);
        self.saved(editor);
    }

    /// Once a frame: notices what happened on the disk, and has edits kept for recovery.
    pub(super) fn update(&mut self, editor: &Editor) {
        if self.disk.as_ref().is_some_and(DiskWatch::take_written) {
            self.changed_on_disk = editor.changed_on_disk();
        }
        if !Arc::ptr_eq(&self.noted, &editor.document()) {
            self.note(editor);
            self.recovery.keep();
        }
    }

    fn watch(&mut self, editor: &Editor, wake: Wake) {
        self.disk = Some(DiskWatch::new(editor.path().to_owned(), wake));
    }

    fn note(&mut self, editor: &Editor) {
        self.noted = editor.document();
        self.recovery.note(editor.is_dirty().then(|| self.noted.clone()));
    }
}
