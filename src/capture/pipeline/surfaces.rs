//! The surfaces of a set by name: that of the photos before separation, and one after each method.

use std::sync::Arc;

use firstbounce_core::Mesh;
use firstbounce_core::stereo::shape::Shape;
use serde::{Deserialize, Serialize};

use super::Method;

/// Which surface of a set.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(into = "&'static str", try_from = "String")]
pub enum SurfaceName {
    /// From the photos before separation.
    Before,
    /// From the direct light that a method finds.
    After(Method),
}

impl SurfaceName {
    /// From bounce 1, as photos in several colours give it.
    pub const AFTER: Self = Self::After(Method::Colours);

    /// Every surface that a set can have.
    pub fn all() -> impl Iterator<Item = Self> + Clone {
        std::iter::once(Self::Before).chain(Method::ALL.into_iter().map(Self::After))
    }

    /// The method, where it is not the paper's own.
    pub fn other_method(self) -> Option<Method> {
        match self {
            Self::Before | Self::AFTER => None,
            Self::After(method) => Some(method),
        }
    }

    /// In a sentence: "before", "after" or "by Nayar's method".
    pub fn words(self) -> String {
        match self {
            Self::Before => "before".into(),
            Self::AFTER => "after".into(),
            Self::After(method) => format!("by {}", method.title()),
        }
    }
}

/// The word in the window's settings.
impl From<SurfaceName> for &'static str {
    fn from(name: SurfaceName) -> Self {
        match name {
            SurfaceName::Before => "Before",
            SurfaceName::AFTER => "After",
            SurfaceName::After(method) => method.name(),
        }
    }
}

impl TryFrom<String> for SurfaceName {
    type Error = String;

    fn try_from(word: String) -> Result<Self, String> {
        // Settings of earlier versions write Nayar's method with a capital.
        let named = |name: &Self| <&'static str>::from(*name).eq_ignore_ascii_case(&word);
        Self::all().find(named).ok_or_else(|| format!("{word:?} is no surface"))
    }
}

/// Normals, albedo and depth, and the depth as triangles. Shared: a copy costs nothing.
#[derive(Clone, Debug)]
pub struct Surface {
    /// Normals, albedo, depth.
    pub shape: Arc<Shape>,
    /// The depth as triangles.
    pub mesh: Arc<Mesh>,
}
