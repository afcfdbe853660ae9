//! Masks as picture editors save them.

use firstbounce_capture::image_file::{ImageWarning, MaskFile, read_mask};
use image::{DynamicImage, ImageFormat};

use crate::pictures::{Folder, encoded};

/// A disc in the middle of the picture.
fn is_object(x: u32, y: u32) -> bool {
    (f64::from(x) - 31.5).hypot(f64::from(y) - 31.5) < 20.0
}

fn read(name: &str, bytes: &[u8]) -> MaskFile {
    read_mask(&Folder::new().file(name, bytes)).unwrap()
}

fn assert_disc(read: &MaskFile, slack: usize) {
    let wrong = (0..64 * 64).filter(|i| read.mask.data()[*i] != is_object(*i as u32 % 64, *i as u32 / 64)).count();
    assert!(wrong <= slack, "{wrong} pixels are wrong");
}

fn grey(value: impl Fn(u32, u32) -> u8) -> DynamicImage {
    image::GrayImage::from_fn(64, 64, |x, y| image::Luma([value(x, y)])).into()
}

#[test]
fn transparency_is_the_mask_where_it_varies() {
    let rgba = image::RgbaImage::from_fn(64, 64, |x, y| image::Rgba([200, 180, 90, 255 * u8::from(is_object(x, y))]));
    let read_rgba = read("mask.png", &encoded(&rgba.into(), ImageFormat::Png));
    assert_disc(&read_rgba, 0);
    assert!(read_rgba.warnings.is_empty());
    let opaque = image::RgbaImage::from_fn(64, 64, |x, y| image::Rgba([255 * u8::from(is_object(x, y)), 0, 0, 255]));
    assert_disc(&read("mask.png", &encoded(&opaque.into(), ImageFormat::Png)), 0);
}

#[test]
fn a_background_that_is_not_quite_black_is_no_object() {
    let two = read("mask.png", &encoded(&grey(|x, y| if is_object(x, y) { 255 } else { 8 }), ImageFormat::Png));
    assert_disc(&two, 0);
    assert!(two.warnings.is_empty());
    let ones = read("mask.png", &encoded(&grey(|x, y| u8::from(is_object(x, y))), ImageFormat::Png));
    assert_disc(&ones, 0);
}

#[test]
fn ringing_of_jpeg_and_soft_edges_are_cut_at_half_with_a_warning() {
    let hard = grey(|x, y| 255 * u8::from(is_object(x, y)));
    let ringing = read("mask.jpg", &encoded(&hard, ImageFormat::Jpeg));
    assert_disc(&ringing, 20);
    assert!(matches!(ringing.warnings[..], [ImageWarning::MaskManyValues { .. }]), "{:?}", ringing.warnings);
    let soft = DynamicImage::ImageLuma8(image::GrayImage::from_fn(64, 64, |x, y| {
        let inside = 20.5 - (f64::from(x) - 31.5).hypot(f64::from(y) - 31.5);
        image::Luma([(255.0 * inside.clamp(0.0, 1.0)) as u8])
    }));
    let soft = read("mask.png", &encoded(&soft, ImageFormat::Png));
    assert_disc(&soft, 0);
    assert!(soft.warnings[0].to_string().contains("more than two values"));
}

#[test]
fn of_a_palette_the_indices_count_and_not_the_colours() {
    for (palette, background) in
        [([0, 0, 128, 255, 255, 0], 0), ([255, 255, 255, 0, 0, 0], 1), ([0, 0, 0, 128, 0, 0], 0)]
    {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, 64, 64);
        encoder.set_color(png::ColorType::Indexed);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_palette(palette.to_vec());
        let indices: Vec<u8> =
            (0..64 * 64).map(|i| if is_object(i % 64, i / 64) { 1 - background } else { background }).collect();
        encoder.write_header().unwrap().write_image_data(&indices).unwrap();
        let by_index = read("mask.png", &bytes);
        assert_disc(&by_index, 0);
        assert!(by_index.warnings.is_empty());
    }
}

#[test]
fn a_mask_of_the_whole_picture_is_named() {
    let whole = read("mask.png", &encoded(&grey(|_, _| 255), ImageFormat::Png));
    assert!(matches!(whole.warnings[..], [ImageWarning::MaskWhole { .. }]));
    assert!(whole.warnings[0].to_string().contains("whole picture"));
    assert_eq!(read("mask.png", &encoded(&grey(|_, _| 0), ImageFormat::Png)).mask.count(), 0);
}
