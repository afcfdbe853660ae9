//! `firstbounce solve SET...`

use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use firstbounce_capture::CaptureSet;
use firstbounce_capture::atomic::{WriteError, refuse_links};
use firstbounce_capture::export::{OutputOptions, stage_results, write_solved_as};
use firstbounce_capture::pipeline::{AlbedoScale, Method, SolveOptions, Work, solve};
use firstbounce_capture::report::{BatchRecord, ColoursAndShapeRecord, NayarRecord, Report};
use firstbounce_capture::set::Word;
use firstbounce_core::methods::by_shape::ByShapeOptions;
use firstbounce_core::stereo::normals::Paint;

use super::memory::MemoryArgs;
use super::output::OutputArgs;
use super::progress::Terminal;
use super::table::{row, table};
use super::{PrintArgs, print, print_json, print_warnings, solve_many};

/// Folder for results that are given none.
const OUTPUT_FOLDER: &str = "out";

#[derive(Args, Debug)]
pub struct SolveArgs {
    /// Capture sets: their folders or their capture.toml
    #[arg(value_name = "SET", required = true)]
    pub sets: Vec<PathBuf>,
    /// Take lamps and colours from the calibration of this set; results lie in a folder for each set, a set whose results are
    /// up to date is passed over, and one that fails holds up no other
    #[arg(long, value_name = "RIGSET")]
    pub rig: Option<PathBuf>,
    /// The objects are of the rig's paint: take beta too
    #[arg(long, requires = "rig")]
    pub same_paint: bool,
    /// Where to write the results [default: out/NAME OF THE SET'S FOLDER]; of several sets, each into DIR/NAME
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print the table as comma-separated values
    #[arg(long, conflicts_with = "json")]
    pub csv: bool,
    #[command(flatten)]
    pub method: MethodArgs,
    #[command(flatten)]
    pub output: OutputArgs,
    #[command(flatten)]
    pub memory: MemoryArgs,
    #[command(flatten)]
    pub print: PrintArgs,
}

/// How to get from photos to normals.
#[derive(Args, Debug)]
pub struct MethodArgs {
    /// How many bounces the paper's method separates; chooses --method colours [default: the set's own]
    #[arg(long, value_name = "M")]
    bounces: Option<usize>,
    /// With --method colours: half width of the window in which the noise of indirect light is averaged; 0 for none
    /// [default: the set's, or 3]
    #[arg(long, value_name = "PIXELS")]
    indirect_window: Option<usize>,
    /// A light that normals are found without; may be given more than once [default: the set's]
    #[arg(long, value_name = "LIGHT")]
    leave_out: Vec<String>,
    /// A light is in shadow at a pixel where it is weaker than this share of the brightest light, 0 to 1
    /// [default: the set's, or 0.08]
    #[arg(long, value_name = "SHARE")]
    shadow_share: Option<f64>,
    /// With five or more lights, one that misses the fit by more than this share of the brightest is left out, 0 to 1
    /// [default: the set's, or 0.15]
    #[arg(long, value_name = "SHARE")]
    misfit_share: Option<f64>,
    /// Iterations that find how near near lamps are [default: the set's, or 3]
    #[arg(long, value_name = "N")]
    rounds: Option<usize>,
    /// How to tell direct from indirect light [default: the set's, or colours-and-shape where there are two colours]
    #[arg(long, value_parser = methods())]
    method: Option<Method>,
    /// Whether the object has one albedo: "one", "any" for each pixel its own, or "auto" to look whether one will do
    /// [default: the set's, or auto]
    #[arg(long, value_parser = paints())]
    paint: Option<Paint>,
    /// Albedo of the grey ball, 0 to 1, which makes the paint's albedo absolute [default: the set's]
    #[arg(long, value_name = "ALBEDO")]
    grey_albedo: Option<f64>,
    /// With --method shape: about how many patches exchange light; time grows with the square
    #[arg(long, value_name = "N", default_value_t = ByShapeOptions::default().patches)]
    patches: usize,
    /// With --method shape: stop after so many iterations
    #[arg(long, value_name = "N", default_value_t = ByShapeOptions::default().max_iterations)]
    iterations: usize,
}

/// The methods by their names.
fn methods() -> impl TypedValueParser<Value = Method> {
    let named = |method: Method| PossibleValue::new(method.name()).aliases(method.alias()).help(method.purpose());
    PossibleValuesParser::new(Method::ALL.map(named)).map(|name| Method::from_name(&name).unwrap_or_default())
}

fn paints() -> impl TypedValueParser<Value = Paint> {
    let words = Paint::ALL.iter().map(|paint| PossibleValue::new(paint.word()));
    PossibleValuesParser::new(words).map(|word| Paint::from_word(&word).unwrap_or_default())
}

impl MethodArgs {
    /// What is asked for of a set, as the pipeline takes it: what is given here goes before what the set's file says.
    pub fn options(&self, set: &CaptureSet) -> anyhow::Result<SolveOptions> {
        let mut asked = set.clone();
        asked.separation.method = Some(self.method_for(set)?);
        let shape = &mut asked.shape;
        shape.shadow_share = self.shadow_share.unwrap_or(shape.shadow_share);
        shape.misfit_share = self.misfit_share.unwrap_or(shape.misfit_share);
        shape.rounds = self.rounds.unwrap_or(shape.rounds);
        shape.indirect_window_px = self.indirect_window.unwrap_or(shape.indirect_window_px);
        shape.paint = self.paint.unwrap_or(shape.paint);
        if !self.leave_out.is_empty() {
            shape.leave_out.clone_from(&self.leave_out);
        }
        if let Some(problem) = asked.check().into_iter().next() {
            anyhow::bail!("{problem}");
        }
        let nayar =
            ByShapeOptions { patches: self.patches, max_iterations: self.iterations, ..ByShapeOptions::default() };
        let scale = AlbedoScale { grey_albedo: self.grey_albedo, ..AlbedoScale::default() };
        Ok(SolveOptions { bounces: self.bounces, nayar, scale, ..SolveOptions::of(&asked) })
    }

    /// The method that is asked for; an order of bounces asks for the one that keeps them apart.
    fn method_for(&self, set: &CaptureSet) -> anyhow::Result<Method> {
        match (self.method, self.bounces) {
            (None | Some(Method::Colours), Some(_)) => Ok(Method::Colours),
            (Some(method), Some(_)) => anyhow::bail!(
                "--bounces is for --method {}; {} takes all indirect light together, leave it out",
                Method::Colours,
                method.title()
            ),
            (Some(Method::ColoursAndShape), None) if set.colours.len() < 2 => {
                anyhow::bail!("--method {} needs two colours; use --method {}", Method::ColoursAndShape, Method::Shape)
            }
            (method, None) => Ok(method.unwrap_or_else(|| set.method())),
        }
    }
}

/// Runs the command.
pub fn run(args: &SolveArgs) -> anyhow::Result<()> {
    let terminal = Terminal::attend();
    let [path] = args.sets.as_slice() else { return solve_many::run(args, &terminal) };
    if args.rig.is_some() || args.csv {
        return solve_many::run(args, &terminal);
    }
    let set = CaptureSet::open(path)?;
    let options = args.method.options(&set)?;
    args.memory.check(&set, Work::Solve)?;
    let folder = args.out.clone().map_or_else(|| default_folder(&set), Ok)?;
    let report = solve_into(&set, &folder, &options, &args.output.options(), None, &terminal)?;
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

/// Solves a set and writes the results into `folder`; of a run among many, `batch` is what was asked for.
pub fn solve_into(
    set: &CaptureSet,
    folder: &Path,
    options: &SolveOptions,
    output_options: &OutputOptions,
    batch: Option<BatchRecord>,
    terminal: &Terminal,
) -> anyhow::Result<Report> {
    output_options.check()?;
    let output = stage_results(set, folder)?;
    let solved = solve(set, options, terminal);
    let report = solved.and_then(|solved| write_solved_as(set, &solved, output, output_options, batch, terminal));
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

/// The summary of a finished run, for the user.
fn summary(report: &Report, folder: &Path) -> String {
    let mut lines = match (&report.nayar, &report.colours_and_shape) {
        (Some(nayar), _) => nayar_lines(report, nayar),
        (None, Some(record)) => colours_and_shape_lines(report, record),
        (None, None) => separation_lines(report),
    };
    lines.extend(result_lines(report, folder));
    lines.join("\n")
}

/// What came out of a finished run, and where it lies.
pub fn result_lines(report: &Report, folder: &Path) -> Vec<String> {
    let mut lines = Vec::new();
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
    lines
}

fn nayar_lines(report: &Report, nayar: &NayarRecord) -> Vec<String> {
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

fn colours_and_shape_lines(report: &Report, record: &ColoursAndShapeRecord) -> Vec<String> {
    let mut rows = vec![row(["light", "mean direct light", "its noise", "mean indirect light", "pixels left out"])];
    for ((light, separation), words) in report.separation.iter().zip(record.light.values()) {
        let left_out = separation.unsolved_clipped_pixels + separation.unsolved_dark_pixels;
        rows.push(vec![
            light.clone(),
            format!("{:.4}", words.mean_direct),
            separation.noise.first().map_or_else(String::new, |noise| format!("{noise:.5}")),
            format!("{:.4}", words.mean_indirect),
            left_out.to_string(),
        ]);
    }
    let mut lines =
        vec![format!("{}: colours and shape, {} object pixels", report.set.name, report.set.mask_pixels), table(&rows)];
    lines.extend(record.line());
    lines.extend(record.verdict.iter().map(|line| format!("  {line}")));
    lines.push(format!("separation: {}", report.trust.level));
    lines.extend(report.trust.normal.map(|normal| {
        format!(
            "  expected error of normals: {:.2} degrees by noise, {:.2} by the interval of beta",
            normal.denoised_noise_deg, normal.calibration_deg
        )
    }));
    lines
}

fn separation_lines(report: &Report) -> Vec<String> {
    let mut rows = vec![row(["light", "gain of bounce 1", "condition", "mean of each bounce", "pixels left out"])];
    for (light, words) in &report.separation {
        let means: Vec<_> = words.mean.iter().map(|mean| format!("{mean:.4}")).collect();
        let left_out = words.unsolved_clipped_pixels + words.unsolved_dark_pixels;
        rows.push(vec![
            light.clone(),
            format!("{:.2}", words.gain[0]),
            words.condition_number.map_or("-".into(), |condition| format!("{condition:.1}")),
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
