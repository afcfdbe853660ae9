//! Masks: which pixels are the object, from what picture editors make of a painted one.

use std::path::Path;

use firstbounce_core::{Mask, Plane};
use rayon::prelude::*;

use super::head::Opened;
use super::raster::png_palette;
use super::read::{Decoded, Palette, decode};
use super::{Format, ImageError, ImageWarning};

/// A mask as it was read.
#[derive(Clone, Debug, PartialEq)]
pub struct MaskFile {
    /// The object.
    pub mask: Mask,
    /// Reasons to look at it again.
    pub warnings: Vec<ImageWarning>,
}

/// Reads a mask. Of a picture with a colour map every index but the background's is inside: that of the only black entry,
/// else 0. Else what is nearer to the largest value than to the smallest is inside, in the alpha channel where that
/// varies, else in the brightest channel of each pixel.
///
/// # Errors
/// As [`read_image`](super::read_image).
pub fn read_mask(path: &Path) -> Result<MaskFile, ImageError> {
    let mut opened = Opened::open(path)?;
    let decoded = decode(&mut opened, None)?;
    let palette = match opened.format {
        Format::Png => png_palette(&opened.bytes()?),
        _ => None,
    };
    let mut warnings = Vec::new();
    let values = match palette.as_ref().or(decoded.palette.as_ref()) {
        Some(palette) => by_index(palette),
        None => values_of(decoded),
    };
    let (low, high) = range(&values);
    let middle = 0.5 * (low + high);
    let between = values.data().par_iter().filter(|&&value| value != low && value != high).count();
    if between > 0 {
        let between = between as f64 / values.data().len() as f64;
        warnings.push(ImageWarning::MaskManyValues { path: path.to_path_buf(), between });
    }
    let is_inside = |value: f32| if low == high { value > 0.0 } else { value > middle };
    let (width, height) = values.size();
    let mask = Mask::from_vec(width, height, values.data().par_iter().map(|&value| is_inside(value)).collect());
    let mask = mask.ok_or_else(|| ImageError::UnequalPlanes { what: path.display().to_string() })?;
    if mask.count() == width * height {
        warnings.push(ImageWarning::MaskWhole { path: path.to_path_buf() });
    }
    Ok(MaskFile { mask, warnings })
}

/// 1 for all indices but the background's, which is 0.
fn by_index(Palette { index, map }: &Palette) -> Plane {
    let mut black = map.iter().enumerate().filter(|(_, colour)| **colour == [0.0; 3]).map(|(index, _)| index);
    let background = black.next().filter(|_| black.next().is_none()).unwrap_or(0) as f32;
    let mut inside = index.clone();
    inside.data_mut().par_iter_mut().for_each(|index| *index = f32::from(*index != background));
    inside
}

/// The alpha channel where it varies, else the largest of the channels. What is no number is 0.
fn values_of(decoded: Decoded) -> Plane {
    let varies = |alpha: &Plane| {
        let (low, high) = range(alpha);
        low < high
    };
    if let Some(alpha) = decoded.alpha.filter(varies) {
        return alpha;
    }
    let mut channels = decoded.channels.into_iter().map(|(_, plane)| plane);
    let mut brightest = channels.next().unwrap_or_default();
    for plane in channels {
        let pixels = brightest.data_mut().par_iter_mut().zip(plane.data());
        pixels.for_each(|(brightest, value)| *brightest = brightest.max(*value));
    }
    brightest.data_mut().par_iter_mut().filter(|value| !value.is_finite()).for_each(|value| *value = 0.0);
    brightest
}

fn range(plane: &Plane) -> (f32, f32) {
    let values = plane.data().par_iter().copied();
    values.map(|value| (value, value)).reduce(
        || (f32::INFINITY, f32::NEG_INFINITY),
        |(low, high), (other_low, other_high)| (low.min(other_low), high.max(other_high)),
    )
}
