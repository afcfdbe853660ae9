//! `firstbounce demo`

use std::path::{Path, PathBuf};

use clap::Args;
use firstbounce_capture::CaptureSet;
use firstbounce_capture::atomic::{OutputFolder, OutputRules};
use firstbounce_capture::pipeline::{OutputOptions, SolveOptions};
use include_dir::{Dir, include_dir};

use super::progress::Terminal;
use super::solve::{default_place, solve_into, summary};
use crate::app::{self, Start};

use super::{PrintArgs, print, print_json, print_warnings};

/// The capture set that the program carries within itself.
static DEMO: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/assets/demo");

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
    let report = solve_into(&set, &folder, &SolveOptions::default(), &OutputOptions::default(), &terminal)?;
    drop(terminal);
    print_warnings(&report.warnings);
    if args.print.json {
        return print_json(&report);
    }
    print(&summary(&report, &folder))?;
    if args.no_window || !app::has_display() { Ok(()) } else { app::run(Start::Set(set.folder)) }
}

/// Puts the demo set into `folder`, where a person can look at it and change it: what is there already stays. Returns the
/// folder.
pub fn unpack(folder: &Path) -> anyhow::Result<&Path> {
    // The folder of the set is this program's idea, not the user's: a link of its name is not followed.
    let rules = OutputRules { guarded: folder.parent(), is_output: |name| DEMO.get_file(name).is_some() };
    let output = OutputFolder::stage_with(folder, rules)?;
    let mut pending = vec![&DEMO];
    while let Some(dir) = pending.pop() {
        for file in dir.files().filter(|file| !output.target().join(file.path()).exists()) {
            std::fs::write(output.file(file.path())?, file.contents())?;
        }
        pending.extend(dir.dirs());
    }
    output.commit()?;
    Ok(folder)
}
