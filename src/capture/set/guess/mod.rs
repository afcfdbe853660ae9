//! Subject, light and colour from the names of files, by a pattern that the user can see and change.

mod pattern;
mod propose;
#[cfg(test)]
mod tests;

use std::path::Path;

pub use pattern::{Guess, Pattern, PatternError};
pub use propose::propose;

use super::model::{CaptureSet, Channel, Colour, Shot};
use super::subject::{Naming, Subject};

/// How files become shots.
#[derive(Clone, Debug)]
pub struct GuessOptions {
    /// How their names are built.
    pub pattern: Pattern,
    /// What files show whose pattern has no `{subject}`.
    pub subject: Subject,
    /// Whether a file that names no colour is an RGB photo under lamps of all colours at once: a shot for each colour.
    pub rgb: bool,
}

/// What a file became.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Became {
    /// A file of these shots of the set, by index; several for an RGB photo.
    Shots(Vec<usize>),
    /// Nothing: the name does not follow the pattern, or leaves out what the subject needs. In words.
    Unassigned(String),
}

/// Makes shots of files and adds them to a set, with the lights and colours that they name; reports for each file what it
/// became. A dark frame or flat field that its name alone shows is one, unless the pattern names subjects. A file that the
/// set already names in the same shot is not added twice.
pub fn add_files<P: AsRef<Path>>(set: &mut CaptureSet, files: &[P], options: &GuessOptions) -> Vec<Became> {
    let mut add = |file: &Path| {
        let guess = options.pattern.read(file);
        let tells_subject = guess.as_ref().is_some_and(|guess| guess.subject.is_some());
        match (pattern::correction_of_name(file).filter(|_| !tells_subject), guess) {
            (Some(subject), _) => Became::Shots(vec![assign(set, file, subject, None, None)]),
            (None, Some(guess)) => add_file(set, file, &guess, options),
            (None, None) => Became::Unassigned(format!("does not follow {}", options.pattern)),
        }
    };
    files.iter().map(|file| add(file.as_ref())).collect()
}

fn add_file(set: &mut CaptureSet, file: &Path, guess: &Guess, options: &GuessOptions) -> Became {
    let subject = guess.subject.unwrap_or(options.subject);
    let light = guess.light.as_deref().filter(|_| subject.light() != Naming::Refused);
    let colour = guess.colour.as_deref().filter(|_| subject.colour() != Naming::Refused);
    if light.is_none() && subject.light() == Naming::Required {
        return Became::Unassigned(format!("a photo of {subject} needs a light"));
    }
    if colour.is_none() && subject.colour() == Naming::Required {
        if !options.rgb {
            return Became::Unassigned(format!("a photo of {subject} needs a colour"));
        }
        let colours = rgb_colours(set);
        let shots = colours.iter().map(|colour| assign(set, file, subject, light, Some(colour)));
        return Became::Shots(shots.collect());
    }
    Became::Shots(vec![assign(set, file, subject, light, colour)])
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
