//! The amount of indirect light of one light: the share s of the light that arrives, and light from outside the surface.

use rayon::prelude::*;

use super::grid::{Grid, GridLight};
use super::indirect::Indirect;
use crate::image::gaussian::gaussian;
use crate::{Mask, Plane};

/// The amount is expected within this share of the object's own, where a window knows no better.
const EXPECTED_SPREAD: f64 = 0.3;
/// No paint reflects more than it receives; surfaces out of view may send half as much again.
pub(super) const MAX_AMOUNT: f64 = 1.5;
/// Relative to that of the object, the least amount that errors of the shape can explain; walls out of view only raise it.
const MIN_FITTING: f64 = 0.2;
/// The share of the lights that have to say so where a cell counts as another paint: paint belongs to the surface, errors of arriving
/// light to one lamp.
const MIN_AGREEING_LIGHTS: f64 = 2.0 / 3.0;
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
    /// Whether the colours fit beta, the same under every light. Where they do not, another paint is there: the reference colour is
    /// used alone, with the amount of the rest of the object.
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

/// s of one light in windows.
pub(super) struct Windows {
    /// s, that of the object where the window says nothing.
    share: Plane,
    information: Plane,
    /// Whether the colours fit beta there.
    fits: Mask,
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

    /// s in windows; `share` is that of the whole object.
    pub(super) fn windows(&self, share: f64, sigma_px: f64) -> Windows {
        let share = share.min(MAX_AMOUNT);
        let expected = (EXPECTED_SPREAD * share.max(0.01)).powi(-2) / cells_of_window(sigma_px);
        let (information, weighted) = (gaussian(&self.information, sigma_px), gaussian(&self.weighted, sigma_px));
        let of_cell = |((information, weighted), arriving_share): ((&f32, &f32), &f32)| {
            let information = f64::from(*information) + expected;
            let fitted = (f64::from(*weighted) + expected * share) / information;
            let wrong = (fitted - share).abs() * f64::from(*arriving_share);
            let fits = share <= 0.0 || fitted > MIN_FITTING * share || wrong < WRONG_LIGHT;
            (fitted as f32, (information as f32, fits))
        };
        let cells = information.data().par_iter().zip(weighted.data()).zip(self.arriving_share.data()).map(of_cell);
        let (share, (information, fits)): (Vec<f32>, (Vec<f32>, Vec<bool>)) = cells.unzip();
        let (width, height) = weighted.size();
        let plane = |data| Plane::from_vec(width, height, data).unwrap_or_default();
        let fits = Mask::from_vec(width, height, fits).unwrap_or_default();
        Windows { share: plane(share), information: plane(information), fits }
    }

    /// The amount in windows where the colours fit beta, that of the whole object where they do not.
    pub(super) fn amount(&self, windows: Windows, fits: &Mask, arriving: &Plane, share: f64, sigma_px: f64) -> Amount {
        // Windows that reach into another paint say nothing of this one.
        let other = gaussian(&fits.map(|fits| if fits { 0.0 } else { 1.0 }), sigma_px);
        let is_clear = other.map(|other| other < REACHED);
        let of_object = share.min(MAX_AMOUNT) as f32;
        let own = |(own, clear): (f32, &bool)| if *clear { own.clamp(0.0, MAX_AMOUNT as f32) } else { of_object };
        let Windows { share, information, .. } = windows;
        let (width, height) = arriving.size();
        let plane = |data| Plane::from_vec(width, height, data).unwrap_or_default();
        let share = plane(share.data().iter().copied().zip(is_clear.data()).map(own).collect());
        let (outside, of_outside) = self.outside(arriving, &share, &is_clear, WIDER * sigma_px);
        let cells = cells_of_window(sigma_px);
        let of_cell = |cell: usize| {
            let (arriving, share) = (f64::from(arriving.data()[cell]), f64::from(share.data()[cell]));
            let light = (share * arriving + f64::from(outside.data()[cell])).max(0.0);
            let of_share = arriving.powi(2) / (cells * f64::from(information.data()[cell]));
            let variance = of_share + (MODEL_ERROR * light).powi(2) + f64::from(of_outside.data()[cell]);
            (light as f32, variance as f32)
        };
        let (light, variance): (Vec<f32>, Vec<f32>) = (0..width * height).into_par_iter().map(of_cell).unzip();
        Amount { light: plane(light), variance: plane(variance), share, outside, fits: fits.clone() }
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

/// By light, the amount in windows; `share` is that of the whole object. Another paint is where most lights see it.
pub(super) fn amounts(fits: &[Fit], arriving: &[&Plane], share: f64, sigma_px: f64) -> Vec<Amount> {
    let windows: Vec<Windows> = fits.iter().map(|fit| fit.windows(share, sigma_px)).collect();
    let Some((width, height)) = windows.first().map(|windows| windows.fits.size()) else { return Vec::new() };
    let limit = MIN_AGREEING_LIGHTS * windows.len() as f64;
    let fits_beta = |cell: usize| {
        let doubting = windows.iter().filter(|windows| !windows.fits.data()[cell]).count();
        (doubting as f64) < limit
    };
    let of_surface = (0..width * height).into_par_iter().map(fits_beta).collect();
    let of_surface = Mask::from_vec(width, height, of_surface).unwrap_or_default();
    let lights = fits.iter().zip(windows).zip(arriving);
    lights.map(|((fit, windows), arriving)| fit.amount(windows, &of_surface, arriving, share, sigma_px)).collect()
}

/// Independent cells that one Gaussian window averages; a window within one cell averages that cell alone.
pub(super) fn cells_of_window(sigma_px: f64) -> f64 {
    (4.0 * std::f64::consts::PI * sigma_px * sigma_px).max(1.0)
}
