//! The session: everything that panels, views and commands may reach.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use firstbounce_capture::WriteError;
use firstbounce_capture::set::{FILE_NAME, Location, Problem, SetError};
use thiserror::Error;

use super::document::{Document, Editor, Recovered, kept_view, read_view, save_everything_now, write_view};
use super::file::SetFile;
use super::layout::Views;
use super::log::{Level, Log};
use super::panel::PanelName;
use super::preferences::{Folders, Preferences};
use super::reference::Reference;
use super::results::{Next, Results};
use super::surfaces::{LayerName, Surfaces};
use crate::app::base::dialogs::Dialogs;
use crate::app::base::jobs::{Jobs, Wake};
use crate::demo;

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

/// Why a set was not opened.
#[derive(Debug, Error)]
enum OpenError {
    #[error(transparent)]
    Set(#[from] SetError),
    /// The demo could not be written.
    #[error(transparent)]
    Demo(#[from] WriteError),
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
    /// Whether a command asked for the results to be written.
    pub export_asked: bool,
    pub(in crate::app) editor: Editor,
    pub(in crate::app) file: SetFile,
    system: System,
}

/// What the system provides: folders of this program's own, and file dialogs.
struct System {
    folders: Folders,
    dialogs: Arc<dyn Dialogs>,
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
            export_asked: false,
            editor: Editor::default(),
            file: SetFile::new(&folders),
            system: System { folders, dialogs },
        }
    }

    /// Whether a set is open; without one the window shows where to begin.
    pub fn is_open(&self) -> bool {
        self.file.is_open()
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

    /// Everything that keeps the set from being solved.
    pub fn problems(&self) -> &[Problem] {
        self.editor.problems()
    }

    /// The problems of one part of the set: of a shot's cell, for instance.
    pub fn problems_at(&self, location: Location) -> impl Iterator<Item = &Problem> {
        self.editor.problems().iter().filter(move |problem| problem.location == location)
    }

    /// The system's file dialogs; they wait for the user: ask in a job, or use a `PathField`.
    pub fn dialogs(&self) -> Arc<dyn Dialogs> {
        self.system.dialogs.clone()
    }

    /// Reports that something was done, and shows it for a while.
    pub fn done(&mut self, text: impl Into<String>) {
        self.log.toast(Level::Done, text);
    }

    /// Reports what to know before trusting a number.
    pub fn warn(&mut self, text: impl Into<String>) {
        self.log.toast(Level::Warning, text);
    }

    /// Reports that something was not done, and what to do.
    pub fn error(&mut self, text: impl Into<String>) {
        self.log.toast(Level::Error, text);
    }

    /// The program's own folders.
    pub fn folders(&self) -> &Folders {
        &self.system.folders
    }

    /// Opens a set in place of the one that is open, whose unsaved edits are lost: ask first, by `Chrome::open_set`.
    pub fn open(&mut self, open: Open) {
        // Noted before anything of it is read: what ends this run is not opened by the next one without asking.
        self.file.opening(&open.folder(&self.system.folders));
        let opened = match &open {
            Open::Set(path) => Editor::open(path).map_err(OpenError::from),
            Open::Demo => self.open_demo(),
            Open::New(folder) => Ok(Editor::untitled(folder)),
            Open::Recovered(_, kept) => Ok(Editor::recovered(&kept.text, kept.path.clone(), kept.settings.clone())),
        };
        match opened {
            Ok(editor) => {
                self.take(editor);
                if matches!(open, Open::Demo) {
                    // What the program does is told best by what comes out.
                    self.panel = PanelName::Shape;
                }
            }
            Err(error) => {
                self.file.opening_failed(&self.editor);
                return self.error(error.to_string());
            }
        }
        if let Open::Recovered(folder, _) = &open {
            // Only what this run keeps may be forgotten there.
            save_everything_now();
            self.file.recovery.discard(folder);
        }
    }

    fn open_demo(&self) -> Result<Editor, OpenError> {
        let folder = &self.system.folders.demo;
        if !folder.join("capture.toml").is_file() {
            demo::unpack(folder)?;
        }
        Ok(Editor::open(folder)?)
    }

    fn take(&mut self, editor: Editor) {
        self.close();
        self.editor = editor;
        self.file.opened(&self.editor, self.jobs.wake());
        let document = self.document();
        let folder = &document.set.folder;
        self.preferences.opened(folder);
        self.remember();
        self.panel = PanelName::Captures;
        self.views = read_view(folder, "layout").and_then(Views::from_json).unwrap_or_default();
        self.views.turn_to(self.panel, &document);
        self.say_not_kept(kept_view(folder).err());
        // A set that has just begun lacks everything, which is no news.
        let problems = if self.editor.path().is_file() { self.editor.problems().len() } else { 0 };
        let title = document.set.title();
        match problems {
            0 => self.log.add(Level::Done, format!("Opened {title}")),
            1 => self.warn(format!("{title}: 1 problem; it is shown where it is, in Captures and Calibrate")),
            _ => self.warn(format!("{title}: {problems} problems; they are shown where they are")),
        }
    }

    /// Leaves the set for the start screen, and the next run begins there.
    pub fn leave(&mut self) {
        self.close();
        self.file.opened_well();
        self.preferences.last_open = None;
        self.remember();
    }

    /// The next run does not begin with this set by itself; it stays among the recent ones.
    pub(in crate::app) fn forget_last_open(&mut self, folder: &Path) {
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
        self.file.closed(&self.editor);
        self.views = Views::default();
        self.surfaces = Surfaces::default();
        self.reference = Reference::default();
    }

    /// Keeps the arrangement of views beside the set. A folder that cannot be written keeps none: nothing is lost.
    pub(in crate::app) fn keep_layout(&self) {
        let folder = &self.document().set.folder;
        if self.is_open() && self.editor.path().is_file() {
            let _ = write_view(folder, "layout", self.views.to_json());
        }
    }

    /// Says once for a set why the window's settings and views are not kept beside it.
    fn say_not_kept(&mut self, reason: Option<WriteError>) {
        if let Some(reason) = reason.filter(|_| !std::mem::replace(&mut self.file.said_not_kept, true)) {
            self.log.add(Level::Warning, format!("how the window shows and solves this set is not kept: {reason}"));
        }
    }

    /// Writes the preferences; a system that keeps none is reported once in the log.
    pub fn remember(&mut self) {
        if let Err(error) = self.preferences.write(&self.system.folders.preferences) {
            self.log.add(Level::Warning, format!("preferences are not kept: {error:#}"));
        }
    }

    /// Saves the document in its file.
    pub fn save(&mut self) {
        match self.editor.save() {
            Ok(not_kept) => {
                self.file.saved(&self.editor);
                self.say_not_kept(not_kept);
                self.keep_layout();
                self.done(format!("Saved {}", self.editor.path().display()));
            }
            Err(error) => self.error(error.to_string()),
        }
    }

    /// Saves the document into another folder, whose set it is from now on.
    pub fn save_as(&mut self, folder: &Path) {
        match self.editor.save_as(folder) {
            Ok(not_kept) => {
                self.file.saved_elsewhere(&self.editor, self.jobs.wake());
                self.say_not_kept(not_kept);
                self.preferences.opened(folder);
                self.remember();
                self.keep_layout();
                self.done(format!("Saved {}", self.editor.path().display()));
            }
            Err(error) => self.error(error.to_string()),
        }
    }

    /// Reads capture.toml again; undo brings back what was there before.
    pub fn reload_from_disk(&mut self) {
        match self.editor.reload() {
            Ok(()) => {
                self.file.changed_on_disk = false;
                self.done("Reloaded capture.toml");
            }
            Err(error) => self.error(error.to_string()),
        }
    }

    /// What another program wrote is replaced at the next save.
    pub fn keep_mine(&mut self) {
        self.editor.ignore_change_on_disk();
        self.file.changed_on_disk = false;
    }

    /// Makes ready what 3D views show. Once a frame for as long as one is on the screen.
    pub fn update_surfaces(&mut self) {
        let (document, results, reference) = (self.document(), &self.results, &self.reference);
        let mesh = |name: LayerName| match name {
            LayerName::Surface(name) => results.mesh(name, &document),
            LayerName::Reference => reference.mesh(),
        };
        self.surfaces.update(mesh, &mut self.jobs);
    }

    /// Once a frame: takes finished work, starts what is stale, notices what happened on the disk.
    pub(in crate::app) fn update(&mut self) -> Next {
        if !self.is_open() {
            return Next::Rest;
        }
        self.update_reference();
        self.file.update(&self.editor);
        let document = self.document();
        self.views.turn_to(self.panel, &document);
        let log = &mut self.log;
        self.results.update(&document, &mut self.jobs, &mut |level, line| log.add(level, line))
    }
}
