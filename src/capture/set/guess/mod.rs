//! Subject, light and colour from the names of files, by a pattern that the user can see and change.

mod arrivals;
#[cfg(test)]
mod arrivals_tests;
mod doubt;
mod exposure;
mod name;
mod order;
mod pattern;
mod plan;
mod propose;
#[cfg(test)]
mod tests;
mod words;

use std::collections::HashMap;
use std::path::{Path, PathBuf};

pub use arrivals::{ArrivalOptions, Arrivals, Sequence, TakenFor, take_arrivals};
pub use doubt::Doubt;
pub use order::{TakenOrder, order_taken};
pub use pattern::{Guess, Pattern, PatternError};
pub use plan::{Place, named_subjects, plan};
pub use propose::propose;

use super::model::{CaptureSet, Channel, Colour, Shot};
use super::subject::Subject;

/// How files become shots.
#[derive(Clone, Debug)]
pub struct GuessOptions {
    /// How their names are built.
    pub pattern: Pattern,
    /// What files show whose names have no word for a subject.
    pub subject: Subject,
    /// Whether a file that names no colour is an RGB photo under lamps of all colours at once: a shot for each colour.
    pub rgb: bool,
    /// Whether any word in its place is a colour, and not only a word for one or a colour of the set.
    pub any_colour: bool,
    /// What the files in these folders show, as the user says.
    pub folders: HashMap<PathBuf, Subject>,
}

impl GuessOptions {
    /// Photos of the object whose names are built by `pattern`, each in one colour.
    pub fn of(pattern: Pattern) -> Self {
        Self { pattern, subject: Subject::Object, rgb: false, any_colour: false, folders: HashMap::new() }
    }
}

/// What a file became.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Became {
    /// A file of these shots of the set, by index; several for an RGB photo.
    Shots(Vec<usize>),
    /// Nothing, for it is in doubt what it is.
    Unassigned(Doubt),
}

/// Makes shots of files and adds them to a set, with the lights and colours that they name; reports for each file what it
/// became. A dark frame or flat field that its name alone shows is one, unless the pattern names subjects. A file that the
/// set already names in the same shot is not added twice.
pub fn add_files<P: AsRef<Path>>(set: &mut CaptureSet, files: &[P], options: &GuessOptions) -> Vec<Became> {
    let places = plan(set, files, options);
    let mut put = |(file, place): (&P, Result<Place, Doubt>)| match place {
        Ok(place) => Became::Shots(put(set, file.as_ref(), &place)),
        Err(doubt) => Became::Unassigned(doubt),
    };
    files.iter().zip(places).map(&mut put).collect()
}

/// Puts a file where it belongs; the indices of its shots.
pub fn put(set: &mut CaptureSet, file: &Path, place: &Place) -> Vec<usize> {
    let Place { subject, light, colour, rgb } = place;
    if !rgb {
        return vec![assign(set, file, *subject, light.as_deref(), colour.as_deref())];
    }
    let colours = rgb_colours(set);
    colours.iter().map(|colour| assign(set, file, *subject, light.as_deref(), Some(colour))).collect()
}

/// Whether the name of a file says that it is the object's mask.
pub fn is_mask_name(file: &Path) -> bool {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let is_of_ball = named_subjects(&[file])[0].is_some_and(|subject| subject.sphere_kind().is_some());
    words::is_mask(&stem) && !is_of_ball
}

/// Puts a file into the shot of a subject, light and colour, which is made if the set has none yet, as are light and
/// colour. Returns the shot's index.
pub fn assign(set: &mut CaptureSet, file: &Path, subject: Subject, light: Option<&str>, colour: Option<&str>) -> usize {
    set.know_names(light, colour);
    let written = set.written(file);
    let same =
        |shot: &Shot| shot.subject == subject && shot.light.as_deref() == light && shot.colour.as_deref() == colour;
    let index = set.shots.iter().position(same).unwrap_or_else(|| {
        let (light, colour) = (light.map(str::to_owned), colour.map(str::to_owned));
        set.shots.push(Shot { subject, light, colour, ..Shot::default() });
        set.shots.len() - 1
    });
    let files = &mut set.shots[index].files;
    if !files.contains(&written) {
        files.push(written);
    }
    index
}

/// The names of the colours that an RGB photo holds: those of the set, which is given red, green and blue if it has none.
fn rgb_colours(set: &mut CaptureSet) -> Vec<String> {
    if set.colours.is_empty() {
        let channels = [("red", Channel::R), ("green", Channel::G), ("blue", Channel::B)];
        set.colours = channels.map(|(name, channel)| Colour { name: name.into(), channel }).to_vec();
    }
    set.colours.iter().map(|colour| colour.name.clone()).collect()
}
