//! What was put into a file comes out of it, to the last bit where the format allows.

use firstbounce_capture::image_file::{
    Content, ExrLayer, Format, GreenAxis, ImageError, ImageFile, ImageWarning, ReadOptions, grey16_png, layer_names,
    normals_png, preview_png, read_image, read_image_as, read_mask, write_exr,
};
use firstbounce_capture::set::Channel;
use firstbounce_core::Plane;
use image::{DynamicImage, ImageFormat};
use tiff::encoder::Compression;

use crate::codecs::tiff_of_tags;
use crate::pictures::*;

const PIXELS: usize = (WIDTH * HEIGHT) as usize;

fn read(name: &str, bytes: &[u8]) -> ImageFile {
    let folder = Folder::new();
    let image = read_image(&folder.file(name, bytes)).unwrap();
    assert_eq!(image.size(), (WIDTH as usize, HEIGHT as usize));
    image
}

/// The values of channel `index` of interleaved samples.
fn every_third<T: Copy>(values: &[T], index: usize) -> Vec<T> {
    values.iter().skip(index).step_by(3).copied().collect()
}

fn assert_bits(plane: &Plane, expected: &[f32]) {
    assert!(plane.data().iter().map(|v| v.to_bits()).eq(expected.iter().map(|v| v.to_bits())));
}

fn assert_grey(image: &ImageFile, expected: &[f32], maximum: Option<f32>) {
    assert_eq!(image.stored.maximum, maximum);
    assert_eq!(image.channels.len(), 1);
    assert_eq!(image.channels[0].0, Channel::Grey);
    assert_bits(&image.channels[0].1, expected);
}

fn assert_rgb(image: &ImageFile, interleaved: &[f32], maximum: Option<f32>) {
    assert_eq!(image.stored.maximum, maximum);
    let names: Vec<_> = image.channels.iter().map(|(name, _)| *name).collect();
    assert_eq!(names, [Channel::R, Channel::G, Channel::B]);
    for (index, (_, plane)) in image.channels.iter().enumerate() {
        assert_bits(plane, &every_third(interleaved, index));
    }
}

fn as_floats<T: Copy + Into<f32>>(values: &[T]) -> Vec<f32> {
    values.iter().map(|&value| value.into()).collect()
}

#[test]
fn sixteen_bit_png_is_exact() {
    let (grey, rgb) = (words(PIXELS), words(3 * PIXELS));
    let image = DynamicImage::ImageLuma16(image::ImageBuffer::from_raw(WIDTH, HEIGHT, grey.clone()).unwrap());
    let image = read("a.png", &encoded(&image, ImageFormat::Png));
    assert!(image.warnings.is_empty());
    assert_grey(&image, &as_floats(&grey), Some(65535.0));
    let image = DynamicImage::ImageRgb16(image::ImageBuffer::from_raw(WIDTH, HEIGHT, rgb.clone()).unwrap());
    assert_rgb(&read("a.png", &encoded(&image, ImageFormat::Png)), &as_floats(&rgb), Some(65535.0));
}

#[test]
fn alpha_is_dropped() {
    let grey_alpha = words(2 * PIXELS);
    let grey: Vec<u16> = grey_alpha.iter().step_by(2).copied().collect();
    let image = DynamicImage::ImageLumaA16(image::ImageBuffer::from_raw(WIDTH, HEIGHT, grey_alpha).unwrap());
    assert_grey(&read("a.png", &encoded(&image, ImageFormat::Png)), &as_floats(&grey), Some(65535.0));
    let rgba = image::RgbaImage::from_fn(WIDTH, HEIGHT, |x, y| image::Rgba([x as u8, y as u8, 3, 4]));
    let rgb: Vec<u8> = rgba.pixels().flat_map(|pixel| pixel.0[..3].to_vec()).collect();
    assert_rgb(&read("a.png", &encoded(&rgba.into(), ImageFormat::Png)), &as_floats(&rgb), Some(255.0));
}

#[test]
fn palette_and_one_bit_png_come_out_as_eight_bits() {
    // 16 x 1 with one bit a pixel, then 4 x 1 with two bits that name a colour of the palette.
    let one_bit = png_of(16, 1, png::ColorType::Grayscale, png::BitDepth::One, None, &[0b1010_0000, 0b0000_0001]);
    let folder = Folder::new();
    let image = read_image(&folder.file("mask.png", &one_bit)).unwrap();
    let expected = [255.0, 0.0, 255.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 255.0];
    assert_eq!(image.channels[0].1.data(), expected);
    let mask = read_mask(&folder.path("mask.png")).unwrap().mask;
    assert_eq!((mask.count(), mask.at(0, 0), mask.at(1, 0)), (3, true, false));

    let palette = [10, 20, 30, 40, 50, 60, 70, 80, 90];
    let indexed = png_of(4, 1, png::ColorType::Indexed, png::BitDepth::Two, Some(&palette), &[0b1000_0100]);
    let image = read_image(&folder.file("palette.png", &indexed)).unwrap();
    assert_eq!(image.channels[0].1.data(), [70.0, 10.0, 40.0, 10.0]);
    assert_eq!(image.channels[2].1.data(), [90.0, 30.0, 60.0, 30.0]);
}

fn png_of(
    w: u32,
    h: u32,
    colour: png::ColorType,
    depth: png::BitDepth,
    palette: Option<&[u8]>,
    data: &[u8],
) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, w, h);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    if let Some(palette) = palette {
        encoder.set_palette(palette.to_vec());
    }
    encoder.write_header().unwrap().write_image_data(data).unwrap();
    bytes
}

#[test]
fn eight_bits_and_jpeg_warn() {
    let rgb = image::RgbImage::from_pixel(WIDTH, HEIGHT, image::Rgb([100, 100, 100]));
    let png = read("a.png", &encoded(&rgb.clone().into(), ImageFormat::Png));
    assert_eq!(png.warnings, [ImageWarning::EightBit { path: png.path.clone() }]);
    let jpeg = read("a.JPG", &encoded(&rgb.into(), ImageFormat::Jpeg));
    let path = jpeg.path.clone();
    assert_eq!(jpeg.warnings, [ImageWarning::EightBit { path: path.clone() }, ImageWarning::ProbablySrgb { path }]);
    assert!(jpeg.channels[1].1.data().iter().all(|value| (value - 100.0).abs() <= 2.0));
}

#[test]
fn the_content_decides_and_a_wrong_name_warns() {
    let image = read("photo.tif", &encoded(&image::GrayImage::new(WIDTH, HEIGHT).into(), ImageFormat::Png));
    assert_eq!(image.format, Format::Png);
    assert!(image.warnings.contains(&ImageWarning::WrongExtension { path: image.path.clone(), format: Format::Png }));
}

#[test]
fn tiff_of_every_kind_is_exact() {
    let (grey, rgb) = (words(PIXELS), words(3 * PIXELS));
    for compression in
        [Compression::Uncompressed, Compression::Lzw, Compression::Deflate(Default::default()), Compression::Packbits]
    {
        assert_grey(&read("a.tif", &grey16_tiff(&grey, compression)), &as_floats(&grey), Some(65535.0));
    }
    assert_rgb(&read("a.tiff", &rgb16_tiff(&rgb)), &as_floats(&rgb), Some(65535.0));
    let bytes: Vec<u8> = rgb.iter().map(|value| (value >> 8) as u8).collect();
    let eight = read("a.tif", &rgb8_tiff(&bytes));
    assert_rgb(&eight, &as_floats(&bytes), Some(255.0));
    assert_eq!(eight.warnings, [ImageWarning::EightBit { path: eight.path.clone() }]);
    assert_grey(&read("a.tif", &grey32f_tiff(&floats(PIXELS))), &floats(PIXELS), None);
    assert_rgb(&read("a.tif", &rgb32f_tiff(&floats(3 * PIXELS))), &floats(3 * PIXELS), None);
}

/// Tags of a TIFF in the types that the standard gives them.
fn tags(width: u32, height: u32, bits: u32, samples: u32, format: u32) -> Vec<(u16, u16, Vec<u32>)> {
    let each = |value: u32| vec![value; samples as usize];
    let photometric = if samples == 3 { 2 } else { 1 };
    vec![
        (256, 4, vec![width]),
        (257, 4, vec![height]),
        (258, 3, each(bits)),
        (259, 3, vec![1]),
        (262, 3, vec![photometric]),
        (277, 3, vec![samples]),
        (339, 3, each(format)),
    ]
}

#[test]
fn tiff_in_tiles_is_exact() {
    // 20 x 18 pixels in tiles of 16 x 16, padded at the right and the bottom.
    let value = |x: usize, y: usize| (1000 * y + x) as u16;
    let tile = |left: usize, top: usize| -> Vec<u8> {
        (0..256).flat_map(|i| value(left + i % 16, top + i / 16).to_le_bytes()).collect()
    };
    let tiles = [tile(0, 0), tile(16, 0), tile(0, 16), tile(16, 16)];
    let mut tags = tags(20, 18, 16, 1, 1);
    tags.extend([(322, 4, vec![16]), (323, 4, vec![16]), (325, 4, vec![512; 4])]);
    let folder = Folder::new();
    let image = read_image(&folder.file("tiles.tif", tiff_of_tags(tags, &tiles, 324))).unwrap();
    assert_eq!(image.channels[0].1, Plane::from_fn(20, 18, |x, y| f32::from(value(x, y))));
}

#[test]
fn tiff_plane_by_plane_is_exact() {
    let strip = |colour: u16| -> Vec<u8> { (0..12_u16).flat_map(|i| (100 * colour + i).to_le_bytes()).collect() };
    let mut tags = tags(4, 3, 16, 3, 1);
    tags.extend([(278, 4, vec![3]), (279, 4, vec![24; 3]), (284, 3, vec![2])]);
    let folder = Folder::new();
    let file = folder.file("planes.tif", tiff_of_tags(tags, &[strip(1), strip(2), strip(3)], 273));
    let image = read_image(&file).unwrap();
    for (colour, (_, plane)) in image.channels.iter().enumerate() {
        assert_eq!(*plane, Plane::from_fn(4, 3, |x, y| (100 * (colour + 1) + 4 * y + x) as f32));
    }
}

#[test]
fn tiff_of_32_bit_integers_64_bit_floats_and_one_bit() {
    let folder = Folder::new();
    let strip = |mut tags: Vec<_>, bytes: &[u8]| {
        tags.extend([(278, 4, vec![1]), (279, 4, vec![bytes.len() as u32])]);
        read_image(&folder.file("a.tif", tiff_of_tags(tags, &[bytes.to_vec()], 273))).unwrap()
    };
    let long = strip(tags(2, 1, 32, 1, 1), &[1_u32 << 31, u32::MAX].map(u32::to_le_bytes).concat());
    assert_eq!(long.channels[0].1.data(), [2_147_483_648.0, 4_294_967_295_u32 as f32]);
    assert_eq!(long.stored.maximum, Some(u32::MAX as f32));
    let double = strip(tags(2, 1, 64, 1, 3), &[0.1_f64, 7.5].map(f64::to_le_bytes).concat());
    assert_eq!(double.channels[0].1.data(), [0.1, 7.5]);
    let bilevel = strip(tags(10, 1, 1, 1, 1), &[0b1001_0000, 0b0100_0000]);
    assert_eq!(bilevel.channels[0].1.data(), [1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    assert_eq!(bilevel.stored.maximum, Some(1.0));
}

#[test]
fn hdr_keeps_light_beyond_one_within_its_8_bit_mantissa() {
    let light = |x: u32, y: u32| [0.001 * x as f32 + 0.5, 40.0 + y as f32, 0.25];
    let rgb = image::Rgb32FImage::from_fn(WIDTH, HEIGHT, |x, y| image::Rgb(light(x, y)));
    let image = read("a.hdr", &encoded(&rgb.into(), ImageFormat::Hdr));
    assert_eq!(image.stored.maximum, None);
    for y in 0..HEIGHT {
        let expected = light(3, y);
        let stored: Vec<f32> = image.channels.iter().map(|(_, plane)| plane.at(3, y as usize)).collect();
        assert!((stored[1] - expected[1]).abs() <= expected[1] / 128.0, "{stored:?} {expected:?}");
        assert!((stored[0] - expected[0]).abs() <= expected[1] / 128.0);
    }
}

#[test]
fn pfm_of_both_byte_orders_is_exact() {
    for little_endian in [true, false] {
        assert_grey(&read("a.pfm", &pfm("Pf", &floats(PIXELS), little_endian)), &floats(PIXELS), None);
        assert_rgb(&read("a.pfm", &pfm("PF", &floats(3 * PIXELS), little_endian)), &floats(3 * PIXELS), None);
    }
}

#[test]
fn exr_returns_what_was_written_layer_by_layer() {
    let folder = Folder::new();
    let path = folder.path("bounces.exr");
    let negative: Vec<f32> = floats(PIXELS).iter().map(|value| -value).collect();
    let (a, b) = (plane(&floats(PIXELS)), plane(&negative));
    let first = ExrLayer { name: "bounce 1", channels: vec![("Y", &a)] };
    let second = ExrLayer { name: "bounce 2", channels: vec![("R", &a), ("G", &b), ("B", &a)] };
    write_exr(&path, &[first, second]).unwrap();
    assert_eq!(layer_names(&path).unwrap(), ["bounce 1", "bounce 2"]);

    let layer = |name: &str| ReadOptions { content: Content::Data, layer: Some(name.into()) };
    assert_grey(&read_image_as(&path, &layer("bounce 1")).unwrap(), a.data(), None);
    let rgb = read_image_as(&path, &layer("bounce 2")).unwrap();
    assert_bits(&rgb.channels[0].1, a.data());
    assert_bits(&rgb.channels[1].1, b.data());
    let names = |error: ImageError| error.to_string();
    assert!(names(read_image_as(&path, &layer("bounce 3")).unwrap_err()).contains("\"bounce 1\", \"bounce 2\""));
    assert!(matches!(read_image(&path), Err(ImageError::NoLayer { wanted: None, .. })));
}

#[test]
fn exr_layers_of_other_programs_are_prefixes_of_channel_names() {
    let folder = Folder::new();
    let (a, b) = (plane(&floats(PIXELS)), plane(&[0.5; PIXELS]));
    let channels = vec![("direct.Y", &a), ("indirect.depth", &b), ("A", &b), ("Z", &b)];
    let path = folder.path("prefixed.exr");
    write_exr(&path, &[ExrLayer { name: "view", channels }]).unwrap();
    assert_eq!(layer_names(&path).unwrap(), ["view", "view.direct", "view.indirect"]);
    for (name, expected) in [("view.direct", &a), ("view.indirect", &b), ("view", &b)] {
        let options = ReadOptions { layer: Some(name.into()), ..ReadOptions::default() };
        assert_bits(&read_image_as(&path, &options).unwrap().channels[0].1, expected.data());
    }
}

#[test]
fn normals_go_out_in_either_convention_and_come_back_within_half_a_step() {
    let tilted = [0.48_f32, 0.6, 0.64];
    let planes = tilted.map(|n| Plane::from_fn(2, 1, |x, _| if x == 0 { n } else { 0.0 }));
    let [x, y, z] = &planes;
    let folder = Folder::new();
    for (green, sign) in [(GreenAxis::Up, 1.0), (GreenAxis::Down, -1.0)] {
        let file = folder.file("normals.png", normals_png([x, y, z], green).unwrap());
        let image = read_image(&file).unwrap();
        for ((_, plane), expected) in image.channels.iter().zip([tilted[0], sign * tilted[1], tilted[2]]) {
            assert!((plane.at(0, 0) / 65535.0 * 2.0 - 1.0 - expected).abs() < 1.01 / 65535.0);
            assert_eq!(plane.at(1, 0), 0.0, "no normal is black");
        }
    }
}

#[test]
fn grey_and_preview_pngs_hold_what_they_promise() {
    let folder = Folder::new();
    let light = Plane::from_vec(4, 1, vec![-0.5, 0.25, 1.0, 3.0]).unwrap();
    let grey = read_image(&folder.file("grey.png", grey16_png(&light, 2.0).unwrap())).unwrap();
    assert_eq!(grey.channels[0].1.data(), [0.0, 8192.0, 32768.0, 65535.0]);
    // Linear 0.2140 is sRGB 0.5 (IEC 61966-2-1).
    let light = Plane::from_vec(3, 1, vec![0.0, 0.107_02, 9.0]).unwrap();
    let preview = read_image(&folder.file("preview.png", preview_png(&[&light], 2.0).unwrap())).unwrap();
    assert_eq!(preview.channels[0].1.data(), [0.0, 127.0, 255.0]);
    assert_eq!(read_image(&folder.file("p.png", preview_png(&[&light; 3], 2.0).unwrap())).unwrap().channels.len(), 3);
}
