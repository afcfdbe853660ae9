//! The files that a run was computed from, by their SHA-256: whether a result is of the files that lie there now.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use indexmap::IndexMap;
use rayon::prelude::*;
use serde::Serialize;
use sha2::{Digest, Sha256};

use crate::set::CaptureSet;

/// Read at a time: a file may be larger than the memory.
const CHUNK_BYTES: usize = 1 << 16;

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
        match hashed(path) {
            Ok((sha256, bytes)) => Self { sha256: Some(sha256), bytes: Some(bytes) },
            Err(_) => Self { sha256: None, bytes: None },
        }
    }
}

fn hashed(path: &Path) -> io::Result<(String, u64)> {
    // A pipe would wait for ever.
    if !path.metadata()?.is_file() {
        return Err(io::ErrorKind::InvalidInput.into());
    }
    let mut file = File::open(path)?;
    let (mut hash, mut bytes, mut chunk) = (Sha256::new(), 0, vec![0; CHUNK_BYTES]);
    loop {
        let read = file.read(&mut chunk)?;
        if read == 0 {
            break;
        }
        hash.update(&chunk[..read]);
        bytes += read as u64;
    }
    Ok((hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect(), bytes))
}
