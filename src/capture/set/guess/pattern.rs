//! The pattern of file names.

use std::fmt;
use std::path::Path;
use std::str::FromStr;

use regex::{Captures, Regex, RegexBuilder};
use thiserror::Error;

use super::super::subject::Subject;
use super::super::word::Word;

/// How the names of files are built: text with the fields `{subject}`, `{light}`, `{colour}`, `{repeat}` and `{any}`, and
/// in brackets what may be absent: `{subject}/{light}-{colour}[-{repeat}]`.
///
/// It is held against the end of a path without its extension: as many folders as it has slashes. Where several
/// readings fit, the one whose colour is a word for a colour is taken, then the one with the shortest light.
#[derive(Clone, Debug)]
pub struct Pattern {
    text: String,
    fields: Vec<Field>,
    folders: usize,
    /// Tried in this order.
    readings: [Regex; 2],
}

/// The fields of a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Field {
    Subject,
    Light,
    Colour,
    Repeat,
    Any,
}

/// What a file's name says.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Guess {
    /// What it shows; `None` where the pattern does not say.
    pub subject: Option<Subject>,
    /// The light's name.
    pub light: Option<String>,
    /// The colour's name.
    pub colour: Option<String>,
    /// The number of the repeat.
    pub repeat: Option<u64>,
}

/// Why a text is no pattern.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
pub enum PatternError {
    /// An unknown word in braces.
    #[error("unknown field {{{0}}}: there are {{subject}}, {{light}}, {{colour}}, {{repeat}} and {{any}}")]
    UnknownField(String),
    /// The same field twice.
    #[error("{{{0}}} is in the pattern twice")]
    Twice(&'static str),
    /// A brace or bracket without its partner.
    #[error("a \"{0}\" without its partner")]
    Unpaired(char),
    /// Brackets within brackets, or a slash within them.
    #[error("brackets can hold neither brackets nor a slash")]
    Nested,
    /// It says nothing.
    #[error("a pattern needs {{subject}}, {{light}} or {{colour}}")]
    NoField,
}

/// Words for colours, as lamps and channels are called.
const COLOUR_WORDS: &[&str] = &[
    "red", "green", "blue", "white", "cyan", "magenta", "yellow", "amber", "orange", "violet", "uv", "ir", "nir",
    "lime", "r", "g", "b",
];

impl Field {
    const ALL: [Self; 5] = [Self::Subject, Self::Light, Self::Colour, Self::Repeat, Self::Any];

    fn word(self) -> &'static str {
        match self {
            Self::Subject => "subject",
            Self::Light => "light",
            Self::Colour => "colour",
            Self::Repeat => "repeat",
            Self::Any => "any",
        }
    }

    /// As a regular expression; `strict` takes words for colours alone.
    fn expression(self, strict: bool) -> String {
        match self {
            Self::Subject => {
                let names = Subject::ALL.iter().flat_map(|subject| subject.names());
                let words = names.map(|word| word.replace('-', "[-_ ]?"));
                format!("(?<subject>{})", words.collect::<Vec<_>>().join("|"))
            }
            Self::Colour if strict => format!(r"(?<colour>{}|\d+ ?nm)", COLOUR_WORDS.join("|")),
            Self::Light | Self::Colour => format!("(?<{}>[^/]+?)", self.word()),
            Self::Repeat => r"(?<repeat>\d+)".into(),
            Self::Any => "[^/]*?".into(),
        }
    }
}

/// A piece of a pattern.
enum Piece {
    Text(char),
    Field(Field),
    Open,
    Close,
}

impl FromStr for Pattern {
    type Err = PatternError;

    fn from_str(text: &str) -> Result<Self, PatternError> {
        let pieces = pieces(text)?;
        let fields: Vec<Field> = pieces
            .iter()
            .filter_map(|piece| if let Piece::Field(field) = piece { Some(*field) } else { None })
            .collect();
        let twice = |field: &&Field| **field != Field::Any && fields.iter().filter(|other| other == field).count() > 1;
        if let Some(field) = fields.iter().find(twice) {
            return Err(PatternError::Twice(field.word()));
        }
        if !fields.iter().any(|field| matches!(field, Field::Subject | Field::Light | Field::Colour)) {
            return Err(PatternError::NoField);
        }
        let expression = |strict: bool| {
            let inner: String = pieces
                .iter()
                .map(|piece| match piece {
                    Piece::Text(c) => regex::escape(c.encode_utf8(&mut [0; 4])),
                    Piece::Field(field) => field.expression(strict),
                    Piece::Open => "(?:".into(),
                    Piece::Close => ")?".into(),
                })
                .collect();
            // The only expressions that could be refused are those that the user made too large.
            RegexBuilder::new(&format!("^{inner}$")).case_insensitive(true).build().map_err(|_| PatternError::NoField)
        };
        let folders = pieces.iter().filter(|piece| matches!(piece, Piece::Text('/'))).count();
        let readings = [expression(true)?, expression(false)?];
        Ok(Self { text: text.to_owned(), fields, folders, readings })
    }
}

fn pieces(text: &str) -> Result<Vec<Piece>, PatternError> {
    let mut pieces = Vec::new();
    let mut rest = text.chars();
    let mut in_brackets = false;
    while let Some(c) = rest.next() {
        pieces.push(match c {
            '{' => {
                let word: String = rest.by_ref().take_while(|c| *c != '}').collect();
                if !text.contains('}') {
                    return Err(PatternError::Unpaired('{'));
                }
                // "color" is the same word to half of the world.
                let known = |field: &Field| field.word() == if word == "color" { "colour" } else { word.as_str() };
                let field = Field::ALL.into_iter().find(known);
                Piece::Field(field.ok_or_else(|| PatternError::UnknownField(word.clone()))?)
            }
            '}' => return Err(PatternError::Unpaired('}')),
            '[' if in_brackets => return Err(PatternError::Nested),
            '[' => {
                in_brackets = true;
                Piece::Open
            }
            ']' if !in_brackets => return Err(PatternError::Unpaired(']')),
            ']' => {
                in_brackets = false;
                Piece::Close
            }
            '/' | '\\' if in_brackets => return Err(PatternError::Nested),
            '\\' => Piece::Text('/'),
            c => Piece::Text(c),
        });
    }
    if in_brackets { Err(PatternError::Unpaired('[')) } else { Ok(pieces) }
}

impl Pattern {
    /// What the name of a file says; `None` where it does not follow the pattern.
    pub fn read(&self, file: &Path) -> Option<Guess> {
        let mut parts: Vec<String> = file.parent()?.iter().map(|part| part.to_string_lossy().into_owned()).collect();
        parts.push(file.file_stem()?.to_string_lossy().into_owned());
        let end = parts.get(parts.len().checked_sub(self.folders + 1)?..)?.join("/");
        let captures = self.readings.iter().find_map(|reading| reading.captures(&end))?;
        let text = |field: Field| captures.name(field.word()).map(|found| found.as_str().to_owned());
        let repeat = text(Field::Repeat);
        Some(Guess {
            subject: subject_of(&captures),
            light: text(Field::Light),
            colour: text(Field::Colour),
            repeat: repeat.and_then(|digits| digits.parse().ok()),
        })
    }

    /// Whether the pattern says what a file shows.
    pub fn names_subject(&self) -> bool {
        self.fields.contains(&Field::Subject)
    }

    /// Whether the pattern says the colour of a photo.
    pub fn names_colour(&self) -> bool {
        self.fields.contains(&Field::Colour)
    }
}

fn subject_of(captures: &Captures<'_>) -> Option<Subject> {
    subject_of_word(captures.name("subject")?.as_str())
}

fn subject_of_word(word: &str) -> Option<Subject> {
    let bare = word.to_lowercase().replace(['-', '_', ' '], "");
    let means = |subject: &Subject| subject.names().iter().any(|word| word.replace('-', "") == bare);
    Subject::ALL.iter().copied().find(means)
}

/// Dark frames and flat fields lie beside the photos and follow no pattern of theirs: "dark.png", "flat-03.tif". A lamp
/// may well be called black or white.
pub(super) fn correction_of_name(file: &Path) -> Option<Subject> {
    let stem = file.file_stem()?.to_string_lossy();
    let word = stem.trim_end_matches(|c: char| c.is_ascii_digit() || "-_ ".contains(c));
    let is_correction = |subject: &Subject| matches!(subject, Subject::Dark | Subject::FlatField);
    subject_of_word(word).filter(is_correction).filter(|_| !matches!(&*word.to_lowercase(), "black" | "white"))
}

impl fmt::Display for Pattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

impl PartialEq for Pattern {
    fn eq(&self, other: &Self) -> bool {
        self.text == other.text
    }
}

/// Whether a name is a word for a colour.
pub(super) fn is_colour_word(name: &str) -> bool {
    COLOUR_WORDS.contains(&name.to_lowercase().as_str())
        || name.strip_suffix("nm").is_some_and(|digits| digits.trim_end().parse::<u32>().is_ok())
}
