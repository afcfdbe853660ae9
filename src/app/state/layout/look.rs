//! The look of a view, from numbers to colours: the user's choices over the picture's proposal.

use serde::{Deserialize, Serialize};

use crate::gpu::{ColourMap, Display, Encoding, Tint};

/// The user's choices; where there is none, the picture's own proposal holds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Look {
    /// Values are multiplied by 2 to this power.
    pub exposure_stops: f32,
    /// Of greys and colours; `None` for the curve of sRGB.
    pub gamma: Option<f32>,
    /// Of single values.
    pub map: Option<ColourMap>,
    /// The values at the two ends of the map.
    pub range: Option<[f32; 2]>,
    /// Whether clipped values get stripes.
    pub clip_zebra: bool,
    /// Whether values below zero get stripes.
    pub negative_zebra: bool,
    /// Whether marked pixels are shown without their tints.
    pub plain: bool,
}

impl Look {
    /// The picture's proposal with the choices in it.
    pub fn over(&self, proposal: &Display) -> Display {
        Display {
            exposure_stops: proposal.exposure_stops + self.exposure_stops,
            encoding: self.gamma.map_or(proposal.encoding, Encoding::Gamma),
            map: self.map.unwrap_or(proposal.map),
            range: self.range.unwrap_or(proposal.range),
            clip: self.clip_zebra.then_some(1.0),
            negative_zebra: self.negative_zebra,
            tints: if self.plain { [Tint::default(); 8] } else { proposal.tints },
            ..proposal.clone()
        }
    }
}
