//! PNG, JPEG and Radiance HDR, by the `image` crate.

use std::io::{BufRead, Cursor, Seek};

use image::error::ImageError as DecodeError;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};

use super::head::{PictureSize, Stated};
use super::read::{Decoded, Source};
use super::samples::{Layout, split};
use super::{Encoding, Format, ImageError, Metadata, StatedCurve, StoredRange};

/// The most that a colour profile or another text beside the pixels may inflate to.
const MAX_EXTRA_BYTES: usize = 64 << 20;

pub(super) fn stated(source: &Source, format: Format, file: impl BufRead + Seek) -> Result<Stated, ImageError> {
    source
        .guarded(format, || Ok(Stated { size: size(&decoder(source, format, file, MAX_EXTRA_BYTES)?), bounded: true }))
}

fn size(decoder: &impl ImageDecoder) -> PictureSize {
    let (width, height) = decoder.dimensions();
    let channels = usize::from(decoder.color_type().channel_count());
    PictureSize { width: width as usize, height: height as usize, channels }
}

/// What stands before the pixels of a PNG.
pub(super) fn png_metadata(_source: &Source, file: impl BufRead + Seek) -> Metadata {
    let mut decoder = png::Decoder::new_with_limits(file, png::Limits { bytes: MAX_EXTRA_BYTES });
    decoder.set_ignore_text_chunk(true);
    let Ok(reader) = decoder.read_info() else { return Metadata::default() };
    let info = reader.info();
    let exif = info.exif_metadata.as_ref().map(|block| Metadata::of_exif(block.to_vec()).0);
    Metadata { curve: StatedCurve::of_png(info), ..exif.unwrap_or_default() }
}

/// A colour profile, or else what EXIF says of the colours.
pub(super) fn jpeg_metadata(source: &Source, file: impl BufRead + Seek) -> Metadata {
    let Ok(mut decoder) = decoder(source, Format::Jpeg, file, MAX_EXTRA_BYTES) else { return Metadata::default() };
    let profile = decoder.icc_profile().ok().flatten();
    let (metadata, is_srgb) = decoder.exif_metadata().ok().flatten().map(Metadata::of_exif).unwrap_or_default();
    let of_exif = if is_srgb { StatedCurve::Known(Encoding::Srgb) } else { StatedCurve::Unstated };
    Metadata { curve: profile.map_or(of_exif, |profile| StatedCurve::of_icc(&profile)), ..metadata }
}

/// Palettes and fewer than 8 bits come out as 8 bits, 0 and 255 for the two values of a one-bit picture.
pub(super) fn read(source: &Source, format: Format, bytes: &[u8]) -> Result<Decoded, ImageError> {
    let PictureSize { width, height, channels } = stated(source, format, Cursor::new(bytes))?.size;
    let pixel_bytes = width.saturating_mul(height).saturating_mul(channels).saturating_mul(size_of::<f32>());
    let max_bytes = pixel_bytes.saturating_add(MAX_EXTRA_BYTES);
    let image = source.guarded(format, || {
        let decoder = decoder(source, format, Cursor::new(bytes), max_bytes)?;
        DynamicImage::from_decoder(decoder).map_err(|error| failed(source, format, error))
    })?;
    let layout = Layout { width, height, samples_per_pixel: channels, planar: false };
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

fn decoder<'a, R: BufRead + Seek + 'a>(
    source: &Source,
    format: Format,
    file: R,
    max_bytes: usize,
) -> Result<impl ImageDecoder + 'a, ImageError> {
    let image_format = match format {
        Format::Jpeg => ImageFormat::Jpeg,
        Format::Hdr => ImageFormat::Hdr,
        _ => ImageFormat::Png,
    };
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(max_bytes as u64);
    let mut reader = ImageReader::with_format(file, image_format);
    reader.limits(limits);
    reader.into_decoder().map_err(|error| failed(source, format, error))
}

fn failed(source: &Source, format: Format, error: DecodeError) -> ImageError {
    match error {
        DecodeError::Unsupported(what) => source.unsupported(format, what),
        error => source.damaged(format, error),
    }
}
