//! What an earlier run left in the folder.

use std::fs;
use std::path::{Component, Path};

use serde_json::Value;

use crate::atomic::OutputFolder;

/// Has the commit take away what an earlier run's `report.json` names and this run does not write: a mesh of a format that
/// is no longer wanted would show another surface than the report. What was changed since that run is somebody's work and
/// stays.
pub fn retire_earlier(folder: &mut OutputFolder) {
    let target = folder.target().to_owned();
    let report = target.join("report.json");
    let Some(written) = modified(&report) else { return };
    let text = fs::read_to_string(&report).unwrap_or_default();
    let Ok(report) = serde_json::from_str::<Value>(&text) else { return };
    if !report["program"].as_str().is_some_and(|program| program.starts_with("Firstbounce ")) {
        return;
    }
    let files = report["files"].as_object().into_iter().flatten().map(|(name, _)| name);
    let inside = |name: &&String| Path::new(name).components().all(|part| matches!(part, Component::Normal(_)));
    let untouched = |name: &&String| modified(&target.join(name)).is_some_and(|since| since <= written);
    files.filter(inside).filter(untouched).for_each(|name| folder.retire(name));
}

fn modified(path: &Path) -> Option<std::time::SystemTime> {
    path.metadata().ok()?.modified().ok()
}
