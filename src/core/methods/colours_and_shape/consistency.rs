//! Whether direct light found over the shape explains the object better than that of one colour ratio a light.

use rayon::prelude::*;

use super::direct::{direct_light, placed};
use super::fit::MAX_AMOUNT;
use super::grid::Grid;
use super::indirect::Indirect;
use super::{AmountReport, NoShape};
use crate::interval::median;
use crate::separate::{OUTSIDE, UNSOLVED};
use crate::stereo::normals::{Lamp, NormalsOptions, Paint, SHADOW_USED, Surface, normals};
use crate::{Plane, Unwatched};

/// An albedo that differs from that of the object by a larger share is another paint, and counts no more than this.
const MAX_DIFFERENCE: f64 = 0.3;
/// The spread of albedos by one ratio has to be smaller than this share of that over the shape: it has more noise, and less only
/// where the shape is wrong.
const CLEARLY_SMALLER: f64 = 0.9;

/// How much the albedos of photometric stereo differ over the object: the mean of their differences from the median, relative.
/// Indirect light that is left in, or too much that is taken off, makes one paint look like many. `None` where no cell is lit by
/// three lights.
fn spread_of_albedo(
    grid: &Grid,
    indirect: &[Indirect],
    lamps: &[Option<(Lamp, f64)>],
    depth_mm: &Plane,
    options: &NormalsOptions,
) -> Option<f64> {
    let direct = direct_light(grid, indirect);
    let surface = Surface { camera: &grid.camera, depth_mm: Some(depth_mm) };
    let options = NormalsOptions { paint: Paint::Any, ..*options };
    let (found, _) = normals(&placed(&direct, lamps), &grid.mask, surface, &options, &Unwatched).ok()?;
    let cells = found.albedo.data().par_iter().zip(found.marks.data());
    let is_lit = |marks: u8| marks & (UNSOLVED | OUTSIDE | SHADOW_USED) == 0;
    let mut albedos: Vec<f64> =
        cells.filter(|(_, marks)| is_lit(**marks)).map(|(albedo, _)| f64::from(*albedo)).collect();
    let middle = median(&mut albedos);
    let difference = |albedo: &f64| ((albedo - middle).abs() / middle).min(MAX_DIFFERENCE);
    (middle > 0.0).then(|| albedos.par_iter().map(difference).sum::<f64>() / albedos.len() as f64)
}

/// Why one ratio a light is better than what was found over the shape, where it is.
pub(super) fn why_even_is_better(
    grid: &Grid,
    (even, over_shape): (&[Indirect], &[Indirect]),
    amount: &AmountReport,
    lamps: &[Option<(Lamp, f64)>],
    depth_mm: &Plane,
    options: &NormalsOptions,
) -> Option<NoShape> {
    if amount.is_known() && amount.mean > MAX_AMOUNT {
        return Some(NoShape::OutOfView { amount: amount.mean });
    }
    let spread = |indirect| spread_of_albedo(grid, indirect, lamps, depth_mm, options);
    let (even, over_shape) = (spread(even)?, spread(over_shape)?);
    (even < CLEARLY_SMALLER * over_shape).then_some(NoShape::Misfit { even, over_shape })
}
