//! Dark frames and flat fields.

use std::borrow::Borrow;
use std::path::PathBuf;

use firstbounce_core::image::photo::{CLIPPED, DARK};
use firstbounce_core::{Marks, Plane};
use rayon::prelude::*;

use super::repeats::Average;
use super::{ImageError, ImageFile, LinearOptions};

/// A flat field below this fraction of its mean is as good as unlit.
const FLAT_DARK: f32 = 0.02;
/// A flat field with a larger share of bad pixels corrects nothing.
const FLAT_BAD_LIMIT: f64 = 0.5;

/// What is taken out of every photo of a set.
#[derive(Clone, Copy, Debug, Default)]
pub struct Corrections<'a> {
    /// Subtracted.
    pub dark: Option<&'a DarkFrame>,
    /// Divided by.
    pub flat: Option<&'a FlatField>,
}

/// What the sensor shows without light, black level subtracted; taken at the exposure of the photos it corrects.
#[derive(Clone, Debug, PartialEq)]
pub struct DarkFrame {
    level: Plane,
    /// Pixels that clip without light.
    marks: Marks,
    /// Standard deviation of one frame's noise, as a fraction of the range from black to white; `None` from one frame.
    pub noise_floor: Option<f32>,
}

/// How light falls off over the picture, by its mean; taken with an evenly bright target.
#[derive(Clone, Debug, PartialEq)]
pub struct FlatField {
    /// The mean of the flat field over its value; 0 where it is bad.
    inverse: Plane,
    /// Where the flat field is clipped or dark, and photos are so too.
    marks: Marks,
}

/// Averages dark frames. `options` are those of the photos; the exposure is not divided by.
///
/// # Errors
/// As [`linearise()`](super::linearise()).
pub fn dark_frame<I: Borrow<ImageFile>>(
    images: impl IntoIterator<Item = Result<I, ImageError>>,
    options: &LinearOptions,
) -> Result<DarkFrame, ImageError> {
    options.check()?;
    let average = Average::of(images, options)?;
    let noise_floor = average.noise().map(|noise| {
        let pixels: usize = noise.bins.iter().map(|bin| bin.pixels).sum();
        let variance: f64 = noise.bins.iter().map(|bin| bin.variance * bin.pixels as f64).sum();
        (variance / pixels.max(1) as f64).sqrt() as f32
    });
    Ok(DarkFrame { level: average.mean, marks: average.marks, noise_floor })
}

/// Averages flat fields and divides by their mean over the good pixels.
///
/// # Errors
/// As [`linearise()`](super::linearise()), and [`ImageError::UnusableFlat`].
pub fn flat_field<I: Borrow<ImageFile>>(
    images: impl IntoIterator<Item = Result<I, ImageError>>,
    options: &LinearOptions,
    dark: Option<&DarkFrame>,
) -> Result<FlatField, ImageError> {
    options.check()?;
    let mut average = Average::of(images, options)?;
    Corrections { dark, flat: None }.check_size(&average)?;
    if let Some(dark) = dark {
        dark.subtract_from(&mut average);
    }
    let Average { mean: mut inverse, mut marks, first, .. } = average;
    let lit = inverse.data().par_iter().zip(marks.data()).filter(|&(_, &mark)| mark & CLIPPED == 0);
    let (sum, pixels) = lit
        .map(|(&value, _)| (f64::from(value), 1_usize))
        .reduce(|| (0.0, 0), |left, right| (left.0 + right.0, left.1 + right.1));
    let mean = (sum / pixels.max(1) as f64) as f32;
    let dark_below = (FLAT_DARK * mean).max(0.0);
    inverse.data_mut().par_iter_mut().zip(marks.data_mut()).for_each(|(value, mark)| {
        *mark |= if *value <= dark_below { DARK } else { 0 };
        *value = if *mark == 0 { mean / *value } else { 0.0 };
    });
    let bad = marks.count(u8::MAX) as f64 / marks.data().len() as f64;
    if bad > FLAT_BAD_LIMIT {
        return Err(ImageError::UnusableFlat { path: first, percent: 100.0 * bad });
    }
    Ok(FlatField { inverse, marks })
}

impl Corrections<'_> {
    pub(super) fn check_size(&self, average: &Average) -> Result<(), ImageError> {
        let expected =
            [("the dark frame", self.dark.map(|d| &d.level)), ("the flat field", self.flat.map(|f| &f.inverse))];
        for (expected_by, plane) in expected {
            if let Some(plane) = plane.filter(|plane| plane.size() != average.mean.size()) {
                return Err(ImageError::SizeMismatch {
                    path: PathBuf::from(&average.first),
                    size: average.mean.size(),
                    expected_by: expected_by.to_string(),
                    expected: plane.size(),
                });
            }
        }
        Ok(())
    }
}

impl FlatField {
    pub(super) fn divide_row(&self, y: usize, light: &mut [f32], marks: &mut [u8]) {
        let inverse = self.inverse.row(y);
        let bad = self.marks.row(y);
        for ((light, mark), (inverse, bad)) in light.iter_mut().zip(marks).zip(inverse.iter().zip(bad)) {
            *light *= inverse;
            *mark |= bad;
        }
    }
}

impl DarkFrame {
    pub(super) fn subtract_from(&self, average: &mut Average) {
        let light = average.mean.data_mut().par_iter_mut().zip(average.marks.data_mut());
        light.zip(self.level.data()).zip(self.marks.data()).for_each(|(((light, mark), level), hot)| {
            *light -= level;
            *mark |= hot;
        });
    }
}
