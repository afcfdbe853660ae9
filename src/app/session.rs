//! Everything that panels, views and commands may reach: the document, its results, and what goes on around them.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use firstbounce_capture::WriteError;
use firstbounce_capture::set::{FILE_NAME, Location, Problem};

use super::commands::CommandId;
use super::dialogs::Dialogs;
use super::document::{DiskWatch, Document, Editor, Recovered, Recovery};
use super::jobs::{Jobs, Wake};
use super::log::{Level, Log};
use super::panels::PanelName;
use super::preferences::{Folders, Preferences};
use super::reference::Reference;
use super::results::{Next, Results};
use super::surface::Surfaces;
use super::views::{Shown, Views};

/// Where a set comes from that is to be opened.
#[derive(Clone, Debug, PartialEq)]
pub enum Open {
    /// A set on the disk: its folder or its capture.toml.
    Set(PathBuf),
    /// The demo set.
    Demo,
    /// A folder without a capture.toml: a new set of the pictures in it.
    New(PathBuf),
    /// An unsaved document of an earlier run, and the folder that keeps it.
    Recovered(PathBuf, Box<Recovered>),
}

impl Open {
    /// The set's folder.
    fn folder(&self, folders: &Folders) -> PathBuf {
        let path = match self {
            Self::Set(path) | Self::New(path) => path,
            Self::Demo => &folders.demo,
            Self::Recovered(_, kept) => &kept.path,
        };
        let is_file = path.is_file() || path.ends_with(FILE_NAME);
        path.parent().filter(|_| is_file).unwrap_or(path).to_owned()
    }
}

/// An open set and everything around it.
pub struct Session {
    /// What is computed from the document.
    pub results: Results,
    /// Work off the UI thread.
    pub jobs: Jobs,
    /// The tiles in the centre.
    pub views: Views,
    /// What the 3D views among them show.
    pub surfaces: Surfaces,
    /// The scan that the surface is compared with.
    pub reference: Reference,
    /// Lines and toasts.
    pub log: Log,
    /// What is remembered between runs.
    pub preferences: Preferences,
    /// The step whose panel is open.
    pub panel: PanelName,
    pub(super) editor: Editor,
    pub(super) recovery: Recovery,
    pub(super) folders: Folders,
    dialogs: Arc<dyn Dialogs>,
    disk: Option<DiskWatch>,
    is_open: bool,
    /// Counts the sets that were opened: panels begin anew with each.
    pub(super) opened: u64,
    /// Whether it is noted that a set is being opened.
    is_opening: bool,
    requests: Vec<CommandId>,
    /// The document that recovery knows.
    noted: Arc<Document>,
    pub(super) changed_on_disk: bool,
    /// Whether it was said that nothing is kept beside this set.
    said_not_kept: bool,
}

impl Session {
    /// Without a set.
    pub fn new(folders: Folders, dialogs: Arc<dyn Dialogs>, wake: Wake) -> Self {
        Self {
            results: Results::default(),
            jobs: Jobs::new(wake),
            views: Views::default(),
            surfaces: Surfaces::default(),
            reference: Reference::default(),
            log: Log::default(),
            preferences: Preferences::read(&folders.preferences),
            panel: PanelName::Captures,
            editor: Editor::default(),
            recovery: Recovery::new(folders.recovery.clone()),
            folders,
            dialogs,
            disk: None,
            is_open: false,
            opened: 0,
            is_opening: false,
            requests: Vec::new(),
            noted: Arc::default(),
            changed_on_disk: false,
            said_not_kept: false,
        }
    }

    /// Whether a set is open; without one the window shows where to begin.
    pub fn is_open(&self) -> bool {
        self.is_open
    }

    /// The document as it is now; cheap to keep for a frame.
    pub fn document(&self) -> Arc<Document> {
        self.editor.document()
    }

    /// Changes the document under a name that the undo menu shows: "Move grey ball". Edits of one name within one drag, or
    /// while one field has the focus, are undone together.
    pub fn edit(&mut self, name: &str, change: impl FnOnce(&mut Document)) {
        self.editor.edit(name, change);
    }

    /// Shows a photo of the set, as when it is opened: for photos that come into a set without any.
    pub fn show_first_photo(&mut self) {
        let first = first_view(&self.document());
        self.views.show(first);
    }

    /// Everything that keeps the set from being solved.
    pub fn problems(&self) -> &[Problem] {
        self.editor.problems()
    }

    /// The problems of one part of the set: of a shot's cell, for instance.
    pub fn problems_at(&self, location: Location) -> impl Iterator<Item = &Problem> {
        self.editor.problems().iter().filter(move |problem| problem.location == location)
    }

    /// The system's file dialogs; they wait for a person, so ask in a job, or use a `PathField`.
    pub fn dialogs(&self) -> Arc<dyn Dialogs> {
        self.dialogs.clone()
    }

    /// Tells that something was done, and shows it for a while.
    pub fn done(&mut self, text: impl Into<String>) {
        self.log.toast(Level::Done, text);
    }

    /// Tells what to know before trusting a number.
    pub fn warn(&mut self, text: impl Into<String>) {
        self.log.toast(Level::Warning, text);
    }

    /// Tells that something was not done, and what to do.
    pub fn error(&mut self, text: impl Into<String>) {
        self.log.toast(Level::Error, text);
    }

    /// Runs a command after this frame's panels.
    pub fn request(&mut self, command: CommandId) {
        self.requests.push(command);
    }

    pub(super) fn take_requests(&mut self) -> Vec<CommandId> {
        std::mem::take(&mut self.requests)
    }

    /// Opens a set in place of the one that is open, whose unsaved edits are lost: ask first, by `Chrome::open_set`.
    pub fn open(&mut self, open: Open) {
        // Noted before anything of it is read: what ends this run is not opened by the next one without asking.
        self.recovery.note_opening(&open.folder(&self.folders));
        let opened = match &open {
            Open::Set(path) => Editor::open(path).map_err(|error| error.to_string()),
            Open::Demo => self.open_demo(),
            Open::New(folder) => Ok(Editor::untitled(folder)),
            Open::Recovered(_, kept) => Ok(Editor::recovered(&kept.text, kept.path.clone(), kept.settings.clone())),
        };
        match opened {
            Ok(editor) => self.take(editor),
            Err(line) => {
                if self.is_opening {
                    self.recovery.note_opening(&self.document().set.folder);
                } else {
                    self.recovery.opened_well();
                }
                return self.error(line);
            }
        }
        if let Open::Recovered(folder, _) = &open {
            // Only what this run keeps may be forgotten there.
            super::document::save_everything_now();
            self.recovery.discard(folder);
        }
    }

    fn open_demo(&self) -> Result<Editor, String> {
        let folder = &self.folders.demo;
        if !folder.join("capture.toml").is_file() {
            crate::cli::unpack_demo(folder).map_err(|error| format!("{error:#}"))?;
        }
        Editor::open(folder).map_err(|error| error.to_string())
    }

    fn take(&mut self, editor: Editor) {
        self.close();
        self.is_opening = true;
        self.editor = editor;
        self.noted = self.document();
        self.recovery.note(self.editor.is_dirty().then(|| self.noted.clone()));
        self.is_open = true;
        self.opened += 1;
        let document = self.document();
        let folder = &document.set.folder;
        self.preferences.opened(folder);
        self.remember();
        self.views = super::document::read_view(folder, "layout")
            .and_then(Views::from_json)
            .unwrap_or_else(|| Views::showing(first_view(&document)));
        self.disk = Some(DiskWatch::new(self.editor.path().to_owned(), self.jobs.wake()));
        self.panel = PanelName::Captures;
        self.say_not_kept(super::document::kept_view(folder).err());
        // A set that has just begun lacks everything, which nobody needs to be told.
        let problems = if self.editor.path().is_file() { self.editor.problems().len() } else { 0 };
        let title = document.set.title();
        match problems {
            0 => self.log.add(Level::Done, format!("Opened {title}")),
            1 => self.warn(format!("{title}: 1 problem; it is shown where it is, in Captures and Calibrate")),
            _ => self.warn(format!("{title}: {problems} problems; they are shown where they are")),
        }
    }

    /// What the open set gave was drawn, or the program ends in order: nothing of the set ends the next run.
    pub(super) fn opened_well(&mut self) {
        if std::mem::take(&mut self.is_opening) {
            self.recovery.opened_well();
        }
    }

    /// Leaves the set for the start screen, and the next run begins there.
    pub fn leave(&mut self) {
        self.close();
        self.opened_well();
        self.preferences.last_open = None;
        self.remember();
    }

    /// The next run does not begin with this set by itself; it stays among the recent ones.
    pub(super) fn forget_last_open(&mut self, folder: &Path) {
        if self.preferences.last_open.as_deref() == Some(folder) {
            self.preferences.last_open = None;
            self.remember();
        }
    }

    /// Leaves the set; its arrangement of views is kept beside it.
    fn close(&mut self) {
        self.keep_layout();
        self.results.clear();
        self.editor = Editor::default();
        self.noted = self.editor.document();
        self.recovery.note(None);
        self.disk = None;
        self.is_open = false;
        self.changed_on_disk = false;
        self.said_not_kept = false;
        self.views = Views::default();
        self.surfaces = Surfaces::default();
        self.reference = Reference::default();
    }

    /// Keeps the arrangement of views beside the set. A folder that cannot be written keeps none: nothing is lost.
    pub(super) fn keep_layout(&self) {
        let folder = &self.document().set.folder;
        if self.is_open && self.editor.path().is_file() {
            let _ = super::document::write_view(folder, "layout", self.views.to_json());
        }
    }

    /// Says once for a set why the window's settings and views are not kept beside it.
    fn say_not_kept(&mut self, reason: Option<WriteError>) {
        if let Some(reason) = reason.filter(|_| !self.said_not_kept) {
            self.said_not_kept = true;
            self.log.add(Level::Warning, format!("how the window shows and solves this set is not kept: {reason}"));
        }
    }

    /// Writes the preferences; a system that keeps none is told once in the log.
    pub fn remember(&mut self) {
        if let Err(error) = self.preferences.write(&self.folders.preferences.clone()) {
            self.log.add(Level::Warning, format!("preferences are not kept: {error:#}"));
        }
    }

    /// Saves the document in its file.
    pub fn save(&mut self) {
        match self.editor.save() {
            Ok(not_kept) => {
                self.saved_all();
                self.say_not_kept(not_kept);
                self.keep_layout();
                self.changed_on_disk = false;
                self.done(format!("Saved {}", self.editor.path().display()));
            }
            Err(error) => self.error(error.to_string()),
        }
    }

    /// Nothing is left to recover.
    fn saved_all(&mut self) {
        self.noted = self.document();
        self.recovery.note(None);
        self.recovery.keep();
    }

    /// Saves the document into another folder, whose set it is from now on.
    pub fn save_as(&mut self, folder: &Path) {
        match self.editor.save_as(folder) {
            Ok(not_kept) => {
                self.say_not_kept(not_kept);
                self.disk = Some(DiskWatch::new(self.editor.path().to_owned(), self.jobs.wake()));
                self.saved_all();
                self.preferences.opened(folder);
                self.remember();
                self.keep_layout();
                self.changed_on_disk = false;
                self.done(format!("Saved {}", self.editor.path().display()));
            }
            Err(error) => self.error(error.to_string()),
        }
    }

    /// Reads capture.toml anew; undo brings back what was there before.
    pub fn reload_from_disk(&mut self) {
        match self.editor.reload() {
            Ok(()) => {
                self.changed_on_disk = false;
                self.done("Reloaded capture.toml");
            }
            Err(error) => self.error(error.to_string()),
        }
    }

    /// What another program wrote is replaced at the next save.
    pub fn keep_mine(&mut self) {
        self.editor.ignore_change_on_disk();
        self.changed_on_disk = false;
    }

    /// Once a frame: takes finished work, starts what is stale, notices what happened on the disk.
    pub(super) fn update(&mut self) -> Next {
        if !self.is_open {
            return Next::Rest;
        }
        if self.disk.as_ref().is_some_and(DiskWatch::take_written) {
            self.changed_on_disk = self.editor.changed_on_disk();
        }
        self.update_reference();
        let document = self.document();
        if !Arc::ptr_eq(&self.noted, &document) {
            self.noted = document.clone();
            self.recovery.note(self.editor.is_dirty().then(|| document.clone()));
            self.recovery.keep();
        }
        let log = &mut self.log;
        self.results.update(&document, &mut self.jobs, &mut |level, line| log.add(level, line))
    }
}

/// What a set shows first: a photo of it, which is there soonest.
fn first_view(document: &Document) -> Shown {
    let set = &document.set;
    match (set.lights.first(), set.colours.first()) {
        (Some(light), Some(colour)) => Shown::object(&light.name, &colour.name),
        _ => Shown::default(),
    }
}
