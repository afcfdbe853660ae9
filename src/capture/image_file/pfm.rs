//! Portable float maps: "Pf" (grey) or "PF" (red, green, blue), width, height and a scale whose sign is the byte order,
//! then rows of f32, the bottom row first (Debevec, <https://www.pauldebevec.com/Research/HDR/PFM/>).

use std::io::Read;

use firstbounce_core::Plane;

use super::head::{PictureSize, Stated};
use super::read::{Decoded, Source};
use super::samples::{Layout, split};
use super::{Channel, Format, ImageError, StoredRange};

/// Four words, with as much white space as anybody would write between them.
const MAX_HEADER_BYTES: u64 = 4096;

pub(super) fn stated(source: &Source, file: impl Read) -> Result<Stated, ImageError> {
    let mut bytes = Vec::new();
    file.take(MAX_HEADER_BYTES).read_to_end(&mut bytes).map_err(|error| source.damaged(Format::Pfm, error))?;
    Ok(Stated { size: Header::of(source, &bytes)?.size, bounded: true })
}

/// The size of the scale is not applied: readers disagree on its meaning, and the capture file has its own white level.
pub(super) fn read(source: &Source, bytes: &[u8]) -> Result<Decoded, ImageError> {
    let Header { size: PictureSize { width, height, channels: samples_per_pixel }, scale, pixels } =
        Header::of(source, bytes)?;
    let (values, _) = pixels.as_chunks::<4>();
    let decode = if scale < 0.0 { f32::from_le_bytes } else { f32::from_be_bytes };
    let layout = Layout { width, height, colours: samples_per_pixel, samples_per_pixel, planar: false };
    let upside_down =
        split(layout, values, decode).ok_or_else(|| source.damaged(Format::Pfm, "pixels are missing at its end"))?;
    let channels =
        upside_down.into_iter().map(|(name, plane)| (name, flipped(plane))).collect::<Vec<(Channel, Plane)>>();
    Ok(Decoded::of(channels, StoredRange { maximum: None }))
}

fn flipped(mut plane: Plane) -> Plane {
    let (width, height) = plane.size();
    let (upper, lower) = plane.data_mut().split_at_mut(height / 2 * width);
    for (above, below) in upper.chunks_exact_mut(width).zip(lower.chunks_exact_mut(width).rev()) {
        above.swap_with_slice(below);
    }
    plane
}

struct Header<'a> {
    size: PictureSize,
    /// Negative where the low byte is first.
    scale: f32,
    pixels: &'a [u8],
}

impl<'a> Header<'a> {
    fn of(source: &Source, bytes: &'a [u8]) -> Result<Self, ImageError> {
        let damaged = |reason: &str| source.damaged(Format::Pfm, reason);
        let mut words = Words(bytes);
        let channels = if words.next() == Some("PF") { 3 } else { 1 };
        let mut length = || words.next().and_then(|word| word.parse::<usize>().ok());
        let (Some(width), Some(height)) = (length(), length()) else {
            return Err(damaged("the width and height are not numbers"));
        };
        let scale = words.next().and_then(|word| word.parse::<f32>().ok()).filter(|scale| scale.abs() > 0.0);
        let scale = scale.ok_or_else(|| damaged("the scale is not a number other than 0"))?;
        Ok(Self { size: PictureSize { width, height, channels }, scale, pixels: words.0 })
    }
}

/// The words of a header, and what comes after them.
struct Words<'a>(&'a [u8]);

impl<'a> Iterator for Words<'a> {
    type Item = &'a str;

    /// The next word and the one white space after it; that is where the pixels begin after the last word.
    fn next(&mut self) -> Option<&'a str> {
        let start = self.0.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let length = self.0[start..].iter().take(64).position(u8::is_ascii_whitespace)?;
        let word = std::str::from_utf8(&self.0[start..start + length]).ok();
        self.0 = &self.0[start + length + 1..];
        word
    }
}
