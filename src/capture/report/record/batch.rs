//! What a run among many was asked for: whether its results are those that would come out now.

use indexmap::IndexMap;
use serde::Serialize;
use sha2::{Digest, Sha256};

use super::InputRecord;
use crate::pipeline::PipelineError;

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
    /// Of how sets are solved and results written, all of it, and of a rig.
    ///
    /// # Errors
    /// Options that have no words in JSON, as numbers that are not finite have none.
    pub fn new(options: &impl Serialize, rig: Option<RigRecord>, same_paint: bool) -> Result<Self, PipelineError> {
        let options = serde_json::to_vec(options).map_err(PipelineError::Json)?;
        let hash = Sha256::digest(&options);
        let options_sha256 = hash.iter().map(|byte| format!("{byte:02x}")).collect();
        Ok(Self { options_sha256, same_paint, rig })
    }
}
