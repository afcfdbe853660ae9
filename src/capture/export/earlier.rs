//! What lies in the folder already: an earlier run's files, and a person's.

use std::collections::HashSet;
use std::fs;
use std::path::{Component, Path, PathBuf};
use std::time::SystemTime;

use serde_json::Value;

use crate::atomic::{OutputFolder, WriteError};
use crate::set::CaptureSet;

/// What an earlier run wrote, by its `report.json`.
#[derive(Default)]
pub struct Earlier {
    files: HashSet<String>,
    written: Option<SystemTime>,
}

impl Earlier {
    /// What lies in `folder`; nothing where no report of this program does.
    pub fn of(folder: &Path) -> Self {
        let report = folder.join("report.json");
        let text = fs::read_to_string(&report).unwrap_or_default();
        let words: Value = serde_json::from_str(&text).unwrap_or_default();
        if !words["program"].as_str().is_some_and(|program| program.starts_with("Firstbounce ")) {
            return Self::default();
        }
        let names = words["files"].as_object().into_iter().flatten().map(|(name, _)| name.clone());
        let inside = |name: &String| Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
        Self { files: names.filter(inside).collect(), written: modified(&report) }
    }

    /// Makes sure that no file of a person is replaced: neither one that no run wrote, nor a photo of the set itself.
    pub fn check<'a>(
        &self,
        set: &CaptureSet,
        folder: &OutputFolder,
        names: impl Iterator<Item = &'a String>,
    ) -> Result<(), WriteError> {
        let of_set: HashSet<PathBuf> = set_files(set).filter_map(|path| path.canonicalize().ok()).collect();
        for name in names {
            let path = folder.target().join(name);
            let Ok(there) = path.canonicalize() else { continue };
            if !self.files.contains(name) || of_set.contains(&there) {
                return Err(WriteError::NotOurs { path });
            }
        }
        Ok(())
    }

    /// Has the commit take away what the earlier run wrote and this one does not: a mesh of a format that is no longer
    /// wanted would show another surface than the report. What was changed since is somebody's work and stays.
    pub fn retire(&self, folder: &mut OutputFolder) {
        let untouched = |name: &&String| modified(&folder.target().join(name)) <= self.written;
        let retired: Vec<_> = self.files.iter().filter(untouched).cloned().collect();
        retired.into_iter().for_each(|name| folder.retire(name));
    }
}

fn set_files(set: &CaptureSet) -> impl Iterator<Item = PathBuf> {
    let photos = set.distinct_files().into_keys().map(|file| set.resolve(file)).collect::<Vec<_>>();
    let mask = set.mask.as_deref().map(|mask| set.resolve(mask));
    photos.into_iter().chain(mask).chain([set.file_path(), set.truth_normals(), set.truth_depth()])
}

fn modified(path: &Path) -> Option<SystemTime> {
    path.metadata().ok()?.modified().ok()
}
