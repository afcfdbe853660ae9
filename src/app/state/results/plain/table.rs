//! The table of plain pictures: one row for each.

use firstbounce_capture::CaptureSet;
use firstbounce_capture::set::Projection;
use serde::{Deserialize, Serialize};

use super::{Each, Place, Quantity, Range, Row};
use crate::app::state::results::Step;
use crate::gpu::ColourMap;

/// The plain pictures. Their names are those in saved layouts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Plain {
    /// Bounce 1 with less noise: what the surface is recovered from.
    Direct,
    /// Direct light, as another method finds it.
    #[serde(alias = "NayarDirect")]
    DirectBy,
    /// What the bounces leave of the photos, root mean square over the colours.
    Residual,
    /// Predicted noise of bounce 1.
    Noise,
    /// Albedo.
    Albedo,
    /// Predicted noise of the normals in degrees.
    NormalNoise,
    /// Depth in the mesh's unit; not a number where there is none.
    Depth,
}

impl Plain {
    /// Every one, in the order of the menu.
    pub const ALL: [Self; 7] =
        [Self::Direct, Self::DirectBy, Self::Residual, Self::Noise, Self::Albedo, Self::NormalNoise, Self::Depth];

    /// The row of the table.
    pub fn row(self) -> Row {
        match self {
            Self::Direct => Row {
                title: "Bounce 1 with less noise",
                each: Each::Light(Step::Shape),
                by_colour: false,
                place: Place::AfterBounces,
                map: ColourMap::Grey,
                range: Range::FromZero,
                quantity: |_| Quantity::LIGHT,
                impossible: |_| None,
            },
            Self::DirectBy => Row {
                title: "Direct light",
                each: Each::LightBy(|_| true),
                by_colour: false,
                place: Place::AfterBounces,
                map: ColourMap::Grey,
                range: Range::FromZeroTo(Self::Direct),
                quantity: |_| Quantity::LIGHT,
                impossible: |_| None,
            },
            Self::Residual => Row {
                title: "Residual",
                each: Each::Light(Step::Separate),
                by_colour: false,
                place: Place::AfterSum,
                map: ColourMap::Viridis,
                range: Range::Own,
                quantity: |_| Quantity::light("Root mean square residual, linear light"),
                impossible: |set| {
                    (set.bounces() >= set.colours.len()).then_some(
                        "with as many bounces as colours there is no residual: choose a lower order in Separate",
                    )
                },
            },
            Self::Noise => Row {
                title: "Noise of bounce 1",
                each: Each::Light(Step::Separate),
                by_colour: false,
                place: Place::AfterSum,
                map: ColourMap::Viridis,
                range: Range::Own,
                quantity: |_| Quantity::light("Predicted noise, linear light"),
                impossible: |_| None,
            },
            Self::Albedo => Row {
                title: "Albedo",
                each: Each::Surface,
                by_colour: false,
                place: Place::Surface,
                map: ColourMap::Grey,
                range: Range::FromZero,
                quantity: |_| ALBEDO,
                impossible: |_| None,
            },
            Self::NormalNoise => Row {
                title: "Noise of the normals",
                each: Each::Surface,
                by_colour: false,
                place: Place::Surface,
                map: ColourMap::Viridis,
                range: Range::Own,
                quantity: |_| NOISE_DEG,
                impossible: |_| None,
            },
            Self::Depth => Row {
                title: "Depth",
                each: Each::Surface,
                by_colour: false,
                place: Place::Surface,
                map: ColourMap::Viridis,
                range: Range::Own,
                quantity: |set| if has_scale(set) { DEPTH_MM } else { DEPTH_PX },
                impossible: |_| None,
            },
        }
    }
}

const ALBEDO: Quantity =
    Quantity { words: "Albedo, relative to the first lamp", difference: "Difference of albedo", unit: "" };
const NOISE_DEG: Quantity =
    Quantity { words: "Predicted noise, degrees", difference: "Difference of noise, degrees", unit: " degrees" };
const DEPTH_MM: Quantity =
    Quantity { words: "Depth toward the camera, mm", difference: "Difference of depth, mm", unit: " mm" };
const DEPTH_PX: Quantity =
    Quantity { words: "Depth, pixels", difference: "Difference of depth, pixels", unit: " pixels" };

fn has_scale(set: &CaptureSet) -> bool {
    !matches!(set.camera.projection, Projection::Orthographic { mm_per_pixel: None })
}
