//! The words that the file uses for closed choices.

use std::fmt;

use super::model::{Channel, SphereKind, Subject};

/// A closed choice that the file spells as a word.
pub trait Word: Copy + 'static {
    /// Every choice, in the order in which they are offered.
    const ALL: &'static [Self];

    /// How the file spells it.
    fn word(self) -> &'static str;

    /// The choice that the file spells so.
    fn from_word(word: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|choice| choice.word() == word)
    }
}

impl Word for Subject {
    const ALL: &'static [Self] =
        &[Self::Object, Self::GreySphere, Self::MaterialSphere, Self::MirrorSphere, Self::Dark, Self::FlatField];

    fn word(self) -> &'static str {
        match self {
            Self::Object => "object",
            Self::GreySphere => "grey-sphere",
            Self::MaterialSphere => "material-sphere",
            Self::MirrorSphere => "mirror-sphere",
            Self::Dark => "dark",
            Self::FlatField => "flat-field",
        }
    }
}

impl Word for SphereKind {
    const ALL: &'static [Self] = &[Self::Grey, Self::Material, Self::Mirror];

    fn word(self) -> &'static str {
        match self {
            Self::Grey => "grey",
            Self::Material => "material",
            Self::Mirror => "mirror",
        }
    }
}

impl Word for Channel {
    const ALL: &'static [Self] = &[Self::R, Self::G, Self::B, Self::Grey];

    fn word(self) -> &'static str {
        match self {
            Self::R => "r",
            Self::G => "g",
            Self::B => "b",
            Self::Grey => "grey",
        }
    }
}

impl fmt::Display for Subject {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

impl fmt::Display for SphereKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

impl fmt::Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}
