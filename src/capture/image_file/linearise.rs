//! Stored values to linear light, with the pixels marked that must not be used.

use std::borrow::Borrow;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use firstbounce_core::capture_checks::{ValueEnd, find_value_end};
use firstbounce_core::image::noise::NoiseModel;
use firstbounce_core::image::photo::{CLIPPED, DARK};
use firstbounce_core::{Photo, Plane};
use rayon::prelude::*;

use super::repeats::Average;
use super::{
    Channel, Corrections, Encoding, ImageError, ImageFile, ImageWarning, Metadata, RepeatNoise, StatedCurve, read_image,
};

/// How many standard deviations of the noise at no light a pixel must rise above to count as lit.
const DARK_SIGMAS: f32 = 3.0;

/// Floats may store light beyond all measure, whose square would be no number.
const MAX_LIGHT: f32 = 1e9;

/// Options of linearisation, named as in a capture file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearOptions {
    /// The channel to take; for grey, the mean of the channels, in linear light.
    pub channel: Channel,
    /// The curve of the stored values; `None` for what each file states, and linear where it states nothing.
    pub encoding: Option<Encoding>,
    /// The stored value at no light.
    pub black_level: f32,
    /// The stored value where the sensor clips; `None` for the file type's maximum, or for floats 1, where nothing clips.
    pub white_level: Option<f32>,
    /// Relative exposure; light is divided by it.
    pub exposure: f32,
    /// Standard deviation of one picture's noise at no light, as a fraction of the range from black to white, when known.
    /// Pixels below three of it (less by the root of the number of repeats) are marked dark. Repeated dark frames, if
    /// given, take its place.
    pub noise_floor: Option<f32>,
    /// Where the noise is not known: pixels below this fraction of the range from black to white are marked dark.
    pub dark_below: f32,
}

impl Default for LinearOptions {
    fn default() -> Self {
        Self {
            channel: Channel::Grey,
            encoding: None,
            black_level: 0.0,
            white_level: None,
            exposure: 1.0,
            noise_floor: None,
            dark_below: 0.002,
        }
    }
}

impl LinearOptions {
    /// Whether each option lies in its range.
    ///
    /// # Errors
    /// [`ImageError::Option`] that names the first that does not.
    pub fn check(&self) -> Result<(), ImageError> {
        let demand = |holds: bool, name: &'static str, value: f32, expected: &'static str| {
            if holds { Ok(()) } else { Err(ImageError::Option { name, value: f64::from(value), expected }) }
        };
        demand(self.black_level.is_finite(), "black_level", self.black_level, "a number")?;
        if let Some(white) = self.white_level {
            demand(white.is_finite() && white > self.black_level, "white_level", white, "more than black_level")?;
        }
        demand(self.exposure.is_finite() && self.exposure > 0.0, "exposure", self.exposure, "a number above 0")?;
        if let Some(Encoding::Gamma(gamma)) = self.encoding {
            demand((0.1..=10.0).contains(&gamma), "gamma", gamma as f32, "0.1 to 10")?;
        }
        if let Some(sigma) = self.noise_floor {
            demand((0.0..1.0).contains(&sigma), "noise_floor", sigma, "0 to 1")?;
        }
        demand((0.0..1.0).contains(&self.dark_below), "dark_below", self.dark_below, "0 to 1")
    }
}

/// A photo in linear light, and what came to light on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearLight {
    /// The average of the repeats, corrected.
    pub photo: Arc<Photo>,
    /// How many files were averaged.
    pub repeats: usize,
    /// The noise by signal, from the differences between the repeats; `None` for one file.
    pub noise: Option<RepeatNoise>,
    /// The noise of a photo that is combined of others, where it is known: of the exposures of a bracket by noise weight, of channels whose
    /// crosstalk was undone; `None` for one exposure as it was taken.
    pub combined_noise: Option<NoiseModel>,
    /// Variance of a pixel over that of one as it was taken: 1, and less where distortion was undone, which mixes neighbours.
    pub variance_share: f64,
    /// Below this fraction of the range from black to white pixels were marked dark.
    pub dark_below: f32,
    /// What the light was divided by.
    pub exposure: f32,
    /// The files that were averaged, and what each says of itself.
    pub files: Vec<(PathBuf, Metadata)>,
    /// From one stored integer to the next in linear light, in the middle of the range; 0 for floats.
    pub quantisation_step: f32,
    /// The warnings of all files.
    pub warnings: Vec<ImageWarning>,
    /// By file, what shows how it was taken.
    pub facts: Vec<FileFacts>,
}

/// What one of the averaged files shows of the way it was taken.
#[derive(Clone, Debug, PartialEq)]
pub struct FileFacts {
    /// The file.
    pub path: PathBuf,
    /// The largest value that its integers hold; `None` for floats.
    pub maximum: Option<f32>,
    /// The stored value from which its pixels count as clipped; `None` where none do.
    pub clips_at: Option<f32>,
    /// Where its values end, in the channels that are looked at.
    pub end: Option<ValueEnd>,
    /// By how much it differs from the mean of the files before it, but for noise: root mean square over that of their light.
    pub change: Option<f64>,
}

/// Reads and averages repeats of one photo; see [`linearise()`].
///
/// # Errors
/// As [`read_image`] and [`linearise()`].
pub fn linearise_files(
    paths: &[impl AsRef<Path>],
    options: &LinearOptions,
    corrections: &Corrections,
) -> Result<LinearLight, ImageError> {
    linearise(paths.iter().map(|path| read_image(path.as_ref())), options, corrections)
}

/// Averages repeats of one photo in linear light:
///
/// light = ((decode(stored) - decode(black)) / (decode(white) - decode(black)) - dark) / flat / exposure
///
/// for each file, where decode undoes the encoding on stored / full scale. Full scale is what the numbers were made for:
/// 1, or the power of two less one at or above the white level (255 for a camera that clips at 250, 1023 for ten bits in
/// a 16-bit file). A pixel that reaches the white level in any channel taken of any repeat is marked clipped, one whose
/// average is within the noise of the dark is marked dark, and the marks of the corrections are added.
///
/// # Errors
/// [`ImageError::NoFiles`], [`ImageError::Option`], [`ImageError::NoChannel`], [`ImageError::SizeMismatch`], and the
/// errors of `images` themselves.
pub fn linearise<I: Borrow<ImageFile>>(
    images: impl IntoIterator<Item = Result<I, ImageError>>,
    options: &LinearOptions,
    corrections: &Corrections,
) -> Result<LinearLight, ImageError> {
    options.check()?;
    let mut average = Average::of(images, options)?;
    corrections.check_size(&average)?;
    if let Some(dark) = corrections.dark {
        dark.subtract_from(&mut average);
    }
    let noise = average.noise();
    let dark_below = dark_threshold(options, corrections, average.repeats);
    let width = average.mean.width();
    average
        .mean
        .data_mut()
        .par_chunks_mut(width)
        .zip(average.marks.data_mut().par_chunks_mut(width))
        .enumerate()
        .for_each(|(y, (light, marks))| {
            for (light, mark) in light.iter_mut().zip(marks.iter_mut()) {
                *mark |= if *light < dark_below { DARK } else { 0 };
                *light /= options.exposure;
            }
            if let Some(flat) = corrections.flat {
                flat.divide_row(y, light, marks);
            }
        });
    let photo = Arc::new(Photo { linear: average.mean, marks: average.marks });
    let quantisation_step = average.step / options.exposure;
    Ok(LinearLight {
        photo,
        repeats: average.repeats,
        noise,
        combined_noise: None,
        variance_share: 1.0,
        dark_below,
        exposure: options.exposure,
        files: average.files,
        quantisation_step,
        warnings: average.warnings,
        facts: average.facts,
    })
}

fn dark_threshold(options: &LinearOptions, corrections: &Corrections, repeats: usize) -> f32 {
    let sigma = corrections.dark.and_then(|dark| dark.noise_floor).or(options.noise_floor);
    sigma.map_or(options.dark_below, |sigma| DARK_SIGMAS * sigma / (repeats as f32).sqrt())
}

/// What the user should know of a file, by what is stated of it elsewhere.
pub(super) fn warnings_of(image: &ImageFile, stated: Option<Encoding>) -> Vec<ImageWarning> {
    // Where the capture file states the encoding, none needs to be guessed.
    let asks = |warning: &&ImageWarning| !(stated.is_some() && matches!(warning, ImageWarning::ProbablySrgb { .. }));
    let path = image.path.clone();
    let of_curve = match (&image.metadata.curve, stated) {
        (StatedCurve::Known(curve), Some(believed)) if !curve.is_near(believed) => {
            Some(ImageWarning::CurveContradicted { path, curve: *curve, believed })
        }
        (StatedCurve::Known(curve), None) if *curve != Encoding::Linear => {
            Some(ImageWarning::CurveUndone { path, curve: *curve })
        }
        (StatedCurve::Unknown(curve), None) => Some(ImageWarning::CurveUnknown { path, curve: curve.clone() }),
        _ => None,
    };
    image.warnings.iter().filter(asks).cloned().chain(of_curve).collect()
}

/// From stored values of one file to fractions of the range from black to white.
pub(super) struct Scale<'a> {
    planes: Vec<&'a Plane>,
    encoding: Encoding,
    full_scale: f32,
    black: f32,
    /// What a decoded step counts in the mean over the planes.
    share: f32,
    clips_at: f32,
}

impl<'a> Scale<'a> {
    pub fn new(options: &LinearOptions, image: &'a ImageFile) -> Result<Self, ImageError> {
        let clips = options.white_level.or(image.stored.maximum);
        let white_level = clips.unwrap_or(1.0);
        LinearOptions { white_level: Some(white_level), ..*options }.check()?;
        let planes = image.pick(options.channel)?;
        let full_scale = full_scale(white_level);
        let encoding = options.encoding.or(image.metadata.curve.known()).unwrap_or_default();
        let decode = |stored: f32| encoding.decode(stored / full_scale);
        let black = decode(options.black_level);
        let share = 1.0 / (planes.len() as f32 * (decode(white_level) - black));
        if !(black.is_finite() && share.is_normal()) {
            let (path, black) = (image.path.clone(), options.black_level);
            return Err(ImageError::Levels { path, black, white: white_level });
        }
        let clips_at = clips.unwrap_or(f32::INFINITY);
        Ok(Self { planes, encoding, full_scale, black, share, clips_at })
    }

    /// What `image` shows of the way it was taken.
    pub fn facts(&self, image: &ImageFile) -> FileFacts {
        let maximum = image.stored.maximum;
        let ends = self.planes.iter().filter_map(|plane| find_value_end(plane, maximum.is_some()));
        FileFacts {
            path: image.path.clone(),
            maximum,
            clips_at: Some(self.clips_at).filter(|value| value.is_finite()),
            end: ends.max_by(|a, b| a.share.total_cmp(&b.share)),
            change: None,
        }
    }

    /// From one stored integer to the next, in the middle of the range.
    pub fn step(&self) -> f32 {
        let middle = (self.full_scale / 2.0).floor();
        let decode = |stored: f32| self.encoding.decode(stored / self.full_scale);
        (decode(middle + 1.0) - decode(middle)) * self.share * self.planes.len() as f32
    }

    /// Sets `light` to row `y`, the mean over the planes, and marks what is clipped in any of them.
    pub fn row(&self, y: usize, light: &mut [f32], marks: &mut [u8]) {
        light.fill(0.0);
        for plane in &self.planes {
            match self.encoding {
                // Apart, so that the compiler sees a loop without a branch.
                Encoding::Linear => self.add_row(plane.row(y), light, marks, |stored| stored),
                encoding => self.add_row(plane.row(y), light, marks, |stored| encoding.decode(stored)),
            }
        }
        light.iter_mut().for_each(|light| *light = light.clamp(-MAX_LIGHT, MAX_LIGHT));
    }

    fn add_row(&self, stored: &[f32], light: &mut [f32], marks: &mut [u8], decode: impl Fn(f32) -> f32) {
        for ((light, mark), &stored) in light.iter_mut().zip(marks).zip(stored) {
            // What is no number, or endlessly far below black, is taken for black.
            if stored.is_nan() || stored == f32::NEG_INFINITY {
                *mark |= DARK;
                continue;
            }
            *mark |= if stored >= self.clips_at { CLIPPED } else { 0 };
            // Endlessly far above white is white: it must not outshine the photo where its mark is not looked at.
            let stored = if stored == f32::INFINITY { self.full_scale } else { stored };
            *light += (decode(stored / self.full_scale) - self.black) * self.share;
        }
    }
}

/// The largest value of the numbers that hold `white_level`: 1, 255, 1023, 4095, 65535, ...
fn full_scale(white_level: f32) -> f32 {
    if white_level <= 1.0 { 1.0 } else { ((white_level + 1.0).log2().ceil().exp2() - 1.0).max(white_level) }
}
