//! What a stage costs: time and memory.

use std::path::Path;
use std::time::Instant;

use serde::Serialize;

use super::Stage;
use crate::open::read_text;

/// The cost of one stage of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StageCost {
    /// The stage's name.
    pub stage: &'static str,
    /// Wall-clock seconds.
    pub seconds: f64,
    /// The most memory that the process had held by the end of the stage; absent where the system does not tell.
    pub peak_rss_bytes: Option<u64>,
}

impl StageCost {
    /// Runs `work` and notes its cost in `costs`.
    pub fn measure<T>(costs: &mut Vec<Self>, stage: Stage, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        let seconds = start.elapsed().as_secs_f64();
        match costs.iter_mut().find(|cost| cost.stage == stage.name()) {
            Some(cost) => {
                cost.seconds += seconds;
                cost.peak_rss_bytes = peak_rss_bytes();
            }
            None => costs.push(Self { stage: stage.name(), seconds, peak_rss_bytes: peak_rss_bytes() }),
        }
        result
    }
}

/// The most memory that this process has held, in bytes; `None` where the system does not tell (Linux does).
pub fn peak_rss_bytes() -> Option<u64> {
    let status = read_text(Path::new("/proc/self/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes * 1024)
}
