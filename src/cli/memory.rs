//! How much memory a command may take.

use anyhow::anyhow;
use clap::{Args, value_parser};
use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::{MemoryOptions, Work, check_memory};

#[derive(Args, Debug)]
pub struct MemoryArgs {
    /// The most memory that a run may need [default: what is free]
    #[arg(long, value_name = "MIB", value_parser = value_parser!(u64).range(1..=MAX_LIMIT_MIB))]
    memory_limit: Option<u64>,
}

/// What a number of bytes can count.
const MAX_LIMIT_MIB: u64 = u64::MAX >> 20;

impl MemoryArgs {
    /// Refuses a set that needs more, by the sizes that its pictures state: none of them is decoded before.
    pub fn check(&self, set: &CaptureSet, work: Work) -> anyhow::Result<()> {
        let options = MemoryOptions { limit_bytes: self.memory_limit.map(|mebibytes| mebibytes << 20) };
        check_memory(set, work, &options).map(drop).map_err(|shortage| {
            anyhow!("{shortage}: close other programs, crop the photos, or raise the limit with --memory-limit MIB")
        })
    }
}
