//! PNG, JPEG and Radiance HDR, by the `image` crate.

use std::io::Cursor;

use image::error::ImageError as DecodeError;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};

use super::read::{BYTE_LIMIT, Decoded, Source};
use super::samples::{Layout, split};
use super::{Format, ImageError, StoredRange};

/// Palettes and fewer than 8 bits come out as 8 bits, 0 and 255 for the two values of a one-bit picture.
pub(super) fn read(source: &Source, format: Format, image_format: ImageFormat) -> Result<Decoded, ImageError> {
    let failed = |error: DecodeError| match error {
        DecodeError::Unsupported(what) => source.unsupported(format, what),
        error => source.damaged(format, error),
    };
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(BYTE_LIMIT as u64);
    let mut reader = ImageReader::with_format(Cursor::new(source.bytes), image_format);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(failed)?;
    let (width, height) = decoder.dimensions();
    let (width, height) = (width as usize, height as usize);
    let samples_per_pixel = usize::from(decoder.color_type().channel_count());
    source.check_size(width, height, samples_per_pixel)?;

    let layout = Layout { width, height, samples_per_pixel, planar: false };
    let image = DynamicImage::from_decoder(decoder).map_err(failed)?;
    let (channels, maximum) = match &image {
        DynamicImage::ImageRgb32F(pixels) => (split(layout, pixels.as_raw(), |value| value), None),
        DynamicImage::ImageLuma16(pixels) => (split(layout, pixels.as_raw(), f32::from), Some(65535.0)),
        DynamicImage::ImageLumaA16(pixels) => (split(layout, pixels.as_raw(), f32::from), Some(65535.0)),
        DynamicImage::ImageRgb16(pixels) => (split(layout, pixels.as_raw(), f32::from), Some(65535.0)),
        DynamicImage::ImageRgba16(pixels) => (split(layout, pixels.as_raw(), f32::from), Some(65535.0)),
        eight_bit => (split(layout, eight_bit.as_bytes(), f32::from), Some(255.0)),
    };
    let channels = channels.ok_or_else(|| source.damaged(format, "pixels are missing at its end"))?;
    Ok(Decoded { channels, stored: StoredRange { maximum } })
}
