//! What a picture of a TIFF is, before it is decoded.

use std::io::{Read, Seek};

use tiff::ColorType;
use tiff::decoder::{ChunkType, Decoder};
use tiff::tags::{IfdPointer, Tag};

use super::head::PictureSize;
use super::read::Source;
use super::samples::Layout;
use super::tiff_in::failed;
use super::{Format, ImageError};

/// PhotometricInterpretation of grey with 0 as black, of red, green and blue, and of an index into a colour map.
const BLACK_IS_ZERO: u32 = 1;
const PALETTE: u32 = 3;
/// The bit of NewSubfileType that marks a reduced copy of another picture.
const REDUCED: u32 = 1;
/// The most pictures that are looked at for one that is not reduced.
const MAX_PAGES: usize = 64;

/// How samples become colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// The first sample of a pixel.
    Grey,
    Rgb,
    YCbCr,
    /// An index into the colour map.
    Palette,
}

/// One picture.
pub(super) struct Page {
    pub size: PictureSize,
    pub kind: Kind,
    /// Of a sample.
    pub bits: u8,
    /// Of a pixel, as they are stored.
    pub samples: usize,
    /// Its directory.
    pub place: IfdPointer,
    /// Columns of a tile; `None` for strips.
    tile_width: Option<u32>,
}

/// The decoder at the first picture that is not a reduced copy of another: cameras put a preview first.
pub(super) fn first_page<R: Read + Seek>(source: &Source, file: R) -> Result<Decoder<R>, ImageError> {
    let failed = |error| failed(source, error);
    let mut decoder = Decoder::new(file).map_err(failed)?;
    for _ in 0..MAX_PAGES {
        let kind = decoder.find_tag_unsigned::<u32>(Tag::NewSubfileType).map_err(failed)?;
        if kind.unwrap_or_default() & REDUCED == 0 {
            return Ok(decoder);
        }
        if !decoder.more_images() {
            break;
        }
        decoder.next_image().map_err(failed)?;
    }
    Err(source.unsupported(Format::Tiff, "nothing but reduced previews, as camera raw files have them"))
}

impl Page {
    pub fn of<R: Read + Seek>(source: &Source, decoder: &mut Decoder<R>) -> Result<Self, ImageError> {
        let failed = |error| failed(source, error);
        let (width, height) = decoder.dimensions().map_err(failed)?;
        let photometric = decoder.find_tag_unsigned(Tag::PhotometricInterpretation).map_err(failed)?;
        let (kind, bits, samples) = if photometric == Some(PALETTE) {
            let bits = decoder.find_tag_unsigned_vec(Tag::BitsPerSample).map_err(failed)?;
            (Kind::Palette, bits.and_then(|bits| bits.first().copied()).unwrap_or(1), 1)
        } else {
            match decoder.colortype().map_err(failed)? {
                ColorType::Gray(bits) => (Kind::Grey, bits, 1),
                ColorType::GrayA(bits) => (Kind::Grey, bits, 2),
                ColorType::Multiband { bit_depth, num_samples } => (Kind::Grey, bit_depth, usize::from(num_samples)),
                ColorType::RGB(bits) => (Kind::Rgb, bits, 3),
                ColorType::RGBA(bits) => (Kind::Rgb, bits, 4),
                ColorType::YCbCr(bits) => (Kind::YCbCr, bits, 3),
                other => return Err(source.unsupported(Format::Tiff, format_args!("colours of the kind {other:?}"))),
            }
        };
        let channels = if kind == Kind::Palette { 3 } else { samples };
        let size = PictureSize { width: width as usize, height: height as usize, channels };
        let place = decoder.ifd_pointer().ok_or_else(|| source.damaged(Format::Tiff, "no directory"))?;
        let tile_width = match decoder.get_chunk_type() {
            ChunkType::Strip => None,
            ChunkType::Tile => Some(decoder.chunk_dimensions().0),
        };
        let page = Self { size, kind, bits, samples, place, tile_width };
        page.check_bits(source)?;
        page.check_chunks(source, decoder)?;
        if page.is_packed() && decoder.find_tag_unsigned::<u16>(Tag::Predictor).map_err(failed)?.unwrap_or(1) != 1 {
            return Err(source.unsupported(Format::Tiff, "a predictor of packed samples"));
        }
        Ok(page)
    }

    pub fn layout(&self) -> Layout {
        let colours = if matches!(self.kind, Kind::Rgb | Kind::YCbCr) { 3 } else { 1 };
        let PictureSize { width, height, .. } = self.size;
        Layout { width, height, colours, samples_per_pixel: self.samples, planar: false }
    }

    /// Whether samples lie across bytes.
    pub fn is_packed(&self) -> bool {
        matches!(self.bits, 9..=15)
    }

    fn check_bits(&self, source: &Source) -> Result<(), ImageError> {
        let allowed = match (self.kind, self.bits) {
            (Kind::Grey | Kind::Palette, 1 | 2 | 4) => self.samples == 1,
            (Kind::Palette | Kind::YCbCr, 8) => true,
            (Kind::Grey | Kind::Rgb, 8..=16 | 32 | 64) => true,
            _ => false,
        };
        let what = format_args!("{} bits a sample of the kind {:?}", self.bits, self.kind).to_string();
        allowed.then_some(()).ok_or_else(|| source.unsupported(Format::Tiff, what))
    }

    /// Refuses tiles and samples for which the decoder would make room, and which the file cannot hold: its limits leave
    /// out the row of a tile that it decodes, and the samples of a pixel that it passes over.
    fn check_chunks<R: Read + Seek>(&self, source: &Source, decoder: &mut Decoder<R>) -> Result<(), ImageError> {
        let samples = decoder.find_tag_unsigned::<u16>(Tag::SamplesPerPixel).map_err(|error| failed(source, error))?;
        let whole = |side: usize, chunk: u32| side.checked_next_multiple_of(chunk as usize).unwrap_or(usize::MAX);
        let (width, height) = match decoder.get_chunk_type() {
            ChunkType::Strip => (self.size.width, self.size.height),
            ChunkType::Tile => {
                let (tile_width, tile_height) = decoder.chunk_dimensions();
                (whole(self.size.width, tile_width), whole(self.size.height, tile_height))
            }
        };
        source.check_size(PictureSize { width, height, channels: self.size.channels.max(samples.unwrap_or(1).into()) })
    }

    /// The tags to change for a decoder that knows neither colour maps nor packed samples: an index is grey, and the bytes
    /// of a row are 8-bit grey.
    pub fn changes(&self) -> Vec<(Tag, u32)> {
        let row_bytes = |columns: usize| (columns * self.samples * usize::from(self.bits)).div_ceil(8) as u32;
        let mut changes = Vec::new();
        if self.kind == Kind::Palette || (self.is_packed() && self.kind == Kind::Rgb) {
            changes.push((Tag::PhotometricInterpretation, BLACK_IS_ZERO));
        }
        if self.is_packed() {
            changes.extend([(Tag::ImageWidth, row_bytes(self.size.width)), (Tag::BitsPerSample, 8)]);
            changes.extend((self.samples > 1).then_some((Tag::SamplesPerPixel, 1)));
            changes.extend(self.tile_width.map(|width| (Tag::TileWidth, row_bytes(width as usize))));
        }
        changes
    }
}
