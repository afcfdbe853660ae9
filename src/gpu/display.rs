//! Display of numbers as colours.

use std::sync::LazyLock;

use firstbounce_core::image::photo::{CLIPPED, DARK};
use serde::{Deserialize, Serialize};

/// The colour of each value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum ColourMap {
    /// Black to white, encoded for the screen.
    #[default]
    Grey,
    /// Dark blue over green to yellow, even steps for the eye (Smith, van der Walt, matplotlib 2015).
    Viridis,
    /// Blue over green to red, more detail and less even (Mikhailov, Google Research 2019).
    Turbo,
    /// Blue below zero, white at zero, red above (ColorBrewer RdBu); always symmetric about zero.
    Signed,
}

impl ColourMap {
    /// Every map, in the order of a menu.
    pub const ALL: [Self; 4] = [Self::Grey, Self::Viridis, Self::Turbo, Self::Signed];

    /// The map's name in the window.
    pub fn name(self) -> &'static str {
        match self {
            Self::Grey => "Grey",
            Self::Viridis => "Viridis",
            Self::Turbo => "Turbo",
            Self::Signed => "Signed",
        }
    }

    /// The map as 256 colours, 0 to 1 in gamma space, low values first.
    pub(super) fn table(self) -> &'static [[u8; 3]; 256] {
        static TABLES: LazyLock<[[[u8; 3]; 256]; 4]> = LazyLock::new(|| {
            ColourMap::ALL.map(|map| std::array::from_fn(|index| map.colour_at(f64::from(index as u32) / 255.0)))
        });
        &TABLES[self as usize]
    }

    fn colour_at(self, t: f64) -> [u8; 3] {
        let colour = match self {
            Self::Grey => return [(255.0 * t).round() as u8; 3],
            Self::Viridis => colorous::VIRIDIS.eval_continuous(t),
            Self::Turbo => colorous::TURBO.eval_continuous(t),
            Self::Signed => colorous::RED_BLUE.eval_continuous(1.0 - t),
        };
        [colour.r, colour.g, colour.b]
    }
}

/// How linear light is encoded for the screen: greys and colours only, the other maps take values as they are.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Encoding {
    /// The curve of IEC 61966-2-1.
    #[default]
    Srgb,
    /// `v^(1/gamma)`; gamma 1 shows the numbers themselves.
    Gamma(f32),
}

/// A colour laid over marked pixels.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Tint {
    /// sRGB bytes.
    pub colour: [u8; 3],
    /// 0 leaves the picture, 1 covers it.
    pub strength: f32,
}

/// How numbers become colours.
#[derive(Clone, Debug, PartialEq)]
pub struct Display {
    /// Values are multiplied by 2 to this power before anything else.
    pub exposure_stops: f32,
    /// The values, after exposure, at the two ends of the colour map. [`ColourMap::Signed`] takes the larger magnitude for
    /// both sides.
    pub range: [f32; 2],
    /// Of greys and colours.
    pub encoding: Encoding,
    /// Of single values; colours and normals need none.
    pub map: ColourMap,
    /// Values from here on get red stripes, whatever the exposure.
    pub clip: Option<f32>,
    /// Whether values below zero get blue stripes, which lean the other way.
    pub negative_zebra: bool,
    /// How much of the picture outside the mask gives way to the background, 0 to 1.
    pub mask_dimming: f32,
    /// The tint of each bit of the marks, the lowest bit first.
    pub tints: [Tint; 8],
}

impl Default for Display {
    fn default() -> Self {
        let mut tints = [Tint::default(); 8];
        tints[CLIPPED.trailing_zeros() as usize] = Tint { colour: [229, 57, 140], strength: 0.6 };
        tints[DARK.trailing_zeros() as usize] = Tint { colour: [57, 120, 229], strength: 0.6 };
        Self {
            exposure_stops: 0.0,
            range: [0.0, 1.0],
            encoding: Encoding::Srgb,
            map: ColourMap::Grey,
            clip: None,
            negative_zebra: false,
            mask_dimming: 0.6,
            tints,
        }
    }
}

impl Display {
    /// Signed colours from `-largest` to `largest`, as differences need them.
    pub fn signed(largest: f32) -> Self {
        Self { map: ColourMap::Signed, range: [-largest, largest], ..Self::default() }
    }

    /// The factor of the exposure.
    pub fn gain(&self) -> f32 {
        self.exposure_stops.exp2()
    }

    /// The values, after exposure, at the two ends of the colour map as it is drawn: never empty, symmetric if signed.
    pub(super) fn drawn_range(&self) -> [f32; 2] {
        let [low, high] = self.range;
        match self.map {
            ColourMap::Signed => {
                let largest = low.abs().max(high.abs()).max(f32::MIN_POSITIVE);
                [-largest, largest]
            }
            _ if low == high => [low, low + f32::EPSILON * low.abs().max(1.0)],
            _ => [low, high],
        }
    }

    /// The values of the picture, before exposure, at the two ends of the legend.
    pub fn legend_range(&self) -> [f32; 2] {
        self.drawn_range().map(|value| value / self.gain())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_meet_their_published_ends() {
        assert_eq!(ColourMap::Viridis.table()[0], [68, 1, 84]);
        assert_eq!(ColourMap::Viridis.table()[255], [253, 231, 37]);
        let turbo = ColourMap::Turbo.table();
        assert!(turbo[64][2] > 200 && turbo[128][1] > 230 && turbo[230][0] > 180);
    }

    #[test]
    fn the_signed_map_is_blue_below_pale_at_and_red_above_zero() {
        let table = ColourMap::Signed.table();
        assert!(table[20][2] > table[20][0] + 50 && table[235][0] > table[235][2] + 50);
        assert!(table[127].iter().all(|&channel| channel > 235));
    }

    #[test]
    fn two_stops_quarter_the_values_of_the_legend() {
        let display = Display { exposure_stops: 2.0, ..Display::default() };
        assert_eq!(display.legend_range(), [0.0, 0.25]);
        assert_eq!(Display { range: [-0.5, 2.0], map: ColourMap::Signed, ..display }.legend_range(), [-0.5, 0.5]);
    }
}
