//! What lies in the folder already: an earlier run's files, and the user's.

use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use serde_json::Value;

use super::names::{REPORT, is_result_name};
use crate::atomic::{WriteError, is_plain_file};
use crate::open::read_text;
use crate::set::CaptureSet;

/// What an earlier run wrote, by its `report.json`. The folder may have come with a set, and the report say anything.
#[derive(Default)]
pub struct Earlier {
    files: HashSet<String>,
    written: Option<SystemTime>,
}

impl Earlier {
    /// What lies in `folder`; nothing where no report of this program does.
    pub fn of(folder: &Path) -> Self {
        let report = folder.join(REPORT);
        if !is_plain_file(&report) {
            return Self::default();
        }
        let text = read_text(&report).unwrap_or_default();
        let words: Value = serde_json::from_str(&text).unwrap_or_default();
        if !words["program"].as_str().is_some_and(|program| program.starts_with("Firstbounce ")) {
            return Self::default();
        }
        let names = words["files"].as_object().into_iter().flatten().map(|(name, _)| name.clone());
        Self { files: names.filter(|name| is_result_name(name)).collect(), written: modified(&report) }
    }

    /// Makes sure that no file of the user is replaced: neither one that no run wrote, nor a photo of the set itself.
    pub fn check<'a>(
        &self,
        set: &CaptureSet,
        folder: &Path,
        names: impl Iterator<Item = &'a String>,
    ) -> Result<(), WriteError> {
        let of_set: HashSet<PathBuf> = set_files(set).filter_map(|path| path.canonicalize().ok()).collect();
        for name in names {
            let path = folder.join(name);
            let Ok(there) = path.canonicalize() else { continue };
            if !self.files.contains(name) || of_set.contains(&there) {
                return Err(WriteError::NotOurs { path });
            }
        }
        Ok(())
    }

    /// What the earlier run wrote, to be taken away where this one does not write it: a mesh of a format that is no longer
    /// wanted would show another surface than the report. What was changed since is the user's work and stays.
    pub fn untouched(&self, folder: &Path) -> Vec<String> {
        let untouched = |name: &&String| modified(&folder.join(name)) <= self.written;
        self.files.iter().filter(untouched).cloned().collect()
    }
}

fn set_files(set: &CaptureSet) -> impl Iterator<Item = PathBuf> {
    let photos = set.distinct_files().into_keys().map(|file| set.resolve(file)).collect::<Vec<_>>();
    let mask = set.mask.as_deref().map(|mask| set.resolve(mask));
    photos.into_iter().chain(mask).chain([set.file_path(), set.truth_normals(), set.truth_depth()])
}

fn modified(path: &Path) -> Option<SystemTime> {
    path.symlink_metadata().ok()?.modified().ok()
}
