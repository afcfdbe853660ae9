//! Reading a picture: what it is, whether it can be true, and which decoder takes it.

use std::fmt::Display;
use std::path::Path;

use firstbounce_core::{Mask, Plane};
use rayon::prelude::*;

use super::head::{Opened, PictureSize};
use super::{Channel, Format, ImageError, ImageFile, ImageWarning, Metadata, StatedCurve, StoredRange, subprocess};
use crate::guard::{Panicked, guarded};

/// The most pixels of a picture: twice the largest camera sensor of today.
const PIXEL_LIMIT: usize = 300_000_000;
/// The most bytes that a decoder may take for one picture, and that a file may be long.
pub(super) const BYTE_LIMIT: usize = 16 * PIXEL_LIMIT;
/// The best that a decoder's compression does: deflate (1032 : 1) on samples of one bit.
const SAMPLES_PER_BYTE: usize = 8 * 1032;
/// A claim of as many pixels needs no proof.
const HARMLESS_PIXELS: usize = 4_000_000;

/// The longest that the words of a decoder are told.
const MAX_REASON_CHARS: usize = 300;

/// What the values mean, and so which of them cannot be true.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Content {
    /// Light: NaN, infinite and negative values are refused, 8 bits are worth a warning.
    #[default]
    Photo,
    /// Numbers such as normals or depths: NaN and infinite values are refused.
    Data,
}

/// How to read a picture.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// What the values mean.
    pub content: Content,
    /// The layer of a layered EXR; `None` for a file with one. Other formats have no layers and ignore it.
    pub layer: Option<String>,
}

/// Reads a photo: the values as they are stored.
///
/// # Errors
/// An [`ImageError`] that names the file: missing, empty, not an image, damaged, too large, or with values no light has.
pub fn read_image(path: &Path) -> Result<ImageFile, ImageError> {
    read_image_as(path, &ReadOptions::default())
}

/// Reads a picture of any content, or one layer of a layered EXR.
///
/// # Errors
/// As [`read_image`], and [`ImageError::NoLayer`].
pub fn read_image_as(path: &Path, options: &ReadOptions) -> Result<ImageFile, ImageError> {
    let mut opened = Opened::open(path)?;
    let (source, format) = (opened.source, opened.format);
    let stated = opened.stated()?;
    let metadata = opened.metadata()?;
    let layer = options.layer.as_deref();
    let decoded = match subprocess::program() {
        Some(program) if !stated.bounded => subprocess::decode(program, &mut opened, stated.size, layer)?,
        _ => format.read(&source, &opened.bytes()?, layer)?,
    };
    let planes = decoded.channels.iter().map(|(_, plane)| plane);
    if decoded.stored.maximum.is_none() {
        refuse_bad_pixels(path, planes, options.content)?;
    }
    Ok(ImageFile {
        path: path.to_path_buf(),
        format,
        warnings: warnings(path, format, &decoded, &metadata, options.content),
        metadata,
        channels: decoded.channels,
        stored: decoded.stored,
    })
}

/// Reads a mask: non-zero in any channel is inside.
///
/// # Errors
/// As [`read_image`].
pub fn read_mask(path: &Path) -> Result<Mask, ImageError> {
    let image = read_image_as(path, &ReadOptions { content: Content::Data, layer: None })?;
    let (width, height) = image.size();
    let planes = image.pick(Channel::Grey)?;
    let inside = (0..width * height).into_par_iter().map(|i| planes.iter().any(|p| p.data()[i] != 0.0)).collect();
    Mask::from_vec(width, height, inside).ok_or(ImageError::UnequalPlanes { what: path.display().to_string() })
}

/// What a decoder makes of a file.
pub(super) struct Decoded {
    pub channels: Vec<(Channel, Plane)>,
    pub stored: StoredRange,
}

/// The file that is being read.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub path: &'a Path,
    /// Its bytes.
    pub length: usize,
}

impl Source<'_> {
    pub fn damaged(&self, format: Format, reason: impl Display) -> ImageError {
        ImageError::Damaged { path: self.path.to_path_buf(), format, reason: one_line(reason) }
    }

    pub fn unsupported(&self, format: Format, what: impl Display) -> ImageError {
        ImageError::Unsupported { path: self.path.to_path_buf(), format, what: one_line(what) }
    }

    pub fn unreadable(&self, reason: impl Display) -> ImageError {
        ImageError::Unreadable { path: self.path.to_path_buf(), reason: one_line(reason) }
    }

    pub fn too_large(&self, width: usize, height: usize) -> ImageError {
        ImageError::TooLarge { path: self.path.to_path_buf(), width, height, bytes: self.length }
    }

    /// Refuses, before anything is allocated, what cannot be a picture: no pixels, or more than the file can hold.
    pub fn check_size(&self, PictureSize { width, height, channels }: PictureSize) -> Result<(), ImageError> {
        let plausible = self.length.saturating_mul(SAMPLES_PER_BYTE);
        let pixels = width.saturating_mul(height);
        let samples = pixels.saturating_mul(channels);
        if pixels > plausible.clamp(HARMLESS_PIXELS, PIXEL_LIMIT)
            || samples > plausible.clamp(4 * HARMLESS_PIXELS, BYTE_LIMIT / 4)
        {
            return Err(self.too_large(width, height));
        }
        if samples == 0 {
            return Err(ImageError::Empty { path: self.path.to_path_buf() });
        }
        Ok(())
    }

    /// The format by the first bytes.
    pub fn format(&self, first: &[u8]) -> Result<Format, ImageError> {
        let path = self.path.to_path_buf();
        if first.is_empty() {
            return Err(ImageError::Empty { path });
        }
        Format::of_content(first).ok_or_else(|| {
            let first = first.iter().take(3).map(|byte| format!("{byte:02x}")).collect::<Vec<_>>();
            ImageError::NotAnImage { path, first_bytes: first.join(" ") }
        })
    }

    /// Decoders meet bytes that were never meant for them, and hold an `expect` or an index here and there: should one panic,
    /// the file is damaged and the work goes on.
    pub fn guarded<T>(&self, format: Format, decode: impl FnOnce() -> Result<T, ImageError>) -> Result<T, ImageError> {
        guarded(decode).unwrap_or_else(|Panicked| Err(self.damaged(format, "the decoder gave up")))
    }
}

/// What a decoder says may quote the file, at any length.
pub(super) fn one_line(text: impl Display) -> String {
    let text = text.to_string().replace(char::is_control, " ");
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    match line.char_indices().nth(MAX_REASON_CHARS) {
        Some((end, _)) => format!("{} ...", &line[..end]),
        None => line,
    }
}

fn warnings(
    path: &Path,
    format: Format,
    decoded: &Decoded,
    metadata: &Metadata,
    content: Content,
) -> Vec<ImageWarning> {
    let path = path.to_path_buf();
    let mut warnings = Vec::new();
    if Format::of_name(&path) != Some(format) {
        warnings.push(ImageWarning::WrongExtension { path: path.clone(), format });
    }
    if content == Content::Photo && decoded.stored.maximum.is_some_and(|maximum| maximum <= 255.0) {
        warnings.push(ImageWarning::EightBit { path: path.clone() });
    }
    if content == Content::Photo && format.usually_srgb() && metadata.curve == StatedCurve::Unstated {
        warnings.push(ImageWarning::ProbablySrgb { path });
    }
    warnings
}

fn refuse_bad_pixels<'a>(
    path: &Path,
    planes: impl Iterator<Item = &'a Plane>,
    content: Content,
) -> Result<(), ImageError> {
    let bad = |value: f32| !value.is_finite() || (content == Content::Photo && value < 0.0);
    let mut found = 0;
    let mut first = None;
    for plane in planes {
        let count = plane.data().par_iter().filter(|&&value| bad(value)).count();
        if count > 0 {
            let position = plane.data().iter().position(|&value| bad(value)).unwrap_or_default();
            let earlier = first.is_none_or(|(at, _)| position < at);
            first = if earlier { Some((position, plane)) } else { first };
        }
        found += count;
    }
    let Some((position, plane)) = first else { return Ok(()) };
    let kind = match plane.data()[position] {
        value if value.is_nan() => "NaN",
        value if value.is_infinite() => "infinite",
        _ => "negative",
    };
    let (x, y) = (position % plane.width(), position / plane.width());
    Err(ImageError::BadPixels { path: path.to_path_buf(), kind, count: found, x, y })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decoder_that_panics_is_a_damaged_file() {
        let source = Source { path: Path::new("left.exr"), length: 0 };
        let result = source.guarded::<()>(Format::Exr, || panic!("a decoder's own bug"));
        assert!(matches!(result, Err(ImageError::Damaged { format: Format::Exr, .. })));
    }
}
