//! The pattern of file names.

use std::fmt;
use std::path::Path;
use std::str::FromStr;
use std::sync::OnceLock;

use regex::{Regex, RegexBuilder};
use thiserror::Error;

use super::super::subject::Subject;
use super::name::names_of;
use super::words;

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
    /// Takes words for colours alone.
    strict: Regex,
    /// Takes any word for a colour; made when it is needed.
    loose: OnceLock<Option<Regex>>,
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
            Self::Subject => format!("(?<subject>{})", words::subject_field()),
            Self::Colour if strict => format!("(?<colour>{})", words::colour_field()),
            Self::Light | Self::Colour => format!("(?<{}>[^/]+?)", self.word()),
            Self::Repeat => "(?<repeat>[0-9]+)".into(),
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
        let folders = pieces.iter().filter(|piece| matches!(piece, Piece::Text('/'))).count();
        // The only expressions that could be refused are those that the user made too large.
        let strict = expression(&pieces, true).ok_or(PatternError::NoField)?;
        Ok(Self { text: text.to_owned(), fields, folders, strict, loose: OnceLock::new() })
    }
}

fn expression(pieces: &[Piece], strict: bool) -> Option<Regex> {
    let inner: String = pieces
        .iter()
        .map(|piece| match piece {
            Piece::Text(c) => regex::escape(c.encode_utf8(&mut [0; 4])),
            Piece::Field(field) => field.expression(strict),
            Piece::Open => "(?:".into(),
            Piece::Close => ")?".into(),
        })
        .collect();
    RegexBuilder::new(&format!("^{inner}$")).case_insensitive(true).build().ok()
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
    /// What the name of a file says; `None` where it does not follow the pattern. Where the pattern has no subject, words
    /// for one may stand at any place of the name.
    pub fn read(&self, file: &Path) -> Option<Guess> {
        names_of(&[file]).pop()??.read(self)
    }

    /// What the parts of a path say, of which the last is the name without its extension. A colour is a word for one.
    pub(super) fn read_strictly(&self, parts: &[String]) -> Option<Guess> {
        self.read_by(&self.strict, parts)
    }

    /// The same where any word in its place is a colour.
    pub(super) fn read_loosely(&self, parts: &[String]) -> Option<Guess> {
        let loose = || pieces(&self.text).ok().and_then(|pieces| expression(&pieces, false));
        self.read_by(self.loose.get_or_init(loose).as_ref()?, parts)
    }

    fn read_by(&self, reading: &Regex, parts: &[String]) -> Option<Guess> {
        let end = parts.get(parts.len().checked_sub(self.folders + 1)?..)?.join("/");
        let captures = reading.captures(&end)?;
        let text = |field: Field| captures.name(field.word()).map(|found| found.as_str().to_owned());
        let repeat = text(Field::Repeat);
        Some(Guess {
            subject: captures.name("subject").and_then(|word| words::subject_of_word(word.as_str())),
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

/// The folders of a file, and its name without the extension.
pub(super) fn parts(file: &Path) -> Option<Vec<String>> {
    let mut parts: Vec<String> = file.parent()?.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    parts.push(file.file_stem()?.to_string_lossy().into_owned());
    Some(parts)
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
