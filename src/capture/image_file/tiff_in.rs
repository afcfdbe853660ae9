//! TIFF, by the `tiff` crate: the `image` crate refuses grey floats.

use std::io::{Cursor, Read, Seek};

use firstbounce_core::Plane;
use rayon::prelude::*;
use tiff::TiffError;
use tiff::decoder::ifd::Value;
use tiff::decoder::{Decoder, DecodingResult, IfdDecoder, Limits};
use tiff::tags::{CompressionMethod, Tag};

use super::head::Stated;
use super::metadata::TagValue;
use super::read::{BYTE_LIMIT, Decoded, Source};
use super::samples::{Layout, alpha, split};
use super::tiff_page::{Kind, Page, first_page};
use super::tiff_tags::{longest_text, set_tags};
use super::{Channel, Format, ImageError, Metadata, StatedCurve, StoredRange};

/// The longest value of EXIF that is read: a time has 20 letters.
const MAX_TAG_VALUES: u64 = 64;
/// The entries of a colour map are 16-bit; it has at most 256, so that its pixels are 8-bit pixels.
const MAP_VALUES_PER_LEVEL: f32 = 257.0;

pub(super) fn stated(source: &Source, mut file: impl Read + Seek) -> Result<Stated, ImageError> {
    let longest_text = longest_text(&mut file).map_err(|error| source.damaged(Format::Tiff, error))?;
    if longest_text > Limits::default().decoding_buffer_size as u64 {
        return Err(source.damaged(Format::Tiff, "a text that would not fit into memory"));
    }
    file.rewind().map_err(|error| source.unreadable(error))?;
    source.guarded(Format::Tiff, || {
        let mut decoder = first_page(source, file)?;
        let page = Page::of(source, &mut decoder)?;
        Ok(Stated { size: page.size, bounded: is_bounded(source, &mut decoder)? })
    })
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

pub(super) fn failed(source: &Source, error: TiffError) -> ImageError {
    match error {
        TiffError::UnsupportedError(what) => source.unsupported(Format::Tiff, what),
        error => source.damaged(Format::Tiff, error),
    }
}

/// Of the tags of the picture that is read and their EXIF directory.
pub(super) fn metadata(source: &Source, mut file: impl Read + Seek) -> Metadata {
    // A text that is too long makes the decoder print a line.
    if stated(source, &mut file).is_err() || file.rewind().is_err() {
        return Metadata::default();
    }
    let Ok(mut decoder) = first_page(source, file) else { return Metadata::default() };
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

/// The first picture of the file that is not reduced, in strips or tiles, interleaved or plane by plane.
pub(super) fn read(source: &Source, bytes: &[u8]) -> Result<Decoded, ImageError> {
    let page = source.guarded(Format::Tiff, || Page::of(source, &mut first_page(source, Cursor::new(bytes))?))?;
    let (samples, planar) = samples(source, bytes, &page)?;
    let layout = Layout { planar, ..page.layout() };
    let integer = |bits: u8| Some((u64::MAX >> (64 - bits)) as f32);
    let (planes, maximum) = match &samples {
        DecodingResult::U8(s) => (planes(layout, s, f32::from), integer(page.bits)),
        DecodingResult::U16(s) => (planes(layout, s, f32::from), integer(page.bits)),
        DecodingResult::U32(s) => (planes(layout, s, |value| value as f32), integer(page.bits)),
        DecodingResult::F16(s) => (planes(layout, s, |value| value.to_f32()), None),
        DecodingResult::F32(s) => (planes(layout, s, |value| value), None),
        DecodingResult::F64(s) => (planes(layout, s, |value| value as f32), None),
        _ => return Err(source.unsupported(Format::Tiff, "signed or 64-bit integers")),
    };
    let (channels, alpha) = planes.ok_or_else(|| source.damaged(Format::Tiff, "pixels are missing at its end"))?;
    let stored = StoredRange { maximum };
    match page.kind {
        Kind::Palette => {
            let map = colour_map(source, bytes)?;
            let index = channels.into_iter().next().map(|(_, index)| index);
            Ok(Decoded::of_palette(index.unwrap_or_default(), map))
        }
        Kind::YCbCr => Ok(Decoded { channels: rgb_of_ycbcr(channels), alpha, ..Decoded::of(Vec::new(), stored) }),
        Kind::Grey | Kind::Rgb => Ok(Decoded { alpha, ..Decoded::of(channels, stored) }),
    }
}

type Planes = (Vec<(Channel, Plane)>, Option<Plane>);

fn planes<T: Copy + Sync>(layout: Layout, samples: &[T], stored: impl Fn(T) -> f32 + Sync) -> Option<Planes> {
    let alpha = alpha(layout, samples, &stored);
    Some((split(layout, samples, stored)?, alpha))
}

/// The samples one by one, and whether they lie plane by plane.
fn samples(source: &Source, bytes: &[u8], page: &Page) -> Result<(DecodingResult, bool), ImageError> {
    let changes = page.changes();
    let (samples, planar) = if changes.is_empty() {
        decode(source, bytes)?
    } else {
        // The decoder does not know such samples; what it takes for 8-bit grey it gives as it is stored.
        let mut changed = bytes.to_vec();
        set_tags(&mut changed, page.place, &changes)
            .ok_or_else(|| source.damaged(Format::Tiff, "a tag of its first directory is missing"))?;
        decode(source, &changed)?
    };
    Ok(match samples {
        DecodingResult::U8(packed) if page.bits < 8 || page.is_packed() => {
            (DecodingResult::U16(unpacked(&packed, page.size.width * page.samples, page.bits)), planar)
        }
        samples => (samples, planar),
    })
}

fn decode(source: &Source, bytes: &[u8]) -> Result<(DecodingResult, bool), ImageError> {
    let mut limits = Limits::default();
    limits.decoding_buffer_size = BYTE_LIMIT;
    limits.intermediate_buffer_size = BYTE_LIMIT;
    let mut samples = DecodingResult::U8(Vec::new());
    let planes = source.guarded(Format::Tiff, || {
        let mut decoder = first_page(source, Cursor::new(bytes))?.with_limits(limits);
        Ok(decoder.read_image_to_buffer(&mut samples).map_err(|error| failed(source, error))?.planes)
    })?;
    Ok((samples, planes > 1))
}

/// Samples of 1 to 16 bits, packed from the high bits down; each row begins with a new byte.
fn unpacked(bytes: &[u8], row_samples: usize, bits: u8) -> Vec<u16> {
    let bits = usize::from(bits);
    let sample = |row: &[u8], index: usize| {
        let (first, shift) = (index * bits / 8, index * bits % 8);
        // A sample lies in three bytes at most.
        let window = (first..first + 3).fold(0_u32, |window, at| window << 8 | u32::from(*row.get(at).unwrap_or(&0)));
        (window >> (24 - shift - bits)) as u16 & (u16::MAX >> (16 - bits))
    };
    let rows = bytes.par_chunks_exact((row_samples * bits).div_ceil(8));
    rows.flat_map_iter(|row| (0..row_samples).map(move |index| sample(row, index))).collect()
}

/// Red, green and blue of each index, from 0 to 255.
fn colour_map(source: &Source, bytes: &[u8]) -> Result<Vec<[f32; 3]>, ImageError> {
    source.guarded(Format::Tiff, || {
        let mut decoder = first_page(source, Cursor::new(bytes))?;
        let map = decoder.get_tag_u16_vec(Tag::ColorMap).map_err(|error| failed(source, error))?;
        let entries = map.len() / 3;
        let level = |place: usize| f32::from(map[place]) / MAP_VALUES_PER_LEVEL;
        Ok((0..entries).map(|entry| [0, 1, 2].map(|colour| level(colour * entries + entry))).collect())
    })
}

/// By the coefficients of ITU-R BT.601, which TIFF and JPEG take where a file gives none; all 8 bits are used.
fn rgb_of_ycbcr(channels: Vec<(Channel, Plane)>) -> Vec<(Channel, Plane)> {
    let Ok([(_, mut red), (_, mut green), (_, mut blue)]) = <[_; 3]>::try_from(channels) else { return Vec::new() };
    let pixels = red.data_mut().par_iter_mut().zip(green.data_mut()).zip(blue.data_mut());
    pixels.for_each(|((first, second), third)| {
        let (luma, b, r) = (*first, *second - 128.0, *third - 128.0);
        let rgb = [luma + 1.402 * r, luma - 0.344_136 * b - 0.714_136 * r, luma + 1.772 * b];
        [*first, *second, *third] = rgb.map(|value| value.round().clamp(0.0, 255.0));
    });
    vec![(Channel::R, red), (Channel::G, green), (Channel::B, blue)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_samples_of_every_size_come_apart() {
        assert_eq!(unpacked(&[0b1010_0000], 3, 1), [1, 0, 1]);
        assert_eq!(unpacked(&[0x12, 0x30, 0x45, 0x60], 3, 4), [1, 2, 3, 4, 5, 6]);
        assert_eq!(unpacked(&[0xab, 0xcd, 0xef], 2, 12), [0xabc, 0xdef]);
        assert_eq!(unpacked(&[0b1111_1111, 0b1100_0000, 0b0001_0000], 2, 10), [1023, 1]);
        assert_eq!(unpacked(&[0xff, 0xfc, 0x00, 0x10], 2, 14), [0x3fff, 1]);
    }
}
