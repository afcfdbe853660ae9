//! `firstbounce demo`

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use clap::Args;
use firstbounce_capture::CaptureSet;
use firstbounce_capture::export::OutputOptions;
use firstbounce_capture::pipeline::{Angles, Evaluation, Method, SolveOptions, evaluate};
use firstbounce_capture::report::Report;
use serde::Serialize;

use super::progress::Terminal;
use super::solve::{default_place, result_lines, solve_into};
use super::table::{row, table};
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

/// The report of the run, and each method against the truth by its name.
#[derive(Serialize)]
struct DemoRecord<'a> {
    #[serde(flatten)]
    report: &'a Report,
    evaluations: &'a BTreeMap<&'static str, Evaluation>,
}

/// Runs the command.
pub fn run(args: &DemoArgs) -> anyhow::Result<()> {
    let folder = args.out.clone().map_or_else(|| default_place("demo"), Ok)?;
    let terminal = Terminal::attend();
    let set = CaptureSet::open(unpack(&folder.join("set"))?)?;
    let options = SolveOptions::of(&set);
    let report = solve_into(&set, &folder, &options, &OutputOptions::default(), None, &terminal)?;
    let evaluations = if report.shape.is_some() { evaluations(&set, &options, &terminal)? } else { BTreeMap::new() };
    drop(terminal);
    print_warnings(&report.warnings);
    if args.print.json {
        return print_json(&DemoRecord { report: &report, evaluations: &evaluations });
    }
    print(&text(&set, &report, &evaluations, &folder))?;
    if args.no_window || !window::can_open() { Ok(()) } else { window::show_result(set.folder) }
}

/// The paper's method, colours and shape together and the method in force against the truth. The user may have taken colours or
/// the truth out of the set.
fn evaluations(
    set: &CaptureSet,
    options: &SolveOptions,
    terminal: &Terminal,
) -> anyhow::Result<BTreeMap<&'static str, Evaluation>> {
    if !set.truth_normals().is_file() {
        return Ok(BTreeMap::new());
    }
    let asked = |method: &Method| *method == options.method || (*method != Method::Shape && set.colours.len() > 1);
    let methods = [Method::Colours, Method::ColoursAndShape, Method::Shape].into_iter().filter(asked);
    let evaluation = |method: Method| {
        let evaluation = evaluate(set, &SolveOptions { method, ..options.clone() }, terminal);
        terminal.finish();
        Ok((method.name(), evaluation?))
    };
    methods.map(evaluation).collect()
}

fn text(set: &CaptureSet, report: &Report, evaluations: &BTreeMap<&'static str, Evaluation>, folder: &Path) -> String {
    let (lamps, colours) = (report.set.lights.len(), report.set.colours.len());
    let mut lines = vec![format!("{}: photos under {lamps} lamps in {colours} colours", set.name)];
    if let Some((_, first)) = evaluations.first_key_value() {
        let line = |name: String, angles: Angles, rmse: Option<f64>| {
            let rmse = rmse.map_or_else(|| "-".to_owned(), |rmse| format!("{rmse:.2}"));
            vec![name, format!("{:.2}", angles.mean), rmse]
        };
        let mut rows = vec![row(["surface by", "normals off by, degrees", "depth off by, mm"])];
        rows.push(line("photos before separation".into(), first.normal_error_deg.raw, first.depth_rmse_raw_mm));
        rows.extend(evaluations.iter().map(|(name, found)| {
            let title = Method::from_name(name).map_or(*name, Method::title);
            let paper =
                if *name == Method::Colours.name() { format!(", {} bounces", found.bounces) } else { String::new() };
            line(format!("{title}{paper}"), found.normal_error_deg.separated, found.depth_rmse_mm)
        }));
        lines.push("rendered with every bounce of light, so that the true surface is known:".into());
        lines.push(String::new());
        lines.push(table(&rows));
        lines.push(String::new());
    }
    let title = Method::from_name(report.method).map_or(report.method, Method::title);
    lines.push(format!("solved by {title}"));
    lines.extend(result_lines(report, folder));
    let own = set.folder.display();
    lines.push(format!("next: firstbounce open {own}, or firstbounce solve SET for photos of your own"));
    lines.join("\n")
}
