//! The pattern that explains the most of a list of files.

use std::collections::HashSet;
use std::path::Path;

use super::super::subject::Naming;
use super::pattern::{Guess, Pattern, is_colour_word};

/// Between the parts of a name.
const SEPARATORS: [&str; 4] = ["-", "_", ".", " "];

/// The pattern under which most files have a light and a colour that make a full table; `None` where none explains a
/// single file.
pub fn propose<P: AsRef<Path>>(files: &[P]) -> Option<Pattern> {
    candidates()
        .filter_map(|text| text.parse::<Pattern>().ok())
        .map(|pattern| (merit(&pattern, files), pattern))
        .filter(|(merit, _)| merit.explained > 0 && merit.convinces)
        // Of equals the first, which is the simplest.
        .reduce(|best, next| if next.0.beats(&best.0) { next } else { best })
        .map(|(_, pattern)| pattern)
}

/// Patterns from the usual to the unusual.
fn candidates() -> impl Iterator<Item = String> {
    let mut lit: Vec<String> = vec!["{light}/{colour}[-{repeat}]".into(), "{colour}/{light}[-{repeat}]".into()];
    for separator in SEPARATORS {
        for (first, second) in [("light", "colour"), ("colour", "light")] {
            lit.push(format!("{{{first}}}{separator}{{{second}}}[{separator}{{repeat}}]"));
        }
    }
    // Mirror balls are photographed in one colour, whose name is left out, and dark frames are only numbered.
    lit.extend(SEPARATORS.map(|separator| format!("{{light}}[{separator}{{colour}}][{separator}{{repeat}}]")));
    lit.push("{light}".into());
    let subjects = ["", "{subject}/", "{subject}-", "{subject}_", "{subject} ", "{subject}."];
    subjects.into_iter().flat_map(move |subject| lit.clone().into_iter().map(move |lit| format!("{subject}{lit}")))
}

/// How well a pattern explains files.
struct Merit {
    /// Files whose names follow it and say enough.
    explained: usize,
    /// Of those, how many name a colour by a word for a colour.
    colour_words: usize,
    /// Of those, how many name a subject.
    subjects: usize,
    /// Share of the cells of the light x colour tables that have a file.
    filled: f64,
    /// Whether it is more than a coincidence: any two parts of a name could be a light and a colour.
    convinces: bool,
    /// Different lights and colours: one word taken for many names is a worse explanation.
    names: usize,
}

impl Merit {
    fn beats(&self, other: &Self) -> bool {
        let rank = |merit: &Self| (merit.explained + merit.colour_words + merit.subjects) as f64 + merit.filled;
        let (mine, its) = (rank(self), rank(other));
        mine > its + 1e-9 || (mine > its - 1e-9 && self.names < other.names)
    }
}

fn merit<P: AsRef<Path>>(pattern: &Pattern, files: &[P]) -> Merit {
    let enough = |guess: &Guess| {
        let subject = guess.subject.unwrap_or_default();
        // A pattern that names no colour at all is one of RGB photos.
        guess.colour.is_some() || subject.colour() != Naming::Required || !pattern.names_colour()
    };
    let guesses: Vec<Guess> = files.iter().filter_map(|file| pattern.read(file.as_ref())).filter(enough).collect();
    let named = |name: fn(&Guess) -> &Option<String>| guesses.iter().map(name).collect::<HashSet<_>>().len();
    let (lights, colours) = (named(|guess| &guess.light), named(|guess| &guess.colour));
    let subjects: HashSet<_> = guesses.iter().map(|guess| guess.subject).collect();
    let cells: HashSet<_> = guesses.iter().map(|guess| (guess.subject, &guess.light, &guess.colour)).collect();
    let is_colour = |guess: &&Guess| guess.colour.as_deref().is_some_and(is_colour_word);
    let colour_words = guesses.iter().filter(is_colour).count();
    let named_subjects = guesses.iter().filter(|guess| guess.subject.is_some()).count();
    let full_table = lights > 1 && colours > 1 && cells.len() == subjects.len() * lights * colours;
    Merit {
        explained: guesses.len(),
        colour_words,
        subjects: named_subjects,
        filled: cells.len() as f64 / (subjects.len() * lights * colours).max(1) as f64,
        convinces: colour_words > 0 || named_subjects > 0 || full_table || !pattern.names_colour(),
        names: lights + colours,
    }
}
