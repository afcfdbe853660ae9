//! A view: what it shows and how.

use serde::{Deserialize, Serialize};

use super::{Look, Shown};
use crate::app::state::surfaces::SurfaceLook;

/// One view: what it shows and how.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct View {
    /// Identifies the view for as long as the layout is kept.
    pub id: u64,
    /// What is shown.
    pub shown: Shown,
    /// What it is compared with.
    pub against: Option<Shown>,
    /// How.
    #[serde(default)]
    pub compare: Compare,
    /// How numbers become colours.
    pub look: Look,
    /// Whether zoom and pan follow the other linked views.
    pub linked: bool,
    /// How a surface in 3D is shown.
    #[serde(default)]
    pub surface: SurfaceLook,
}

/// How a view shows what it is compared with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Compare {
    /// While B is held.
    #[default]
    Hold,
    /// A line divides the two.
    Wipe,
    /// The one minus the other.
    Difference,
}

impl Compare {
    /// All, in the order of the strip, with what they are called.
    pub const ALL: [(Self, &'static str, &'static str); 3] = [
        (Self::Hold, "Hold B", "Shows the other picture while B is held"),
        (Self::Wipe, "Wipe", "A line divides the two"),
        (Self::Difference, "Difference", "This picture minus the other"),
    ];
}

impl View {
    pub(super) fn showing(id: u64, shown: Shown) -> Self {
        Self {
            id,
            shown,
            against: None,
            compare: Compare::default(),
            look: Look::default(),
            linked: true,
            surface: SurfaceLook::default(),
        }
    }

    /// What is drawn: the picture, or its difference to the one that it is compared with.
    pub fn drawn(&self) -> Shown {
        match (&self.against, self.compare) {
            (Some(other), Compare::Difference) => Shown::difference(self.shown.clone(), other.clone()),
            _ => self.shown.clone(),
        }
    }
}

/// The pixel under the pointer or the keyboard's cursor, and where.
#[derive(Clone, Debug, PartialEq)]
pub struct Hover {
    /// What is shown there.
    pub shown: Shown,
    /// Column and row.
    pub pixel: (usize, usize),
}
