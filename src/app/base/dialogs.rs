//! The system's file dialogs, behind a trait: tests answer in the place of a person.

use std::path::{Path, PathBuf};

/// What to choose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Choose {
    /// One folder.
    Folder,
    /// One or more pictures.
    Pictures,
    /// A mesh file.
    Mesh,
    /// A light file.
    LightFile,
    /// A file to be written.
    NewFile,
}

/// Asks a person for a path, and waits for the answer: call it off the UI thread. Empty: cancelled, or this system has no
/// dialog; that is why there is a path field beside every button that asks.
pub trait Dialogs: Send + Sync {
    /// Asks, starting in `near`.
    fn ask(&self, choose: Choose, title: &str, near: &Path) -> Vec<PathBuf>;
}

/// The dialogs of the system.
#[derive(Clone, Copy, Debug, Default)]
pub struct SystemDialogs;

const PICTURES: [&str; 7] = ["png", "jpg", "jpeg", "tif", "tiff", "exr", "pfm"];

const MESHES: [&str; 3] = ["obj", "ply", "stl"];

impl Dialogs for SystemDialogs {
    fn ask(&self, choose: Choose, title: &str, near: &Path) -> Vec<PathBuf> {
        let mut dialog = rfd::FileDialog::new().set_title(title);
        if near.is_dir() {
            dialog = dialog.set_directory(near);
        }
        match choose {
            Choose::Folder => dialog.pick_folder().into_iter().collect(),
            Choose::Pictures => dialog.add_filter("Pictures", &PICTURES).pick_files().unwrap_or_default(),
            Choose::Mesh => dialog.add_filter("Meshes", &MESHES).pick_file().into_iter().collect(),
            Choose::LightFile => dialog.add_filter("Light files", &["lp"]).pick_file().into_iter().collect(),
            Choose::NewFile => dialog.save_file().into_iter().collect(),
        }
    }
}
