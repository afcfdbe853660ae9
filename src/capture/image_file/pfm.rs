//! Portable float maps: "Pf" (grey) or "PF" (red, green, blue), width, height and a scale whose sign is the byte order,
//! then rows of f32, the bottom row first (Debevec, <https://www.pauldebevec.com/Research/HDR/PFM/>).

use firstbounce_core::Plane;

use super::read::{Decoded, Source};
use super::samples::{Layout, split};
use super::{Channel, Format, ImageError, StoredRange};

/// The size of the scale is not applied: readers disagree on its meaning, and the capture file has its own white level.
pub(super) fn read(source: &Source) -> Result<Decoded, ImageError> {
    let damaged = |reason: &str| source.damaged(Format::Pfm, reason);
    let mut header = Header { bytes: source.bytes };
    let samples_per_pixel = if header.word() == Some("PF") { 3 } else { 1 };
    let mut length = || header.word().and_then(|word| word.parse::<usize>().ok());
    let (Some(width), Some(height)) = (length(), length()) else {
        return Err(damaged("the width and height are not numbers"));
    };
    let Some(scale) = header.word().and_then(|word| word.parse::<f32>().ok()).filter(|scale| scale.abs() > 0.0) else {
        return Err(damaged("the scale is not a number other than 0"));
    };
    source.check_size(width, height, samples_per_pixel)?;

    let (values, _) = header.bytes.as_chunks::<4>();
    let decode = if scale < 0.0 { f32::from_le_bytes } else { f32::from_be_bytes };
    let layout = Layout { width, height, samples_per_pixel, planar: false };
    let upside_down = split(layout, values, decode).ok_or_else(|| damaged("pixels are missing at its end"))?;
    let channels =
        upside_down.into_iter().map(|(name, plane)| (name, flipped(plane))).collect::<Vec<(Channel, Plane)>>();
    Ok(Decoded { channels, stored: StoredRange { maximum: None } })
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
    bytes: &'a [u8],
}

impl<'a> Header<'a> {
    /// The next word and the one white space after it; that is where the pixels begin after the last word.
    fn word(&mut self) -> Option<&'a str> {
        let start = self.bytes.iter().position(|byte| !byte.is_ascii_whitespace())?;
        let length = self.bytes[start..].iter().take(64).position(u8::is_ascii_whitespace)?;
        let word = std::str::from_utf8(&self.bytes[start..start + length]).ok();
        self.bytes = &self.bytes[start + length + 1..];
        word
    }
}
