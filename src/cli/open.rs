//! `firstbounce open SET`

use clap::Args;

use super::SetArgs;
use crate::app::{self, Start};

#[derive(Args, Debug)]
pub struct OpenArgs {
    #[command(flatten)]
    set: SetArgs,
}

/// Runs the command.
pub fn run(args: OpenArgs) -> anyhow::Result<()> {
    app::run(Start::Set(args.set.path))
}
