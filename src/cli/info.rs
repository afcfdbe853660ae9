//! `firstbounce info SET`

use std::path::Path;

use clap::Args;
use firstbounce_capture::CaptureSet;
use firstbounce_capture::image_file::Metadata;
use firstbounce_capture::open::near;
use firstbounce_capture::pipeline::{Exposed, Exposures, PhotoStore, survey};
use firstbounce_capture::report::CaptureWarningRecord;
use firstbounce_capture::set::{BallValue, Shot, Subject};
use serde::Serialize;

use super::progress::Terminal;
use super::table::{row, table};
use super::{PrintArgs, SetArgs, print, print_json};

#[derive(Args, Debug)]
pub struct InfoArgs {
    #[command(flatten)]
    set: SetArgs,
    #[command(flatten)]
    print: PrintArgs,
}

/// What a set holds.
#[derive(Debug, Serialize)]
struct Info {
    name: String,
    folder: String,
    lights: Vec<String>,
    colours: Vec<String>,
    bounces: usize,
    subjects: Vec<SubjectInfo>,
    shots: Vec<ShotInfo>,
    mask: Option<String>,
    missing_files: Vec<String>,
    lacks: Vec<String>,
    /// The worst first.
    capture_warnings: Vec<CaptureWarningRecord>,
}

#[derive(Debug, Serialize)]
struct SubjectInfo {
    subject: String,
    shots: usize,
    files: usize,
}

/// One photo and how well it is exposed. Shares are of the mask's pixels, or of the ball's, where they are known.
#[derive(Debug, Serialize)]
struct ShotInfo {
    subject: String,
    light: Option<String>,
    colour: Option<String>,
    channel: String,
    exposure: f64,
    /// What the exposure comes from: `capture.toml`, `exif` or `default`.
    exposure_source: &'static str,
    /// What the first of its files says of itself.
    file: Option<FileInfo>,
    repeats: usize,
    clipped: Option<f64>,
    dark: Option<f64>,
    mean: Option<f64>,
    problem: Option<String>,
}

/// What a file says of itself; `null` where it says nothing that can be true.
#[derive(Debug, Serialize)]
struct FileInfo {
    exposure_s: Option<f64>,
    f_number: Option<f64>,
    iso: Option<f64>,
    focal_length_mm: Option<f64>,
    taken: Option<String>,
    orientation: Option<u8>,
    curve: String,
}

/// Runs the command.
pub fn run(args: &InfoArgs) -> anyhow::Result<()> {
    let terminal = Terminal::attend();
    let set = CaptureSet::open(&args.set.path)?;
    let surveyed = survey(&set, &terminal);
    terminal.finish();
    let surveyed = surveyed?;
    let store = PhotoStore::default();
    let exposures = store.exposures(&set);
    let shots = set.shots.iter().zip(surveyed.shots).map(|(shot, exposed)| {
        let first = shot.files.first().and_then(|file| store.metadata(&set.resolve(file)));
        shot_info(&set, shot, (&exposures, first), exposed)
    });
    let info = Info {
        name: set.title(),
        folder: set.folder.display().to_string(),
        lights: set.lights.iter().map(|light| light.name.clone()).collect(),
        colours: set.colours.iter().map(|colour| colour.name.clone()).collect(),
        bounces: set.bounces(),
        subjects: set.subjects().into_iter().map(|subject| subject_info(&set, subject)).collect(),
        shots: shots.collect(),
        mask: set.mask.clone(),
        missing_files: missing_files(&set),
        lacks: lacks(&set),
        capture_warnings: CaptureWarningRecord::all(&surveyed.captures),
    };
    if args.print.json { print_json(&info) } else { print(&text(&info)) }
}

fn subject_info(set: &CaptureSet, subject: Subject) -> SubjectInfo {
    let mut files: Vec<_> = set.shots_of(subject).flat_map(|shot| &shot.files).collect();
    files.sort_unstable();
    files.dedup();
    SubjectInfo { subject: subject.to_string(), shots: set.shots_of(subject).count(), files: files.len() }
}

fn shot_info(
    set: &CaptureSet,
    shot: &Shot,
    (exposures, file): (&Exposures, Option<Metadata>),
    exposed: Result<Exposed, String>,
) -> ShotInfo {
    let number = |value: fn(&Exposed) -> f64| exposed.as_ref().ok().map(value);
    ShotInfo {
        subject: shot.subject.to_string(),
        light: shot.light.clone(),
        colour: shot.colour.clone(),
        channel: set.channel_of(shot).to_string(),
        exposure: exposures.exposure(shot),
        exposure_source: match (shot.exposure, exposures.filled_in(shot)) {
            (Some(_), _) => "capture.toml",
            (None, Some(_)) => "exif",
            (None, None) => "default",
        },
        file: file.map(file_info),
        repeats: shot.files.len(),
        clipped: number(|exposed| exposed.clipped),
        dark: number(|exposed| exposed.dark),
        mean: number(|exposed| exposed.mean),
        problem: exposed.err(),
    }
}

fn file_info(metadata: Metadata) -> FileInfo {
    FileInfo {
        exposure_s: metadata.exposure_s,
        f_number: metadata.f_number,
        iso: metadata.iso,
        focal_length_mm: metadata.focal_length_mm,
        taken: metadata.taken.map(|taken| taken.to_string()),
        orientation: metadata.orientation,
        curve: metadata.curve.to_string(),
    }
}

fn missing_files(set: &CaptureSet) -> Vec<String> {
    let files = set.distinct_files();
    let named = files.keys().copied().chain(set.mask.as_deref());
    named.filter(|file| !set.resolve(file).is_file()).map(str::to_owned).collect()
}

/// A missing file, with one that is there and was probably meant.
fn missing(folder: &str, file: &str) -> String {
    let near = near(&Path::new(folder).join(file.replace('\\', "/")));
    format!("missing file: {file}{}", near.map_or_else(String::new, |near| format!("; there is {near:?}")))
}

/// What this set needs before it gives a mesh.
fn lacks(set: &CaptureSet) -> Vec<String> {
    let given = &set.calibration;
    let all = |known: &dyn Fn(&str) -> bool| set.lights.iter().all(|light| known(&light.name));
    let no_ball_for = |value| !set.has_ball_for(value);
    let several = set.colours.len() > 1;
    let placed = |light: &str| {
        let position = set.light_index(light).and_then(|l| set.lights[l].position_mm);
        position.is_some() || set.given_direction(light).is_some()
    };
    let wants = [
        (set.lights.len() < 3, "a third light: normals need three, the bounces come out all the same"),
        (
            several && no_ball_for(BallValue::Alpha) && !all(&|l| given.alpha.contains_key(l)),
            "alpha: photograph a grey ball, or type it; one beside the object is a [[sphere]] with subject = \"object\"",
        ),
        (
            several && no_ball_for(BallValue::Beta) && given.beta.is_none(),
            "beta: photograph a ball of the object's paint, or type it; without, it is measured on the object",
        ),
        (
            no_ball_for(BallValue::Direction) && !all(&placed),
            "directions: photograph a mirror or grey ball, or type them; one beside the object is a [[sphere]] with subject \
             = \"object\"",
        ),
        (
            no_ball_for(BallValue::Intensity) && !all(&|l| given.intensity.contains_key(l)),
            "intensities: photograph a grey ball, or type them; without, all lamps count as equally strong",
        ),
        (set.mask.is_none(), "a mask: without one the object is the brighter part of the photos"),
    ];
    wants.into_iter().filter(|(lacking, _)| *lacking).map(|(_, what)| what.to_owned()).collect()
}

fn shot_rows(shots: &[ShotInfo]) -> Vec<Vec<String>> {
    let heading = [
        "subject",
        "light",
        "colour",
        "channel",
        "exposure",
        "repeats",
        "clipped, %",
        "dark, %",
        "mean light",
        "problem",
    ];
    let percent = |share: Option<f64>| share.map_or_else(String::new, |share| format!("{:.1}", 100.0 * share));
    let shot = |shot: &ShotInfo| {
        row([
            &shot.subject,
            shot.light.as_deref().unwrap_or("-"),
            shot.colour.as_deref().unwrap_or("-"),
            &shot.channel,
            &exposure_words(shot),
            &shot.repeats.to_string(),
            &percent(shot.clipped),
            &percent(shot.dark),
            &shot.mean.map_or_else(String::new, |mean| format!("{mean:.4}")),
            shot.problem.as_deref().unwrap_or(""),
        ])
    };
    std::iter::once(row(heading)).chain(shots.iter().map(shot)).collect()
}

fn exposure_words(shot: &ShotInfo) -> String {
    let of_file = if shot.exposure_source == "exif" { " (EXIF)" } else { "" };
    format!("{}{of_file}", shot.exposure)
}

fn text(info: &Info) -> String {
    let mut rows = vec![row(["subject", "shots", "files"])];
    rows.extend(
        info.subjects
            .iter()
            .map(|subject| row([&subject.subject, &subject.shots.to_string(), &subject.files.to_string()])),
    );
    let mut lines = vec![
        info.name.clone(),
        format!("{} lights: {}", info.lights.len(), info.lights.join(", ")),
        format!("{} colours: {} (the first is the reference)", info.colours.len(), info.colours.join(", ")),
        format!("{} bounces to separate", info.bounces),
        table(&rows),
        String::new(),
        table(&shot_rows(&info.shots)),
        String::new(),
    ];
    lines.extend(info.missing_files.iter().map(|file| missing(&info.folder, file)));
    lines.extend(info.lacks.iter().map(|what| format!("lacks {what}")));
    lines.extend(info.capture_warnings.iter().map(|warning| format!("capture warning: {}", warning.words)));
    lines.join("\n")
}
