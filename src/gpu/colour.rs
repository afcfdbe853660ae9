//! From numbers to a colour, as `canvas.wgsl` does it: the two are held together by the tests of the canvas.

use super::{ColourMap, Display, Drawing, Encoding, Kind, Placement, Source, Twin};

/// Width of a zebra's stripe, in pixels of the screen. The shader has the same number.
const STRIPE: f32 = 4.0;
/// Stripes over values at or above the clip.
const CLIP_STRIPE: [f32; 3] = [0.898, 0.224, 0.208];
/// Stripes over values below zero.
const NEGATIVE_STRIPE: [f32; 3] = [0.118, 0.533, 0.898];

/// The colour of the whole pixel `(x, y)`, sRGB bytes and alpha; the pixel lies at the same place of the screen. The background,
/// 0 to 1 in gamma space, outside the picture.
pub fn shade(source: &Source, display: &Display, pixel: (usize, usize), background: [f32; 3]) -> [u8; 4] {
    let placement = Placement { origin_px: [0.0, 0.0], scale: 1.0 };
    let drawing = Drawing { source, display, placement, background };
    Twin::new(drawing).pixel([pixel.0 as f32 + 0.5, pixel.1 as f32 + 0.5]).map(to_byte)
}

/// The colour of one value through the display's map, as legends need it: sRGB bytes.
pub fn colour_of_value(value: f32, display: &Display) -> [u8; 3] {
    mapped(value, display).map(to_byte)
}

/// A pixel's colour before tints and mask, 0 to 1 in gamma space.
pub(super) fn colour(values: [f32; 3], kind: Kind, display: &Display) -> [f32; 3] {
    match kind {
        Kind::Value | Kind::Difference | Kind::Ratio => mapped(values[0], display),
        Kind::Colour => values.map(|value| encoded(position(value, display), display.encoding)),
        Kind::Normal => values.map(|component| (0.5 * component + 0.5).clamp(0.0, 1.0)),
    }
}

/// The stripe over a pixel at `screen_px`, if its numbers ask for one and it lies on a stripe.
pub(super) fn zebra(values: [f32; 3], kind: Kind, display: &Display, screen_px: [f32; 2]) -> Option<[f32; 3]> {
    let shown = match kind {
        Kind::Value => &values[..1],
        Kind::Colour => &values[..],
        Kind::Normal | Kind::Difference | Kind::Ratio => return None,
    };
    let on_stripe = |along: f32| (along / STRIPE).floor().rem_euclid(2.0) < 1.0;
    if display.clip.is_some_and(|clip| shown.iter().any(|&value| value >= clip))
        && on_stripe(screen_px[0] + screen_px[1])
    {
        return Some(CLIP_STRIPE);
    }
    let negative = display.negative_zebra && shown.iter().any(|&value| value < 0.0);
    (negative && on_stripe(screen_px[0] - screen_px[1])).then_some(NEGATIVE_STRIPE)
}

/// Where a value lies on the colour map, 0 to 1.
fn position(value: f32, display: &Display) -> f32 {
    let [low, high] = display.drawn_range();
    ((value * display.gain() - low) / (high - low)).clamp(0.0, 1.0)
}

fn mapped(value: f32, display: &Display) -> [f32; 3] {
    let position = position(value, display);
    if display.map == ColourMap::Grey {
        return [encoded(position, display.encoding); 3];
    }
    let table = display.map.table();
    let index = (position * 255.0).floor().min(254.0);
    let (below, above) = (table[index as usize], table[index as usize + 1]);
    let fraction = position * 255.0 - index;
    std::array::from_fn(|channel| {
        (f32::from(below[channel]) * (1.0 - fraction) + f32::from(above[channel]) * fraction) / 255.0
    })
}

fn encoded(linear: f32, encoding: Encoding) -> f32 {
    match encoding {
        Encoding::Srgb if linear <= 0.003_130_8 => 12.92 * linear,
        Encoding::Srgb => 1.055 * linear.powf(1.0 / 2.4) - 0.055,
        Encoding::Gamma(gamma) => linear.powf(1.0 / gamma),
    }
}

fn to_byte(value: f32) -> u8 {
    (value.clamp(0.0, 1.0) * 255.0).round() as u8
}
