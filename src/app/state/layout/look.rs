//! The look of a view, from numbers to colours: the user's choices over the picture's proposal.

use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};

use crate::gpu::{ColourMap, Display, Encoding, Tint};

/// Where the values at the two ends of a map come from, unless they are typed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Scale {
    /// One scale for all light of a lamp, so that the same value has the same grey in all its pictures.
    #[default]
    Locked,
    /// The picture's own values.
    Own,
}

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
    /// Where the values at the two ends of the map come from.
    pub scale: Scale,
    /// The values at the two ends of the map, whatever the scale.
    pub range: Option<[f32; 2]>,
    /// Whether clipped values get stripes.
    pub clip_zebra: bool,
    /// Whether values below zero get stripes.
    pub negative_zebra: bool,
    /// Whether marked pixels are shown without their tints.
    pub plain: bool,
}

impl Look {
    /// What `exposure_stops` may be.
    pub const EXPOSURE_STOPS: RangeInclusive<f32> = -20.0..=20.0;
    /// What `gamma` may be.
    pub const GAMMA: RangeInclusive<f32> = 0.2..=5.0;
    /// What the ends of `range` may be: their difference is a number too.
    pub const ENDS: RangeInclusive<f32> = -1e30..=1e30;

    /// The same without choices beyond these ranges, which a file may hold.
    pub fn within_ranges(&self) -> Self {
        let is_end = |end: &f32| Self::ENDS.contains(end);
        Self {
            exposure_stops: Some(self.exposure_stops).filter(|x| Self::EXPOSURE_STOPS.contains(x)).unwrap_or_default(),
            gamma: self.gamma.filter(|gamma| Self::GAMMA.contains(gamma)),
            range: self.range.filter(|ends| ends.iter().all(is_end)),
            ..self.clone()
        }
    }

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
