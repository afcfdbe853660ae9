//! Why a file is not assigned by its name.

use std::fmt;
use std::path::PathBuf;

use super::super::subject::Subject;

/// Why the name of a file does not say enough; by `Display` in words that follow the name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Doubt {
    /// The name has another form.
    NoPattern {
        /// The pattern.
        pattern: String,
    },
    /// The name of a light is missing.
    NoLight(Subject),
    /// The name of a colour is missing.
    NoColour(Subject),
    /// What stands in the place of the colour is no word for one.
    NoColourWord(String),
    /// A ball of an unknown kind.
    SomeBall,
    /// Words for several subjects.
    SeveralSubjects,
    /// Files of several folders would be the same photo.
    SameNames {
        /// The folders, of which at most one holds this photo.
        folders: Vec<PathBuf>,
    },
    /// Another file, in the same folder, is this photo.
    SamePhoto {
        /// The other file's name.
        other: String,
    },
    /// The same photo at several exposures: no repeats, which would be averaged.
    Exposures {
        /// As the names write them.
        exposures: Vec<String>,
    },
    /// No pattern explains the names.
    NoNames,
    /// The set has a mask already.
    SecondMask {
        /// As the capture file writes it.
        mask: String,
    },
    /// An order has no place left.
    OrderIsFull,
}

impl Doubt {
    /// Whether the name alone says too little, and contradicts nothing: the order may say the rest.
    pub fn is_of_silent_name(&self) -> bool {
        matches!(self, Self::NoPattern { .. } | Self::NoLight(_) | Self::NoColour(_) | Self::NoNames)
    }
}

impl fmt::Display for Doubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoPattern { pattern } => write!(f, "does not follow {pattern}"),
            Self::NoLight(subject) => write!(f, "a photo of {subject} needs a light"),
            Self::NoColour(subject) => write!(f, "a photo of {subject} needs a colour"),
            Self::NoColourWord(word) => {
                write!(f, "{word:?} is no word for a colour; confirm it, or change the pattern")
            }
            Self::SomeBall => f.write_str("which ball is this? name its kind: grey, of the paint, or mirror"),
            Self::SeveralSubjects => f.write_str("names several subjects: choose one"),
            Self::SameNames { folders } => {
                let folders: Vec<_> = folders.iter().map(|folder| folder.display().to_string()).collect();
                write!(f, "the same names are in {}: choose what each folder shows", folders.join(" and "))
            }
            Self::SamePhoto { other } => write!(f, "the same photo as {other}, which is taken; repeats are numbered"),
            Self::Exposures { exposures } => write!(
                f,
                "one photo at several exposures ({}), which are no repeats: assign one of them",
                exposures.join(", ")
            ),
            Self::NoNames => {
                f.write_str("its name does not say what it shows: name light and colour, or give the order")
            }
            Self::SecondMask { mask } => write!(f, "named as a mask, and {mask} is the mask; take one away"),
            Self::OrderIsFull => {
                f.write_str("every place of the order has its photo; take it away, or name what it shows")
            }
        }
    }
}
