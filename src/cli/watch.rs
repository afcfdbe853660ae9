//! `firstbounce watch FOLDER`

use std::path::{Path, PathBuf};
use std::time::Duration;

use clap::Args;
use firstbounce_capture::CaptureSet;
use firstbounce_capture::export::OutputOptions;
use firstbounce_capture::image_file::read_mask;
use firstbounce_capture::pipeline::{Exposed, PhotoStore, PipelineWatch, SolveOptions, Unattended, region_of};
use firstbounce_capture::set::{Shot, Subject};
use firstbounce_capture::watch_folder::{WatchFolder, WatchFolderOptions};

use super::progress::Terminal;
use super::solve::solve_into;
use super::{print, print_error};

/// How long to wait for photos before looking whether the user wants to end.
const PATIENCE: Duration = Duration::from_millis(200);
/// Above this share of clipped pixels a photo is worth a word.
const CLIPPED: f64 = 0.001;
/// Normals need as many.
const MIN_LIGHTS: usize = 3;

#[derive(Args, Debug)]
pub struct WatchArgs {
    /// The folder of a capture set, whose capture.toml names the photos that are to come
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
    /// Where to write the results each time another light is complete [default: nowhere, photos are only checked]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Look through the folder as often as this, for shares that report no changes
    #[arg(long, value_name = "SECONDS", default_value_t = WatchFolderOptions::default().poll.as_secs_f64())]
    poll: f64,
    /// End once every photo of the set is there
    #[arg(long)]
    until_complete: bool,
}

/// Runs the command, until it is cancelled.
pub fn run(args: &WatchArgs) -> anyhow::Result<()> {
    let terminal = Terminal::attend();
    let poll = Duration::try_from_secs_f64(args.poll).map_err(|error| anyhow::anyhow!("--poll: {error}"))?;
    let options = WatchFolderOptions { poll, ..WatchFolderOptions::default() };
    let (mut present, mut missing) = CaptureSet::open(&args.folder)?.present();
    let mut watch = WatchFolder::start(&args.folder, options)?;
    let (mut complete, mut is_unsolved) = (Vec::new(), false);
    while !terminal.cancelled() {
        let arrived = watch.next(PATIENCE)?;
        if !arrived.is_empty() {
            // Read again: the user may go on writing it.
            let set = CaptureSet::open(&args.folder)?;
            for file in &arrived {
                print(&line(&set, file))?;
            }
            (present, missing) = set.present();
            let lights: Vec<String> = present.lights.iter().map(|light| light.name.clone()).collect();
            for light in lights.iter().filter(|light| !complete.contains(*light)) {
                print(&format!("light {light} is complete ({} of {})", lights.len(), set.lights.len()))?;
            }
            (complete, is_unsolved) = (lights, true);
            // Photos of one light come one after the other: they are solved together, in the pause after them.
            continue;
        }
        if let (true, Some(out)) = (is_unsolved && complete.len() >= MIN_LIGHTS, &args.out) {
            // A set that cannot be solved yet is waited for.
            solved(&present, out, &terminal).unwrap_or_else(|error| print_error(&error));
        }
        is_unsolved = false;
        if missing.is_empty() && args.until_complete {
            break;
        }
    }
    Ok(())
}

fn solved(set: &CaptureSet, out: &Path, terminal: &Terminal) -> anyhow::Result<()> {
    let report = solve_into(set, out, &SolveOptions::of(set), &OutputOptions::default(), None, terminal)?;
    let noise = report.shape.as_ref().map_or(f64::NAN, |shape| shape.mean_noise_deg);
    print(&format!(
        "solved {} lights: {}, expected noise of normals {noise:.2} degrees; {}",
        set.lights.len(),
        report.trust.level,
        out.join("report.html").display()
    ))
}

/// What a photo shows, and whether its exposure will do.
fn line(set: &CaptureSet, file: &Path) -> String {
    let written = set.written(file);
    let mut of_file = set.clone();
    of_file.shots.retain(|shot| shot.files.iter().any(|name| set.resolve(name) == set.resolve(&written)));
    if of_file.shots.is_empty() {
        return format!("{written}: no shot of capture.toml names it");
    }
    // A photo of a bracket or of repeats is looked at by itself.
    for shot in &mut of_file.shots {
        (shot.files, shot.exposures) = (vec![written.clone()], Vec::new());
    }
    let shots: Vec<&Shot> = of_file.shots.iter().collect();
    let mask = of_file.mask.as_ref().and_then(|mask| read_mask(&of_file.resolve(mask)).ok()).map(|file| file.mask);
    let lights = PhotoStore::default().read(&of_file, &shots, &Unattended).unwrap_or_default();
    let lines = shots.into_iter().zip(lights).map(|(shot, light)| {
        let names = [Some(shot.subject.title()), shot.light.as_deref(), shot.colour.as_deref()];
        let what = names.into_iter().flatten().collect::<Vec<_>>().join(" ");
        match light {
            Ok(light) => {
                let region = region_of(&of_file, shot, mask.as_ref(), light.photo.linear.size());
                format!("{written}: {what}, {}", exposure(shot.subject, &Exposed::of(&light.photo, region.as_ref())))
            }
            Err(error) => error.to_string(),
        }
    });
    lines.collect::<Vec<_>>().join("\n")
}

fn exposure(subject: Subject, seen: &Exposed) -> String {
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    // On a mirror ball the lamp's image clips, as it should.
    if seen.clipped > CLIPPED && !subject.is_shiny_ball() {
        return format!("{} clipped: shorten the exposure", percent(seen.clipped));
    }
    format!("{} x {} pixels, mean light {:.3}, {} dark", seen.size.0, seen.size.1, seen.mean, percent(seen.dark))
}
