//! Problems of a capture set, and where they are.

use std::fmt;
use std::path::{Path, PathBuf};

use thiserror::Error;

use crate::open::OpenError;

/// The part of a capture set that a problem belongs to; indices count from 0 in the order of the set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Location {
    /// The set as a whole.
    Set,
    /// `[camera]`
    Camera,
    /// A `[[colour]]`
    Colour(usize),
    /// A `[[light]]`
    Light(usize),
    /// A `[[shot]]`
    Shot(usize),
    /// A `[[sphere]]`
    Sphere(usize),
    /// `[calibration]`
    Calibration,
    /// `[separation]`
    Separation,
    /// `[shape]`
    Shape,
    /// `[truth]`
    Truth,
}

impl Location {
    pub(super) fn header(self) -> &'static str {
        match self {
            Self::Set => "",
            Self::Camera => "[camera]",
            Self::Colour(_) => "[[colour]]",
            Self::Light(_) => "[[light]]",
            Self::Shot(_) => "[[shot]]",
            Self::Sphere(_) => "[[sphere]]",
            Self::Calibration => "[calibration]",
            Self::Separation => "[separation]",
            Self::Shape => "[shape]",
            Self::Truth => "[truth]",
        }
    }

    fn index(self) -> Option<usize> {
        match self {
            Self::Colour(index) | Self::Light(index) | Self::Shot(index) | Self::Sphere(index) => Some(index),
            Self::Set | Self::Camera | Self::Calibration | Self::Separation | Self::Shape | Self::Truth => None,
        }
    }
}

/// A place in a text, both counted from 1; columns count characters.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TextPosition {
    /// The line.
    pub line: usize,
    /// The column.
    pub column: usize,
}

/// One thing that is wrong with a capture set, in words for its author.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// The part of the set it belongs to.
    pub location: Location,
    /// The key of that part, dotted where it lies deeper: `exposure`, `alpha.left`.
    pub key: Option<String>,
    /// What was found and what was expected.
    pub message: String,
    /// Where in the file's text; `None` for a set in memory.
    pub position: Option<TextPosition>,
}

impl Problem {
    /// A problem with one key of a part.
    pub(super) fn of_key(location: Location, key: impl Into<String>, message: impl Into<String>) -> Self {
        Self { key: Some(key.into()), ..Self::of_part(location, message) }
    }

    /// A problem with a part as a whole.
    pub(super) fn of_part(location: Location, message: impl Into<String>) -> Self {
        Self { location, key: None, message: message.into(), position: None }
    }
}

/// `[[shot]] exposure: expected a positive number, found 0`; without a line to point at, the part's number follows its
/// header.
impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.location != Location::Set {
            write!(f, "{} ", self.location.header())?;
        }
        if let (None, Some(index)) = (self.position, self.location.index()) {
            write!(f, "number {} ", index + 1)?;
        }
        if let Some(key) = &self.key {
            write!(f, "{key}: ")?;
        }
        f.write_str(&self.message)
    }
}

/// Why a capture set could not be opened.
#[derive(Debug, Error)]
pub enum SetError {
    /// The path names nothing that can be read.
    #[error("{}: {reason}", path.display())]
    Read {
        /// The path as given, or the capture.toml in it.
        path: PathBuf,
        /// Why not.
        reason: OpenError,
    },
    /// The folder is no capture set.
    #[error("{}: no capture.toml in this folder", folder.display())]
    NoSetFile {
        /// The folder.
        folder: PathBuf,
    },
    /// A file far larger than any capture set.
    #[error("{}: larger than {limit_bytes} bytes; expected a capture.toml", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The largest file that is read.
        limit_bytes: u64,
    },
    /// The file was read but is wrong; never empty, in the order of the file.
    #[error("{}", first_of(path, problems))]
    Invalid {
        /// The file.
        path: PathBuf,
        /// Everything that is wrong with it.
        problems: Vec<Problem>,
    },
}

impl SetError {
    /// Every problem of the file, with its place; empty where the file could not be read at all.
    pub fn problems(&self) -> &[Problem] {
        match self {
            Self::Invalid { problems, .. } => problems,
            Self::Read { .. } | Self::NoSetFile { .. } | Self::TooLarge { .. } => &[],
        }
    }
}

fn first_of(path: &Path, problems: &[Problem]) -> String {
    let mut line = path.display().to_string();
    if let Some(first) = problems.first() {
        if let Some(position) = first.position {
            line += &format!(":{}", position.line);
        }
        line += &format!(": {first}");
    }
    if problems.len() > 1 {
        line += &format!(" (and {} more)", problems.len() - 1);
    }
    line
}
