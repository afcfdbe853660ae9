//! What names and words must be: the same words and the same test for the reader and for a set in memory.

/// What a point in a picture must be.
pub(super) const POINT: &str = "two numbers [x, y]";

/// Characters that some system refuses in a file name.
const NOT_IN_FILE_NAMES: &[char] = &['/', '\\', ':', '*', '?', '"', '<', '>', '|'];

/// File systems end a name at 255 bytes, and an output's name is longer than its light's.
const MAX_NAME_BYTES: usize = 200;

/// Why `name` cannot be part of the name of an output file.
pub(super) fn unusable_name(name: &str) -> Option<String> {
    if name.is_empty() {
        return Some("expected a name, found \"\"".into());
    }
    if name.trim() != name {
        return Some(format!("{name:?} begins or ends with a space; leave it out"));
    }
    let bytes = name.len();
    if bytes > MAX_NAME_BYTES {
        return Some(format!("{bytes} bytes are too long for a name; at most {MAX_NAME_BYTES} fit in file names"));
    }
    let culprit = name.chars().find(|c| c.is_control() || NOT_IN_FILE_NAMES.contains(c))?;
    Some(format!("{name:?} names output files too, and they cannot hold {culprit:?}; choose another name"))
}

/// Whether `name` can stand in the name of an output file.
pub(crate) fn is_usable_name(name: &str) -> bool {
    unusable_name(name).is_none()
}

/// The known word that a misspelt one was probably meant to be.
pub(super) fn nearest<'w>(found: &str, known: impl IntoIterator<Item = &'w str>) -> Option<&'w str> {
    let letters = found.chars().count();
    let near = |word: &'w str| {
        let (of_word, most) = (word.chars().count(), (word.chars().count() / 3).max(1));
        // Comparing takes long where both are long, and words of other lengths are never near.
        let distance = (letters.abs_diff(of_word) <= most).then(|| strsim::damerau_levenshtein(found, word));
        distance.filter(|distance| *distance <= most).map(|distance| (distance, word))
    };
    known.into_iter().filter_map(near).min().map(|(_, word)| word)
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
