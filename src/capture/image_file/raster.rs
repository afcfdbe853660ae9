//! PNG, JPEG, Radiance HDR, BMP and PNM, by the `image` crate.

use std::io::{BufRead, Cursor, Seek};

use firstbounce_core::Plane;
use image::codecs::pnm::PnmDecoder;
use image::error::ImageError as DecodeError;
use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};
use rayon::prelude::*;

use super::head::{PictureSize, Stated};
use super::read::{Decoded, Palette, Source};
use super::samples::{Layout, alpha, split};
use super::{Channel, Encoding, Format, ImageError, Metadata, StatedCurve, StoredRange};

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
    let colours = if channels < 3 { 1 } else { 3 };
    let layout = Layout { width, height, colours, samples_per_pixel: channels, planar: false };
    let sixteen_bit = |pixels: &[u16]| (planes(layout, pixels), Some(65535.0));
    let (planes, maximum) = match &image {
        DynamicImage::ImageRgb32F(pixels) => ((split(layout, pixels.as_raw(), |value| value), None), None),
        DynamicImage::ImageLuma16(pixels) => sixteen_bit(pixels.as_raw()),
        DynamicImage::ImageLumaA16(pixels) => sixteen_bit(pixels.as_raw()),
        DynamicImage::ImageRgb16(pixels) => sixteen_bit(pixels.as_raw()),
        DynamicImage::ImageRgba16(pixels) => sixteen_bit(pixels.as_raw()),
        eight_bit => (planes(layout, eight_bit.as_bytes()), Some(255.0)),
    };
    let (Some(channels), alpha) = planes else { return Err(source.damaged(format, "pixels are missing at its end")) };
    let decoded = Decoded { alpha, ..Decoded::of(channels, StoredRange { maximum }) };
    match (format, maximum) {
        (Format::Pnm, Some(full_scale)) => Ok(as_stored(decoded, full_scale, pnm_maximum(bytes))),
        _ => Ok(decoded),
    }
}

/// Colours, and alpha where there is one.
fn planes<T: Copy + Sync + Into<f32>>(layout: Layout, samples: &[T]) -> (Option<Vec<(Channel, Plane)>>, Option<Plane>) {
    (split(layout, samples, T::into), alpha(layout, samples, T::into))
}

/// The largest value that a PNM states.
fn pnm_maximum(bytes: &[u8]) -> Option<f32> {
    let (_, header) = PnmDecoder::new(Cursor::new(bytes)).ok()?.into_inner();
    Some(header.maximal_sample() as f32)
}

/// The decoder stretches values to all of 8 or 16 bits; here they become again what the file stores.
fn as_stored(mut decoded: Decoded, full_scale: f32, maximum: Option<f32>) -> Decoded {
    let Some(maximum) = maximum.filter(|maximum| *maximum > 1.0 && *maximum < full_scale) else { return decoded };
    for (_, plane) in &mut decoded.channels {
        plane.data_mut().par_iter_mut().for_each(|value| *value = (*value * maximum / full_scale).round());
    }
    decoded.stored.maximum = Some(maximum);
    decoded
}

/// The colour map and the indices of a PNG that has one.
pub(super) fn png_palette(bytes: &[u8]) -> Option<Palette> {
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), png::Limits { bytes: MAX_EXTRA_BYTES });
    decoder.set_transformations(png::Transformations::IDENTITY);
    let mut reader = decoder.read_info().ok()?;
    let map = reader.info().palette.as_ref().filter(|_| reader.info().color_type == png::ColorType::Indexed)?;
    let map = map.as_chunks::<3>().0.iter().map(|colour| colour.map(f32::from)).collect();
    let (width, bits) = (reader.info().width as usize, usize::from(reader.info().bit_depth as u8));
    let mut packed = vec![0; reader.output_buffer_size()?];
    let size = reader.next_frame(&mut packed).ok()?;
    let index = |row: &[u8], x: usize| (row[x * bits / 8] >> (8 - bits - x * bits % 8)) & (u8::MAX >> (8 - bits));
    let rows = packed.chunks_exact(size.line_size).take(size.height as usize);
    let indices = rows.flat_map(|row| (0..width).map(move |x| f32::from(index(row, x)))).collect();
    Some(Palette { index: Plane::from_vec(width, size.height as usize, indices)?, map })
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
        Format::Bmp => ImageFormat::Bmp,
        Format::Pnm => ImageFormat::Pnm,
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
