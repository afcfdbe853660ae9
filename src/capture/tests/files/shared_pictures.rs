//! The pictures of the shared capture sets, where they are at hand.

use std::path::{Path, PathBuf};

use firstbounce_capture::image_file::{
    Content, Format, ImageWarning, ReadOptions, read_image, read_image_as, read_mask,
};
use firstbounce_testing::shared_set;

fn pictures_below(folder: &Path, pictures: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
        if path.is_dir() {
            pictures_below(&path, pictures);
        } else if ["png", "exr", "jpg"].contains(&extension.as_str()) {
            pictures.push(path);
        }
    }
}

#[test]
fn every_shared_picture_is_read() {
    let Some(data) = shared_set("") else { return };
    let mut pictures = Vec::new();
    pictures_below(&data, &mut pictures);
    assert!(pictures.len() > 100, "{}", pictures.len());
    for path in pictures {
        let truth = path.parent().is_some_and(|folder| folder.ends_with("truth"));
        let content = if truth { Content::Data } else { Content::Photo };
        let image = read_image_as(&path, &ReadOptions { content, layer: None }).unwrap();
        assert_eq!(image.warnings.contains(&ImageWarning::ProbablySrgb { path }), image.format == Format::Jpeg);
    }
}

#[test]
fn sizes_and_kinds_are_as_known() {
    let Some(data) = shared_set("") else { return };
    let known = [
        ("corner-blue/object/left-blue.png", (384, 384), 1, Some(65535.0)),
        ("groove-rgb/object/east.png", (400, 320), 3, Some(65535.0)),
        ("psbox-cat/object/Image_01.png", (430, 550), 1, Some(255.0)),
        ("psbox-cat/mirror-sphere/ref.JPG", (1100, 1000), 3, Some(255.0)),
        ("corner-blue/truth/depth.exr", (384, 384), 1, None),
    ];
    for (name, size, channels, maximum) in known {
        let options = ReadOptions { content: Content::Data, layer: None };
        let image = read_image_as(&data.join(name), &options).unwrap();
        assert_eq!((image.size(), image.channels.len(), image.stored.maximum), (size, channels, maximum), "{name}");
    }
    let mask = read_mask(&data.join("corner-blue/mask.png")).unwrap().mask;
    assert!(mask.size() == (384, 384) && mask.count() > 1000 && mask.count() < 384 * 384);
    assert!(read_image(&data.join("psbox-cat/mirror-sphere/ref.JPG")).unwrap().warnings.len() == 2);
}
