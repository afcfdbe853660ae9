//! Bad pictures and bad disks get one line that names the file and says what to do.

use std::path::Path;

use firstbounce_capture::image_file::{
    Content, ExrLayer, ImageError, ReadOptions, read_image, read_image_as, write_exr,
};
use firstbounce_core::Plane;

use crate::pictures::*;

fn message(path: &Path) -> String {
    let text = read_image(path).unwrap_err().to_string();
    assert!(text.starts_with(&path.display().to_string()) && !text.contains('\n'), "{text}");
    text
}

#[test]
fn what_is_no_image_is_named() {
    let folder = Folder::new();
    assert!(message(&folder.path("missing.png")).contains("cannot be read"));
    assert!(message(folder.root()).contains("not a file"));
    assert!(message(&folder.file("empty.png", b"")).contains("empty"));
    let text = message(&folder.file("left.png", b"Hello, world"));
    assert!(text.ends_with(
        "left.png: not an image Firstbounce reads (camera raw, PNG, TIFF, EXR, JPEG, HDR, PFM, BMP, PNM): first bytes 48 65 6c; export it again"
    ));
}

#[test]
fn half_a_file_is_damaged() {
    let folder = Folder::new();
    for (name, bytes) in one_of_each() {
        let path = folder.file(name, &bytes[..bytes.len() / 2]);
        let read = read_image_as(&path, &ReadOptions { layer: None, content: Content::Photo });
        // Half a JPEG still shows its upper half; a decoder may take it, no other format may.
        if !name.ends_with("jpg") && name != "two.exr" {
            assert!(matches!(read, Err(ImageError::Damaged { .. })), "{name}: {read:?}");
        }
    }
}

#[test]
fn a_small_file_that_claims_a_vast_picture_is_refused_before_memory_is_taken() {
    let folder = Folder::new();
    let text = message(&folder.file("bomb.pfm", b"PF\n2000000 2000000\n-1.0\n0000"));
    assert!(text.contains("2000000 x 2000000"), "{text}");
    // A PNG header of 60000 x 60000 pixels.
    let mut png = Vec::new();
    let mut encoder = png::Encoder::new(&mut png, 60_000, 60_000);
    encoder.set_color(png::ColorType::Rgb);
    encoder.write_header().unwrap().write_chunk(png::chunk::IDAT, &[0x78, 0x01, 0, 0]).unwrap();
    let text = message(&folder.file("bomb.png", &png));
    assert!(text.contains("60000 x 60000"), "{text}");
}

#[test]
fn values_that_no_light_has_are_counted_and_placed() {
    let folder = Folder::new();
    let at = |x: usize, y: usize| y * WIDTH as usize + x;
    let mut values = floats((WIDTH * HEIGHT) as usize);
    values[at(4, 2)] = -0.25;
    values[at(7, 3)] = -1.0;
    let negative = folder.file("negative.pfm", pfm("Pf", &values, true));
    let warning = read_image(&negative).unwrap().warnings[0].to_string();
    assert!(warning.contains("2 values are NaN, infinite or negative, the first (negative) at x 4, y 2"), "{warning}");
    let data = ReadOptions { content: Content::Data, layer: None };
    assert_eq!(read_image_as(&negative, &data).unwrap().channels[0].1.at(4, 2), -0.25);

    values[at(0, 1)] = f32::NAN;
    let nan = folder.file("nan.tif", grey32f_tiff(&values));
    let warning = read_image(&nan).unwrap().warnings[0].to_string();
    assert!(warning.contains("3 values are NaN, infinite or negative, the first (NaN) at x 0, y 1"), "{warning}");
    let error = read_image_as(&nan, &data).unwrap_err();
    assert!(matches!(error, ImageError::BadPixels { count: 1, x: 0, y: 1, .. }), "{error}");
}

#[test]
fn layers_that_make_no_picture_are_refused() {
    let folder = Folder::new();
    let (a, b) = (Plane::filled(3, 2, 0.0), Plane::filled(2, 2, 0.0));
    let layer = |name, channels| ExrLayer { name, channels };
    for layers in [
        vec![],
        vec![layer("", vec![("Y", &a)])],
        vec![layer("l", vec![])],
        vec![layer("l", vec![("R", &a), ("G", &b)])],
        vec![layer("l", vec![("R", &a), ("R", &a)])],
        vec![layer("l", vec![("Y", &a)]), layer("l", vec![("Y", &a)])],
    ] {
        let path = folder.path("bad.exr");
        assert!(matches!(write_exr(&path, &layers), Err(ImageError::UnequalPlanes { .. })));
        assert!(!path.exists());
    }
}

#[test]
fn a_folder_that_is_not_there_and_a_full_disk_are_told() {
    let plane = plane(&floats((WIDTH * HEIGHT) as usize));
    let layers = [ExrLayer { name: "l", channels: vec![("Y", &plane)] }];
    let error = write_exr(&Folder::new().path("no/such/out.exr"), &layers).unwrap_err();
    assert!(matches!(error, ImageError::Unwritable { .. }), "{error}");
    if Path::new("/dev/full").exists() {
        let error = write_exr(Path::new("/dev/full"), &layers).unwrap_err().to_string();
        assert!(error.starts_with("/dev/full: cannot be written: No space left"), "{error}");
    }
}
