//! From arriving light to the indirect light of every cell: its colour ratio r_c and its amount, `I = s K N_ref`.

use rayon::prelude::*;

use super::amount::{AmountReport, Tiles};
use super::grid::{Grid, GridLight};
use super::split::Split;
use super::{ColoursAndShapeOptions, IndirectMaps};
use crate::image::gaussian::gaussian;
use crate::{Mask, Plane};

/// Less light than this, relative to the brightest of the photo, has no colour ratio worth the name.
const DIM: f32 = 1e-4;
/// The amount is expected within this share of the object's own, where a window knows no better.
const EXPECTED_SPREAD: f64 = 0.3;
/// No paint reflects more than it receives; surfaces out of view may send half as much again.
const LARGEST_AMOUNT: f64 = 1.5;

/// How wrong arriving light is for reasons that its noise does not show: patches, creases, normals between them.
const MODEL_ERROR: f64 = 0.01;

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

/// How much indirect light there is.
#[derive(Clone, Debug)]
pub(super) struct Amount {
    /// s.
    pub share: Plane,
    /// I in linear light of the reference colour.
    pub light: Plane,
    /// Its variance.
    pub variance: Plane,
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

    /// The fit of every cell with the ratios as they are.
    pub(super) fn split(&self, light: &GridLight, cell: usize) -> Split {
        let mut split = Split::default();
        for ((photo, beta), ratio) in light.colours.iter().zip(&light.beta).zip(&self.ratio) {
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
    let mut lights: Vec<_> = (grid.lights.iter().zip(even).zip(arriving))
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
    let share = common_share(&fits);
    for ((indirect, arriving), fit) in lights.iter_mut().zip(&fits) {
        indirect.amount = Some(fit.amount(arriving, share, options.amount_window_px));
    }
    let report = Tiles::of(&grid.mask, &fits).map(|tiles| tiles.report());
    let (indirect, arriving) = lights.into_iter().unzip();
    (indirect, arriving, report)
}

/// What the cells of one light say of s: information, and s times information.
pub(super) struct Fit {
    pub information: Plane,
    pub weighted: Plane,
}

impl Fit {
    pub(super) fn new(grid: &Grid, light: &GridLight, indirect: &Indirect, arriving: &Plane) -> Self {
        let of_cell = |cell: usize| {
            if !grid.mask.data()[cell] {
                return (0.0, 0.0);
            }
            let arriving = f64::from(arriving.data()[cell]);
            let (precision, weighted) = indirect.split(light, cell).indirect();
            ((precision * arriving * arriving) as f32, (weighted * arriving) as f32)
        };
        let (width, height) = grid.size();
        let (information, weighted): (Vec<f32>, Vec<f32>) = (0..width * height).into_par_iter().map(of_cell).unzip();
        let plane = |data| Plane::from_vec(width, height, data).unwrap_or_default();
        Self { information: plane(information), weighted: plane(weighted) }
    }

    /// s in windows, `share` where they say nothing.
    pub(super) fn amount(&self, arriving: &Plane, share: f64, sigma_px: f64) -> Amount {
        // Independent cells that one window averages.
        let cells = 4.0 * std::f64::consts::PI * sigma_px * sigma_px;
        let expected = (EXPECTED_SPREAD * share.max(0.01)).powi(-2) / cells;
        let (information, weighted) = (gaussian(&self.information, sigma_px), gaussian(&self.weighted, sigma_px));
        let of_cell = |((information, weighted), arriving): ((&f32, &f32), &f32)| {
            let information = f64::from(*information) + expected;
            let amount = ((f64::from(*weighted) + expected * share) / information).clamp(0.0, LARGEST_AMOUNT);
            let arriving = f64::from(*arriving);
            (
                amount as f32,
                (
                    (amount * arriving) as f32,
                    (arriving * arriving / (cells * information) + (MODEL_ERROR * amount * arriving).powi(2)) as f32,
                ),
            )
        };
        let cells = information.data().par_iter().zip(weighted.data()).zip(arriving.data()).map(of_cell);
        let (share, (light, variance)): (Vec<f32>, (Vec<f32>, Vec<f32>)) = cells.unzip();
        let plane = |data| Plane::from_vec(arriving.width(), arriving.height(), data).unwrap_or_default();
        Amount { share: plane(share), light: plane(light), variance: plane(variance) }
    }
}

/// s of the whole object, all lights together.
pub(super) fn common_share(fits: &[Fit]) -> f64 {
    let sum = |plane: &Plane| plane.data().par_iter().map(|&value| f64::from(value)).sum::<f64>();
    let information: f64 = fits.iter().map(|fit| sum(&fit.information)).sum();
    let weighted: f64 = fits.iter().map(|fit| sum(&fit.weighted)).sum();
    if information > 0.0 { (weighted / information).clamp(0.0, LARGEST_AMOUNT) } else { 0.0 }
}
