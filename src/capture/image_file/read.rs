//! Reading a picture: what it is, whether it can be true, and which decoder takes it.

use std::fmt::Display;
use std::io::{Read, Seek};
use std::path::Path;

use firstbounce_core::Plane;
use rayon::prelude::*;

use super::head::{Opened, PictureSize};
use super::raw::is_camera_raw;
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

/// As many bytes say what a file is.
const FIRST_BYTES: u64 = 16;

/// Pictures that are known and not read: name, and which bytes stand where.
const OTHER_FORMATS: [(&str, usize, &[u8]); 10] = [
    ("HEIC picture", 4, b"ftyphei"),
    ("HEIC picture", 4, b"ftyphev"),
    ("HEIF picture", 4, b"ftypmif1"),
    ("AVIF picture", 4, b"ftypavif"),
    ("Photoshop document", 0, b"8BPS"),
    ("GIMP document", 0, b"gimp xcf"),
    ("JPEG 2000 picture", 4, b"jP  "),
    ("JPEG XL picture", 4, b"JXL "),
    ("WebP picture", 8, b"WEBP"),
    ("GIF picture", 0, b"GIF8"),
];

/// What the values mean, and so which of them cannot be true.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Content {
    /// Light: NaN, infinite and negative values are worth a warning, and so are 8 bits.
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
    let metadata = opened.metadata()?;
    let format = opened.format;
    let decoded = decode(&mut opened, options.layer.as_deref())?;
    let mut warnings = warnings(path, format, &decoded, &metadata, options.content);
    if decoded.stored.maximum.is_none()
        && let Some(bad) = BadValues::in_planes(decoded.channels.iter().map(|(_, plane)| plane), options.content)
    {
        match options.content {
            Content::Photo => warnings.push(bad.warning(path)),
            Content::Data => return Err(bad.error(path)),
        }
    }
    Ok(ImageFile {
        path: path.to_path_buf(),
        format,
        warnings,
        metadata,
        channels: decoded.channels,
        stored: decoded.stored,
    })
}

/// Decodes an opened file, in a process of its own where nothing else bounds its decoder.
pub(super) fn decode(opened: &mut Opened, layer: Option<&str>) -> Result<Decoded, ImageError> {
    let (source, format) = (opened.source, opened.format);
    if let (Format::Raw, Some(program)) = (format, subprocess::program()) {
        // Its size comes with its pixels.
        return subprocess::decode(program, opened, source.largest_raw(), layer);
    }
    let stated = opened.stated()?;
    match subprocess::program() {
        Some(program) if !stated.bounded => subprocess::decode(program, opened, stated.size, layer),
        _ => format.read(&source, &opened.bytes()?, layer),
    }
}

/// What a decoder makes of a file.
pub(super) struct Decoded {
    pub channels: Vec<(Channel, Plane)>,
    /// Opacity, on the scale of the channels; `None` where the file has none, or its decoder gives none.
    pub alpha: Option<Plane>,
    /// Of a file with a colour map, which has made the channels.
    pub palette: Option<Palette>,
    pub stored: StoredRange,
}

/// Indices, and the red, green and blue of each from 0 to 255.
pub(super) struct Palette {
    pub index: Plane,
    pub map: Vec<[f32; 3]>,
}

impl Decoded {
    /// Without alpha or a colour map.
    pub fn of(channels: Vec<(Channel, Plane)>, stored: StoredRange) -> Self {
        Self { channels, alpha: None, palette: None, stored }
    }

    /// By a colour map; an index beyond it is black.
    pub fn of_palette(index: Plane, map: Vec<[f32; 3]>) -> Self {
        let plane = |colour: usize| {
            let mut plane = index.clone();
            let level = |index: f32| map.get(index as usize).map_or(0.0, |rgb| rgb[colour]);
            plane.data_mut().par_iter_mut().for_each(|value| *value = level(*value));
            plane
        };
        let channels = vec![(Channel::R, plane(0)), (Channel::G, plane(1)), (Channel::B, plane(2))];
        Self { palette: Some(Palette { index, map }), ..Self::of(channels, StoredRange { maximum: Some(255.0) }) }
    }
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

    /// More pixels than a raw file of this length can hold: cameras compress to about half a byte a site.
    pub fn largest_raw(&self) -> PictureSize {
        PictureSize { width: 2 * self.length.min(PIXEL_LIMIT), height: 1, channels: 3 }
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

    /// The format by the first bytes, and of a TIFF by its first directory.
    pub fn format(&self, mut file: impl Read + Seek) -> Result<Format, ImageError> {
        let path = self.path.to_path_buf();
        let mut first = Vec::new();
        file.by_ref().take(FIRST_BYTES).read_to_end(&mut first).map_err(|error| self.unreadable(error))?;
        if first.is_empty() {
            return Err(ImageError::Empty { path });
        }
        let format = Format::of_content(&first).ok_or_else(|| match other_format(&first) {
            Some(name) => ImageError::OtherFormat { path, name },
            None => {
                let first = first.iter().take(3).map(|byte| format!("{byte:02x}")).collect::<Vec<_>>();
                ImageError::NotAnImage { path, first_bytes: first.join(" ") }
            }
        })?;
        file.rewind().map_err(|error| self.unreadable(error))?;
        Ok(if format == Format::Tiff && is_camera_raw(file) { Format::Raw } else { format })
    }

    /// What is left of a head.
    pub fn rest_of(&self, mut head: impl Read) -> Result<Vec<u8>, ImageError> {
        let mut bytes = Vec::new();
        head.read_to_end(&mut bytes).map_err(|error| self.unreadable(error))?;
        Ok(bytes)
    }

    /// Decoders meet bytes that were never meant for them, and hold an `expect` or an index here and there: should one panic,
    /// the file is damaged and the work goes on.
    pub fn guarded<T>(&self, format: Format, decode: impl FnOnce() -> Result<T, ImageError>) -> Result<T, ImageError> {
        guarded(decode).unwrap_or_else(|Panicked| Err(self.damaged(format, "the decoder gave up")))
    }
}

/// The name of a kind of picture that is known and not read.
fn other_format(first: &[u8]) -> Option<&'static str> {
    OTHER_FORMATS
        .into_iter()
        .find(|(_, at, mark)| first.get(*at..).is_some_and(|rest| rest.starts_with(mark)))
        .map(|it| it.0)
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

/// Values of a float file that cannot be what they should be.
struct BadValues {
    count: usize,
    /// Column and row of the first, and what it is.
    first: (usize, usize),
    kind: &'static str,
}

impl BadValues {
    fn in_planes<'a>(planes: impl Iterator<Item = &'a Plane>, content: Content) -> Option<Self> {
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
        let (position, plane) = first?;
        let kind = match plane.data()[position] {
            value if value.is_nan() => "NaN",
            value if value.is_infinite() => "infinite",
            _ => "negative",
        };
        Some(Self { count: found, first: (position % plane.width(), position / plane.width()), kind })
    }

    fn error(&self, path: &Path) -> ImageError {
        let (x, y) = self.first;
        ImageError::BadPixels { path: path.to_path_buf(), kind: self.kind, count: self.count, x, y }
    }

    fn warning(&self, path: &Path) -> ImageWarning {
        let (x, y) = self.first;
        ImageWarning::BadValues { path: path.to_path_buf(), kind: self.kind, count: self.count, x, y }
    }
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
