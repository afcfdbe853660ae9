//! Capture warnings in words and numbers.

use serde::Serialize;

use crate::pipeline::{CaptureReport, CaptureWarning};

/// One capture warning.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CaptureWarningRecord {
    /// What is wrong, in one word.
    pub kind: &'static str,
    /// The lights that it is about; none where it is about all.
    pub lights: Vec<String>,
    /// The files that it is about, as the capture file writes them.
    pub files: Vec<String>,
    /// One line: what, the number that proves it, what to do.
    pub words: String,
}

impl CaptureWarningRecord {
    /// Of every warning, the worst first.
    pub fn all(captures: &CaptureReport) -> Vec<Self> {
        let record = |warning: &CaptureWarning| Self {
            kind: warning.kind(),
            lights: warning.lights(),
            files: warning.files(),
            words: warning.to_string(),
        };
        captures.warnings.iter().map(record).collect()
    }
}
