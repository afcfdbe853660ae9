//! `firstbounce demo`

use std::path::PathBuf;

use clap::Args;
use firstbounce_capture::CaptureSet;
use firstbounce_capture::export::OutputOptions;
use firstbounce_capture::pipeline::SolveOptions;

use super::progress::Terminal;
use super::solve::{default_place, solve_into, summary};
use super::{PrintArgs, print, print_json, print_warnings, window};
use crate::demo::unpack;

#[derive(Args, Debug)]
pub struct DemoArgs {
    /// Where to write the results [default: out/demo]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Do not open the window on the demo afterwards
    #[arg(long)]
    no_window: bool,
    #[command(flatten)]
    print: PrintArgs,
}

/// Runs the command.
pub fn run(args: &DemoArgs) -> anyhow::Result<()> {
    let folder = args.out.clone().map_or_else(|| default_place("demo"), Ok)?;
    let terminal = Terminal::attend();
    let set = CaptureSet::open(unpack(&folder.join("set"))?)?;
    let report = solve_into(&set, &folder, &SolveOptions::of(&set), &OutputOptions::default(), &terminal)?;
    drop(terminal);
    print_warnings(&report.warnings);
    if args.print.json {
        return print_json(&report);
    }
    print(&summary(&report, &folder))?;
    if args.no_window || !window::can_open() { Ok(()) } else { window::open(Some(set.folder)) }
}
