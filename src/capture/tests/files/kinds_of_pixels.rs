//! Kinds of pixels that cameras and picture editors write beside the usual ones.

use firstbounce_capture::image_file::{
    Corrections, ExrLayer, ImageFile, ImageWarning, LinearOptions, ReadOptions, linearise, read_image, read_image_as,
    write_exr,
};
use firstbounce_core::Plane;
use firstbounce_core::image::photo::{CLIPPED, DARK};
use image::{DynamicImage, ImageFormat};
use tiff::encoder::TiffEncoder;
use tiff::encoder::colortype::{Gray16, YCbCr8};

use crate::codecs::tiff_of_tags;
use crate::pictures::*;

/// A TIFF of one strip and one row: its samples' bits, how many a pixel has, and what they are.
fn row(
    width: u32,
    (bits, samples, photometric): (u32, u32, u32),
    more: &[(u16, u16, Vec<u32>)],
    strip: &[u8],
) -> Vec<u8> {
    let mut tags = vec![
        (256, 4, vec![width]),
        (257, 4, vec![1]),
        (258, 3, vec![bits; samples as usize]),
        (259, 3, vec![1]),
        (262, 3, vec![photometric]),
        (277, 3, vec![samples]),
        (278, 4, vec![1]),
        (279, 4, vec![strip.len() as u32]),
    ];
    tags.extend_from_slice(more);
    tiff_of_tags(tags, &[strip.to_vec()], 273)
}

fn read(name: &str, bytes: &[u8]) -> ImageFile {
    let folder = Folder::new();
    read_image(&folder.file(name, bytes)).unwrap()
}

fn values(image: &ImageFile, channel: usize) -> &[f32] {
    image.channels[channel].1.data()
}

#[test]
fn a_grey_tiff_with_alpha_is_read_as_its_grey() {
    let strip: Vec<u8> = [7_u16, 65535, 300, 0].iter().flat_map(|value| value.to_le_bytes()).collect();
    for extra in [vec![], vec![(338, 3, vec![2])]] {
        let image = read("a.tif", &row(2, (16, 2, 1), &extra, &strip));
        assert_eq!((image.channels.len(), values(&image, 0)), (1, [7.0, 300.0].as_slice()));
    }
}

#[test]
fn a_tiff_with_a_colour_map_is_read_by_it() {
    let mut map = vec![0; 3 * 256];
    (map[5], map[256 + 5], map[512 + 5]) = (257 * 10, 257 * 20, 257 * 30);
    let image = read("a.tif", &row(3, (8, 1, 3), &[(320, 3, map)], &[0, 5, 5]));
    assert_eq!(image.channels.iter().map(|(_, plane)| plane.at(1, 0)).collect::<Vec<_>>(), [10.0, 20.0, 30.0]);
    assert_eq!((values(&image, 0), image.stored.maximum), ([0.0, 10.0, 10.0].as_slice(), Some(255.0)));
    let mut four_bits = vec![0; 3 * 16];
    four_bits[16 + 2] = 65535;
    let image = read("a.tif", &row(3, (4, 1, 3), &[(320, 3, four_bits)], &[0x20, 0x20]));
    assert_eq!(values(&image, 1), [255.0, 0.0, 255.0]);
}

#[test]
fn a_tiff_of_luma_and_chroma_becomes_red_green_and_blue() {
    // The three of a pure red, and of a grey.
    let pixels = [76, 85, 255, 100, 128, 128];
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    let mut picture = encoder.new_image::<YCbCr8>(2, 1).unwrap();
    picture.encoder().write_tag(tiff::tags::Tag::ChromaSubsampling, &[1_u16, 1][..]).unwrap();
    picture.write_data(&pixels).unwrap();
    let image = read("a.tif", &bytes.into_inner());
    for (channel, expected) in [[254.0, 100.0], [0.0, 100.0], [0.0, 100.0]].iter().enumerate() {
        let error = values(&image, channel).iter().zip(expected).map(|(value, expected)| (value - expected).abs());
        assert!(error.fold(0.0, f32::max) <= 1.0, "{:?}", values(&image, channel));
    }
}

#[test]
fn packed_samples_of_10_12_and_14_bits_are_exact() {
    let packed = |values: &[u32], bits: usize| -> Vec<u8> {
        let all: Vec<bool> = values.iter().flat_map(|v| (0..bits).rev().map(move |bit| v >> bit & 1 == 1)).collect();
        all.chunks(8).map(|byte| byte.iter().enumerate().map(|(at, bit)| u8::from(*bit) << (7 - at)).sum()).collect()
    };
    for bits in [10_usize, 12, 14] {
        let top = (1 << bits) - 1;
        let grey = [0, 1, top, top / 3, 512];
        let image = read("a.tif", &row(5, (bits as u32, 1, 1), &[], &packed(&grey, bits)));
        assert_eq!(values(&image, 0), grey.map(|value| value as f32), "{bits} bits");
        assert_eq!(image.stored.maximum, Some(top as f32));
        let rgb = read("a.tif", &row(1, (bits as u32, 3, 2), &[], &packed(&grey[1..4], bits)));
        assert_eq!([values(&rgb, 0)[0], values(&rgb, 1)[0], values(&rgb, 2)[0]], [1.0, top as f32, (top / 3) as f32]);
    }
}

#[test]
fn a_page_that_is_marked_reduced_is_passed_over() {
    let mut bytes = std::io::Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    for (reduced, value) in [(1_u32, 9_u16), (0, 1000)] {
        let mut picture = encoder.new_image::<Gray16>(2, 1).unwrap();
        picture.encoder().write_tag(tiff::tags::Tag::NewSubfileType, reduced).unwrap();
        picture.write_data(&[value; 2]).unwrap();
    }
    assert_eq!(values(&read("a.tif", &bytes.into_inner()), 0), [1000.0; 2]);

    let only = row(2, (8, 1, 1), &[(254, 4, vec![1])], &[1, 2]);
    let error = read_image(&Folder::new().file("a.nef", only)).unwrap_err().to_string();
    assert!(error.contains("reduced previews") && !error.contains("rename"), "{error}");
}

#[test]
fn bitmaps_of_windows_and_portable_maps_are_read_as_they_are_stored() {
    let rgb = image::RgbImage::from_fn(5, 4, |x, y| image::Rgb([x as u8 * 9, y as u8 * 17, 77]));
    let bmp = read("a.BMP", &encoded(&rgb.clone().into(), ImageFormat::Bmp));
    assert_eq!(bmp.channels[0].1, Plane::from_fn(5, 4, |x, _| (x * 9) as f32));
    assert_eq!(bmp.warnings, [ImageWarning::EightBit { path: bmp.path.clone() }]);
    let ppm = read("a.ppm", &encoded(&DynamicImage::ImageRgb8(rgb), ImageFormat::Pnm));
    assert_eq!(ppm.channels[1].1, Plane::from_fn(5, 4, |_, y| (y * 17) as f32));

    let twelve_bits = read("a.pgm", b"P5\n# camera\n3 1\n4095\n\x00\x00\x0f\xff\x01\x02");
    assert_eq!((values(&twelve_bits, 0), twelve_bits.stored.maximum), ([0.0, 4095.0, 258.0].as_slice(), Some(4095.0)));
    assert!(twelve_bits.warnings.is_empty());
    assert_eq!(values(&read("a.pgm", b"P2\n2 1\n1000\n1 999\n"), 0), [1.0, 999.0]);
    assert!(read_image(&Folder::new().file("cut.pgm", b"P5\n30 10\n255\nabc")).is_err());
}

#[test]
fn an_exr_with_colours_beside_other_layers_needs_no_choice_and_obeys_one() {
    let folder = Folder::new();
    let (light, other) = (plane(&[0.25; 294]), plane(&[0.5; 294]));
    let colours = |plane| vec![("R", plane), ("G", plane), ("B", plane)];
    let depth = || ExrLayer { name: "depth", channels: vec![("Z", &other)] };
    let path = folder.path("layers.exr");
    write_exr(&path, &[depth(), ExrLayer { name: "beauty", channels: colours(&light) }]).unwrap();
    assert_eq!(read_image(&path).unwrap().channels[0].1, light);
    let chosen = ReadOptions { layer: Some("depth".into()), ..ReadOptions::default() };
    assert_eq!(read_image_as(&path, &chosen).unwrap().channels[0].1, other);

    let passes = vec![("R", &light), ("G", &light), ("B", &light), ("glossy.R", &other), ("glossy.G", &other)];
    let passes = [passes, vec![("glossy.B", &other)]].concat();
    write_exr(&path, &[ExrLayer { name: "view", channels: passes }]).unwrap();
    assert_eq!(read_image(&path).unwrap().channels[2].1, light);
}

#[test]
fn negative_and_nan_floats_count_as_dark_and_are_reported_once() {
    let folder = Folder::new();
    let mut values = vec![0.5; 294];
    (values[3], values[4], values[5]) = (f32::NAN, -0.01, f32::INFINITY);
    let file = folder.file("noise.tif", grey32f_tiff(&values));
    let light = linearise([read_image(&file)], &LinearOptions::default(), &Corrections::default()).unwrap();
    let [warning @ ImageWarning::BadValues { count: 3, .. }] = &light.warnings[..] else {
        panic!("{:?}", light.warnings)
    };
    assert!(warning.to_string().contains("noise.tif"));
    let marks = light.photo.marks.data();
    assert_eq!((marks[2], marks[3], marks[4], marks[5]), (0, DARK, DARK, CLIPPED));
    assert!(light.photo.linear.data().iter().all(|light| (-0.1..=1.0).contains(light)), "none outshines the photo");
}
