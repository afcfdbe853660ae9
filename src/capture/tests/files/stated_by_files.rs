//! What a file says of itself: the curve of its values, how and when it was taken.

use std::f64::consts::FRAC_PI_2;
use std::io::Cursor;
use std::path::Path;

use exif::experimental::Writer;
use exif::{Field, In, Rational as Fraction, Value};
use firstbounce_capture::image_file::{
    Corrections, ImageWarning, LinearLight, LinearOptions, Metadata, StatedCurve, grey16_png, linearise_files,
    picture_metadata, read_image,
};
use firstbounce_capture::set::Encoding;
use firstbounce_core::Plane;
use image::ImageFormat;
use moxcms::ColorProfile;
use tiff::encoder::colortype::Gray16;
use tiff::encoder::{Rational, TiffEncoder};
use tiff::tags::Tag;

use crate::codecs::chunk;
use crate::pictures::{Folder, encoded};

/// What is stored, and the light that the sRGB curve makes of it.
const STORED: f32 = 0.5;
const SRGB_LIGHT: f32 = 0.214_041;

fn words() -> Vec<u16> {
    vec![(STORED * 65535.0).round() as u16; 12]
}

/// A 16-bit TIFF with a colour profile, and with the tags of EXIF in a directory of their own.
fn tiff(profile: Option<&[u8]>, exposure: Option<(u32, u32)>) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    let exif = exposure.map(|(n, d)| {
        let mut exif = encoder.extra_directory().unwrap();
        exif.write_tag(Tag::Unknown(0x829a), Rational { n, d }).unwrap();
        exif.write_tag(Tag::Unknown(0x829d), Rational { n: 8, d: 1 }).unwrap();
        exif.write_tag(Tag::Unknown(0x8827), 200_u16).unwrap();
        exif.write_tag(Tag::Unknown(0x9003), "2026:05:31 14:02:59").unwrap();
        exif.write_tag(Tag::Unknown(0x920a), Rational { n: 50, d: 1 }).unwrap();
        exif.finish_with_offsets().unwrap().offset
    });
    let mut picture = encoder.new_image::<Gray16>(4, 3).unwrap();
    if let Some(profile) = profile {
        picture.encoder().write_tag(Tag::IccProfile, profile).unwrap();
    }
    if let Some(place) = exif {
        picture.encoder().write_tag(Tag::ExifDirectory, place).unwrap();
    }
    picture.encoder().write_tag(Tag::Orientation, 6_u16).unwrap();
    picture.write_data(&words()).unwrap();
    bytes.into_inner()
}

/// A 16-bit PNG with a chunk before its pixels.
fn png(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let plain = grey16_png(&Plane::filled(4, 3, STORED), 1.0).unwrap();
    let (header, rest) = plain.split_at(33);
    [header, &chunk(kind, data), rest].concat()
}

fn exif_block(fields: &[(exif::Tag, Value)]) -> Vec<u8> {
    let fields: Vec<Field> =
        fields.iter().map(|(tag, value)| Field { tag: *tag, ifd_num: In::PRIMARY, value: value.clone() }).collect();
    let mut writer = Writer::new();
    fields.iter().for_each(|field| writer.push_field(field));
    let mut block = Cursor::new(Vec::new());
    writer.write(&mut block, true).unwrap();
    block.into_inner()
}

/// A JPEG with a segment of EXIF.
fn jpeg(fields: &[(exif::Tag, Value)]) -> Vec<u8> {
    let grey = image::GrayImage::from_pixel(4, 3, image::Luma([128]));
    let plain = encoded(&grey.into(), ImageFormat::Jpeg);
    let block = [b"Exif\0\0".as_slice(), &exif_block(fields)].concat();
    let length = (block.len() as u16 + 2).to_be_bytes();
    [&plain[..2], &[0xff, 0xe1], &length, &block, &plain[2..]].concat()
}

fn linear(path: &Path, encoding: Option<Encoding>) -> LinearLight {
    linearise_files(&[path], &LinearOptions { encoding, ..LinearOptions::default() }, &Corrections::default()).unwrap()
}

fn light_of(light: &LinearLight) -> f32 {
    light.photo.linear.data()[0]
}

#[test]
fn a_sixteen_bit_file_with_an_srgb_or_gamma_profile_is_undone_and_reported() {
    let folder = Folder::new();
    let srgb = ColorProfile::new_srgb().encode().unwrap();
    let gamma = ColorProfile::new_gray_with_gamma(2.2).encode().unwrap();
    for (name, bytes, expected) in [
        ("srgb.tif", tiff(Some(&srgb), None), SRGB_LIGHT),
        ("gamma.tif", tiff(Some(&gamma), None), STORED.powf(2.2)),
        ("gamma.png", png(b"gAMA", &45455_u32.to_be_bytes()), STORED.powf(2.2)),
        ("srgb.png", png(b"sRGB", &[0]), SRGB_LIGHT),
        ("cicp.png", png(b"cICP", &[1, 13, 0, 1]), SRGB_LIGHT),
    ] {
        let light = linear(&folder.file(name, bytes), None);
        assert!((light_of(&light) - expected).abs() < 1e-3, "{name}: {}", light_of(&light));
        assert!(matches!(light.warnings[..], [ImageWarning::CurveUndone { .. }]), "{name}: {:?}", light.warnings);
        assert!(light.warnings[0].to_string().contains(name));
    }
}

#[test]
fn a_linear_profile_or_none_is_silent() {
    let folder = Folder::new();
    let linear_profile = ColorProfile::new_gray_with_gamma(1.0).encode().unwrap();
    for (name, bytes) in [
        ("plain.tif", tiff(None, None)),
        ("linear.tif", tiff(Some(&linear_profile), None)),
        ("linear.png", png(b"gAMA", &100_000_u32.to_be_bytes())),
        ("lie.png", png(b"gAMA", &0_u32.to_be_bytes())),
    ] {
        let light = linear(&folder.file(name, bytes), None);
        assert!(light.warnings.is_empty() && (light_of(&light) - STORED).abs() < 1e-4, "{name}: {:?}", light.warnings);
    }
}

#[test]
fn what_the_capture_file_states_is_believed_and_a_file_that_contradicts_it_is_named() {
    let folder = Folder::new();
    let path = folder.file("left.png", png(b"sRGB", &[0]));
    let believed = linear(&path, Some(Encoding::Linear));
    assert!((light_of(&believed) - STORED).abs() < 1e-4);
    assert!(matches!(believed.warnings[..], [ImageWarning::CurveContradicted { .. }]), "{:?}", believed.warnings);
    assert!(believed.warnings[0].to_string().contains("capture.toml says linear light"));
    assert!(linear(&path, Some(Encoding::Srgb)).warnings.is_empty(), "both say the same");
}

#[test]
fn a_profile_that_cannot_be_undone_or_is_damaged_is_named_with_its_remedy() {
    let folder = Folder::new();
    let mut dot_gain = ColorProfile::new_gray_with_gamma(1.0);
    let table = (0..256).map(|x| (65535.0 * (1.0 - f64::cos(f64::from(x) / 255.0 * FRAC_PI_2)) as f32) as u16);
    dot_gain.gray_trc = Some(moxcms::ToneReprCurve::Lut(table.collect()));
    let srgb = ColorProfile::new_srgb().encode().unwrap();
    for profile in [dot_gain.encode().unwrap(), srgb[..srgb.len() / 2].to_vec(), vec![7; 200]] {
        let path = folder.file("left.tif", tiff(Some(&profile), None));
        let light = linear(&path, None);
        let [warning @ ImageWarning::CurveUnknown { .. }] = &light.warnings[..] else { panic!("{:?}", light.warnings) };
        assert!(warning.to_string().contains("set encoding"), "{warning}");
        assert!(linear(&path, Some(Encoding::Linear)).warnings.is_empty(), "the capture file knows better");
    }
}

#[test]
fn exposure_aperture_sensitivity_time_and_focal_length_are_read_from_every_format_that_has_them() {
    let folder = Folder::new();
    let fields = [
        (exif::Tag::ExposureTime, Value::Rational(vec![Fraction { num: 1, denom: 50 }])),
        (exif::Tag::FNumber, Value::Rational(vec![Fraction { num: 8, denom: 1 }])),
        (exif::Tag::PhotographicSensitivity, Value::Short(vec![200])),
        (exif::Tag::DateTimeOriginal, Value::Ascii(vec![b"2026:05:31 14:02:59".to_vec()])),
        (exif::Tag::FocalLength, Value::Rational(vec![Fraction { num: 50, denom: 1 }])),
        (exif::Tag::Orientation, Value::Short(vec![6])),
    ];
    for (name, bytes) in
        [("a.tif", tiff(None, Some((1, 50)))), ("a.jpg", jpeg(&fields)), ("a.png", png(b"eXIf", &exif_block(&fields)))]
    {
        let path = folder.file(name, bytes);
        let metadata = picture_metadata(&path).unwrap();
        assert_eq!(metadata.to_string(), "1/50 s, f/8, ISO 200, 50 mm, 2026-05-31T14:02:59", "{name}");
        assert_eq!(metadata.orientation, Some(6));
        assert_eq!(read_image(&path).unwrap().metadata, metadata);
    }
}

#[test]
fn exif_that_lies_is_passed_over() {
    let folder = Folder::new();
    let metadata = picture_metadata(&folder.file("a.tif", tiff(None, Some((0, 0))))).unwrap();
    assert_eq!((metadata.exposure_s, metadata.iso), (None, Some(200.0)));
    let fields = [
        (exif::Tag::ExposureTime, Value::Rational(vec![Fraction { num: 1, denom: 0 }])),
        (exif::Tag::DateTimeOriginal, Value::Ascii(vec![b"0000:00:00 00:00:00".to_vec()])),
    ];
    let lies = picture_metadata(&folder.file("a.png", png(b"eXIf", &exif_block(&fields)))).unwrap();
    assert_eq!(lies, Metadata::default());
    let garbage = folder.file("b.png", png(b"eXIf", &[0x4d; 40]));
    assert_eq!(picture_metadata(&garbage).unwrap(), Metadata::default());
    assert!(read_image(&garbage).is_ok());
}

#[test]
fn a_jpeg_whose_exif_says_srgb_is_undone_and_one_that_says_nothing_is_asked_about() {
    let folder = Folder::new();
    let tagged = folder.file("a.jpg", jpeg(&[(exif::Tag::ColorSpace, Value::Short(vec![1]))]));
    assert_eq!(picture_metadata(&tagged).unwrap().curve, StatedCurve::Known(Encoding::Srgb));
    let light = linear(&tagged, None);
    assert!((light_of(&light) - SRGB_LIGHT).abs() < 0.01, "{}", light_of(&light));
    let untagged = folder.file("b.jpg", jpeg(&[(exif::Tag::Orientation, Value::Short(vec![1]))]));
    let asks = |encoding| {
        let warnings = linear(&untagged, encoding).warnings;
        warnings.iter().any(|warning| matches!(warning, ImageWarning::ProbablySrgb { .. }))
    };
    assert!(asks(None) && !asks(Some(Encoding::Srgb)) && !asks(Some(Encoding::Linear)));
}
