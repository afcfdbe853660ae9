//! The end of the colour ratio: where no indirect light falls in, `N_c' / N_ref` is beta_c; everywhere else it lies on the far side
//! of beta_c from 1, for indirect light has met the paint more than once. See "Beta without a ball of the paint" in
//! [`crate::method`].

use rayon::prelude::*;

use super::fit::cells_of_window;
use super::grid::{Grid, GridLight};
use super::indirect::Indirect;
use crate::image::gaussian::gaussian;
use crate::{Mask, Plane};

/// Photos are smoothed by a Gaussian of this standard deviation first, so that noise makes no end of its own.
const WINDOW_PX: f64 = 3.0;
/// Cells darker than this share of the brightest are not lit.
const LIT: f32 = 0.1;
/// The share of the cells beyond the end.
const BEYOND: f64 = 0.01;

/// The end of the ratio of one colour over the reference colour, all lights together.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct EndOfRatio {
    /// The ratio: the largest where the colour is darker than the reference, else the smallest. Beta lies at or beyond it.
    pub value: f64,
    /// Standard deviation of the ratio of one cell.
    pub noise: f64,
    /// By how much of itself indirect light keeps the ratio from beta there, as the shape tells it; `None` without one.
    pub indirect_share: Option<f64>,
}

/// One cell under one light.
struct Sample {
    ratio: f32,
    light: usize,
    cell: usize,
}

/// What the shape tells of the light that arrives at every cell.
#[derive(Clone, Copy)]
pub(super) struct Arriving<'a> {
    pub indirect: &'a [Indirect],
    /// By light, K N_ref.
    pub light: &'a [Plane],
    /// s of the whole object. What a window says near the end of the ratio is no evidence: with a beta that was taken from there, no
    /// indirect light is left there.
    pub amount: f64,
}

/// By colour, the reference left out. `None` where nothing is lit.
pub(super) fn ends_of_ratio(grid: &Grid, arriving: Option<Arriving>) -> Vec<Option<EndOfRatio>> {
    let colours = grid.lights.first().map_or(0, |light| light.colours.len());
    (1..colours).map(|c| end_of_ratio(grid, arriving, c)).collect()
}

fn end_of_ratio(grid: &Grid, arriving: Option<Arriving>, c: usize) -> Option<EndOfRatio> {
    let sigma = WINDOW_PX / grid.step_px as f64;
    let of_light = |(l, light): (usize, &GridLight)| {
        let [reference, other] = [0, c].map(|c| smoothed(light, c, &grid.mask, sigma));
        let brightest = reference.data().iter().copied().fold(0.0, f32::max);
        let cells = reference.data().iter().zip(other.data()).enumerate();
        let lit = cells.filter(|(cell, (reference, _))| grid.mask.data()[*cell] && **reference > LIT * brightest);
        lit.map(|(cell, (reference, other))| Sample { ratio: other / reference, light: l, cell }).collect::<Vec<_>>()
    };
    let mut samples: Vec<Sample> = grid.lights.iter().enumerate().flat_map(of_light).collect();
    samples.par_sort_unstable_by(|a, b| a.ratio.total_cmp(&b.ratio));
    let count = samples.len();
    if samples.get(count / 2)?.ratio < 1.0 {
        samples.reverse();
    }
    let beyond = &samples[..((BEYOND * count as f64) as usize).max(1)];
    let value = f64::from(beyond.last()?.ratio);
    let mean = |of: &dyn Fn(&Sample) -> f64| beyond.iter().map(of).sum::<f64>() / beyond.len() as f64;
    let averaged = cells_of_window(sigma);
    let variance = mean(&|sample| {
        let relative = |c: usize| {
            let photo = &grid.lights[sample.light].colours[c];
            let (light, precision) = (photo.light.data()[sample.cell], photo.precision.data()[sample.cell]);
            if precision > 0.0 { 1.0 / (f64::from(precision) * f64::from(light).powi(2)).max(1e-12) } else { 0.0 }
        };
        relative(0) + relative(c)
    });
    let indirect_share = arriving.map(|arriving| mean(&|sample| share_of(grid, &arriving, sample, c).abs()));
    Some(EndOfRatio { value, noise: value * (variance / averaged).sqrt(), indirect_share })
}

/// `N_c' = beta_c (N_ref - (1 - r_c) I)`: what indirect light takes from the ratio, of the whole.
fn share_of(grid: &Grid, arriving: &Arriving, sample: &Sample, c: usize) -> f64 {
    let ratio = f64::from(arriving.indirect[sample.light].ratio[c].at(sample.cell));
    let all = f64::from(grid.lights[sample.light].colours[0].light.data()[sample.cell]);
    let indirect = arriving.amount * f64::from(arriving.light[sample.light].data()[sample.cell]);
    if all > 0.0 { (1.0 - ratio) * indirect / all } else { 0.0 }
}

/// A colour of a light, smoothed over the cells where the photos of both colours are usable.
fn smoothed(light: &GridLight, c: usize, mask: &Mask, sigma: f64) -> Plane {
    let photo = &light.colours[c];
    let usable =
        |cell: usize| mask.data()[cell] && light.colours.iter().all(|photo| photo.precision.data()[cell] > 0.0);
    let data = (0..mask.data().len()).into_par_iter();
    let data = data.map(|cell| if usable(cell) { photo.light.data()[cell] } else { 0.0 }).collect();
    let plane = Plane::from_vec(mask.width(), mask.height(), data).unwrap_or_default();
    gaussian(&plane, sigma)
}
