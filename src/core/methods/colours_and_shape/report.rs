//! How the method went.

use rayon::prelude::*;

use super::indirect::Indirect;
use super::{AmountReport, ClosureReport, NoShape, SeparatedLight};
use crate::image::photo::CLIPPED;
use crate::separate::{OUTSIDE, UNSOLVED};

/// How the method went.
#[derive(Clone, Debug, PartialEq)]
pub struct ColoursAndShapeReport {
    /// Pixels along a cell of the grid on which arriving light was computed.
    pub step_px: usize,
    /// Why no shape was used, where one was asked for: then each light has one colour ratio.
    pub no_shape: Option<NoShape>,
    /// The amount of indirect light; `None` without a shape, or where no light arrives.
    pub amount: Option<AmountReport>,
    /// That amount against the albedo of the paint; `None` without an amount.
    pub closure: Option<ClosureReport>,
    /// By light.
    pub lights: Vec<LightReport>,
}

/// The separation of one light. Means run over the solved pixels.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct LightReport {
    /// By colour, the ratio of all the object's light over that of the reference colour, with the lamps' ratio divided out.
    pub ratio: Vec<f64>,
    /// Mean of L_1.
    pub mean_direct: f64,
    /// Mean of I.
    pub mean_indirect: f64,
    /// Mean of the predicted noise of L_1.
    pub mean_noise: f64,
    /// Pixels inside the mask that were solved, with all colours or with some.
    pub solved_pixels: usize,
    /// Of those, the pixels solved without a clipped or dark colour.
    pub reduced_pixels: usize,
    /// Pixels left unsolved because of clipped colours (perhaps dark ones too).
    pub unsolved_clipped_pixels: usize,
    /// Pixels left unsolved because of dark colours alone.
    pub unsolved_dark_pixels: usize,
}

impl LightReport {
    pub(super) fn of(light: &SeparatedLight, even: &Indirect) -> Self {
        let planes = (light.marks.data().par_iter(), light.direct.data(), light.indirect.data(), light.noise.data());
        let sums = planes.into_par_iter().filter(|(marks, ..)| **marks & OUTSIDE == 0).fold(Self::default, Self::with);
        let sums = sums.reduce(Self::default, Self::plus);
        let mean = |sum: f64| sum / sums.solved_pixels.max(1) as f64;
        Self {
            ratio: even.ratio.iter().map(|ratio| f64::from(ratio.at(0))).collect(),
            mean_direct: mean(sums.mean_direct),
            mean_indirect: mean(sums.mean_indirect),
            mean_noise: mean(sums.mean_noise),
            ..sums
        }
    }

    fn with(mut self, (marks, direct, indirect, noise): (&u8, &f32, &f32, &f32)) -> Self {
        if marks & UNSOLVED == 0 {
            self.solved_pixels += 1;
            self.reduced_pixels += usize::from(*marks != 0);
            self.mean_direct += f64::from(*direct);
            self.mean_indirect += f64::from(*indirect);
            self.mean_noise += f64::from(*noise);
        } else if marks & CLIPPED != 0 {
            self.unsolved_clipped_pixels += 1;
        } else {
            self.unsolved_dark_pixels += 1;
        }
        self
    }

    fn plus(self, other: Self) -> Self {
        Self {
            ratio: self.ratio,
            mean_direct: self.mean_direct + other.mean_direct,
            mean_indirect: self.mean_indirect + other.mean_indirect,
            mean_noise: self.mean_noise + other.mean_noise,
            solved_pixels: self.solved_pixels + other.solved_pixels,
            reduced_pixels: self.reduced_pixels + other.reduced_pixels,
            unsolved_clipped_pixels: self.unsolved_clipped_pixels + other.unsolved_clipped_pixels,
            unsolved_dark_pixels: self.unsolved_dark_pixels + other.unsolved_dark_pixels,
        }
    }
}
