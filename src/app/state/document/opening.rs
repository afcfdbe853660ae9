//! The note that a set is being opened: what stands there after a run that did not end in order may have ended it.

use std::fs;
use std::path::{Path, PathBuf};

use firstbounce_capture::atomic::write_file;
use firstbounce_capture::open::read_text;
use serde::{Deserialize, Serialize};

use super::Recovery;

const NOTE: &str = "opening.json";

/// What a run notes before it opens a set.
#[derive(Debug, Serialize, Deserialize)]
struct Note {
    /// The set's folder.
    set: PathBuf,
}

/// A set whose opening an earlier run did not bring to an end.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LeftOpening {
    /// The set's folder.
    pub set: PathBuf,
    /// What that run left behind.
    pub run: PathBuf,
}

impl Recovery {
    /// Notes that the set in `folder` is being opened. Where nothing can be noted it is opened all the same.
    pub fn note_opening(&self, folder: &Path) {
        let set = std::path::absolute(folder).unwrap_or_else(|_| folder.to_owned());
        if let Ok(text) = serde_json::to_vec(&Note { set }) {
            let _ = write_file(&self.folder.join(NOTE), &text);
        }
    }

    /// Takes the note back: the set was opened, computed and drawn, or left in order.
    pub fn opened_well(&self) {
        // A note that stays makes the next run ask once more than needed.
        let _ = fs::remove_file(self.folder.join(NOTE));
    }

    /// The sets whose opening earlier runs did not bring to an end, runs that still live left out.
    pub fn left_opening(&self) -> Vec<LeftOpening> {
        let read = |run: PathBuf| {
            let Note { set } = serde_json::from_str(&read_text(&run.join(NOTE)).ok()?).ok()?;
            Some(LeftOpening { set, run })
        };
        self.abandoned().filter_map(read).collect()
    }

    /// Forgets that an earlier run was opening a set; the document that it kept stays.
    pub fn forget_opening(&self, left: &LeftOpening) {
        self.forget(&left.run, NOTE);
    }
}
