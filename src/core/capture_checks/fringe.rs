//! Lateral colour shift: edges of one light's photos that lie elsewhere in another colour, as lenses make them toward the border of
//! the picture. Found in small parts of the picture at full size, by the phase correlation of [`super::shift`].

use rayon::prelude::*;

use super::shift::{EdgeSpectrum, EdgeWindow, PairShift, pair_shifts};
use super::small::region;
use crate::options::{OptionError, check_range};
use crate::{Mask, Plane};

/// How to look for a colour fringe.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FringeOptions {
    /// Shifts up to here are none, in pixels: the light between walls has another colour, and moves the middle of an edge.
    pub max_rest_px: f64,
    /// A correlation whose peak is lower, in standard deviations of the correlation, says nothing.
    pub min_strength: f64,
    /// Parts that correlate so well without a shift, as a share of the peak, are at rest.
    pub min_at_rest: f64,
    /// The shift of a part must lie so many standard errors of its lights beyond `max_rest_px`.
    pub min_errors: f64,
}

impl Default for FringeOptions {
    fn default() -> Self {
        Self { max_rest_px: 0.5, min_strength: 10.0, min_at_rest: 0.85, min_errors: 3.0 }
    }
}

impl FringeOptions {
    /// Whether every option is in its range.
    pub fn check(&self) -> Result<(), OptionError> {
        let positive =
            [("max_rest_px", self.max_rest_px), ("min_strength", self.min_strength), ("min_errors", self.min_errors)];
        for (option, value) in positive {
            check_range(option, value, value > 0.0 && value.is_finite(), "a positive number")?;
        }
        let share = self.min_at_rest;
        check_range("min_at_rest", share, share > 0.0 && share <= 1.0, "above 0, up to 1")
    }
}

/// The side of a part in pixels.
const SIDE_PX: usize = 128;
/// A smaller part holds no edges to compare.
const MIN_SIDE_PX: usize = 48;
/// Parts along each side of the picture.
const ALONG: usize = 3;
/// Lights that must agree.
const MIN_LIGHTS: usize = 2;
/// One light's shift is measured no better than this, in pixels.
const MIN_SPREAD_PX: f64 = 0.1;
/// From median absolute deviations to standard deviations of normal noise.
const MAD_TO_SD: f64 = 1.4826;

/// The parts of a scene's photos in which edges are compared.
#[derive(Clone, Debug)]
pub struct FringeWindow {
    parts: Vec<EdgeWindow>,
    /// The middle of each, x right and y down, in pixels.
    middles_px: Vec<[f64; 2]>,
}

impl FringeWindow {
    /// For photos of this size, over the object where there is a mask. `None` for pictures too small for edges.
    pub fn new(size: (usize, usize), mask: Option<&Mask>) -> Option<Self> {
        let mask = mask.filter(|mask| mask.size() == size);
        let [left, top, width, height] = region(size, mask)?;
        let side = SIDE_PX.min(width).min(height);
        if side < MIN_SIDE_PX {
            return None;
        }
        let starts = |from: usize, length: usize| {
            let count = if length < 2 * side { 1 + usize::from(length > side) } else { ALONG };
            (0..count).map(move |index| from + index * (length - side) / (count - 1).max(1)).collect::<Vec<_>>()
        };
        let (columns, rows) = (starts(left, width), starts(top, height));
        let corners: Vec<[usize; 2]> = rows.iter().flat_map(|y| columns.iter().map(|x| [*x, *y])).collect();
        Some(Self {
            middles_px: corners.iter().map(|corner| corner.map(|at| (at + side / 2) as f64)).collect(),
            parts: corners.into_iter().map(|corner| EdgeWindow::of(size, corner, 1, (side, side), mask)).collect(),
        })
    }

    /// The phases of a photo's edges in each part; `None` for a photo of another size.
    pub fn spectrum(&self, photo: &Plane) -> Option<FringeSpectrum> {
        self.parts.par_iter().map(|part| part.spectrum(photo)).collect::<Option<_>>().map(FringeSpectrum)
    }
}

/// The phases of a photo's edges in each part.
#[derive(Clone, Debug)]
pub struct FringeSpectrum(Vec<EdgeSpectrum>);

/// Edges of one colour that lie beside those of another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fringe {
    /// Where the shift is largest, x right and y down, in pixels.
    pub at_px: [f64; 2],
    /// From the first colour to the second there, in pixels.
    pub shift_px: [f64; 2],
    /// Whether all parts are shifted alike, as by a camera that was moved between the colours; a lens shifts the sides apart.
    pub is_uniform: bool,
}

/// The colour fringe of photos in two colours, a pair for each light; `None` where there is none. A lens gives all lights the same:
/// the median of the lights counts, so that one whose photo was moved says nothing.
///
/// # Errors
/// An option out of its range.
pub fn find_fringe(
    window: &FringeWindow,
    lights: &[(&FringeSpectrum, &FringeSpectrum)],
    options: &FringeOptions,
) -> Result<Option<Fringe>, OptionError> {
    options.check()?;
    let at_rest = |pair: PairShift| {
        let is_at_rest = pair.at_rest >= options.min_at_rest && length(pair.shift_px) > options.max_rest_px;
        (pair.strength >= options.min_strength).then_some(if is_at_rest { [0.0; 2] } else { pair.shift_px })
    };
    // Each light's parts two by two.
    let of_light = |(first, second): &(&FringeSpectrum, &FringeSpectrum)| {
        let parts: Vec<_> = first.0.iter().zip(&second.0).collect();
        parts.chunks(2).flat_map(pair_shifts).map(|pair| pair.and_then(at_rest)).collect::<Vec<_>>()
    };
    let by_light: Vec<Vec<Option<[f64; 2]>>> = lights.par_iter().map(of_light).collect();
    let of_part = |part: usize| {
        let shifts: Vec<[f64; 2]> = by_light.iter().filter_map(|shifts| *shifts.get(part)?).collect();
        if shifts.len() < MIN_LIGHTS {
            return None;
        }
        let shift = [0, 1].map(|axis| median(shifts.iter().map(|shift| shift[axis]).collect()));
        let off = |other: &[f64; 2]| length([other[0] - shift[0], other[1] - shift[1]]);
        let spread = (MAD_TO_SD * median(shifts.iter().map(off).collect())).max(MIN_SPREAD_PX);
        Some((part, shift, spread / (shifts.len() as f64).sqrt()))
    };
    let found: Vec<_> = (0..window.parts.len()).filter_map(of_part).collect();
    let is_shifted = |shift: [f64; 2], error: f64| length(shift) > options.max_rest_px + options.min_errors * error;
    let shifted = found.iter().filter(|(_, shift, error)| is_shifted(*shift, *error));
    let largest = shifted.max_by(|a, b| length(a.1).total_cmp(&length(b.1)));
    Ok(largest.map(|&(part, shift, _)| {
        let beside = |other: [f64; 2]| length([other[0] - shift[0], other[1] - shift[1]]);
        let is_uniform = found.iter().all(|(_, other, error)| !is_shifted([beside(*other), 0.0], *error));
        Fringe { at_px: window.middles_px[part], shift_px: shift, is_uniform }
    }))
}

fn length([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}

/// Of at least one number.
fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    if values.len() % 2 == 1 { values[middle] } else { (values[middle - 1] + values[middle]) / 2.0 }
}

#[cfg(test)]
mod tests {
    use rand::rngs::StdRng;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    use super::*;

    const SIZE: usize = 320;
    /// Side of a square with one stone, in pixels.
    const STONE: usize = 11;

    /// A floor of stones of random shade under a lamp, magnified about the middle of the picture by a share.
    fn photo(lamp: usize, magnified: f64, moved_px: f64, seed: u64) -> Plane {
        let mut random = StdRng::seed_from_u64(7);
        let side = 1 + SIZE / STONE;
        let mut stone = |index: usize| {
            let at = |square: usize, within: f64| (square as f64 + within) * STONE as f64;
            let shade = 0.2 + 0.6 * random.random::<f64>();
            [at(index % side, random.random()), at(index / side, random.random()), shade]
        };
        let stones: Vec<[f64; 3]> = (0..side * side).map(&mut stone).collect();
        let mut random = StdRng::seed_from_u64(seed);
        let half = SIZE as f64 / 2.0;
        let around = |at: f64| {
            let square = (at.max(0.0) / STONE as f64) as usize;
            square.saturating_sub(1)..(square + 2).min(side)
        };
        Plane::from_fn(SIZE, SIZE, |x, y| {
            let scaled = |at: usize, moved: f64| (at as f64 - moved - half) / (1.0 + magnified) + half;
            let (x, y) = (scaled(x, moved_px), scaled(y, 0.0));
            let near = around(y).flat_map(|row| around(x).map(move |column| row * side + column));
            let distance = |stone: &[f64; 3]| (stone[0] - x).hypot(stone[1] - y);
            let nearest = near.map(|index| stones[index]).min_by(|a, b| distance(a).total_cmp(&distance(b)));
            let shading = 0.6 + 0.3 * (0.01 * x + lamp as f64).sin();
            (shading * nearest.map_or(0.0, |stone| stone[2]) + 0.003 * random.sample::<f64, _>(StandardNormal)) as f32
        })
    }

    fn fringe(magnified: f64, moved_px: f64) -> Option<Fringe> {
        let window = FringeWindow::new((SIZE, SIZE), None).unwrap();
        let spectrum = |lamp, magnified, moved, seed| window.spectrum(&photo(lamp, magnified, moved, seed)).unwrap();
        let lights = [0, 1, 2]
            .map(|lamp| (spectrum(lamp, 0.0, 0.0, lamp as u64), spectrum(lamp, magnified, moved_px, 10 + lamp as u64)));
        let pairs: Vec<_> = lights.iter().map(|(first, second)| (first, second)).collect();
        find_fringe(&window, &pairs, &FringeOptions::default()).unwrap()
    }

    #[test]
    fn colours_that_lie_over_each_other_have_no_fringe() {
        assert_eq!(fringe(0.0, 0.0), None);
    }

    #[test]
    fn a_lens_that_magnifies_one_colour_more_is_found_and_by_how_many_pixels() {
        // Parts are 96 px from the middle: there 1.2 percent are 1.15 px along each axis.
        let found = fringe(0.012, 0.0).unwrap();
        let expected = found.at_px.map(|at| 0.012 * (at - SIZE as f64 / 2.0));
        let miss = [0, 1].map(|axis| found.shift_px[axis] - expected[axis]);
        assert!(length(miss) < 0.35 && !found.is_uniform, "{found:?}, expected {expected:?}");
    }

    #[test]
    fn a_camera_that_moved_between_the_colours_shifts_all_parts_alike() {
        let found = fringe(0.0, 3.0).unwrap();
        assert!((found.shift_px[0] - 3.0).abs() < 0.3 && found.is_uniform, "{found:?}");
    }

    #[test]
    fn pictures_too_small_for_edges_are_not_compared() {
        assert!(FringeWindow::new((40, 300), None).is_none());
        let window = FringeWindow::new((64, 64), None).unwrap();
        assert!(window.spectrum(&Plane::filled(65, 64, 0.5)).is_none());
        assert!(FringeOptions { min_strength: 0.0, ..FringeOptions::default() }.check().is_err());
    }
}
