//! The pixels of one part of an EXR, block by block.
//!
//! The crate's own reader decodes on a pool of its own, where a panic ends the process, and makes room for all layers
//! and for every size that a block states. Here a block is taken from the file as it lies there, checked and decoded on
//! the calling pool, each under its own guard; only the wanted channels are kept.

use std::collections::HashSet;

use exr::block::UncompressedBlock;
use exr::block::chunk::{Chunk, CompressedBlock, CompressedScanLineBlock, CompressedTileBlock, TileCoordinates};
use exr::compression::Compression;
use exr::meta::BlockDescription;
use exr::meta::attribute::SampleType;
use exr::meta::header::Header;
use exr::prelude::{MetaData, Vec2, f16};
use firstbounce_core::Plane;
use rayon::prelude::*;

use super::exr_in::failed;
use super::read::Source;
use super::{Format, ImageError};

/// A block of as many bytes needs no proof that the file can hold it.
const HARMLESS_BLOCK_BYTES: usize = 64 << 20;
/// The same for all pixels of a part, those that are passed over included.
const HARMLESS_PART_BYTES: usize = 256 << 20;
/// The best that a compression of lossless blocks does: deflate (1032 : 1) on three of four bytes.
const BYTES_PER_BYTE: usize = 1032 * 4 / 3;

/// The whole file, and what its head says.
pub(super) struct Exr<'a> {
    pub source: &'a Source<'a>,
    pub bytes: &'a [u8],
    pub meta: &'a MetaData,
    /// Where the tables of the places of the blocks begin.
    pub tables: usize,
}

/// A compressed block where it lies in the file.
struct Block<'a> {
    place: Place,
    compressed: &'a [u8],
}

#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Place {
    /// The first row.
    Rows(i32),
    Tile(TileCoordinates),
}

impl Exr<'_> {
    /// The channels `wanted` of a part, in that order.
    pub fn planes(&self, part: usize, wanted: &[usize]) -> Result<Vec<Plane>, ImageError> {
        let header = &self.meta.headers[part];
        let Vec2(width, height) = header.layer_size;
        self.check_block_size(header)?;
        let blocks = self.blocks(part).ok_or_else(|| self.damaged("blocks are missing or cut off"))?;
        let mut planes = wanted.iter().map(|_| Plane::filled(width, height, 0.0)).collect::<Vec<_>>();
        let side_by_side = HARMLESS_BLOCK_BYTES.div_ceil(block_bytes(header).max(1));
        for some in blocks.chunks(side_by_side) {
            let decoded = some.par_iter().map(|block| self.decode(part, block)).collect::<Result<Vec<_>, _>>()?;
            for block in decoded {
                for line in block.lines(&header.channels) {
                    let Some(plane) = wanted.iter().position(|&channel| channel == line.location.channel) else {
                        continue;
                    };
                    let Vec2(x, y) = line.location.position;
                    let row = planes[plane].data_mut().get_mut(y * width + x..).unwrap_or_default();
                    store(header.channels.list[line.location.channel].sample_type, line.value, row);
                }
            }
        }
        Ok(planes)
    }

    fn damaged(&self, reason: &str) -> ImageError {
        self.source.damaged(Format::Exr, reason)
    }

    /// Refuses blocks that the file is too short for.
    fn check_block_size(&self, header: &Header) -> Result<(), ImageError> {
        let possible = self.bytes.len().saturating_mul(BYTES_PER_BYTE);
        let Vec2(width, height) = header.layer_size;
        let part = width.saturating_mul(height).saturating_mul(header.channels.bytes_per_pixel);
        if block_bytes(header) > possible.max(HARMLESS_BLOCK_BYTES)
            || (is_bounded(header.compression) && part > possible.max(HARMLESS_PART_BYTES))
        {
            return Err(self.source.too_large(width, height));
        }
        Ok(())
    }

    /// The blocks of the full resolution, each once; `None` unless all are there.
    fn blocks(&self, part: usize) -> Option<Vec<Block<'_>>> {
        let earlier = self.meta.headers[..part].iter().map(|header| header.chunk_count).sum::<usize>();
        let header = &self.meta.headers[part];
        let table = self.bytes.get(self.tables..)?.as_chunks::<8>().0.get(earlier..)?.get(..header.chunk_count)?;
        let mut seen = HashSet::new();
        let mut blocks = Vec::new();
        for place in table {
            let block = self.block(part, usize::try_from(u64::from_le_bytes(*place)).ok()?)?;
            let is_full_size = !matches!(block.place, Place::Tile(tile) if !tile.is_largest_resolution_level());
            if is_full_size && seen.insert(block.place) {
                blocks.push(block);
            }
        }
        let Vec2(width, height) = header.layer_size;
        let Vec2(block_width, block_height) = block_size(header);
        (blocks.len() == width.div_ceil(block_width) * height.div_ceil(block_height)).then_some(blocks)
    }

    /// The block at a place of the file; `None` for one of another part or beyond the end.
    fn block(&self, part: usize, offset: usize) -> Option<Block<'_>> {
        let mut rest = self.bytes.get(offset..)?;
        let mut number = || {
            let (number, after) = rest.split_first_chunk::<4>()?;
            rest = after;
            Some(i32::from_le_bytes(*number))
        };
        let header = &self.meta.headers[part];
        if self.meta.requirements.is_multilayer() && usize::try_from(number()?).ok()? != part {
            return None;
        }
        let place = match header.blocks {
            BlockDescription::ScanLines => Place::Rows(number()?),
            BlockDescription::Tiles(_) => {
                let mut index = || usize::try_from(number()?).ok();
                let tile_index = Vec2(index()?, index()?);
                Place::Tile(TileCoordinates { tile_index, level_index: Vec2(index()?, index()?) })
            }
        };
        let length = usize::try_from(number()?).ok()?;
        Some(Block { place, compressed: rest.get(..length)? })
    }

    fn decode(&self, part: usize, block: &Block) -> Result<UncompressedBlock, ImageError> {
        let header = &self.meta.headers[part];
        let compressed_pixels_le = block.compressed.to_vec();
        let compressed_block = match block.place {
            Place::Rows(y_coordinate) => {
                CompressedBlock::ScanLine(CompressedScanLineBlock { y_coordinate, compressed_pixels_le })
            }
            Place::Tile(coordinates) => {
                CompressedBlock::Tile(CompressedTileBlock { coordinates, compressed_pixels_le })
            }
        };
        self.source.guarded(Format::Exr, || {
            let failed = |error| failed(self.source, error);
            let place = header.get_block_data_indices(&compressed_block).map_err(failed)?;
            let size = header.get_absolute_block_pixel_coordinates(place).map_err(failed)?.size;
            if !dwa_fits(header, size, block.compressed) {
                return Err(self.damaged("a block states sizes that it cannot have"));
            }
            let chunk = Chunk { layer_index: part, compressed_block };
            UncompressedBlock::decompress_chunk(chunk, self.meta, false).map_err(failed)
        })
    }
}

/// Whether no block of that compression makes its decoder take more memory or time than its pixels explain.
///
/// PIZ looks for long codes one by one in a table that the block makes as long as it likes; DWA states the sizes of its
/// parts itself. The others were read: they make what they were told to make, in one pass.
pub(super) fn is_bounded(compression: Compression) -> bool {
    !matches!(compression, Compression::PIZ | Compression::DWAA(_) | Compression::DWAB(_))
}

/// Columns and rows of a whole block, which may be more than those of the picture.
fn block_size(header: &Header) -> Vec2<usize> {
    match header.blocks {
        BlockDescription::Tiles(tiles) => Vec2(tiles.tile_size.0.max(1), tiles.tile_size.1.max(1)),
        BlockDescription::ScanLines => Vec2(header.layer_size.0.max(1), header.compression.scan_lines_per_block()),
    }
}

/// The bytes that a block holds at most.
fn block_bytes(header: &Header) -> usize {
    let size = block_size(header);
    let pixels = size.0.min(header.layer_size.0).saturating_mul(size.1.min(header.layer_size.1));
    pixels.saturating_mul(header.channels.bytes_per_pixel)
}

/// Whether the sizes at the start of a DWA block of `size` are not beyond its pixels, in whole squares of 8 x 8.
fn dwa_fits(header: &Header, size: Vec2<usize>, compressed: &[u8]) -> bool {
    let is_dwa = matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_));
    // As many bytes as its pixels are these pixels.
    if !is_dwa || compressed.len() == size.area() * header.channels.bytes_per_pixel {
        return true;
    }
    let bytes = size.0.next_multiple_of(8) * size.1.next_multiple_of(8) * header.channels.bytes_per_pixel;
    // After the version: unknown, AC, DC and run lengths, compressed and not, and the counts of AC and DC values.
    compressed.as_chunks::<8>().0.iter().skip(1).take(9).all(|stated| u64::from_le_bytes(*stated) <= 2 * bytes as u64)
}

/// Samples in the machine's byte order to the start of `row`.
fn store(sample_type: SampleType, samples: &[u8], row: &mut [f32]) {
    match sample_type {
        SampleType::F16 => {
            let halves = samples.as_chunks().0.iter();
            row.iter_mut().zip(halves).for_each(|(value, half)| *value = f16::from_ne_bytes(*half).to_f32());
        }
        SampleType::F32 => {
            let floats = samples.as_chunks().0.iter();
            row.iter_mut().zip(floats).for_each(|(value, float)| *value = f32::from_ne_bytes(*float));
        }
        SampleType::U32 => {
            let integers = samples.as_chunks().0.iter();
            row.iter_mut().zip(integers).for_each(|(value, integer)| *value = u32::from_ne_bytes(*integer) as f32);
        }
    }
}
