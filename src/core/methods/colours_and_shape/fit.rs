//! The amount of indirect light of one light: the share s of the light that arrives, and light from outside the surface.

use rayon::prelude::*;

use super::grid::{Grid, GridLight};
use super::indirect::Indirect;
use crate::image::gaussian::gaussian;
use crate::{Mask, Plane};

/// The amount is expected within this share of the object's own, where a window knows no better.
const EXPECTED_SPREAD: f64 = 0.3;
/// No paint reflects more than it receives; surfaces out of view may send half as much again.
const LARGEST_AMOUNT: f64 = 1.5;
/// Relative to that of the object, the least amount that errors of the shape can explain; walls out of view only raise it.
const LEAST_FITTING: f64 = 0.2;
/// Where more of the object than this seems to be of another paint, the shape is wrong and not the paint.
const MOST_OTHER_PAINT: f64 = 0.5;
/// Another paint makes the indirect light wrong by more than this share of all light; less is an error of arriving light.
const WRONG_LIGHT: f64 = 0.05;
/// How wrong arriving light is for reasons that its noise does not show: patches, creases, normals between them.
const MODEL_ERROR: f64 = 0.01;
/// A window reaches into another paint where this share of it lies there.
const REACHED: f32 = 0.01;
/// Light from outside the surface is averaged over windows so many times as wide as those of the amount, and counts as far as
/// it exceeds so many standard deviations.
const WIDER: f64 = 2.0;
const SIGNIFICANT: f64 = 3.0;

/// How much indirect light there is.
#[derive(Clone, Debug)]
pub(super) struct Amount {
    /// s.
    pub share: Plane,
    /// I in linear light of the reference colour: s times what arrives, and what comes from outside the surface.
    pub light: Plane,
    /// Of that, what comes from outside.
    pub outside: Plane,
    /// The variance of I.
    pub variance: Plane,
    /// Whether the colours fit beta. Where they do not, another paint is there: the reference colour is used alone, with the
    /// amount of the rest of the object.
    pub fits: Mask,
}

/// What the cells of one light say of s and I, each with one over its variance.
pub(super) struct Fit {
    /// Of s.
    pub information: Plane,
    /// The same times s.
    pub weighted: Plane,
    /// Of I.
    precision: Plane,
    /// The same times I.
    weighted_light: Plane,
    /// What arrives over all light of the reference colour.
    arriving_share: Plane,
}

/// s in windows, and whether the colours fit beta there.
struct Shares {
    share: Plane,
    information: Plane,
    fits: Mask,
    /// Whether the window holds no other paint.
    is_clear: Mask,
}

impl Fit {
    pub(super) fn new(grid: &Grid, light: &GridLight, indirect: &Indirect, arriving: &Plane) -> Self {
        let of_cell = |cell: usize| {
            if !grid.mask.data()[cell] {
                return ((0.0, 0.0), (0.0, 0.0));
            }
            let arriving = f64::from(arriving.data()[cell]);
            let (precision, weighted) = indirect.split(light, cell).indirect();
            let of_share = ((precision * arriving * arriving) as f32, (weighted * arriving) as f32);
            (of_share, (precision as f32, weighted as f32))
        };
        let reference = light.colours[0].light.data();
        let arriving_share = |cell: usize| arriving.data()[cell] / reference[cell].max(f32::MIN_POSITIVE);
        let (width, height) = grid.size();
        let cells = (0..width * height).into_par_iter().map(of_cell);
        let (of_share, of_light): (Vec<_>, Vec<_>) = cells.unzip();
        let (information, weighted) = of_share.into_iter().unzip();
        let (precision, light) = of_light.into_iter().unzip();
        let plane = |data| Plane::from_vec(width, height, data).unwrap_or_default();
        Self {
            information: plane(information),
            weighted: plane(weighted),
            precision: plane(precision),
            weighted_light: plane(light),
            arriving_share: plane((0..width * height).into_par_iter().map(arriving_share).collect()),
        }
    }

    /// The amount in windows; `share` is that of the whole object.
    pub(super) fn amount(&self, arriving: &Plane, share: f64, sigma_px: f64) -> Amount {
        let Shares { share, information, fits, is_clear } = self.shares(share, sigma_px);
        let (outside, of_outside) = self.outside(arriving, &share, &is_clear, WIDER * sigma_px);
        let cells = cells_of_window(sigma_px);
        let of_cell = |cell: usize| {
            let (arriving, share) = (f64::from(arriving.data()[cell]), f64::from(share.data()[cell]));
            let light = (share * arriving + f64::from(outside.data()[cell])).max(0.0);
            let of_share = arriving.powi(2) / (cells * f64::from(information.data()[cell]));
            let variance = of_share + (MODEL_ERROR * light).powi(2) + f64::from(of_outside.data()[cell]);
            (light as f32, variance as f32)
        };
        let (width, height) = arriving.size();
        let (light, variance): (Vec<f32>, Vec<f32>) = (0..width * height).into_par_iter().map(of_cell).unzip();
        let plane = |data| Plane::from_vec(width, height, data).unwrap_or_default();
        Amount { light: plane(light), variance: plane(variance), share, outside, fits }
    }

    /// s in windows, `share` where they say nothing.
    fn shares(&self, share: f64, sigma_px: f64) -> Shares {
        let share = share.min(LARGEST_AMOUNT);
        let share_of_object = share;
        let expected = (EXPECTED_SPREAD * share.max(0.01)).powi(-2) / cells_of_window(sigma_px);
        let (information, weighted) = (gaussian(&self.information, sigma_px), gaussian(&self.weighted, sigma_px));
        let of_cell = |((information, weighted), arriving_share): ((&f32, &f32), &f32)| {
            let information = f64::from(*information) + expected;
            let fitted = (f64::from(*weighted) + expected * share) / information;
            let wrong = (fitted - share).abs() * f64::from(*arriving_share);
            let fits = share <= 0.0 || fitted > LEAST_FITTING * share || wrong < WRONG_LIGHT;
            let amount = if fits { fitted.clamp(0.0, LARGEST_AMOUNT) } else { share };
            (amount as f32, (information as f32, fits))
        };
        let cells = information.data().par_iter().zip(weighted.data()).zip(self.arriving_share.data()).map(of_cell);
        let (share, (information, fits)): (Vec<f32>, (Vec<f32>, Vec<bool>)) = cells.unzip();
        let (width, height) = weighted.size();
        let plane = |data| Plane::from_vec(width, height, data).unwrap_or_default();
        let other = fits.par_iter().filter(|fits| !**fits).count() as f64;
        let known = self.precision.data().par_iter().filter(|precision| **precision > 0.0).count() as f64;
        let fits = if other > MOST_OTHER_PAINT * known { vec![true; fits.len()] } else { fits };
        let fits = Mask::from_vec(width, height, fits).unwrap_or_default();
        // Windows that reach into another paint say nothing of this one.
        let other = gaussian(&fits.map(|fits| if fits { 0.0 } else { 1.0 }), sigma_px);
        let is_clear = other.map(|other| other < REACHED);
        let of_object = share_of_object as f32;
        let share = share.into_iter().zip(is_clear.data()).map(|(own, clear)| if *clear { own } else { of_object });
        Shares { share: plane(share.collect()), information: plane(information), fits, is_clear }
    }

    /// What the colours show of indirect light beyond s times what arrives, averaged in windows, and its variance: light of surfaces
    /// that the camera does not see.
    fn outside(&self, arriving: &Plane, share: &Plane, is_clear: &Mask, sigma_px: f64) -> (Plane, Plane) {
        let (width, height) = arriving.size();
        let plane = |data| Plane::from_vec(width, height, data).unwrap_or_default();
        let excess = |cell: usize| {
            let (precision, arriving) = (self.precision.data()[cell], share.data()[cell] * arriving.data()[cell]);
            let excess = self.weighted_light.data()[cell] - precision * arriving;
            if is_clear.data()[cell] { (precision, excess) } else { (0.0, 0.0) }
        };
        let (precision, excess): (Vec<f32>, Vec<f32>) = (0..width * height).into_par_iter().map(excess).unzip();
        let (precision, excess) = (gaussian(&plane(precision), sigma_px), gaussian(&plane(excess), sigma_px));
        let cells = cells_of_window(sigma_px);
        let of_cell = |cell: usize| {
            let known = f64::from(precision.data()[cell]);
            if known <= 0.0 || self.precision.data()[cell] <= 0.0 || !is_clear.data()[cell] {
                return (0.0, 0.0);
            }
            let mean = (f64::from(excess.data()[cell]) / known).max(0.0);
            let variance = (known * cells).recip();
            let model = MODEL_ERROR * f64::from(share.data()[cell] * arriving.data()[cell]);
            let insignificant = SIGNIFICANT.powi(2) * (variance + model.powi(2)) / mean.powi(2).max(f64::MIN_POSITIVE);
            let kept = (1.0 - insignificant).max(0.0);
            ((kept * mean) as f32, (kept * variance) as f32)
        };
        let (outside, variance): (Vec<f32>, Vec<f32>) = (0..width * height).into_par_iter().map(of_cell).unzip();
        (plane(outside), plane(variance))
    }
}

/// Independent cells that one Gaussian window averages; a window within one cell averages that cell alone.
pub(super) fn cells_of_window(sigma_px: f64) -> f64 {
    (4.0 * std::f64::consts::PI * sigma_px * sigma_px).max(1.0)
}
