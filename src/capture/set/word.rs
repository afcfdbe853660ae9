//! The words that the file uses for closed choices.

use crate::image_file::Channel;

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

impl Word for Channel {
    const ALL: &'static [Self] = &[Self::R, Self::G, Self::B, Self::Grey];

    fn word(self) -> &'static str {
        self.word()
    }
}
