//! `firstbounce decode-picture`: what the program starts itself as for a picture that must not be decoded in its process.

use clap::Args;
use firstbounce_capture::image_file::{DecodeLimits, decode_for_parent};

/// The picture comes in by standard input, its planes leave by standard output.
#[derive(Args, Debug)]
pub struct DecodeArgs {
    /// The most memory that may be mapped
    memory_bytes: u64,
    /// The most seconds that may be computed
    seconds: u64,
    /// The layer of a layered EXR
    #[arg(long)]
    layer: Option<String>,
    /// Only the size of a camera raw file, and what it says of itself
    #[arg(long)]
    facts: bool,
}

pub fn run(args: &DecodeArgs) -> anyhow::Result<()> {
    limit(DecodeLimits { memory_bytes: args.memory_bytes, seconds: args.seconds });
    decode_for_parent(args.layer.as_deref(), args.facts, std::io::stdin().lock(), std::io::stdout().lock())?;
    Ok(())
}

/// Where a limit is unknown, or a lower one is set, that is what there is.
#[cfg(unix)]
fn limit(limits: DecodeLimits) {
    use rustix::process::{Resource, Rlimit, setrlimit};
    for (resource, most) in [(Resource::As, limits.memory_bytes), (Resource::Cpu, limits.seconds), (Resource::Core, 0)]
    {
        let _ = setrlimit(resource, Rlimit { current: Some(most), maximum: Some(most) });
    }
}

/// The parent's patience is all there is.
#[cfg(not(unix))]
fn limit(_: DecodeLimits) {}
