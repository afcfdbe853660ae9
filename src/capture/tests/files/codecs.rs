//! Small sound pictures in every compression that is read, and damaged ones whose sizes cannot be.

#![allow(dead_code, reason = "each test file uses a part")]
#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::io::Cursor;

use exr::prelude::*;
use image::{DynamicImage, ImageFormat};

const WIDTH: u32 = 37;
const HEIGHT: u32 = 22;

/// Red, green and blue of a pixel, not smooth.
fn light(x: usize, y: usize) -> (f32, f32, f32) {
    (x as f32 * 0.3, ((x * 7 + y * 13) % 11) as f32 * 0.1, y as f32)
}

/// An EXR of halves in scan lines or tiles.
pub fn exr_of(compression: Compression, blocks: Blocks) -> Vec<u8> {
    let channels = SpecificChannels::rgb(|at: Vec2<usize>| {
        let (red, green, blue) = light(at.0, at.1);
        (f16::from_f32(red), f16::from_f32(green), f16::from_f32(blue))
    });
    let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
    let size = Vec2(WIDTH as usize, HEIGHT as usize);
    let mut bytes = Cursor::new(Vec::new());
    Image::from_encoded_channels(size, encoding, channels).write().non_parallel().to_buffered(&mut bytes).unwrap();
    bytes.into_inner()
}

const TILES: Blocks = Blocks::Tiles(Vec2(16, 16));
const EXR_COMPRESSIONS: [(&str, Compression); 10] = [
    ("uncompressed", Compression::Uncompressed),
    ("rle", Compression::RLE),
    ("zip1", Compression::ZIP1),
    ("zip16", Compression::ZIP16),
    ("piz", Compression::PIZ),
    ("pxr24", Compression::PXR24),
    ("b44", Compression::B44),
    ("b44a", Compression::B44A),
    ("dwaa", Compression::DWAA(None)),
    ("dwab", Compression::DWAB(None)),
];

/// A JPEG of the usual kind.
fn jpeg() -> Vec<u8> {
    let pixels = image::GrayImage::from_fn(WIDTH, HEIGHT, |x, y| image::Luma([(x * 5 + y * 9) as u8]));
    let mut bytes = Cursor::new(Vec::new());
    DynamicImage::ImageLuma8(pixels).write_to(&mut bytes, ImageFormat::Jpeg).unwrap();
    bytes.into_inner()
}

/// The tags of a grey TIFF of one strip or tile; more are added, or replace those of the same number.
fn grey_tiff(bits: u32, more: &[(u16, u32)], pixels: Vec<u8>) -> Vec<u8> {
    let mut tags = vec![(256, 4, vec![WIDTH]), (257, 4, vec![HEIGHT]), (258, 3, vec![bits]), (262, 3, vec![1])];
    tags.extend([(277, 3, vec![1]), (339, 3, vec![if bits == 32 { 3 } else { 1 }])]);
    for &(tag, value) in more {
        tags.retain(|known| known.0 != tag);
        tags.push((tag, 4, vec![value]));
    }
    let tiled = more.iter().any(|(tag, _)| *tag == 322);
    tags.push((if tiled { 325 } else { 279 }, 4, vec![pixels.len() as u32]));
    tiff_of_tags(tags, &[pixels], if tiled { 324 } else { 273 })
}

/// One sound file of each compression of EXR and TIFF: name and bytes.
pub fn one_of_each_codec() -> Vec<(String, Vec<u8>)> {
    let mut files = Vec::new();
    for (name, compression) in EXR_COMPRESSIONS {
        files.push((format!("lines-{name}.exr"), exr_of(compression, Blocks::ScanLines)));
        files.push((format!("tiles-{name}.exr"), exr_of(compression, TILES)));
    }
    let bytes = |count: u32| (0..count).map(|i| (i * 37 % 251) as u8).collect::<Vec<_>>();
    let tile = [(322, 48), (323, 32)];
    // Literal runs of two bytes.
    let packed = bytes(WIDTH * HEIGHT).chunks(2).flat_map(|pair| [&[pair.len() as u8 - 1], pair].concat()).collect();
    // A white line is one bit, the end of the block 24.
    let mut fax = vec![0xff; HEIGHT.div_ceil(8) as usize];
    fax.extend([0x00, 0x10, 0x01]);
    files.extend([
        ("tile.tif".into(), grey_tiff(8, &tile, bytes(48 * 32))),
        ("tile-float.tif".into(), grey_tiff(32, &[(322, 48), (323, 32), (317, 3)], bytes(48 * 32 * 4))),
        ("packbits.tif".into(), grey_tiff(8, &[(259, 32773)], packed)),
        ("jpeg.tif".into(), grey_tiff(8, &[(259, 7)], jpeg())),
        ("fax.tif".into(), grey_tiff(1, &[(259, 4)], fax)),
    ]);
    files
}

/// A PNG chunk.
pub fn chunk(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let named = [kind, data].concat();
    let check = !named.iter().fold(u32::MAX, |check, &byte| {
        (0..8).fold(check ^ u32::from(byte), |check, _| (check >> 1) ^ (0xedb8_8320 & (check & 1).wrapping_neg()))
    });
    [&(data.len() as u32).to_be_bytes(), named.as_slice(), &check.to_be_bytes()].concat()
}

/// Replaces what stands `after` bytes behind the first `mark`.
fn patched(mut bytes: Vec<u8>, mark: &[u8], after: usize, with: &[u8]) -> Vec<u8> {
    let at = bytes.windows(mark.len()).position(|window| window == mark).unwrap() + mark.len() + after;
    bytes[at..at + with.len()].copy_from_slice(with);
    bytes
}

/// Small files that state sizes, counts or places that they cannot have: name and bytes. None is a picture.
pub fn damaged() -> Vec<(&'static str, Vec<u8>)> {
    let huge = i32::MAX.to_le_bytes();
    let zip = || exr_of(Compression::ZIP16, Blocks::ScanLines);
    let first_block = |bytes: &[u8]| {
        let mut file = Cursor::new(bytes);
        MetaData::read_from_buffered(&mut file, false).unwrap();
        let table = file.position() as usize;
        (table, u64::from_le_bytes(*bytes[table..].first_chunk().unwrap()) as usize)
    };
    let mut files = vec![
        ("window.exr", patched(zip(), b"dataWindow\0box2i\0", 12, &[huge, huge].concat())),
        ("tile.exr", patched(exr_of(Compression::PIZ, TILES), b"tiles\0tiledesc\0", 4, &[huge, huge].concat())),
        ("attribute.exr", patched(zip(), b"dataWindow\0box2i\0", 0, &huge)),
    ];
    for count in 1..=9 {
        let mut dwa = exr_of(Compression::DWAA(None), Blocks::ScanLines);
        let place = first_block(&dwa).1 + 8 + 8 * count;
        dwa[place..place + 8].copy_from_slice(&(1_u64 << 50).to_le_bytes());
        files.push(("counts.exr", dwa));
    }
    for (name, value) in [("beyond.exr", [0xff; 8]), ("here.exr", [0; 8])] {
        let mut bytes = zip();
        let table = first_block(&bytes).0;
        bytes[table..table + 8].copy_from_slice(&value);
        files.push((name, bytes));
    }
    let mut bytes = zip();
    let length = first_block(&bytes).1 + 4;
    bytes[length..length + 4].copy_from_slice(&huge);
    files.push(("length.exr", bytes));

    let pixels = || vec![0; 64];
    let (wide, tall) = ((322, 4_294_967_280), (323, 4_294_967_280));
    files.extend([
        ("tile-width.tif", grey_tiff(32, &[wide, (323, 16), (317, 3)], pixels())),
        ("tile-height.tif", grey_tiff(32, &[(322, 16), tall, (317, 3)], pixels())),
        ("tile.tif", grey_tiff(8, &[wide, tall], pixels())),
        ("samples.tif", grey_tiff(8, &[(277, 65_535), (262, 2), (256, 60_000), (257, 60)], pixels())),
        ("width.tif", grey_tiff(8, &[(256, u32::MAX)], pixels())),
        ("size.tif", grey_tiff(8, &[(256, u32::MAX), (257, u32::MAX)], pixels())),
        // Text in place of a number, longer than the file.
        ("text.tif", patched(grey_tiff(8, &[(259, 1)], pixels()), &[3, 1], 0, &[2, 0, 0xff, 0xff, 0xff, 0x7f])),
        ("rows.tif", grey_tiff(8, &[(278, 1)], pixels())),
        ("jpeg.tif", grey_tiff(8, &[(259, 7)], patched(jpeg(), &[0xff, 0xc0], 3, &[0xff; 4]))),
    ]);
    let header = [WIDTH.to_be_bytes().as_slice(), &HEIGHT.to_be_bytes(), &[8, 3, 0, 0, 0]].concat();
    let palette =
        [chunk(b"IHDR", &header), chunk(b"PLTE", &[7]), chunk(b"IDAT", &[0x78, 1, 3, 0]), chunk(b"IEND", &[])];
    let vast = [[0, 0, 0xff, 0xff], [0, 0, 0xff, 0xff]].concat();
    let vast = [chunk(b"IHDR", &[vast.as_slice(), &[16, 6, 0, 0, 0]].concat()), chunk(b"IDAT", &[0x78, 1, 3, 0])];
    let magic = b"\x89PNG\r\n\x1a\n".to_vec();
    files.extend([
        ("palette.png", [magic.clone(), palette.concat()].concat()),
        ("size.png", [magic, vast.concat()].concat()),
        ("size.jpg", patched(jpeg(), &[0xff, 0xc0], 3, &[0xff; 4])),
        ("size.hdr", b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2000000 +X 2000000\n0000".to_vec()),
        ("size.pfm", b"PF\n2000000 2000000\n-1.0\n0000".to_vec()),
    ]);
    files
}

/// An uncompressed little-endian TIFF written tag by tag: `(tag, type, values)`, the pixels behind the directory.
pub fn tiff_of_tags(mut tags: Vec<(u16, u16, Vec<u32>)>, pieces: &[Vec<u8>], offsets_tag: u16) -> Vec<u8> {
    tags.push((offsets_tag, 4, vec![0; pieces.len()]));
    tags.sort_by_key(|tag| tag.0);
    let size = |kind: u16| if kind == 3 { 2 } else { 4 };
    let directory_end = 8 + 2 + 12 * tags.len() + 4;
    let long: usize = tags.iter().map(|(_, kind, v)| v.len() * size(*kind)).filter(|&length| length > 4).sum();
    let mut pixels_at = directory_end + long;
    for tag in &mut tags {
        if tag.0 == offsets_tag {
            for (offset, piece) in tag.2.iter_mut().zip(pieces) {
                *offset = pixels_at as u32;
                pixels_at += piece.len();
            }
        }
    }
    let mut bytes = b"II*\0\x08\0\0\0".to_vec();
    bytes.extend((tags.len() as u16).to_le_bytes());
    let mut behind = Vec::new();
    for (tag, kind, values) in &tags {
        let mut data: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()[..size(*kind)].to_vec()).collect();
        bytes.extend(tag.to_le_bytes());
        bytes.extend(kind.to_le_bytes());
        bytes.extend((values.len() as u32).to_le_bytes());
        if data.len() > 4 {
            bytes.extend(((directory_end + behind.len()) as u32).to_le_bytes());
            behind.extend(data);
        } else {
            data.resize(4, 0);
            bytes.extend(data);
        }
    }
    bytes.extend([0; 4]);
    bytes.extend(behind);
    bytes.extend(pieces.concat());
    bytes
}
