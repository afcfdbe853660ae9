//! Small pictures in every format, made by other code than the readers under test.

use std::fs;
use std::io::Cursor;

use firstbounce_capture::image_file::{ExrLayer, write_exr};
use firstbounce_core::Plane;
pub use firstbounce_testing::Folder;
use image::{DynamicImage, ImageFormat};
use tiff::encoder::colortype::{Gray16, Gray32Float, RGB8, RGB16, RGB32Float};
use tiff::encoder::{Compression, TiffEncoder};

pub const WIDTH: u32 = 21;
pub const HEIGHT: u32 = 14;

/// `count` different 16-bit values, both ends among them.
pub fn words(count: usize) -> Vec<u16> {
    (0..count).map(|i| if i == 1 { u16::MAX } else { (i * 7919 % 65536) as u16 }).collect()
}

/// Values that floats must keep: beyond 1, denormal, zero.
pub fn floats(count: usize) -> Vec<f32> {
    let odd = [0.0, f32::from_bits(1), 1.0e-40, 1.0, 1.5, 12345.678, 3.0e38];
    (0..count).map(|i| odd.get(i).copied().unwrap_or(i as f32 * 0.0137)).collect()
}

pub fn encoded(image: &DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, format).unwrap();
    bytes.into_inner()
}

pub fn grey16_tiff(values: &[u16], compression: Compression) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap().with_compression(compression);
    encoder.write_image::<Gray16>(WIDTH, HEIGHT, values).unwrap();
    bytes.into_inner()
}

pub fn rgb16_tiff(values: &[u16]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    TiffEncoder::new(&mut bytes).unwrap().write_image::<RGB16>(WIDTH, HEIGHT, values).unwrap();
    bytes.into_inner()
}

pub fn rgb8_tiff(values: &[u8]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    TiffEncoder::new(&mut bytes).unwrap().write_image::<RGB8>(WIDTH, HEIGHT, values).unwrap();
    bytes.into_inner()
}

pub fn grey32f_tiff(values: &[f32]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    TiffEncoder::new(&mut bytes).unwrap().write_image::<Gray32Float>(WIDTH, HEIGHT, values).unwrap();
    bytes.into_inner()
}

pub fn rgb32f_tiff(values: &[f32]) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap().with_compression(Compression::Deflate(Default::default()));
    encoder.write_image::<RGB32Float>(WIDTH, HEIGHT, values).unwrap();
    bytes.into_inner()
}

pub fn pfm(magic: &str, values: &[f32], little_endian: bool) -> Vec<u8> {
    let row = values.len() / HEIGHT as usize;
    let mut bytes = format!("{magic}\n{WIDTH} {HEIGHT}\n{}\n", if little_endian { "-1.0" } else { "1.0" }).into_bytes();
    for row in values.chunks_exact(row).rev() {
        let encode = if little_endian { f32::to_le_bytes } else { f32::to_be_bytes };
        bytes.extend(row.iter().flat_map(|&value| encode(value)));
    }
    bytes
}

pub fn plane(values: &[f32]) -> Plane {
    Plane::from_vec(WIDTH as usize, HEIGHT as usize, values.to_vec()).unwrap()
}

/// One sound file of each kind that is read: name and bytes.
pub fn one_of_each() -> Vec<(&'static str, Vec<u8>)> {
    let pixels = (WIDTH * HEIGHT) as usize;
    let rgb8 = image::RgbImage::from_fn(WIDTH, HEIGHT, |x, y| image::Rgb([x as u8 * 9, y as u8 * 17, 77]));
    let rgb16 = image::ImageBuffer::from_raw(WIDTH, HEIGHT, words(3 * pixels)).unwrap();
    let grey16 = image::ImageBuffer::from_raw(WIDTH, HEIGHT, words(pixels)).unwrap();
    let rgb32f = image::Rgb32FImage::from_fn(WIDTH, HEIGHT, |x, y| image::Rgb([x as f32, y as f32 * 0.1, 0.5]));
    let folder = Folder::new();
    let values = plane(&floats(pixels));
    let layer = |name| ExrLayer { name, channels: vec![("R", &values), ("G", &values), ("B", &values)] };
    write_exr(&folder.path("one.exr"), &[ExrLayer { name: "only", channels: vec![("Y", &values)] }]).unwrap();
    write_exr(&folder.path("two.exr"), &[layer("bounce 1"), layer("bounce 2")]).unwrap();
    vec![
        ("rgb16.png", encoded(&DynamicImage::ImageRgb16(rgb16), ImageFormat::Png)),
        ("grey16.png", encoded(&DynamicImage::ImageLuma16(grey16), ImageFormat::Png)),
        ("rgb8.png", encoded(&rgb8.clone().into(), ImageFormat::Png)),
        ("rgb8.jpg", encoded(&rgb8.into(), ImageFormat::Jpeg)),
        ("rgb.hdr", encoded(&rgb32f.into(), ImageFormat::Hdr)),
        ("grey.pfm", pfm("Pf", &floats(pixels), true)),
        ("rgb.pfm", pfm("PF", &floats(3 * pixels), false)),
        ("lzw.tif", grey16_tiff(&words(pixels), Compression::Lzw)),
        ("plain.tif", grey16_tiff(&words(pixels), Compression::Uncompressed)),
        ("float.tif", rgb32f_tiff(&floats(3 * pixels))),
        ("one.exr", fs::read(folder.path("one.exr")).unwrap()),
        ("two.exr", fs::read(folder.path("two.exr")).unwrap()),
    ]
}
