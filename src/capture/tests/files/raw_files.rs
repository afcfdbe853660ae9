//! Camera raw files: a DNG that the test writes itself.

use std::io::Cursor;

use firstbounce_capture::image_file::{
    Corrections, Format, ImageError, LinearOptions, linearise, picture_metadata, picture_size, read_image,
};
use firstbounce_capture::set::Channel;
use firstbounce_core::image::photo::CLIPPED;
use tiff::encoder::colortype::Gray16;
use tiff::encoder::{Rational, TiffEncoder};
use tiff::tags::Tag;

use crate::pictures::Folder;

const SITES: u32 = 16;
const BLACK: u16 = 512;
const WHITE: u16 = 4095;

/// Counts of a site of red, green or blue; green rises to the right.
fn count(x: u32, y: u32) -> u16 {
    BLACK
        + match (x % 2, y % 2) {
            (0, 0) => 1000,
            (1, 1) => 300,
            _ => 500 + 10 * x as u16,
        }
}

/// A DNG with the pattern red, green, green, blue, behind a preview of 9.
fn dng(count: impl Fn(u32, u32) -> u16) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    let mut preview = encoder.new_image::<Gray16>(2, 2).unwrap();
    preview.encoder().write_tag(Tag::NewSubfileType, 1_u32).unwrap();
    preview.encoder().write_tag(Tag::Unknown(50706), &[1_u8, 4, 0, 0][..]).unwrap();
    preview.encoder().write_tag(Tag::Unknown(0x829a), Rational { n: 1, d: 50 }).unwrap();
    preview.encoder().write_tag(Tag::Unknown(0x8827), 200_u16).unwrap();
    preview.encoder().write_tag(Tag::Make, "Test").unwrap();
    preview.encoder().write_tag(Tag::Model, "Sensor").unwrap();
    preview.write_data(&[9; 4]).unwrap();
    let mut raw = encoder.new_image::<Gray16>(SITES, SITES).unwrap();
    let tags = raw.encoder();
    tags.write_tag(Tag::NewSubfileType, 0_u32).unwrap();
    tags.write_tag(Tag::PhotometricInterpretation, 32803_u16).unwrap();
    tags.write_tag(Tag::Unknown(33421), &[2_u16, 2][..]).unwrap();
    tags.write_tag(Tag::Unknown(33422), &[0_u8, 1, 1, 2][..]).unwrap();
    tags.write_tag(Tag::Unknown(50714), BLACK).unwrap();
    tags.write_tag(Tag::Unknown(50717), WHITE).unwrap();
    let sites: Vec<u16> = (0..SITES * SITES).map(|i| count(i % SITES, i / SITES)).collect();
    raw.write_data(&sites).unwrap();
    bytes.into_inner()
}

#[test]
fn a_raw_file_is_read_as_what_its_sensor_counted_and_never_as_its_preview() {
    let folder = Folder::new();
    let path = folder.file("left.dng", dng(count));
    let image = read_image(&path).unwrap();
    assert_eq!((image.format, image.size()), (Format::Raw, (8, 8)));
    assert_eq!(image.stored.maximum, Some(f32::from(WHITE - BLACK)));
    assert!(image.warnings.is_empty(), "{:?}", image.warnings);
    let plane = |channel| image.pick(channel).unwrap()[0].clone();
    let inside = |value: f32, expected: f32| assert!((value - expected).abs() < 1e-3, "{value} is not {expected}");
    for x in 1..7 {
        inside(plane(Channel::R).at(x, 3), 1000.0);
        inside(plane(Channel::B).at(x, 3), 300.0);
        // In the middle of each cell, half a site right of its left column.
        inside(plane(Channel::G).at(x, 3), 500.0 + 10.0 * (2.0 * x as f32 + 0.5));
    }
    let size = picture_size(&path).unwrap();
    assert_eq!((size.width, size.height, size.channels), (8, 8, 3));
    let metadata = picture_metadata(&path).unwrap();
    assert_eq!((metadata.exposure_s, metadata.iso), (Some(0.02), Some(200.0)));
}

#[test]
fn a_pixel_of_a_raw_file_is_clipped_where_one_of_its_sites_is() {
    let folder = Folder::new();
    let bright = |x, y| if (x, y) == (6, 6) { WHITE } else { count(x, y) };
    let path = folder.file("left.dng", dng(bright));
    let clipped = |channel| {
        let options = LinearOptions { channel, ..LinearOptions::default() };
        let light = linearise([read_image(&path)], &options, &Corrections::default()).unwrap();
        light.photo.marks.data().iter().filter(|mark| **mark & CLIPPED != 0).count()
    };
    assert_eq!((clipped(Channel::R), clipped(Channel::G), clipped(Channel::B)), (4, 0, 0));
}

#[test]
fn a_raw_file_that_is_cut_off_is_one_clear_line() {
    let folder = Folder::new();
    let whole = dng(count);
    for length in [whole.len() / 4, whole.len() / 2, whole.len() - 100] {
        let error = read_image(&folder.file("left.dng", &whole[..length])).unwrap_err().to_string();
        assert!(error.contains("left.dng") && !error.contains('\n'), "{error}");
    }
    for start in [
        b"II*\0\x10\0\0\0CR\x02\0".as_slice(),
        b"FUJIFILMCCD-RAW 0201",
        b"\0\0\0\x18ftypcrx \0\0\0\x01",
        b"IIRO\x08\0\0\0",
    ] {
        let error = read_image(&folder.file("cut.nef", start)).unwrap_err();
        assert!(matches!(error, ImageError::Damaged { .. } | ImageError::Unsupported { .. }), "{error}");
    }
}

#[test]
fn pictures_of_phones_and_editors_are_named_in_the_message() {
    let folder = Folder::new();
    for (start, name) in [(b"\0\0\0\x18ftypheic".as_slice(), "HEIC"), (b"8BPS\0\x01\0\0", "Photoshop")] {
        let error = read_image(&folder.file("photo.tif", start)).unwrap_err().to_string();
        assert!(error.contains(name) && error.contains("export it"), "{error}");
    }
}
