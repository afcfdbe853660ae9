//! The average of repeats of one picture, and the noise that their differences show.

use std::borrow::Borrow;
use std::path::PathBuf;

use firstbounce_core::image::photo::CLIPPED;
use firstbounce_core::{Marks, Plane};
use rayon::prelude::*;

use super::linearise::{FileFacts, Scale, warnings_of};
use super::{ImageError, ImageFile, ImageWarning, LinearOptions, Metadata};

/// How many bins of signal the variance is averaged in.
const BINS: usize = 64;

/// How the noise of one picture grows with its signal, from the differences between repeats.
///
/// Signal is a fraction of the range from black to white, dark frame subtracted, before the division by flat field and
/// exposure: there one camera has one noise law, read noise and photon noise, for all its pictures.
#[derive(Clone, Debug, PartialEq)]
pub struct RepeatNoise {
    /// Bins of rising signal, those without pixels left out.
    pub bins: Vec<NoiseBin>,
}

/// Pixels of about the same signal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NoiseBin {
    /// Their mean signal.
    pub signal: f64,
    /// The mean of their variances: the variance of one repeat, unbiased. That of the average is smaller by the number
    /// of repeats.
    pub variance: f64,
    /// How many pixels, none of them clipped.
    pub pixels: usize,
}

/// The running average of repeats, in fractions of the range from black to white.
pub(super) struct Average {
    pub mean: Plane,
    /// Sum of squared deviations from the mean; `None` before the second repeat.
    spread: Option<Vec<f32>>,
    pub marks: Marks,
    pub repeats: usize,
    /// From one stored integer to the next, in the middle of the range; 0 for floats.
    pub step: f32,
    pub first: PathBuf,
    /// The files, and what each says of itself.
    pub files: Vec<(PathBuf, Metadata)>,
    pub warnings: Vec<ImageWarning>,
    pub facts: Vec<FileFacts>,
}

/// Noise of pixels so far apart is independent, also where a camera made three colours of each pixel.
const NOISE_REACH_PX: usize = 4;

impl Average {
    /// Averages all `images`, which are read one after the other so that one at a time is in memory.
    pub fn of<I: Borrow<ImageFile>>(
        images: impl IntoIterator<Item = Result<I, ImageError>>,
        options: &LinearOptions,
    ) -> Result<Self, ImageError> {
        let mut images = images.into_iter();
        let first = images.next().ok_or(ImageError::NoFiles)??;
        let mut average = Self::start(first.borrow(), options)?;
        drop(first);
        for image in images {
            average.add(image?.borrow(), options)?;
        }
        Ok(average)
    }

    fn start(image: &ImageFile, options: &LinearOptions) -> Result<Self, ImageError> {
        let scale = Scale::new(options, image)?;
        let (width, height) = image.size();
        let mut mean = Plane::filled(width, height, 0.0);
        let mut marks = Marks::filled(width, height, 0);
        let rows = mean.data_mut().par_chunks_mut(width).zip(marks.data_mut().par_chunks_mut(width));
        rows.enumerate().for_each(|(y, (mean, marks))| scale.row(y, mean, marks));
        let first = image.path.clone();
        let files = vec![(first.clone(), image.metadata.clone())];
        let warnings = warnings_of(image, options.encoding);
        let step = if image.stored.maximum.is_some() { scale.step() } else { 0.0 };
        let facts = vec![scale.facts(image)];
        Ok(Self { mean, spread: None, marks, repeats: 1, step, first, files, warnings, facts })
    }

    /// Welford's update: stable in f32, in one pass.
    fn add(&mut self, image: &ImageFile, options: &LinearOptions) -> Result<(), ImageError> {
        let scale = Scale::new(options, image)?;
        check_same_size(image, &self.mean, &self.first.display().to_string())?;
        self.repeats += 1;
        let share = 1.0 / self.repeats as f32;
        let width = self.mean.width();
        let spread = self.spread.get_or_insert_with(|| vec![0.0; self.marks.data().len()]);
        let rows = self.mean.data_mut().par_chunks_mut(width);
        let change = rows
            .zip(spread.par_chunks_mut(width))
            .zip(self.marks.data_mut().par_chunks_mut(width))
            .enumerate()
            .map_init(
                || vec![0.0; width],
                |light, (y, ((means, spreads), marks))| {
                    scale.row(y, light, marks);
                    let change = Change::of_row(means, light);
                    for ((mean, spread), &light) in means.iter_mut().zip(spreads).zip(light.iter()) {
                        let change = light - *mean;
                        *mean += change * share;
                        *spread += change * (light - *mean);
                    }
                    change
                },
            )
            .reduce(Change::default, Change::join);
        self.facts.push(FileFacts { change: Some(change.relative()), ..scale.facts(image) });
        self.files.push((image.path.clone(), image.metadata.clone()));
        self.warnings.extend(warnings_of(image, options.encoding));
        Ok(())
    }

    /// The noise by signal; `None` for a single picture.
    pub fn noise(&self) -> Option<RepeatNoise> {
        let spread = self.spread.as_ref()?;
        let width = self.mean.width();
        let means = self.mean.data().par_chunks(width);
        let sums = means
            .zip(spread.par_chunks(width))
            .zip(self.marks.data().par_chunks(width))
            .fold(
                || [NoiseBin::default(); BINS],
                |mut bins, ((means, spreads), marks)| {
                    for ((&mean, &spread), &mark) in means.iter().zip(spreads).zip(marks) {
                        if mark & CLIPPED == 0 {
                            // A cast from float clamps: noise below black falls in the first bin.
                            let bin = &mut bins[((mean * BINS as f32) as usize).min(BINS - 1)];
                            bin.signal += f64::from(mean);
                            bin.variance += f64::from(spread);
                            bin.pixels += 1;
                        }
                    }
                    bins
                },
            )
            .reduce(|| [NoiseBin::default(); BINS], added);
        let degrees_of_freedom = (self.repeats - 1) as f64;
        let bins = sums.into_iter().filter(|bin| bin.pixels > 0).map(|sum| NoiseBin {
            signal: sum.signal / sum.pixels as f64,
            variance: sum.variance / sum.pixels as f64 / degrees_of_freedom,
            pixels: sum.pixels,
        });
        Some(RepeatNoise { bins: bins.collect() })
    }
}

/// By how much a repeat differs from those before it: products of differences so far apart that noise takes no part in them.
#[derive(Clone, Copy, Default)]
struct Change {
    differences: f64,
    light: f64,
}

impl Change {
    fn of_row(means: &[f32], light: &[f32]) -> Self {
        let difference = |x: usize| f64::from(light[x] - means[x]);
        let apart = 0..means.len().saturating_sub(NOISE_REACH_PX);
        Self {
            differences: apart.clone().map(|x| difference(x) * difference(x + NOISE_REACH_PX)).sum(),
            light: apart.map(|x| f64::from(means[x]).powi(2)).sum(),
        }
    }

    fn join(self, other: Self) -> Self {
        Self { differences: self.differences + other.differences, light: self.light + other.light }
    }

    /// Root mean square difference over that of the light.
    fn relative(self) -> f64 {
        (self.differences.max(0.0) / self.light.max(f64::MIN_POSITIVE)).sqrt()
    }
}

fn added(mut left: [NoiseBin; BINS], right: [NoiseBin; BINS]) -> [NoiseBin; BINS] {
    for (left, right) in left.iter_mut().zip(right) {
        left.signal += right.signal;
        left.variance += right.variance;
        left.pixels += right.pixels;
    }
    left
}

fn check_same_size(image: &ImageFile, expected: &Plane, expected_by: &str) -> Result<(), ImageError> {
    if image.size() == expected.size() {
        return Ok(());
    }
    Err(ImageError::SizeMismatch {
        path: image.path.clone(),
        size: image.size(),
        expected_by: expected_by.to_string(),
        expected: expected.size(),
    })
}
