//! Words in the names of files and folders: for subjects and for colours, in the languages of the field.

use std::ops::Range;
use std::sync::LazyLock;

use regex::{Regex, RegexBuilder};

use super::super::subject::{SphereKind, Subject};
use super::super::word::Word;

/// Words for a ball, of whatever kind.
const BALLS: &[&str] = &[
    "ball",
    "sphere",
    "kugel",
    "kugeln",
    "boule",
    "bille",
    "sphère",
    "esfera",
    "bola",
    "sfera",
    "sfere",
    "palla",
    "球",
    "球体",
    "ボール",
];

/// Words for colours, as lamps and channels are called.
const COLOURS: &[&str] = &[
    "red", "green", "blue", "white", "cyan", "magenta", "yellow", "amber", "orange", "violet", "purple", "uv", "ir",
    "nir", "lime", "r", "g", "b", "rot", "grün", "blau", "weiß", "gelb", "violett", "rouge", "vert", "bleu", "blanc",
    "jaune", "rojo", "verde", "azul", "blanco", "amarillo", "rosso", "blu", "bianco", "giallo", "红", "红色", "绿",
    "绿色", "蓝", "蓝色", "白", "白色", "黄", "黄色", "紅", "赤", "緑", "綠", "青", "藍",
];

/// What may stand before a word for a colour.
const SHADES: &str = "deep|dark|light|royal|far|hyper|warm|cool|cold";

/// Between the parts of a name.
pub(super) const SEPARATORS: &[char] = &['-', '_', ' ', '.', '(', ')', '[', ']'];

/// What the words of a folder, or of a file's name, say that it shows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Named {
    Nothing,
    Subject(Subject),
    /// A ball of an unknown kind.
    SomeBall,
    Several,
}

/// A word as a regular expression: a hyphen is any separator or none, and a letter with a mark may come without it, or
/// with the mark as a character of its own, as some systems store names.
fn expression(word: &str) -> String {
    let letters = word.chars().map(|letter| match letter {
        '-' => "[-_ .]?".into(),
        'ä' => "(?:ä|a\u{308}|ae|a)".into(),
        'ö' => "(?:ö|o\u{308}|oe|o)".into(),
        'ü' => "(?:ü|u\u{308}|ue|u)".into(),
        'ß' => "(?:ß|ss)".into(),
        'é' | 'è' => "(?:[éè]|e[\u{300}\u{301}]?)".into(),
        letter => regex::escape(letter.encode_utf8(&mut [0; 4])),
    });
    letters.collect()
}

/// Whether words like this one are kept apart by separators, and have a plural.
fn is_latin(word: &&&str) -> bool {
    word.chars().all(|letter| letter < '\u{250}')
}

/// Any of the words, in an alphabet with separators or in one without.
fn one_of(words: &[&str], latin: bool) -> String {
    let words = words.iter().filter(|word| is_latin(word) == latin).map(|word| expression(word));
    let plural = if latin { "s?" } else { "" };
    format!("(?:(?:{}){plural})", words.collect::<Vec<_>>().join("|"))
}

/// Words that by themselves mean a subject, or those that do so together.
#[derive(Clone, Copy)]
enum Words {
    /// "grey ball", "Graukugel", "boule grise"
    Together,
    /// "object", "chrome"
    Alone,
}

fn of_subject(subject: Subject, words: Words, latin: bool) -> Option<String> {
    let names = || subject.names().iter().any(|word| is_latin(&word) == latin).then(|| one_of(subject.names(), latin));
    let is_first_place = |kind: &SphereKind| kind.subject() == subject;
    match (words, subject.sphere_kind()) {
        // "Mirror ball" is the ball in its first place: of another place all words together tell.
        (Words::Together, Some(kind)) if !is_first_place(&kind) => names(),
        (Words::Alone, Some(kind)) if !is_first_place(&kind) => None,
        (Words::Alone, _) => names(),
        (Words::Together, None) => None,
        (Words::Together, Some(kind)) => {
            let (made_of, ball) = (one_of(kind.made_of(), latin), one_of(BALLS, latin));
            Some(match latin {
                true => format!("(?:{made_of}[-_ .]?{ball}|{ball}[-_ .]?(?:(?:of|de|di)[-_ .])?{made_of})"),
                false => format!("(?:{made_of}[的の]?{ball})"),
            })
        }
    }
}

/// Every word for some subjects; those of several words first, so that "grey ball" is not read as "grey", nor "mirror ball
/// moved" as "mirror ball".
fn of_subjects(subjects: &[Subject]) -> String {
    let all = [(Words::Together, true), (Words::Together, false), (Words::Alone, true), (Words::Alone, false)];
    let of = |(words, latin)| subjects.iter().rev().filter_map(move |subject| of_subject(*subject, words, latin));
    all.into_iter().flat_map(of).collect::<Vec<_>>().join("|")
}

/// The expression of the field `{subject}`: every word for every subject.
pub(super) fn subject_field() -> String {
    of_subjects(Subject::ALL)
}

/// The expression of the field `{colour}`: words for colours alone.
pub(super) fn colour_field() -> String {
    let words: Vec<String> = COLOURS.iter().map(|word| expression(word)).collect();
    format!(r"(?:(?:{SHADES})[-_ ]?)?(?:{})|[0-9]+[-_ ]?nm", words.join("|"))
}

/// Words for a subject as they are looked for.
struct SubjectWords {
    subject: Subject,
    together: Option<Regex>,
    alone: Option<Regex>,
    whole: Regex,
}

static SUBJECT_WORDS: LazyLock<Vec<SubjectWords>> = LazyLock::new(|| {
    let of = |&subject: &Subject| {
        let within = |words| within_name([true, false].map(|latin| of_subject(subject, words, latin)));
        let whole = regex(&format!("^(?:{})$", of_subjects(&[subject])))?;
        Some(SubjectWords { subject, together: within(Words::Together), alone: within(Words::Alone), whole })
    };
    Subject::ALL.iter().filter_map(of).collect()
});

static SOME_BALL: LazyLock<Option<Regex>> =
    LazyLock::new(|| within_name([true, false].map(|latin| Some(one_of(BALLS, latin)))));

static COLOUR: LazyLock<Option<Regex>> = LazyLock::new(|| regex(&format!("^(?:{})$", colour_field())));

/// Our own words make no expression that could be refused.
fn regex(text: &str) -> Option<Regex> {
    RegexBuilder::new(text).case_insensitive(true).build().ok()
}

/// Finds words within a name: between separators where their alphabet has them. A number may follow without one.
fn within_name([latin, other]: [Option<String>; 2]) -> Option<Regex> {
    if latin.is_none() && other.is_none() {
        return None;
    }
    let latin = latin.map(|words| format!(r"(?:^|[^\p{{L}}])(?<latin>{words}\d*)(?:$|[^\p{{L}}\d])"));
    let other = other.map(|words| format!("(?<other>{words})"));
    regex(&[latin, other].into_iter().flatten().collect::<Vec<_>>().join("|"))
}

/// The subject that a word means.
pub(super) fn subject_of_word(word: &str) -> Option<Subject> {
    SUBJECT_WORDS.iter().find(|words| words.whole.is_match(word)).map(|words| words.subject)
}

/// What the words within the name of a folder or a file say that it shows, and where they are. Dark frames and flat
/// fields are no matter of words within: a lamp may well be called white, and a photo dark.
pub(super) fn subject_within(name: &str) -> (Named, Range<usize>) {
    for words in [Words::Together, Words::Alone] {
        let mut found: Vec<(Subject, Range<usize>)> = Vec::new();
        for one in SUBJECT_WORDS
            .iter()
            .filter(|words| words.subject == Subject::Object || words.subject.sphere_kind().is_some())
        {
            let regex = match words {
                Words::Together => &one.together,
                Words::Alone => &one.alone,
            };
            found.extend(place_of(regex.as_ref(), name).map(|place| (one.subject, place)));
        }
        // "mirror ball" is part of "mirror ball moved".
        let places: Vec<Range<usize>> = found.iter().map(|(_, place)| place.clone()).collect();
        let is_part = |place: &Range<usize>| {
            places.iter().any(|other| other != place && other.start <= place.start && place.end <= other.end)
        };
        found.retain(|(_, place)| !is_part(place));
        match found.as_slice() {
            [] => {}
            [(subject, place)] => return (Named::Subject(*subject), place.clone()),
            _ => return (Named::Several, 0..0),
        }
    }
    place_of(SOME_BALL.as_ref(), name).map_or((Named::Nothing, 0..0), |place| (Named::SomeBall, place))
}

fn place_of(regex: Option<&Regex>, name: &str) -> Option<Range<usize>> {
    let captures = regex?.captures(name)?;
    captures.name("latin").or_else(|| captures.name("other")).map(|found| found.range())
}

/// A name without the words at `place`, and without what kept them apart from the rest.
pub(super) fn without(name: &str, place: &Range<usize>) -> String {
    if place.is_empty() {
        return name.to_owned();
    }
    let (before, after) = (&name[..place.start], &name[place.end..]);
    let (first, last) = (before.trim_end_matches(SEPARATORS), after.trim_start_matches(SEPARATORS));
    match (first.is_empty(), last.is_empty()) {
        (false, false) => format!("{before}{last}"),
        _ => format!("{first}{last}"),
    }
}

/// Whether a name is a word for a colour.
pub(super) fn is_colour(name: &str) -> bool {
    COLOUR.as_ref().is_some_and(|regex| regex.is_match(name))
}

/// What cameras and programs call their pictures before they count them.
const COUNTED: &str = "_?dsc[fn]?|_?img[p]?|_mg|_?p|pict?|picture|dji|gopr|pxl|sam|cimg|hpim|imag|image|photo|foto|bild|frame|\
                       capture|aufnahme|shot|scan|snap|imagen|immagine|untitled|写真|照片|图片|画像";

static COUNT: LazyLock<Option<Regex>> = LazyLock::new(|| regex(&format!(r"^(?:{COUNTED})[-_ ]?[\d_]*$")));

/// Whether a name is only a camera's count, with or without its number: "DSC_0001".
pub(super) fn is_camera_count(name: &str) -> bool {
    COUNT.as_ref().is_some_and(|regex| regex.is_match(name))
}

/// Words for a mask.
const MASKS: &[&str] = &["mask", "maske", "masque", "máscara", "mascara", "maschera", "掩膜", "マスク"];

/// Whether the name of a file, without its extension, says that it is a mask.
pub(super) fn is_mask(stem: &str) -> bool {
    let stem = stem.to_lowercase();
    stem.split(|letter: char| !letter.is_alphabetic()).any(|word| MASKS.contains(&word))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_for_a_subject_means_it_and_no_other() {
        for &subject in Subject::ALL {
            for word in subject.names() {
                assert_eq!(subject_of_word(&word.replace('-', " ")), Some(subject), "{word}");
            }
        }
        for &kind in SphereKind::ALL {
            for made_of in kind.made_of() {
                let ball = if is_latin(&made_of) { "_Ball" } else { "球" };
                assert_eq!(subject_of_word(&format!("{made_of}{ball}")), Some(kind.subject()), "{made_of}{ball}");
            }
        }
    }

    #[test]
    fn the_subject_is_found_at_any_place_of_a_name_and_taken_out_of_it() {
        let cases = [
            ("left_blue_object", Subject::Object, "left_blue"),
            ("left object blue", Subject::Object, "left blue"),
            ("Objekte-left-blue", Subject::Object, "left-blue"),
            ("ball_grey_left_blue", Subject::GreySphere, "left_blue"),
            ("Graukugel", Subject::GreySphere, ""),
            ("Grey_Spheres", Subject::GreySphere, ""),
            ("left-sphere de miroir-2", Subject::MirrorSphere, "left-2"),
            ("boule grise 3", Subject::GreySphere, "3"),
            ("chrome_left", Subject::MirrorSphere, "left"),
            ("mirror-sphere-moved", Subject::MirrorSphereMoved, ""),
            ("mirror ball moved_left", Subject::MirrorSphereMoved, "left"),
            ("left-moved-mirror", Subject::MirrorSphereMoved, "left"),
            ("mirror_moved2", Subject::MirrorSphereMoved, ""),
            ("palla cromata, left", Subject::MirrorSphere, ", left"),
            ("灰球left", Subject::GreySphere, "left"),
            ("左-鏡面ボール", Subject::MirrorSphere, "左"),
            ("left.blue.e\u{301}chantillon", Subject::Object, "left.blue"),
            ("sample2_left", Subject::Object, "left"),
        ];
        for (name, subject, rest) in cases {
            let (found, place) = subject_within(name);
            assert_eq!((found, without(name, &place)), (Named::Subject(subject), rest.into()), "{name}");
        }
        assert_eq!(subject_within("kugel_left").0, Named::SomeBall);
        assert_eq!(subject_within("mirror_object").0, Named::Several);
        for name in ["greyhound", "objective", "mirrored", "left-blue", "football"] {
            assert_eq!(subject_within(name).0, Named::Nothing, "{name}");
        }
    }

    #[test]
    fn colours_have_words_in_several_languages_and_numbers_have_none() {
        for name in ["Blue", "deep-red", "gru\u{308}n", "GRUEN", "weiss", "rojo", "450 nm", "蓝色", "r"] {
            assert!(is_colour(name), "{name}");
        }
        for name in ["blue_object", "0001", "450", "blues", "", "left"] {
            assert!(!is_colour(name), "{name}");
        }
    }
}
