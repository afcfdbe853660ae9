//! `firstbounce solve SET... --rig RIGSET`: many objects, in one table.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{anyhow, bail};
use firstbounce_capture::CaptureSet;
use firstbounce_capture::export::is_finished;
use firstbounce_capture::pipeline::{
    PhotoStore, PipelineWatch, Preference, SolveOptions, Work, calibrate_also_on_object,
};
use firstbounce_capture::report::{BatchRecord, Report, RigRecord, input_records};
use firstbounce_capture::set::Calibration;
use serde::Serialize;

use super::progress::Terminal;
use super::solve::{SolveArgs, default_place, solve_into};
use super::table::{row, table};
use super::{print, print_json, print_warnings};

/// What became of the sets.
#[derive(Debug, Serialize)]
struct Batch {
    solved: usize,
    unchanged: usize,
    failed: usize,
    sets: Vec<SetRow>,
}

/// What became of one set.
#[derive(Debug, Serialize)]
struct SetRow {
    set: String,
    folder: String,
    state: State,
    /// "fine", "take care" or "do not trust".
    verdict: Option<String>,
    solved_pixels: Option<u64>,
    mean_noise_deg: Option<f64>,
    warnings: usize,
    seconds: f64,
    error: Option<String>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
enum State {
    Solved,
    /// Its results are those of the files that lie there.
    Unchanged,
    Failed,
}

impl State {
    fn word(self) -> &'static str {
        match self {
            Self::Solved => "solved",
            Self::Unchanged => "unchanged",
            Self::Failed => "failed",
        }
    }
}

/// The set whose calibration all others take.
struct Rig {
    set: CaptureSet,
    values: Calibration,
    record: RigRecord,
}

/// Solves one set after the other; one that fails holds up no other.
pub fn run(args: &SolveArgs, terminal: &Terminal) -> anyhow::Result<()> {
    let folders = result_folders(args)?;
    let rig = args.rig.as_deref().map(|path| Rig::read(path, terminal)).transpose()?;
    let mut sets = Vec::with_capacity(args.sets.len());
    for (path, folder) in args.sets.iter().zip(folders) {
        let row = solve_one(args, path, &folder, rig.as_ref(), terminal);
        // What was cancelled has not failed.
        if terminal.cancelled() && row.state == State::Failed {
            break;
        }
        sets.push(row);
    }
    terminal.finish();
    let count = |state| sets.iter().filter(|row| row.state == state).count();
    let (solved, unchanged, failed) = (count(State::Solved), count(State::Unchanged), count(State::Failed));
    let batch = Batch { solved, unchanged, failed, sets };
    match (args.print.json, args.csv) {
        (true, _) => print_json(&batch)?,
        (false, true) => print(&csv(&batch.sets))?,
        (false, false) => print(&text(&batch))?,
    }
    let left = args.sets.len() - batch.sets.len();
    if left > 0 {
        bail!("cancelled: {left} of {} sets are left; the same command goes on with them", args.sets.len());
    }
    if failed > 0 {
        bail!("{failed} of {} sets failed; the table says why", args.sets.len());
    }
    Ok(())
}

impl Rig {
    fn read(path: &Path, terminal: &Terminal) -> anyhow::Result<Self> {
        let mut set = CaptureSet::open(path)?;
        let calibrated = calibrate_also_on_object(&set, Preference::File, &PhotoStore::default(), terminal)?;
        let lines: Vec<_> = calibrated.warnings.iter().map(|line| format!("the rig {}: {line}", set.title())).collect();
        print_warnings(&lines);
        let values = calibrated.values(&set);
        set.camera.crosstalk = calibrated.crosstalk_rows();
        let record = RigRecord { name: set.title(), inputs: input_records(&set) };
        Ok(Self { set, values, record })
    }
}

fn solve_one(args: &SolveArgs, path: &Path, folder: &Path, rig: Option<&Rig>, terminal: &Terminal) -> SetRow {
    let since = Instant::now();
    let solved = solve_unless_finished(args, path, folder, rig, terminal);
    let row = SetRow {
        set: path.display().to_string(),
        folder: folder.display().to_string(),
        state: State::Failed,
        verdict: None,
        solved_pixels: None,
        mean_noise_deg: None,
        warnings: 0,
        seconds: since.elapsed().as_secs_f64(),
        error: None,
    };
    match solved {
        Ok(Outcome::Unchanged(report)) => SetRow {
            state: State::Unchanged,
            verdict: report["trust"]["level"].as_str().map(str::to_owned),
            solved_pixels: report["shape"]["solved_pixels"].as_u64(),
            mean_noise_deg: report["shape"]["mean_noise_deg"].as_f64(),
            warnings: report["warnings"].as_array().map_or(0, Vec::len),
            ..row
        },
        Ok(Outcome::Solved(report)) => SetRow {
            state: if report.no_shape.is_some() { State::Failed } else { State::Solved },
            verdict: Some(report.trust.level.to_owned()),
            solved_pixels: report.shape.as_ref().map(|shape| shape.solved_pixels as u64),
            mean_noise_deg: report.shape.as_ref().map(|shape| shape.mean_noise_deg),
            warnings: report.warnings.len(),
            error: report.no_shape.clone(),
            ..row
        },
        Err(error) => SetRow { error: Some(format!("{error:#}").replace('\n', " ")), ..row },
    }
}

enum Outcome {
    Solved(Box<Report>),
    /// The report that lies there.
    Unchanged(serde_json::Value),
}

fn solve_unless_finished(
    args: &SolveArgs,
    path: &Path,
    folder: &Path,
    rig: Option<&Rig>,
    terminal: &Terminal,
) -> anyhow::Result<Outcome> {
    let mut set = CaptureSet::open(path)?;
    let mut notes = Vec::new();
    if let Some(rig) = rig {
        let carried = set.use_rig(&rig.set, &rig.values, args.same_paint);
        let lines = carried.lines();
        if carried.lights.is_empty() {
            bail!("{}", lines.first().map_or("", String::as_str));
        }
        notes.extend(lines.into_iter().skip(1).map(|line| format!("{}: {line}", set.title())));
    }
    let options = args.method.options(&set)?;
    let output_options = args.output.options();
    let batch = record(args, rig, &options)?;
    if let Some(report) = is_finished(&set, folder, &batch) {
        return Ok(Outcome::Unchanged(report));
    }
    args.memory.check(&set, Work::Solve)?;
    let report = solve_into(&set, folder, &options, &output_options, Some(batch), terminal)?;
    notes.extend(report.warnings.iter().map(|line| format!("{}: {line}", set.title())));
    print_warnings(&notes);
    Ok(Outcome::Solved(Box::new(report)))
}

fn record(args: &SolveArgs, rig: Option<&Rig>, options: &SolveOptions) -> anyhow::Result<BatchRecord> {
    let rig = rig.map(|rig| rig.record.clone());
    Ok(BatchRecord::new(&(options, args.output.options()), rig, args.same_paint)?)
}

/// A folder for each set's results, by the name of its own; where two have one name, with that of the folder above.
fn result_folders(args: &SolveArgs) -> anyhow::Result<Vec<PathBuf>> {
    let names: Vec<Vec<String>> = args.sets.iter().map(|path| names_of(path)).collect();
    let short = |names: &Vec<String>| names.last().cloned().unwrap_or_else(|| "set".into());
    let mut count: HashMap<String, usize> = HashMap::new();
    names.iter().for_each(|names| *count.entry(short(names)).or_default() += 1);
    let own = |names: &Vec<String>| {
        let name = short(names);
        let above = names.len().checked_sub(2).and_then(|above| names.get(above));
        above.filter(|_| count.get(&name) > Some(&1)).map_or_else(|| name.clone(), |above| format!("{above}-{name}"))
    };
    let own: Vec<String> = names.iter().map(own).collect();
    for (index, name) in own.iter().enumerate() {
        if own[..index].contains(name) {
            return Err(anyhow!(
                "two sets would have their results in {name}: name each set once, or solve them apart"
            ));
        }
    }
    match &args.out {
        Some(out) => Ok(own.into_iter().map(|name| out.join(name)).collect()),
        None => own.into_iter().map(|name| Ok(default_place(name)?)).collect(),
    }
}

/// The folders down to the set's own.
fn names_of(path: &Path) -> Vec<String> {
    let path = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let folder = if path.is_dir() { path.as_path() } else { path.parent().unwrap_or(&path) };
    folder.iter().map(|name| name.to_string_lossy().into_owned()).collect()
}

const COLUMNS: [&str; 9] =
    ["set", "folder", "state", "verdict", "solved_pixels", "mean_noise_deg", "warnings", "seconds", "error"];

fn cells(set: &SetRow) -> [String; 9] {
    let or_empty = |text: &Option<String>| text.clone().unwrap_or_default();
    [
        set.set.clone(),
        set.folder.clone(),
        set.state.word().into(),
        or_empty(&set.verdict),
        set.solved_pixels.map_or_else(String::new, |pixels| pixels.to_string()),
        set.mean_noise_deg.map_or_else(String::new, |noise| format!("{noise:.3}")),
        set.warnings.to_string(),
        format!("{:.1}", set.seconds),
        or_empty(&set.error),
    ]
}

fn text(batch: &Batch) -> String {
    let heading = ["set", "results", "state", "verdict", "pixels", "noise, degrees", "warnings", "seconds", "reason"];
    let rows: Vec<_> = std::iter::once(row(heading)).chain(batch.sets.iter().map(|set| cells(set).to_vec())).collect();
    let Batch { solved, unchanged, failed, .. } = batch;
    format!("{}\n\n{solved} solved, {unchanged} unchanged, {failed} failed", table(&rows))
}

/// Comma-separated values (RFC 4180).
fn csv(sets: &[SetRow]) -> String {
    let quoted = |cell: &str| match cell.contains([',', '"', '\n', '\r']) {
        true => format!("\"{}\"", cell.replace('"', "\"\"")),
        false => cell.to_owned(),
    };
    let line = |cells: Vec<String>| cells.iter().map(|cell| quoted(cell)).collect::<Vec<_>>().join(",");
    let rows = sets.iter().map(|set| line(cells(set).to_vec()));
    std::iter::once(line(row(COLUMNS))).chain(rows).collect::<Vec<_>>().join("\n")
}
