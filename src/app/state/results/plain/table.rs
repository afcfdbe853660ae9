//! The table of plain pictures: one row for each.

use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::Method;
use serde::{Deserialize, Serialize};

use super::{Each, Place, Quantity, Range, Row};
use crate::gpu::ColourMap;

/// The plain pictures. Their names are those in saved layouts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Plain {
    /// Direct light: what the surface is recovered from.
    Direct,
    /// All light that bounced more than once, together.
    Indirect,
    /// What the indirect light of a colour is, relative to that of the reference colour.
    IndirectRatio,
    /// What part of the light that arrives from the object is sent on.
    IndirectAmount,
    /// That part over the paint's albedo: 1 where all walls that send light are in view.
    AmountOverAlbedo,
    /// Direct light, as another method finds it.
    #[serde(alias = "NayarDirect")]
    DirectBy,
    /// What the bounces leave of the photos, root mean square over the colours.
    Residual,
    /// Predicted noise of the direct light.
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
    pub const ALL: [Self; 11] = [
        Self::Direct,
        Self::Indirect,
        Self::IndirectRatio,
        Self::IndirectAmount,
        Self::AmountOverAlbedo,
        Self::DirectBy,
        Self::Residual,
        Self::Noise,
        Self::Albedo,
        Self::NormalNoise,
        Self::Depth,
    ];

    /// The row of the table.
    pub fn row(self) -> Row {
        match self {
            Self::Direct => Row {
                title: "Direct light",
                each: Each::Light(|_| true),
                by_colour: false,
                place: Place::BeforeBounces,
                map: ColourMap::Grey,
                range: Range::FromZero,
                quantity: |_| Quantity::LIGHT,
                impossible: |_| None,
            },
            Self::Indirect => Row {
                title: "Indirect light",
                each: Each::Light(|method| method == Method::ColoursAndShape),
                by_colour: false,
                place: Place::BeforeBounces,
                map: ColourMap::Grey,
                range: Range::FromZero,
                quantity: |_| Quantity::LIGHT,
                impossible: without_shape_or_colours,
            },
            Self::IndirectRatio => Row {
                title: "Ratio of indirect light",
                each: Each::Light(|method| method == Method::ColoursAndShape),
                by_colour: true,
                place: Place::BeforeBounces,
                map: ColourMap::Viridis,
                range: Range::Own,
                quantity: |_| RATIO,
                impossible: without_shape_or_colours,
            },
            Self::IndirectAmount => Row {
                title: "Amount of indirect light",
                each: Each::Light(|method| method == Method::ColoursAndShape),
                by_colour: false,
                place: Place::BeforeBounces,
                map: ColourMap::Viridis,
                range: Range::FromZero,
                quantity: |_| AMOUNT,
                impossible: without_shape_or_colours,
            },
            Self::AmountOverAlbedo => Row {
                title: "Amount over albedo",
                each: Each::Light(|method| method == Method::ColoursAndShape),
                by_colour: false,
                place: Place::BeforeBounces,
                map: ColourMap::Viridis,
                range: Range::FromZero,
                quantity: |_| AMOUNT_OVER_ALBEDO,
                impossible: |set| {
                    let unknown = set.calibration.grey_albedo.is_none() && set.calibration.white_light.is_none();
                    let why =
                        "the paint's albedo is not known: state the grey ball's albedo below the method in Separate";
                    without_shape_or_colours(set).or_else(|| unknown.then_some(why))
                },
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
                each: Each::Light(|method| method == Method::Colours),
                by_colour: false,
                place: Place::AfterSum,
                map: ColourMap::Viridis,
                range: Range::Own,
                quantity: |_| Quantity::light("Root mean square residual, linear light"),
                impossible: |set| match set.method() {
                    Method::Colours if set.bounces() < set.colours.len() => None,
                    Method::Colours => {
                        Some("with as many bounces as colours there is no residual: choose a lower order in Separate")
                    }
                    _ => Some("only the paper's method has a residual: choose it in Separate"),
                },
            },
            Self::Noise => Row {
                title: "Noise of direct light",
                each: Each::Light(|_| true),
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

fn without_shape_or_colours(set: &CaptureSet) -> Option<&'static str> {
    let other = set.method() != Method::ColoursAndShape;
    other.then_some("only the method \"colours and shape\" finds it: choose that in Separate")
}

const RATIO: Quantity =
    Quantity { words: "Ratio to the reference colour", difference: "Difference of the ratio", unit: "" };
const AMOUNT: Quantity =
    Quantity { words: "Share of arriving light sent on", difference: "Difference of the share", unit: "" };
const AMOUNT_OVER_ALBEDO: Quantity =
    Quantity { words: "Amount of indirect light over the albedo", difference: "Difference of the ratio", unit: "" };
const ALBEDO: Quantity =
    Quantity { words: "Albedo, relative to the first lamp", difference: "Difference of albedo", unit: "" };
const NOISE_DEG: Quantity =
    Quantity { words: "Predicted noise, degrees", difference: "Difference of noise, degrees", unit: " degrees" };
const DEPTH_MM: Quantity =
    Quantity { words: "Depth toward the camera, mm", difference: "Difference of depth, mm", unit: " mm" };
const DEPTH_PX: Quantity =
    Quantity { words: "Depth, pixels", difference: "Difference of depth, pixels", unit: " pixels" };

fn has_scale(set: &CaptureSet) -> bool {
    set.mm_per_pixel().is_some()
}
