//! The system's file dialogs, behind a trait: tests answer in the place of the user.

use std::path::{Path, PathBuf};

use firstbounce_capture::image_file::Format;
use firstbounce_capture::mesh_file::read::MeshFormat;

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

/// Asks the user for a path, and waits for the answer: call it off the UI thread. Empty: cancelled, or this system has no
/// dialog; that is why there is a path field beside every button that asks.
pub trait Dialogs: Send + Sync {
    /// Asks, starting in `near`.
    fn ask(&self, choose: Choose, title: &str, near: &Path) -> Vec<PathBuf>;
}

/// The dialogs of the system.
#[derive(Clone, Copy, Debug, Default)]
pub struct SystemDialogs;

/// The endings of the files that a dialog offers, in small and in capital letters: where a system distinguishes the two, a
/// camera's ".JPG" must not be hidden.
fn endings<'e>(extensions: impl Iterator<Item = &'e str>) -> Vec<String> {
    extensions.flat_map(|extension| [extension.to_owned(), extension.to_uppercase()]).collect()
}

fn picture_endings() -> Vec<String> {
    endings(Format::ALL.iter().flat_map(|format| format.extensions()).copied())
}

impl Dialogs for SystemDialogs {
    fn ask(&self, choose: Choose, title: &str, near: &Path) -> Vec<PathBuf> {
        let mut dialog = rfd::FileDialog::new().set_title(title);
        if near.is_dir() {
            dialog = dialog.set_directory(near);
        }
        match choose {
            Choose::Folder => dialog.pick_folder().into_iter().collect(),
            Choose::Pictures => dialog.add_filter("Pictures", &picture_endings()).pick_files().unwrap_or_default(),
            Choose::Mesh => {
                let meshes = endings(MeshFormat::EXTENSIONS.into_iter());
                dialog.add_filter("Meshes", &meshes).pick_file().into_iter().collect()
            }
            Choose::LightFile => {
                dialog.add_filter("Light files", &endings(["lp", "dome"].into_iter())).pick_file().into_iter().collect()
            }
            Choose::NewFile => dialog.save_file().into_iter().collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dialog_offers_every_picture_that_is_read_in_small_and_capital_letters() {
        let offered = picture_endings();
        let offers = |ending: &str| offered.iter().any(|offered| offered == ending);
        for ending in Format::ALL.iter().flat_map(|format| format.extensions()) {
            assert!(offers(ending) && offers(&ending.to_uppercase()), "{ending} in {offered:?}");
        }
        for ending in ["hdr", "pic", "rgbe", "jpe", "JPG", "TIF"] {
            assert!(offers(ending), "{ending} in {offered:?}");
        }
    }
}
