//! The files that a run was computed from, by their SHA-256: whether a result is of the files that lie there now.

use std::path::Path;

use indexmap::IndexMap;
use rayon::prelude::*;
use serde::Serialize;

use crate::open::hash_file;
use crate::set::CaptureSet;

/// A file that was read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct InputRecord {
    /// Of its content, in hexadecimal digits; absent where it cannot be read any more.
    pub sha256: Option<String>,
    /// How long it is.
    pub bytes: Option<u64>,
}

/// The capture file, the photos and the mask of a set, by the paths that the capture file writes.
pub fn input_records(set: &CaptureSet) -> IndexMap<String, InputRecord> {
    let own = set.written(&set.file_path());
    let photos = set.distinct_files().into_keys().map(str::to_owned);
    let names: Vec<String> = [own].into_iter().chain(set.mask.clone()).chain(photos).collect();
    names
        .into_par_iter()
        .map(|name| (name.clone(), InputRecord::of(&set.resolve(&name))))
        .collect::<Vec<_>>()
        .into_iter()
        .collect()
}

impl InputRecord {
    fn of(path: &Path) -> Self {
        match hash_file(path) {
            Ok((sha256, bytes)) => Self { sha256: Some(sha256), bytes: Some(bytes) },
            Err(_) => Self { sha256: None, bytes: None },
        }
    }
}
