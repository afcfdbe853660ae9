//! The pattern that explains the most of a list of files.

use std::collections::HashSet;
use std::path::Path;
use std::sync::LazyLock;

use super::super::subject::Naming;
use super::name::{Name, names_of};
use super::pattern::{Guess, Pattern};
use super::words::is_camera_count;

/// Between the parts of a name.
const SEPARATORS: [&str; 4] = ["-", "_", ".", " "];

/// Patterns from the usual to the unusual, made once.
static CANDIDATES: LazyLock<Vec<Pattern>> = LazyLock::new(|| {
    let mut lit: Vec<String> = vec!["{light}/{colour}[-{repeat}]".into(), "{colour}/{light}[-{repeat}]".into()];
    for separator in SEPARATORS {
        for (first, second) in [("light", "colour"), ("colour", "light")] {
            lit.push(format!("{{{first}}}{separator}{{{second}}}[{separator}{{repeat}}]"));
        }
    }
    // Mirror balls are photographed in one colour, whose name is left out, and dark frames are only numbered.
    lit.extend(SEPARATORS.map(|separator| format!("{{light}}[{separator}{{colour}}][{separator}{{repeat}}]")));
    lit.push("{light}".into());
    // Words for a subject at any other place are found without a field for them.
    let texts = ["{subject}/", ""].into_iter().flat_map(|subject| lit.iter().map(move |lit| format!("{subject}{lit}")));
    texts.filter_map(|text| text.parse().ok()).collect()
});

/// The pattern under which most files have a light and a colour that make a full table; `None` where none explains a
/// single file.
pub fn propose<P: AsRef<Path>>(files: &[P]) -> Option<Pattern> {
    let names: Vec<Name> = names_of(files).into_iter().flatten().collect();
    CANDIDATES
        .iter()
        .map(|pattern| (merit(pattern, &names), pattern))
        .filter(|(merit, _)| merit.explained > 0 && merit.convinces)
        // Of equals the first, which is the simplest.
        .reduce(|best, next| if next.0.beats(&best.0) { next } else { best })
        .map(|(_, pattern)| pattern.clone())
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
    /// Whether it is more than a coincidence: any two parts of a name could be a light and a colour, and a camera's
    /// count is neither.
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

fn merit(pattern: &Pattern, names: &[Name]) -> Merit {
    let enough = |guess: &Guess| {
        let subject = guess.subject.unwrap_or_default();
        // A pattern that names no colour at all is one of RGB photos.
        guess.colour.is_some() || subject.colour() != Naming::Required || !pattern.names_colour()
    };
    let lit = names.iter().filter(|name| name.correction.is_none() || pattern.names_subject());
    let guesses: Vec<Guess> = lit.filter_map(|name| name.read_strictly(pattern)).filter(enough).collect();
    let named = |name: fn(&Guess) -> &Option<String>| guesses.iter().map(name).collect::<HashSet<_>>().len();
    let (lights, colours) = (named(|guess| &guess.light), named(|guess| &guess.colour));
    let subjects: HashSet<_> = guesses.iter().map(|guess| guess.subject).collect();
    let cells: HashSet<_> = guesses.iter().map(|guess| (guess.subject, &guess.light, &guess.colour)).collect();
    let colour_words = guesses.iter().filter(|guess| guess.colour.is_some()).count();
    let named_subjects = guesses.iter().filter(|guess| guess.subject.is_some()).count();
    let is_count = |light: &String| is_camera_count(light) || (colour_words == 0 && light.parse::<u64>().is_ok());
    let counted = guesses.iter().filter_map(|guess| guess.light.as_ref()).filter(|light| is_count(light)).count();
    Merit {
        explained: guesses.len(),
        colour_words,
        subjects: named_subjects,
        filled: cells.len() as f64 / (subjects.len() * lights * colours).max(1) as f64,
        convinces: 2 * counted <= guesses.len() && (colour_words > 0 || named_subjects > 0),
        names: lights + colours,
    }
}
