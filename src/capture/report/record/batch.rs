//! What a run among many was asked for: whether its results are those that would come out now.

use indexmap::IndexMap;
use serde::Serialize;
use sha2::{Digest, Sha256};

use super::InputRecord;

/// What a run of many sets was asked for.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct BatchRecord {
    /// SHA-256 of all options, in hexadecimal digits.
    pub options_sha256: String,
    /// Whether beta was taken from the rig too.
    pub same_paint: bool,
    /// The set whose calibration was taken; absent where each has its own.
    pub rig: Option<RigRecord>,
}

/// The set whose calibration was taken.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct RigRecord {
    /// Its name.
    pub name: String,
    /// Its files, by the paths that its capture.toml writes.
    pub inputs: IndexMap<String, InputRecord>,
}

impl BatchRecord {
    /// Of all options in words, and of a rig.
    pub fn new(options: &str, rig: Option<RigRecord>, same_paint: bool) -> Self {
        let hash = Sha256::digest(options.as_bytes());
        let options_sha256 = hash.iter().map(|byte| format!("{byte:02x}")).collect();
        Self { options_sha256, same_paint, rig }
    }
}
