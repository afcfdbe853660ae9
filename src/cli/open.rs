//! `firstbounce open SET`

use clap::Args;

use super::{SetArgs, window};

#[derive(Args, Debug)]
pub struct OpenArgs {
    #[command(flatten)]
    set: SetArgs,
}

/// Runs the command.
pub fn run(args: OpenArgs) -> anyhow::Result<()> {
    window::open(Some(args.set.path))
}
