//! Photos that arrive one after the other: what each is taken for, by its name or by its place in an order.

use std::path::{Path, PathBuf};

use super::super::model::CaptureSet;
use super::super::subject::{Naming, Subject};
use super::doubt::Doubt;
use super::order::order_taken;
use super::pattern::Pattern;
use super::plan::{Place, plan};
use super::propose::propose;
use super::{GuessOptions, is_mask_name, put};
use crate::image_file::TimeTaken;

/// How photos that arrive are taken.
#[derive(Clone, Debug, Default)]
pub struct ArrivalOptions {
    /// How their names are built; `None` for the pattern that explains the most of them.
    pub pattern: Option<Pattern>,
    /// What photos show whose names do not say it; `None` leaves them in doubt.
    pub sequence: Option<Sequence>,
}

/// An order in which photos are taken: one subject after the other, each under every light in every colour.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sequence {
    /// The subjects; one that has no light, as dark frames, takes all photos that are left.
    pub subjects: Vec<Subject>,
    /// Names of the lights; empty for those of the set.
    pub lights: Vec<String>,
    /// Names of the colours; empty for those of the set, and where it has none for photos of all colours at once.
    pub colours: Vec<String>,
    /// Whether all colours of one light come before the next light.
    pub colours_first: bool,
}

impl Default for Sequence {
    fn default() -> Self {
        Self { subjects: vec![Subject::Object], lights: Vec::new(), colours: Vec::new(), colours_first: true }
    }
}

/// What a photo was taken for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum TakenFor {
    /// The set names it already: its shots by index, none for the mask.
    Named(Vec<usize>),
    /// The truth of a rendered set.
    Truth,
    /// Its name is that of the object's mask.
    Mask,
    /// Its name says what it shows.
    ByName {
        /// The shots by index.
        shots: Vec<usize>,
        /// The pattern that its name follows.
        pattern: String,
    },
    /// The next place of the order.
    InOrder {
        /// The shots by index.
        shots: Vec<usize>,
        /// Whether the order is that of times; else that of names.
        by_time: bool,
        /// Whether times and names say different orders.
        is_in_doubt: bool,
    },
    /// Nothing yet.
    Unassigned(Doubt),
}

impl TakenFor {
    /// The shots that it became, by index.
    pub fn shots(&self) -> &[usize] {
        match self {
            Self::Named(shots) | Self::ByName { shots, .. } | Self::InOrder { shots, .. } => shots,
            Self::Truth | Self::Mask | Self::Unassigned(_) => &[],
        }
    }

    /// What it was taken for and by what, in words that follow its name; `set` is that of [`Arrivals`].
    pub fn described(&self, set: &CaptureSet) -> String {
        let shots: Vec<_> = self.shots().iter().filter_map(|&index| set.shots.get(index)).collect();
        let words = |shot: &&super::Shot| {
            let names = [Some(shot.subject.title()), shot.light.as_deref(), shot.colour.as_deref()];
            names.into_iter().flatten().collect::<Vec<_>>().join(" ")
        };
        let shots = shots.iter().map(words).collect::<Vec<_>>().join(" and ");
        match self {
            Self::Named(of) if of.is_empty() => "the object's mask".into(),
            Self::Named(_) => shots,
            Self::Truth => "the truth, no photo".into(),
            Self::Mask => "the object's mask (by its name)".into(),
            Self::ByName { pattern, .. } => format!("{shots} (by its name, {pattern})"),
            Self::InOrder { by_time, is_in_doubt, .. } => {
                let by = if *by_time { "the time it was taken" } else { "the number in its name" };
                let doubt = if *is_in_doubt { "; times and names say different orders: look at it" } else { "" };
                format!("{shots} (in order, by {by}{doubt})")
            }
            Self::Unassigned(doubt) => format!("not assigned: {doubt}"),
        }
    }
}

/// A set with the photos that arrived.
#[derive(Clone, Debug)]
pub struct Arrivals {
    /// The set after them.
    pub set: CaptureSet,
    /// By file, in the order in which they were given.
    pub taken: Vec<TakenFor>,
}

/// Puts photos that arrived into a set: those that it names as they are, others by their names, and those whose names do not
/// say enough by `options.sequence` in the order in which they were taken. A photo takes the place of files that the set
/// names and that are not there; it never replaces one that is.
///
/// `files` may be all that arrived so far, over the set as it was before the first, or those alone that are new or were left
/// unassigned, over the set that the others made. The first is surer: a file that comes late still finds its place in the order.
pub fn take_arrivals<P: AsRef<Path>>(
    set: &CaptureSet,
    files: &[P],
    options: &ArrivalOptions,
    time_taken: impl Fn(&Path) -> Option<TimeTaken>,
) -> Arrivals {
    let mut set = set.clone();
    let mut taken: Vec<Option<TakenFor>> = files.iter().map(|file| named(&set, file.as_ref())).collect();
    for (file, taken) in files.iter().zip(&mut taken).filter(|(_, taken)| taken.is_none()) {
        if is_mask_name(file.as_ref()) {
            *taken = Some(take_mask(&mut set, file.as_ref()));
        }
    }
    let open: Vec<usize> = (0..files.len()).filter(|index| taken[*index].is_none()).collect();
    let paths: Vec<&Path> = open.iter().map(|&index| files[index].as_ref()).collect();
    let mut doubts = Vec::new();
    for (index, (place, pattern)) in open.into_iter().zip(by_names(&set, &paths, options)) {
        match place {
            Ok(place) => {
                taken[index] = Some(TakenFor::ByName { shots: fill(&mut set, files[index].as_ref(), &place), pattern })
            }
            Err(doubt) => doubts.push((index, doubt)),
        }
    }
    if let Some(sequence) = &options.sequence {
        let (silent, others): (Vec<_>, Vec<_>) = doubts.into_iter().partition(|(_, doubt)| doubt.is_of_silent_name());
        doubts = others;
        let silent: Vec<usize> = silent.into_iter().map(|(index, _)| index).collect();
        let paths: Vec<&Path> = silent.iter().map(|&index| files[index].as_ref()).collect();
        let order = order_taken(&paths, time_taken);
        let (by_time, is_in_doubt) = (order.by_time.is_some(), order.disagrees());
        let mut places =
            sequence.places(&set).into_iter().filter(|place| is_free(&set, place)).collect::<Vec<_>>().into_iter();
        for &at in order.order() {
            let Some(place) = places.next().or_else(|| sequence.rest()) else {
                doubts.push((silent[at], Doubt::OrderIsFull));
                continue;
            };
            let shots = fill(&mut set, paths[at], &place);
            taken[silent[at]] = Some(TakenFor::InOrder { shots, by_time, is_in_doubt });
        }
    }
    doubts.into_iter().for_each(|(index, doubt)| taken[index] = Some(TakenFor::Unassigned(doubt)));
    // Each file has had its turn.
    Arrivals { set, taken: taken.into_iter().flatten().collect() }
}

/// What the set names a file for; `None` for a file that it does not name.
fn named(set: &CaptureSet, file: &Path) -> Option<TakenFor> {
    let is_it = |written: &String| set.resolve(written) == file;
    let shots = set.shots.iter().enumerate().filter(|(_, shot)| shot.files.iter().any(is_it));
    let shots: Vec<usize> = shots.map(|(index, _)| index).collect();
    if is_truth(set, file) {
        return Some(TakenFor::Truth);
    }
    (!shots.is_empty() || set.mask.as_ref().is_some_and(is_it)).then_some(TakenFor::Named(shots))
}

/// Bounces whose truth a set may hold.
const MAX_TRUTH_BOUNCES: usize = 9;

fn is_truth(set: &CaptureSet, file: &Path) -> bool {
    let bounces =
        (1..=MAX_TRUTH_BOUNCES).flat_map(|k| set.lights.iter().map(move |light| set.truth_bounce(k, &light.name)));
    set.truth_normals() == file || set.truth_depth() == file || bounces.into_iter().any(|bounce| bounce == file)
}

fn take_mask(set: &mut CaptureSet, file: &Path) -> TakenFor {
    if let Some(mask) = set.mask.clone().filter(|mask| set.resolve(mask).is_file()) {
        return TakenFor::Unassigned(Doubt::SecondMask { mask });
    }
    set.mask = Some(set.written(file));
    TakenFor::Mask
}

/// What each file is by its name, and by which pattern.
fn by_names(set: &CaptureSet, files: &[&Path], options: &ArrivalOptions) -> Vec<(Result<Place, Doubt>, String)> {
    // Those that are there already say how the others are named.
    let known: Vec<PathBuf> = set.distinct_files().into_keys().map(|file| set.resolve(file)).collect();
    let all: Vec<&Path> = known.iter().map(PathBuf::as_path).chain(files.iter().copied()).collect();
    let pattern = options.pattern.clone().or_else(|| propose(&all)).or_else(|| propose(files));
    let Some(pattern) = pattern else {
        return files.iter().map(|_| (Err(Doubt::NoNames), String::new())).collect();
    };
    let text = pattern.to_string();
    let rgb = !pattern.names_colour();
    let places = plan(set, files, &GuessOptions { rgb, ..GuessOptions::of(pattern) });
    places.into_iter().map(|place| (place, text.clone())).collect()
}

/// Whether nothing that is there shows this.
fn is_free(set: &CaptureSet, place: &Place) -> bool {
    let is_there = |file: &String| set.resolve(file).is_file();
    !set.shots.iter().any(|shot| is_of(shot, place) && shot.files.iter().any(is_there))
}

fn is_of(shot: &super::Shot, place: &Place) -> bool {
    shot.subject == place.subject && shot.light == place.light && (place.rgb || shot.colour == place.colour)
}

/// Puts a file where it belongs, in place of files that are not there.
fn fill(set: &mut CaptureSet, file: &Path, place: &Place) -> Vec<usize> {
    if is_free(set, place) {
        for shot in set.shots.iter_mut().filter(|shot| is_of(shot, place)) {
            (shot.files, shot.exposures) = (Vec::new(), Vec::new());
        }
    }
    put(set, file, place)
}

impl Sequence {
    /// Every place of the order.
    fn places(&self, set: &CaptureSet) -> Vec<Place> {
        let names = |own: &[String], of_set: &mut dyn Iterator<Item = &String>| -> Vec<String> {
            if own.is_empty() { of_set.cloned().collect() } else { own.to_vec() }
        };
        let lights = names(&self.lights, &mut set.lights.iter().map(|light| &light.name));
        let colours = names(&self.colours, &mut set.colours.iter().map(|colour| &colour.name));
        let lit = self.subjects.iter().filter(|subject| subject.light() == Naming::Required);
        let of_subject = |subject: &Subject| {
            let needs_colour = subject.colour() == Naming::Required;
            let rgb = needs_colour && colours.is_empty();
            let named = colours.iter().filter(|_| needs_colour).cloned().map(Some);
            let colours: Vec<Option<String>> = if needs_colour && !rgb { named.collect() } else { vec![None] };
            let place = |light: &String, colour: &Option<String>| Place {
                subject: *subject,
                light: Some(light.clone()),
                colour: colour.clone(),
                rgb,
            };
            let places: Vec<Place> = if self.colours_first {
                lights.iter().flat_map(|light| colours.iter().map(move |colour| place(light, colour))).collect()
            } else {
                colours.iter().flat_map(|colour| lights.iter().map(move |light| place(light, colour))).collect()
            };
            places
        };
        lit.flat_map(of_subject).collect()
    }

    /// What photos beyond the order show.
    fn rest(&self) -> Option<Place> {
        let subject = self.subjects.iter().copied().find(|subject| subject.light() == Naming::Refused)?;
        Some(Place { subject, light: None, colour: None, rgb: false })
    }
}
