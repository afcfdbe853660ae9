//! `firstbounce watch FOLDER`

use std::path::{Path, PathBuf};
use std::sync::Mutex;
use std::thread;
use std::time::Duration;

use clap::Args;
use firstbounce_capture::CaptureSet;
use firstbounce_capture::export::OutputOptions;
use firstbounce_capture::image_file::{read_mask, time_taken};
use firstbounce_capture::pipeline::{Exposed, PhotoStore, PipelineWatch, SolveOptions, Unattended, region_of};
use firstbounce_capture::set::{
    ArrivalOptions, Arrivals, FILE_NAME, Pattern, Sequence, Shot, Subject, TakenFor, Word, take_arrivals,
};
use firstbounce_capture::watch_folder::{Following, WatchEvent, WatchFolderOptions};

use super::progress::Terminal;
use super::solve::solve_into;
use super::{print, print_error};

/// How long to wait for photos before looking whether the user wants to end. Photos of one light that come closer together are
/// solved together.
const PATIENCE: Duration = Duration::from_millis(200);
/// Above this share of clipped pixels a photo is worth a word.
const CLIPPED: f64 = 0.001;
/// Normals need as many.
const MIN_LIGHTS: usize = 3;

#[derive(Args, Debug)]
pub struct WatchArgs {
    /// A folder that photos arrive in; its capture.toml, where it has one, names the photos that are to come
    #[arg(value_name = "FOLDER")]
    folder: PathBuf,
    /// Where to write the results each time another light is complete [default: nowhere, photos are only checked]
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Look through the folder as often as this, for shares that report no changes
    #[arg(long, value_name = "SECONDS", default_value_t = WatchFolderOptions::default().poll.as_secs_f64())]
    poll: f64,
    /// End once every photo is there that capture.toml, or --lights and --colours, name
    #[arg(long)]
    until_complete: bool,
    /// How names are built that capture.toml does not have, as "{subject}/{light}-{colour}" [default: what explains the most]
    #[arg(long, value_name = "PATTERN")]
    pattern: Option<Pattern>,
    /// Take photos whose names say nothing in the order in which they are taken
    #[arg(long)]
    in_order: bool,
    /// The lights, in their order [default: those of capture.toml, and those that names have]
    #[arg(long, value_name = "NAME,..", value_delimiter = ',')]
    lights: Vec<String>,
    /// The colours, the reference first [default: likewise]
    #[arg(long, value_name = "NAME,..", value_delimiter = ',')]
    colours: Vec<String>,
    /// With --in-order: what is photographed, one after the other
    #[arg(long, value_name = "SUBJECT,..", value_delimiter = ',', default_value = "object", requires = "in_order", value_parser = subject)]
    subjects: Vec<Subject>,
    /// With --in-order: all lights of a colour come before the next colour, in place of all colours of a light
    #[arg(long, requires = "in_order")]
    lights_first: bool,
}

fn subject(word: &str) -> Result<Subject, String> {
    let words = || Subject::ALL.iter().map(|subject| subject.word()).collect::<Vec<_>>().join(", ");
    Subject::from_word(word).ok_or_else(|| format!("there are {}", words()))
}

/// Runs the command, until it is cancelled.
pub fn run(args: &WatchArgs) -> anyhow::Result<()> {
    let terminal = Terminal::attend();
    let poll = Duration::try_from_secs_f64(args.poll).map_err(|error| anyhow::anyhow!("--poll: {error}"))?;
    let options = WatchFolderOptions { poll, ..WatchFolderOptions::default() };
    let watch = Watched::of(args)?;
    let following = Following::start(&args.folder, options, || ())?;
    let failure = Mutex::new(None);
    // Photos are reported while a solution is computed.
    thread::scope(|scope| -> anyhow::Result<()> {
        let (mut files, mut arrivals): (Vec<PathBuf>, _) = (Vec::new(), watch.arrivals(&[])?);
        let (mut complete, mut is_unsolved) = (Vec::new(), false);
        let mut solving: Option<thread::ScopedJoinHandle<'_, ()>> = None;
        while !terminal.cancelled() {
            match following.next(PATIENCE) {
                Some(WatchEvent::Arrived(mut arrived)) => {
                    // What is written there is no photo.
                    arrived.retain(|file| args.out.as_ref().is_none_or(|out| !file.starts_with(out)));
                    if arrived.is_empty() {
                        continue;
                    }
                    files.extend(arrived.iter().filter(|file| !files.contains(file)).cloned().collect::<Vec<_>>());
                    files.retain(|file| file.is_file());
                    let now = match watch.arrivals(&files) {
                        Ok(now) => now,
                        Err(error) => {
                            // The user is writing the capture file: the photos stay, and come with the next ones.
                            print_error(&error);
                            continue;
                        }
                    };
                    report(&files, &arrived, &arrivals, &now)?;
                    arrivals = now;
                    let (present, _) = arrivals.set.present();
                    let lights: Vec<String> = present.lights.iter().map(|light| light.name.clone()).collect();
                    for light in lights.iter().filter(|light| !complete.contains(*light)) {
                        let (count, all) = (lights.len(), arrivals.set.lights.len());
                        print(&format!("light {light} is complete ({count} of {all})"))?;
                    }
                    (complete, is_unsolved) = (lights, true);
                    continue;
                }
                Some(WatchEvent::Polled { reason }) => {
                    let seconds = args.poll;
                    print(&format!("no changes are reported here ({reason}): looked through every {seconds} seconds"))?;
                }
                Some(WatchEvent::Ended(error)) => return Err(error.into()),
                None => {}
            }
            if solving.as_ref().is_some_and(|running| !running.is_finished()) {
                continue;
            }
            if let (true, Some(out)) = (is_unsolved && complete.len() >= MIN_LIGHTS, &args.out) {
                let (present, _) = arrivals.set.present();
                let (terminal, failure) = (&terminal, &failure);
                solving = Some(scope.spawn(move || {
                    // A set that cannot be solved yet is waited for, as is room on the disk.
                    let solved = solved(&present, out, terminal);
                    let failed = solved.map_err(|error| print_error(&error)).is_err();
                    *failure.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = Some(failed);
                }));
                is_unsolved = false;
                continue;
            }
            is_unsolved = false;
            if args.until_complete && watch.is_complete(&arrivals.set) {
                break;
            }
        }
        Ok(())
    })?;
    let failed = failure.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    anyhow::ensure!(failed != Some(true) || !args.until_complete, "every photo is there, and the set is not solved");
    Ok(())
}

/// What the folder is to become.
struct Watched<'a> {
    args: &'a WatchArgs,
    options: ArrivalOptions,
}

impl<'a> Watched<'a> {
    fn of(args: &'a WatchArgs) -> anyhow::Result<Self> {
        let sequence = args.in_order.then(|| Sequence {
            subjects: args.subjects.clone(),
            lights: args.lights.clone(),
            colours: args.colours.clone(),
            colours_first: !args.lights_first,
        });
        let watched = Self { args, options: ArrivalOptions { pattern: args.pattern.clone(), sequence } };
        let is_planned = watched.planned()?.is_some() || (!args.lights.is_empty() && !args.colours.is_empty());
        let needs = "neither capture.toml nor --lights and --colours say which photos are to come";
        anyhow::ensure!(!args.until_complete || is_planned, "--until-complete: {needs}");
        let has_lights = !args.lights.is_empty() || watched.base()?.lights.len() >= MIN_LIGHTS;
        anyhow::ensure!(!args.in_order || has_lights, "--in-order: name the lights in their order with --lights");
        Ok(watched)
    }

    /// The set that a capture file plans; read again each time, for the user may go on writing it.
    fn planned(&self) -> anyhow::Result<Option<CaptureSet>> {
        let folder = &self.args.folder;
        let is_set = folder.is_file() || folder.join(FILE_NAME).is_file();
        Ok(is_set.then(|| CaptureSet::open(folder)).transpose()?)
    }

    /// The set before any photo arrives that it does not name.
    fn base(&self) -> anyhow::Result<CaptureSet> {
        let bare = || CaptureSet { folder: self.args.folder.clone(), ..CaptureSet::default() };
        let mut set = self.planned()?.unwrap_or_else(bare);
        self.args.lights.iter().for_each(|light| set.know_names(Some(light), None));
        self.args.colours.iter().for_each(|colour| set.know_names(None, Some(colour)));
        Ok(set)
    }

    fn arrivals(&self, files: &[PathBuf]) -> anyhow::Result<Arrivals> {
        Ok(take_arrivals(&self.base()?, files, &self.options, time_taken))
    }

    fn is_complete(&self, set: &CaptureSet) -> bool {
        let (present, missing) = set.present();
        missing.is_empty() && present.lights.len() == set.lights.len() && !set.lights.is_empty()
    }
}

/// Prints a line for each photo that arrived, and for each earlier one that is taken for something else now.
fn report(files: &[PathBuf], arrived: &[PathBuf], before: &Arrivals, after: &Arrivals) -> anyhow::Result<()> {
    let shown = |of: &Arrivals, file: &Path| {
        let written = of.set.written(file);
        let shots = of.set.shots.iter().filter(|shot| shot.files.contains(&written));
        shots.map(Shot::described).collect::<Vec<_>>()
    };
    for (file, taken) in files.iter().zip(&after.taken) {
        let was = shown(before, file);
        if arrived.contains(file) {
            print(&line(&after.set, file, taken))?;
        } else if !was.is_empty() && was != shown(after, file) {
            print(&format!("{}: now {}", after.set.written(file), taken.described(&after.set)))?;
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

/// What a photo was taken for, and whether its exposure will do.
fn line(set: &CaptureSet, file: &Path, taken: &TakenFor) -> String {
    let written = set.written(file);
    let described = taken.described(set);
    let mut of_file = set.clone();
    let shots = taken.shots().iter().filter_map(|&index| set.shots.get(index)).cloned();
    // A photo of a bracket or of repeats is looked at by itself.
    of_file.shots = shots.map(|shot| Shot { files: vec![written.clone()], exposures: Vec::new(), ..shot }).collect();
    let shots: Vec<&Shot> = of_file.shots.iter().collect();
    let mask = of_file.mask.as_ref().and_then(|mask| read_mask(&of_file.resolve(mask)).ok()).map(|file| file.mask);
    let lights = PhotoStore::default().read(&of_file, &shots, &Unattended).unwrap_or_default();
    // An RGB photo clips where one of its channels does.
    let exposed = shots.iter().zip(&lights).map(|(shot, light)| {
        let photo = &light.as_ref().map_err(ToString::to_string)?.photo;
        let region = region_of(&of_file, shot, mask.as_ref(), photo.linear.size());
        Ok((shot.subject, Exposed::of(photo, region.as_ref())))
    });
    match exposed.collect::<Result<Vec<_>, String>>() {
        Ok(seen) => {
            let worst = seen.iter().max_by(|(_, a), (_, b)| a.clipped.total_cmp(&b.clipped));
            let exposure = worst.map_or_else(String::new, |(subject, seen)| format!(", {}", exposure(*subject, seen)));
            format!("{written}: {described}{exposure}")
        }
        Err(error) => format!("{error} ({described})"),
    }
}

fn exposure(subject: Subject, seen: &Exposed) -> String {
    let percent = |share: f64| format!("{:.1} %", 100.0 * share);
    // On a mirror ball the lamp's image clips, as it should.
    if seen.clipped > CLIPPED && !subject.is_shiny_ball() {
        return format!("{} clipped: shorten the exposure", percent(seen.clipped));
    }
    format!("{} x {} pixels, mean light {:.3}, {} dark", seen.size.0, seen.size.1, seen.mean, percent(seen.dark))
}
