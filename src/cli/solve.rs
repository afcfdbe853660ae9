//! `firstbounce solve SET`

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use firstbounce_capture::CaptureSet;
use firstbounce_capture::atomic::{WriteError, refuse_links};
use firstbounce_capture::pipeline::{
    AlbedoScale, Method, OutputOptions, SolveOptions, Work, solve, stage_results, write_solved,
};
use firstbounce_capture::report::{NayarWords, Report};
use firstbounce_core::indirect::IndirectOptions;
use firstbounce_core::nayar::NayarOptions;

use super::memory::MemoryArgs;
use super::output::OutputArgs;
use super::progress::Terminal;
use super::table::{row, table};
use super::{PrintArgs, SetArgs, print, print_json, print_warnings};

/// Folder for results whose place nobody names.
const OUTPUT_FOLDER: &str = "out";

#[derive(Args, Debug)]
pub struct SolveArgs {
    #[command(flatten)]
    set: SetArgs,
    /// Where to write the results [default: out/NAME OF THE SET'S FOLDER]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    method: MethodArgs,
    #[command(flatten)]
    output: OutputArgs,
    #[command(flatten)]
    memory: MemoryArgs,
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
    /// How to take the light apart
    #[arg(long, value_enum, default_value_t = MethodName::Bounces)]
    method: MethodName,
    /// With --method nayar: albedo of the grey ball, 0 to 1, which makes the paint's albedo absolute [default: the set's]
    #[arg(long, value_name = "ALBEDO")]
    grey_albedo: Option<f64>,
    /// With --method nayar: about how many patches exchange light; time grows with the square
    #[arg(long, value_name = "N", default_value_t = NayarOptions::default().patches)]
    patches: usize,
    /// With --method nayar: stop after so many iterations
    #[arg(long, value_name = "N", default_value_t = NayarOptions::default().max_iterations)]
    iterations: usize,
}

/// A method by its name.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum MethodName {
    /// Photos in several colours tell the bounces apart (Liao, Huang and Yang 2011)
    Bounces,
    /// Photos in one colour; the bounces are simulated on the shape, over and over (Nayar, Ikeuchi and Kanade 1991)
    Nayar,
}

impl MethodArgs {
    /// Refuses an order where bounces are not told apart.
    fn check(&self) -> anyhow::Result<()> {
        match (self.method, self.bounces) {
            (MethodName::Nayar, Some(_)) => {
                anyhow::bail!("--bounces is for --method bounces; Nayar's method takes all of them away, leave it out")
            }
            _ => Ok(()),
        }
    }

    /// As the pipeline takes them.
    pub fn options(&self) -> SolveOptions {
        let indirect = IndirectOptions { radius_px: self.indirect_window, ..IndirectOptions::default() };
        let method = match self.method {
            MethodName::Bounces => Method::Bounces,
            MethodName::Nayar => Method::Nayar,
        };
        let nayar = NayarOptions { patches: self.patches, max_iterations: self.iterations, ..NayarOptions::default() };
        let scale = AlbedoScale { grey_albedo: self.grey_albedo, ..AlbedoScale::default() };
        SolveOptions { bounces: self.bounces, indirect, method, nayar, scale, ..SolveOptions::default() }
    }
}

/// Runs the command.
pub fn run(args: &SolveArgs) -> anyhow::Result<()> {
    args.method.check()?;
    let terminal = Terminal::attend();
    let set = CaptureSet::open(&args.set.path)?;
    args.memory.check(&set, Work::Solve)?;
    let folder = args.out.clone().map_or_else(|| default_folder(&set), Ok)?;
    let report = solve_into(&set, &folder, &args.method.options(), &args.output.options(), &terminal)?;
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
pub fn solve_into(
    set: &CaptureSet,
    folder: &Path,
    options: &SolveOptions,
    output_options: &OutputOptions,
    terminal: &Terminal,
) -> anyhow::Result<Report> {
    output_options.check()?;
    let output = stage_results(set, folder)?;
    let solved = solve(set, options, terminal);
    let report = solved.and_then(|mut solved| write_solved(set, &mut solved, output, output_options, terminal));
    terminal.finish();
    Ok(report?)
}

fn default_folder(set: &CaptureSet) -> Result<PathBuf, WriteError> {
    let folder = std::path::absolute(&set.folder).unwrap_or_else(|_| set.folder.clone());
    default_place(folder.file_name().unwrap_or(OsStr::new("set")))
}

/// A place in the default folder. The user has not named it: links there may have come with a set.
pub fn default_place(name: impl AsRef<Path>) -> Result<PathBuf, WriteError> {
    let place = Path::new(OUTPUT_FOLDER).join(name);
    refuse_links(Path::new("."), &place)?;
    Ok(place)
}

/// What a person wants to know when it is done.
pub fn summary(report: &Report, folder: &Path) -> String {
    let mut lines = match &report.nayar {
        Some(nayar) => nayar_lines(report, nayar),
        None => separation_lines(report),
    };
    if let Some(shape) = &report.shape {
        lines.push(format!(
            "normals for {} pixels, expected noise {:.2} degrees; mesh of {} vertices in {}",
            shape.solved_pixels, shape.mean_noise_deg, shape.mesh.vertices, shape.mesh.unit
        ));
    }
    lines.extend(report.export.decimation_lines());
    let seconds: f64 = report.stages.iter().map(|cost| cost.seconds).sum();
    lines.push(format!(
        "{} files in {} after {seconds:.1} s; open report.html there",
        report.files.len(),
        folder.display()
    ));
    lines.join("\n")
}

fn nayar_lines(report: &Report, nayar: &NayarWords) -> Vec<String> {
    let mut rows = vec![row(["iteration", "normals turned, degrees", "mean albedo", "indirect, %", "unexplained, %"])];
    for (iteration, step) in nayar.iterations.iter().enumerate() {
        let (name, change, indirect) = match iteration {
            0 => ("pseudo shape".to_owned(), String::new(), String::new()),
            _ => (
                iteration.to_string(),
                format!("{:.2}", step.change_deg),
                format!("{:.1}", 100.0 * step.indirect_fraction),
            ),
        };
        rows.push(vec![
            name,
            change,
            format!("{:.3}", step.mean_albedo),
            indirect,
            format!("{:.1}", 100.0 * step.residual),
        ]);
    }
    vec![
        format!("{}: Nayar's method, {} object pixels", report.set.name, report.set.mask_pixels),
        table(&rows),
        format!(
            "{} after {} iterations over {} patches; light of white {:.4} ({})",
            nayar.ending,
            nayar.iterations.len().saturating_sub(1),
            nayar.patches,
            nayar.white_light,
            nayar.white_light_source
        ),
    ]
}

fn separation_lines(report: &Report) -> Vec<String> {
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
    lines
}
