//! From arriving light to the indirect light of every cell: its colour ratio r_c and its amount, `I = s K N_ref`.

use rayon::prelude::*;

use super::amount::{AmountReport, Tiles};
use super::fit::{Amount, Fit, amounts};
use super::grid::{Grid, GridLight};
use super::split::Split;
use super::{ColoursAndShapeOptions, IndirectMaps};
use crate::image::gaussian::gaussian;
use crate::{Mask, Plane};

/// Less light than this, relative to the brightest of the photo, has no colour ratio worth the name.
const DIM: f32 = 1e-4;

/// What is known of the indirect light of one light.
#[derive(Clone, Debug)]
pub(super) struct Indirect {
    /// By colour, r_c; 1 for the reference.
    pub ratio: Vec<Ratio>,
    /// Where the shape gives it.
    pub amount: Option<Amount>,
}

/// The colour ratio of indirect light.
#[derive(Clone, Debug)]
pub(super) enum Ratio {
    /// One number for the light.
    Even(f32),
    /// For every cell.
    Map(Plane),
}

impl Ratio {
    pub(super) fn at(&self, cell: usize) -> f32 {
        match self {
            Self::Even(ratio) => *ratio,
            Self::Map(plane) => plane.data()[cell],
        }
    }
}

impl Indirect {
    /// One ratio for the light: that of all light of the object.
    pub(super) fn even(light: &GridLight, mask: &Mask) -> Self {
        let usable = |cell: &usize| mask.data()[*cell] && light.colours.iter().all(|c| c.precision.data()[*cell] > 0.0);
        let cells: Vec<usize> = (0..mask.data().len()).into_par_iter().filter(usable).collect();
        let sum = |c: usize| cells.par_iter().map(|&i| f64::from(light.colours[c].light.data()[i])).sum::<f64>();
        let reference = sum(0);
        let ratio = |c: usize| if c == 0 || reference <= 0.0 { 1.0 } else { sum(c) / reference };
        Self { ratio: (0..light.colours.len()).map(|c| Ratio::Even(ratio(c) as f32)).collect(), amount: None }
    }

    /// The ratios of every so many-th cell along columns and rows alone.
    pub(super) fn thinned(&self, every: usize) -> Self {
        let ratio = |ratio: &Ratio| match ratio {
            Ratio::Even(ratio) => Ratio::Even(*ratio),
            Ratio::Map(plane) => Ratio::Map(plane.thinned(every)),
        };
        Self { ratio: self.ratio.iter().map(ratio).collect(), amount: None }
    }

    /// What is shown of it.
    pub(super) fn into_maps(self, (width, height): (usize, usize)) -> IndirectMaps {
        let plane = |ratio| match ratio {
            Ratio::Even(ratio) => Plane::filled(width, height, ratio),
            Ratio::Map(plane) => plane,
        };
        IndirectMaps {
            ratio: self.ratio.into_iter().map(plane).collect(),
            amount: self.amount.map(|amount| amount.share),
        }
    }

    /// How many colours of a cell may be used.
    pub(super) fn colours_at(&self, cell: usize) -> usize {
        if self.amount.as_ref().is_none_or(|amount| amount.fits.data()[cell]) { self.ratio.len() } else { 1 }
    }

    /// The fit of every cell with the ratios as they are.
    pub(super) fn split(&self, light: &GridLight, cell: usize) -> Split {
        let mut split = Split::default();
        let colours = light.colours.iter().zip(&light.beta).zip(&self.ratio).take(self.colours_at(cell));
        for ((photo, beta), ratio) in colours {
            let precision = f64::from(photo.precision.data()[cell]);
            if precision > 0.0 {
                split.add(f64::from(photo.light.data()[cell]), precision, *beta, f64::from(ratio.at(cell)));
            }
        }
        split
    }
}

/// The indirect light of every light from what arrives, by light and then colour, and K N_ref of every light; `even` is that of
/// one ratio a light.
pub(super) fn indirect_light(
    grid: &Grid,
    even: &[Indirect],
    arriving: Vec<Vec<Plane>>,
    options: &ColoursAndShapeOptions,
) -> (Vec<Indirect>, Vec<Plane>, Option<AmountReport>) {
    let sigma = options.ratio_window_px;
    let weight = gaussian(&grid.mask.map(|inside| if inside { 1.0 } else { 0.0 }), sigma);
    let smooth = |plane: Plane| {
        let mut plane = gaussian(&plane, sigma);
        plane.data_mut().par_iter_mut().zip(weight.data()).for_each(|(value, weight)| *value /= weight.max(1e-9));
        plane
    };
    let lights: Vec<_> = (grid.lights.iter().zip(even).zip(arriving))
        .map(|((light, even), arriving)| {
            let smoothed: Vec<Plane> = arriving.iter().map(|plane| smooth(plane.clone())).collect();
            let brightest = light.colours[0].light.data().iter().copied().fold(0.0, f32::max);
            let ratio = |c: usize| {
                let data = smoothed[0].data().par_iter().zip(smoothed[c].data()).enumerate();
                let of_cell = |(cell, (reference, light)): (usize, (&f32, &f32))| {
                    if *reference > DIM * brightest { light / reference } else { even.ratio[c].at(cell) }
                };
                let (width, height) = grid.size();
                Ratio::Map(Plane::from_vec(width, height, data.map(of_cell).collect()).unwrap_or_default())
            };
            let ratio = (0..light.colours.len()).map(|c| if c == 0 { Ratio::Even(1.0) } else { ratio(c) }).collect();
            (Indirect { ratio, amount: None }, arriving.into_iter().next().unwrap_or_default())
        })
        .collect();
    let fits: Vec<Fit> =
        lights.iter().zip(&grid.lights).map(|((i, arriving), light)| Fit::new(grid, light, i, arriving)).collect();
    let report = Tiles::of(&grid.mask, &fits).map(|tiles| tiles.report());
    let share = report.map_or(0.0, |report| report.median.max(0.0));
    let (mut lights, arriving): (Vec<Indirect>, Vec<Plane>) = lights.into_iter().unzip();
    let amounts = amounts(&fits, &arriving.iter().collect::<Vec<_>>(), share, options.amount_window_px);
    for (light, amount) in lights.iter_mut().zip(amounts) {
        light.amount = Some(amount);
    }
    let report = report.map(|report| report.with_lights(&grid.mask, &lights));
    (lights, arriving, report)
}
