//! Results that need not be computed again.

use std::path::Path;

use serde::Serialize;
use serde_json::Value;

use super::names::{REPORT, is_result_name};
use crate::atomic::is_plain_file;
use crate::open::read_text;
use crate::report::{BatchRecord, input_records, program};
use crate::set::CaptureSet;

/// The report in `folder`, if its results are those that the program would compute of `set` now: by the same version, of the
/// same files and options, and all of them still there.
pub fn is_finished(set: &CaptureSet, folder: &Path, batch: &BatchRecord) -> Option<Value> {
    let path = folder.join(REPORT);
    if !is_plain_file(&path) {
        return None;
    }
    let report: Value = serde_json::from_str(&read_text(&path).ok()?).ok()?;
    let files = report["files"].as_object()?;
    let is_there = |name: &String| is_result_name(name) && is_plain_file(&folder.join(name));
    let is_same = report["program"] == program().as_str()
        && same(&report["batch"], batch)
        && files.keys().all(is_there)
        && same(&report["inputs"], &input_records(set));
    is_same.then_some(report)
}

fn same(found: &Value, record: &impl Serialize) -> bool {
    serde_json::to_value(record).is_ok_and(|record| record == *found)
}
