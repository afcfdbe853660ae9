//! Rules for values: the same words and the same test for the reader and for a set in memory.

/// What a number must be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    Finite,
    Positive,
    NotNegative,
    Albedo,
    Share,
}

impl Rule {
    pub(super) fn holds(self, number: f64) -> bool {
        number.is_finite()
            && match self {
                Self::Finite => true,
                Self::Positive => number > 0.0,
                Self::NotNegative => number >= 0.0,
                Self::Albedo => number > 0.0 && number <= 1.0,
                Self::Share => (0.0..1.0).contains(&number),
            }
    }

    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Finite => "a number",
            Self::Positive => "a positive number",
            Self::NotNegative => "a number that is not negative",
            Self::Albedo => "an albedo above 0 and at most 1",
            Self::Share => "a share from 0 and below 1",
        }
    }
}

/// The most near-light iterations that a file may ask for.
pub(super) const MAX_ROUNDS: usize = 100;
/// What their number must be.
pub(super) const ROUNDS: &str = "a whole number from 1 to 100";
/// What the half width of a window must be.
pub(super) const WINDOW: &str = "a whole number of pixels from 0 to 64";

/// What a direction or a position must be.
pub(super) const VECTOR: &str = "three numbers [x, y, z], not all zero";

/// Whether `vector` points anywhere.
pub(super) fn is_vector(vector: &[f64; 3]) -> bool {
    let length = length(vector);
    length.is_finite() && length > 0.0
}

pub(super) fn length(vector: &[f64; 3]) -> f64 {
    vector.iter().fold(0.0, |length: f64, x| length.hypot(*x))
}

/// What a point in a picture must be.
pub(super) const POINT: &str = "two numbers [x, y]";

/// Characters that some system refuses in a file name.
const NOT_IN_FILE_NAMES: &[char] = &['/', '\\', ':', '*', '?', '"', '<', '>', '|'];

/// Why `name` cannot be part of the name of an output file.
pub(super) fn unusable_name(name: &str) -> Option<String> {
    if name.is_empty() {
        return Some("expected a name, found \"\"".into());
    }
    if name.trim() != name {
        return Some(format!("{name:?} begins or ends with a space; leave it out"));
    }
    let culprit = name.chars().find(|c| c.is_control() || NOT_IN_FILE_NAMES.contains(c))?;
    Some(format!("{name:?} names output files too, and they cannot hold {culprit:?}; choose another name"))
}

/// The known word that a misspelt one was probably meant to be.
pub(super) fn nearest<'w>(found: &str, known: impl IntoIterator<Item = &'w str>) -> Option<&'w str> {
    known
        .into_iter()
        .map(|word| (strsim::damerau_levenshtein(found, word), word))
        .filter(|(distance, word)| *distance <= (word.chars().count() / 3).max(1))
        .min()
        .map(|(_, word)| word)
}

/// The same as the end of a sentence.
pub(super) fn did_you_mean<'w>(found: &str, known: impl IntoIterator<Item = &'w str>) -> String {
    nearest(found, known).map_or(String::new(), |word| format!("; did you mean {word:?}?"))
}

/// `"a", "b" or "c"`
pub(super) fn one_of<'w>(words: impl IntoIterator<Item = &'w str>) -> String {
    let mut quoted: Vec<String> = words.into_iter().map(|word| format!("{word:?}")).collect();
    match quoted.pop() {
        Some(last) if !quoted.is_empty() => format!("{} or {last}", quoted.join(", ")),
        Some(only) => only,
        None => "nothing".into(),
    }
}
