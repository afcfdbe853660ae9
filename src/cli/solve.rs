//! `firstbounce solve SET`

use std::path::{Path, PathBuf};

use clap::Args;
use firstbounce_capture::image_file::GreenAxis;
use firstbounce_capture::pipeline::{OutputOptions, SolveOptions, solve, write_solved};
use firstbounce_capture::report::Report;
use firstbounce_capture::{CaptureSet, OutputFolder};
use firstbounce_core::indirect::IndirectOptions;

use super::progress::Terminal;
use super::table::{row, table};
use super::{PrintArgs, SetArgs, print, print_json, print_warnings};

/// Folder for results whose place nobody names.
pub const OUTPUT_FOLDER: &str = "out";

#[derive(Args, Debug)]
pub struct SolveArgs {
    #[command(flatten)]
    set: SetArgs,
    /// Where to write the results [default: out/NAME OF THE SET'S FOLDER]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    method: MethodArgs,
    /// Write normals.png with green down, as DirectX reads it, instead of up, as OpenGL does
    #[arg(long)]
    directx: bool,
    #[command(flatten)]
    print: PrintArgs,
}

/// How to get from photos to normals.
#[derive(Args, Debug)]
pub struct MethodArgs {
    /// How many bounces to tell apart [default: the set's own]
    #[arg(long, value_name = "M")]
    bounces: Option<usize>,
    /// Half width of the window in which the noise of indirect light is averaged before normals are found; 0 for none
    #[arg(long, value_name = "PIXELS", default_value_t = IndirectOptions::default().radius_px)]
    indirect_window: usize,
}

impl MethodArgs {
    /// As the pipeline takes them.
    pub fn options(&self) -> SolveOptions {
        let indirect = IndirectOptions { radius_px: self.indirect_window, ..IndirectOptions::default() };
        SolveOptions { bounces: self.bounces, indirect, ..SolveOptions::default() }
    }
}

/// Runs the command.
pub fn run(args: &SolveArgs) -> anyhow::Result<()> {
    let set = CaptureSet::open(&args.set.path)?;
    let folder = args.out.clone().unwrap_or_else(|| default_folder(&set));
    let green = if args.directx { GreenAxis::Down } else { GreenAxis::Up };
    let report = solve_into(&set, &folder, &args.method.options(), green)?;
    print_warnings(&report.warnings);
    if args.print.json {
        print_json(&report)?
    } else {
        print(&summary(&report, &folder))?
    }
    // The bounces are written all the same; that there is no surface is still a failure of what was asked.
    match &report.no_shape {
        Some(reason) => anyhow::bail!("{reason} (the bounces are in {})", folder.display()),
        None => Ok(()),
    }
}

/// Solves a set and writes the results into `folder`.
pub fn solve_into(set: &CaptureSet, folder: &Path, options: &SolveOptions, green: GreenAxis) -> anyhow::Result<Report> {
    let output = OutputFolder::stage(folder)?;
    let terminal = Terminal::attend();
    let solved = solve(set, options, &terminal);
    let report =
        solved.and_then(|mut solved| write_solved(set, &mut solved, output, OutputOptions { green }, &terminal));
    terminal.finish();
    Ok(report?)
}

fn default_folder(set: &CaptureSet) -> PathBuf {
    let folder = std::path::absolute(&set.folder).unwrap_or_else(|_| set.folder.clone());
    let name = folder.file_name().map_or_else(|| "set".into(), ToOwned::to_owned);
    Path::new(OUTPUT_FOLDER).join(name)
}

/// What a person wants to know when it is done.
pub fn summary(report: &Report, folder: &Path) -> String {
    let mut rows = vec![row(["light", "gain of bounce 1", "condition", "mean of each bounce", "pixels left out"])];
    for (light, words) in &report.separation {
        let means: Vec<_> = words.mean.iter().map(|mean| format!("{mean:.4}")).collect();
        let left_out = words.unsolved_clipped_pixels + words.unsolved_dark_pixels;
        rows.push(vec![
            light.clone(),
            format!("{:.2}", words.gain[0]),
            format!("{:.1}", words.condition_number),
            means.join(" "),
            left_out.to_string(),
        ]);
    }
    let mut lines = vec![
        format!("{}: {} bounces, {} object pixels", report.set.name, report.bounces, report.set.mask_pixels),
        table(&rows),
    ];
    lines.push(format!("separation: {}", report.trust.level));
    lines.extend(report.trust.advice.iter().map(|advice| format!("  better: {advice}")));
    if let Some(shape) = &report.shape {
        lines.push(format!(
            "normals for {} pixels, expected noise {:.2} degrees; mesh of {} vertices in {}",
            shape.solved_pixels, shape.mean_noise_deg, shape.mesh.vertices, shape.mesh.unit
        ));
    }
    let seconds: f64 = report.stages.iter().map(|cost| cost.seconds).sum();
    lines.push(format!(
        "{} files in {} after {seconds:.1} s; open report.html there",
        report.files.len(),
        folder.display()
    ));
    lines.join("\n")
}
