//! TIFF, by the `tiff` crate: the `image` crate refuses grey floats.

use std::io::{Cursor, Read, Seek};

use tiff::decoder::ifd::Value;
use tiff::decoder::{ChunkType, Decoder, DecodingResult, IfdDecoder, Limits};
use tiff::tags::{CompressionMethod, Tag};
use tiff::{ColorType, TiffError};

use super::head::{PictureSize, Stated};
use super::metadata::TagValue;
use super::read::{BYTE_LIMIT, Decoded, Source};
use super::samples::{Layout, split};
use super::tiff_tags::longest_text;
use super::{Format, ImageError, Metadata, StatedCurve, StoredRange};

/// The longest value of EXIF that is read: a time has 20 letters.
const MAX_TAG_VALUES: u64 = 64;

pub(super) fn stated(source: &Source, mut file: impl Read + Seek) -> Result<Stated, ImageError> {
    let longest_text = longest_text(&mut file).map_err(|error| source.damaged(Format::Tiff, error))?;
    if longest_text > Limits::default().decoding_buffer_size as u64 {
        return Err(source.damaged(Format::Tiff, "a text that would not fit into memory"));
    }
    file.rewind().map_err(|error| source.unreadable(error))?;
    source.guarded(Format::Tiff, || {
        let mut decoder = Decoder::new(file).map_err(|error| failed(source, error))?;
        let size = size(source, &mut decoder)?.0;
        check_chunks(source, &mut decoder, size)?;
        Ok(Stated { size, bounded: is_bounded(source, &mut decoder)? })
    })
}

/// The size, and the bits of a sample.
fn size<R: Read + Seek>(source: &Source, decoder: &mut Decoder<R>) -> Result<(PictureSize, u8), ImageError> {
    let failed = |error| failed(source, error);
    let (width, height) = decoder.dimensions().map_err(failed)?;
    let (bits, channels) = match decoder.colortype().map_err(failed)? {
        ColorType::Gray(bits @ (1 | 2 | 4)) => (bits, 1),
        ColorType::Gray(bits @ (8 | 16 | 32 | 64)) => (bits, 1),
        ColorType::GrayA(bits @ (8 | 16 | 32 | 64)) => (bits, 2),
        ColorType::RGB(bits @ (8 | 16 | 32 | 64)) => (bits, 3),
        ColorType::RGBA(bits @ (8 | 16 | 32 | 64)) => (bits, 4),
        other => return Err(source.unsupported(Format::Tiff, format_args!("colours of the kind {other:?}"))),
    };
    Ok((PictureSize { width: width as usize, height: height as usize, channels }, bits))
}

/// Refuses tiles and samples for which the decoder would make room, and which the file cannot hold: its limits leave
/// out the row of a tile that it decodes, and the samples of a pixel that it passes over.
fn check_chunks<R: Read + Seek>(
    source: &Source,
    decoder: &mut Decoder<R>,
    size: PictureSize,
) -> Result<(), ImageError> {
    let samples = decoder.find_tag_unsigned::<u16>(Tag::SamplesPerPixel).map_err(|error| failed(source, error))?;
    let whole = |side: usize, chunk: u32| side.checked_next_multiple_of(chunk as usize).unwrap_or(usize::MAX);
    let (width, height) = match decoder.get_chunk_type() {
        ChunkType::Strip => (size.width, size.height),
        ChunkType::Tile => {
            let (tile_width, tile_height) = decoder.chunk_dimensions();
            (whole(size.width, tile_width), whole(size.height, tile_height))
        }
    };
    source.check_size(PictureSize { width, height, channels: size.channels.max(samples.unwrap_or(1).into()) })
}

/// Whether the compression writes only what there is room for. JPEG and fax have sizes of their own in each strip.
fn is_bounded<R: Read + Seek>(source: &Source, decoder: &mut Decoder<R>) -> Result<bool, ImageError> {
    let compression = decoder.find_tag_unsigned(Tag::Compression).map_err(|error| failed(source, error))?;
    Ok(matches!(
        compression.map_or(CompressionMethod::None, CompressionMethod::from_u16_exhaustive),
        CompressionMethod::None
            | CompressionMethod::LZW
            | CompressionMethod::Deflate
            | CompressionMethod::OldDeflate
            | CompressionMethod::PackBits
    ))
}

fn failed(source: &Source, error: TiffError) -> ImageError {
    match error {
        TiffError::UnsupportedError(what) => source.unsupported(Format::Tiff, what),
        error => source.damaged(Format::Tiff, error),
    }
}

/// Of the tags of the first picture and their EXIF directory.
pub(super) fn metadata(source: &Source, mut file: impl Read + Seek) -> Metadata {
    // A text that is too long makes the decoder print a line.
    if stated(source, &mut file).is_err() || file.rewind().is_err() {
        return Metadata::default();
    }
    let Ok(mut decoder) = Decoder::new(file) else { return Metadata::default() };
    let exif = decoder.find_tag(Tag::ExifDirectory).ok().flatten().and_then(|place| place.into_ifd_pointer().ok());
    let exif = exif.and_then(|place| decoder.read_directory(place).ok());
    let metadata = Metadata::of_tags(|tag| {
        let tag = Tag::from_u16_exhaustive(tag);
        let own = tag_value(decoder.image_ifd(), tag);
        own.or_else(|| tag_value(decoder.read_directory_tags(exif.as_ref()?), tag))
    });
    let curve = match decoder.image_ifd().find_entry(Tag::IccProfile) {
        None => StatedCurve::Unstated,
        // A profile that is too long to be read is damaged as any other.
        Some(_) => StatedCurve::of_icc(&decoder.get_tag_u8_vec(Tag::IccProfile).unwrap_or_default()),
    };
    Metadata { curve, ..metadata }
}

fn tag_value(mut tags: IfdDecoder, tag: Tag) -> Option<TagValue> {
    tags.find_entry(tag).filter(|entry| entry.count() <= MAX_TAG_VALUES)?;
    let value = match tags.find_tag(tag).ok()?? {
        Value::List(values) => values.into_iter().next()?,
        value => value,
    };
    match value {
        Value::Ascii(text) => Some(TagValue::Text(text)),
        Value::Rational(above, below) => Some(TagValue::Number(f64::from(above) / f64::from(below))),
        Value::SRational(above, below) => Some(TagValue::Number(f64::from(above) / f64::from(below))),
        number => {
            let whole = number.clone().into_u64().map(|whole| whole as f64);
            whole.or_else(|_| number.into_f64()).ok().map(TagValue::Number)
        }
    }
}

/// The first picture of the file, in strips or tiles, interleaved or plane by plane.
pub(super) fn read(source: &Source, bytes: &[u8]) -> Result<Decoded, ImageError> {
    let mut limits = Limits::default();
    limits.decoding_buffer_size = BYTE_LIMIT;
    limits.intermediate_buffer_size = BYTE_LIMIT;
    let mut samples = DecodingResult::U8(Vec::new());
    let (PictureSize { width, height, channels: samples_per_pixel }, bits, planes) =
        source.guarded(Format::Tiff, || {
            let failed = |error| failed(source, error);
            let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(failed)?.with_limits(limits);
            let (size, bits) = size(source, &mut decoder)?;
            check_chunks(source, &mut decoder, size)?;
            Ok((size, bits, decoder.read_image_to_buffer(&mut samples).map_err(failed)?.planes))
        })?;
    let layout = Layout { width, height, samples_per_pixel, planar: planes > 1 };
    let integer = |bits: u8| Some((u64::MAX >> (64 - bits)) as f32);
    let (channels, maximum) = match &samples {
        DecodingResult::U8(s) if bits < 8 => (split(layout, &unpacked(s, width, bits), f32::from), integer(bits)),
        DecodingResult::U8(s) => (split(layout, s, f32::from), integer(bits)),
        DecodingResult::U16(s) => (split(layout, s, f32::from), integer(bits)),
        DecodingResult::U32(s) => (split(layout, s, |value| value as f32), integer(bits)),
        DecodingResult::F16(s) => (split(layout, s, |value| value.to_f32()), None),
        DecodingResult::F32(s) => (split(layout, s, |value| value), None),
        DecodingResult::F64(s) => (split(layout, s, |value| value as f32), None),
        _ => return Err(source.unsupported(Format::Tiff, "signed or 64-bit integers")),
    };
    let channels = channels.ok_or_else(|| source.damaged(Format::Tiff, "pixels are missing at its end"))?;
    Ok(Decoded { channels, stored: StoredRange { maximum } })
}

/// Grey samples of 1, 2 or 4 bits, packed from the high bits down; each row begins with a new byte.
fn unpacked(bytes: &[u8], width: usize, bits: u8) -> Vec<u8> {
    let per_byte = usize::from(8 / bits);
    let sample = |row: &[u8], x: usize| {
        let shift = 8 - bits - (x % per_byte) as u8 * bits;
        (row[x / per_byte] >> shift) & ((1 << bits) - 1)
    };
    bytes.chunks_exact(width.div_ceil(per_byte)).flat_map(|row| (0..width).map(move |x| sample(row, x))).collect()
}
