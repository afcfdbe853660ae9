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
    /// From the direct light that the method in force finds.
    After,
    /// From the direct light that a method finds which is compared with it.
    By(Method),
}

impl SurfaceName {
    /// Every surface that a set can have.
    pub fn all() -> impl Iterator<Item = Self> + Clone {
        [Self::Before, Self::After].into_iter().chain(Method::ALL.map(Self::By))
    }

    /// The method, where it is not the one in force.
    pub fn other_method(self) -> Option<Method> {
        match self {
            Self::Before | Self::After => None,
            Self::By(method) => Some(method),
        }
    }

    /// In a sentence: "before", "after" or "by Nayar's method".
    pub fn words(self) -> String {
        match self {
            Self::Before => "before".into(),
            Self::After => "after".into(),
            Self::By(method) => format!("by {}", method.title()),
        }
    }
}

/// The word in the window's settings.
impl From<SurfaceName> for &'static str {
    fn from(name: SurfaceName) -> Self {
        match name {
            SurfaceName::Before => "Before",
            SurfaceName::After => "After",
            SurfaceName::By(method) => method.name(),
        }
    }
}

impl TryFrom<String> for SurfaceName {
    type Error = String;

    fn try_from(word: String) -> Result<Self, String> {
        // Settings of earlier versions write Nayar's method with a capital.
        let method = Method::from_name(&word.to_ascii_lowercase()).map(Self::By);
        let named = |name: &Self| <&'static str>::from(*name) == word;
        method.or_else(|| Self::all().find(named)).ok_or_else(|| format!("{word:?} is no surface"))
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
