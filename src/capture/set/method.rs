//! The methods that tell direct from indirect light, by the words of the capture file.

use std::fmt;

use firstbounce_core::stereo::normals::Paint;
use serde::{Deserialize, Serialize};

use super::word::Word;

/// How direct light is told from light that bounced.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(into = "&'static str", try_from = "String")]
pub enum Method {
    /// Photos in several colours, and the light that arrives over the shape.
    #[default]
    ColoursAndShape,
    /// Liao, Huang and Yang 2011: photos in several colours, whose bounces differ.
    Colours,
    /// Nayar, Ikeuchi and Kanade 1991: photos in one colour, and the bounces simulated on the shape.
    Shape,
}

impl Word for Method {
    const ALL: &'static [Self] = &Method::ALL;

    fn word(self) -> &'static str {
        self.name()
    }

    fn from_word(word: &str) -> Option<Self> {
        Self::from_name(word)
    }
}

impl Method {
    /// Every method, in the order in which they are offered.
    pub const ALL: [Self; 3] = [Self::ColoursAndShape, Self::Colours, Self::Shape];

    /// For files, reports and the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::ColoursAndShape => "colours-and-shape",
            Self::Colours => "colours",
            Self::Shape => "shape",
        }
    }

    /// What earlier versions called it.
    pub fn alias(self) -> Option<&'static str> {
        match self {
            Self::ColoursAndShape => None,
            Self::Colours => Some("bounces"),
            Self::Shape => Some("nayar"),
        }
    }

    /// The method of this name or alias.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|method| method.name() == name || method.alias() == Some(name))
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl From<Method> for &'static str {
    fn from(method: Method) -> Self {
        method.name()
    }
}

impl TryFrom<String> for Method {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        Self::from_name(&name).ok_or_else(|| format!("{name:?} is no method"))
    }
}

impl Word for Paint {
    const ALL: &'static [Self] = &[Self::Auto, Self::One, Self::Any];

    fn word(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::One => "one",
            Self::Any => "any",
        }
    }
}

/// A [`Paint`] as its word, for serde.
pub mod paint_word {
    use firstbounce_core::stereo::normals::Paint;
    use serde::{Deserialize, Deserializer, Serialize, Serializer, de::Error};

    use crate::set::Word;

    /// The word.
    pub fn serialize<S: Serializer>(paint: &Paint, serializer: S) -> Result<S::Ok, S::Error> {
        paint.word().serialize(serializer)
    }

    /// The paint of a word.
    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Paint, D::Error> {
        let word = String::deserialize(deserializer)?;
        Paint::from_word(&word).ok_or_else(|| D::Error::custom(format!("{word:?} is not auto, one or any")))
    }
}
