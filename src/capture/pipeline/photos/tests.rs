use std::fs;
use std::io::Cursor;
use std::path::Path;

use firstbounce_core::Plane;
use tempfile::{TempDir, tempdir};
use tiff::encoder::colortype::Gray16;
use tiff::encoder::{Rational, TiffEncoder};
use tiff::tags::Tag;

use super::*;
use crate::image_file::{ImageWarning, grey16_png};
use crate::pipeline::Unattended;
use crate::set::{CaptureSet, Colour, Light, Shot, Subject};

fn write(path: &Path, light: f32) {
    fs::write(path, grey16_png(&Plane::from_fn(4, 3, |x, y| light + 0.01 * (x + y) as f32), 1.0).unwrap()).unwrap();
}

fn shot(subject: Subject, light: Option<&str>, files: &[&str]) -> Shot {
    Shot {
        subject,
        light: light.map(str::to_owned),
        colour: (subject == Subject::Object).then(|| "blue".into()),
        files: files.iter().map(|file| (*file).to_owned()).collect(),
        ..Shot::default()
    }
}

/// Three lights, two dark frames, two flat fields: seven files.
fn set() -> (TempDir, CaptureSet) {
    let folder = tempdir().unwrap();
    for (name, light) in [("left", 0.3), ("top", 0.4), ("right", 0.5), ("dark1", 0.01), ("dark2", 0.012)] {
        write(&folder.path().join(format!("{name}.png")), light);
    }
    write(&folder.path().join("flat1.png"), 0.6);
    write(&folder.path().join("flat2.png"), 0.61);
    let light = |name: &str| Light { name: name.into(), ..Light::default() };
    let set = CaptureSet {
        folder: folder.path().to_owned(),
        colours: vec![Colour { name: "blue".into(), ..Colour::default() }],
        lights: ["left", "top", "right"].map(light).into(),
        shots: vec![
            shot(Subject::Object, Some("left"), &["left.png"]),
            shot(Subject::Object, Some("top"), &["top.png"]),
            shot(Subject::Object, Some("right"), &["right.png"]),
            shot(Subject::Dark, None, &["dark1.png", "dark2.png"]),
            shot(Subject::FlatField, None, &["flat1.png", "flat2.png"]),
        ],
        ..CaptureSet::default()
    };
    (folder, set)
}

fn read(store: &PhotoStore, set: &CaptureSet) -> Vec<ShotLight> {
    store.read(set, &set.shots.iter().collect::<Vec<_>>(), &Unattended).unwrap()
}

#[test]
fn dark_and_flat_frames_are_decoded_once_for_all_shots() {
    let (_folder, set) = set();
    let store = PhotoStore::default();
    load_object(&set, &store, &Unattended).unwrap();
    assert_eq!(store.decoded_files(), 7);
    // The frames alone are photos too, and are read for that.
    read(&store, &set);
    assert_eq!(store.decoded_files(), 7 + 4);
    let all_at_once = PhotoStore::default();
    read(&all_at_once, &set);
    assert_eq!(all_at_once.decoded_files(), 7);
}

#[test]
fn a_renamed_light_decodes_nothing_and_another_photo_itself_alone() {
    let (folder, mut set) = set();
    let store = PhotoStore::default();
    let before = read(&store, &set);
    set.rename_light(0, "leftmost");
    let after = read(&store, &set);
    assert_eq!(store.decoded_files(), 7);
    assert!(before.iter().zip(&after).all(|(a, b)| a.as_ref().unwrap() == b.as_ref().unwrap()));

    write(&folder.path().join("low.png"), 0.2);
    set.lights.push(Light { name: "low".into(), ..Light::default() });
    set.shots.push(shot(Subject::Object, Some("low"), &["low.png"]));
    read(&store, &set);
    assert_eq!(store.decoded_files(), 8);
}

#[test]
fn a_file_that_was_written_again_is_decoded_again() {
    let (folder, set) = set();
    let store = PhotoStore::default();
    read(&store, &set);
    fs::write(folder.path().join("top.png"), grey16_png(&Plane::filled(40, 30, 0.2), 1.0).unwrap()).unwrap();
    let light = read(&store, &set).swap_remove(1);
    assert_eq!(store.decoded_files(), 8);
    assert!(light.unwrap_err().to_string().contains("the dark frame"), "of another size than its dark frame");
}

#[test]
fn an_error_belongs_to_the_shots_of_its_file() {
    let (folder, set) = set();
    fs::write(folder.path().join("left.png"), "no picture").unwrap();
    let lights = read(&PhotoStore::default(), &set);
    assert!(lights[0].as_ref().unwrap_err().to_string().contains("left.png"));
    assert!(lights[1..].iter().all(Result::is_ok));
    fs::remove_file(folder.path().join("dark2.png")).unwrap();
    let lights = read(&PhotoStore::default(), &set);
    assert!(lights[1..].iter().all(|light| light.as_ref().unwrap_err().to_string().contains("dark2.png")));
}

#[test]
fn the_store_keeps_no_more_than_a_set_needs() {
    let (_folder, mut set) = set();
    let store = PhotoStore::default();
    read(&store, &set);
    let removed = set.shots.remove(0);
    store.keep_only(&set);
    read(&store, &set);
    assert_eq!(store.decoded_files(), 7, "what stays is kept");
    set.shots.push(removed);
    read(&store, &set);
    assert_eq!(store.decoded_files(), 8, "what went is read again");
}

/// A TIFF of even light with an exposure time and a sensitivity.
fn timed(light: f32, exposure: (u32, u32), iso: u16) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    let mut picture = encoder.new_image::<Gray16>(4, 3).unwrap();
    picture.encoder().write_tag(Tag::Unknown(0x829a), Rational { n: exposure.0, d: exposure.1 }).unwrap();
    picture.encoder().write_tag(Tag::Unknown(0x8827), iso).unwrap();
    picture.write_data(&[(light * 65535.0).round() as u16; 12]).unwrap();
    bytes.into_inner()
}

/// The set with TIFFs, of which the last was exposed for half the time.
fn set_of_automatic_exposure(iso: [u16; 3]) -> (TempDir, CaptureSet) {
    let (folder, mut set) = set();
    let names = ["left.tif", "top.tif", "right.tif"];
    for ((name, iso), denominator) in names.into_iter().zip(iso).zip([50, 50, 100]) {
        fs::write(folder.path().join(name), timed(0.25, (1, denominator), iso)).unwrap();
    }
    set.shots.truncate(3);
    set.shots.iter_mut().zip(names).for_each(|(shot, name)| shot.files = vec![name.into()]);
    (folder, set)
}

fn mean_lights(set: &CaptureSet) -> Vec<f32> {
    let lights = read(&PhotoStore::default(), set);
    lights.iter().map(|light| light.as_ref().unwrap().photo.linear.data()[0]).collect()
}

/// What the capture checks say of the files of a set; its equal photos aside.
fn capture_lines(set: &CaptureSet) -> Vec<String> {
    let options = crate::pipeline::CheckOptions::default();
    let checked =
        crate::pipeline::check_captures(set, |_| true, &PhotoStore::default(), &options, &Unattended).unwrap();
    let warnings = checked.report.warnings.iter().filter(|warning| warning.kind() != "equal-files");
    warnings.map(ToString::to_string).collect()
}

#[test]
fn exposures_that_only_exif_states_are_filled_in_and_reported() {
    let (_folder, set) = set_of_automatic_exposure([100; 3]);
    let lights = mean_lights(&set);
    assert!(
        lights.iter().zip([0.25, 0.25, 0.5]).all(|(light, expected)| (light - expected).abs() < 1e-4),
        "{lights:?}"
    );
    let warnings = capture_lines(&set);
    assert!(warnings.len() == 1 && warnings[0].contains("right.tif: exposure 0.5000"), "{warnings:?}");
}

#[test]
fn a_stated_exposure_wins_and_gives_the_scale_of_those_that_exif_states() {
    let (_folder, mut set) = set_of_automatic_exposure([100; 3]);
    set.shots[0].exposure = Some(4.0);
    let exposures = PhotoStore::default().exposures(&set);
    let of: Vec<f64> = set.shots.iter().map(|shot| exposures.exposure(shot)).collect();
    assert_eq!(of, [4.0, 4.0, 2.0]);
    set.shots.iter_mut().for_each(|shot| shot.exposure = Some(1.0));
    let lights = mean_lights(&set);
    assert!(lights.iter().all(|light| (light - 0.25).abs() < 1e-4), "{lights:?}");
}

#[test]
fn mixed_sensitivity_is_divided_by_and_named() {
    let (_folder, set) = set_of_automatic_exposure([100, 100, 200]);
    assert_eq!(PhotoStore::default().exposures(&set), Exposures::default(), "half the time at twice the sensitivity");
    let warnings = capture_lines(&set);
    assert!(warnings.len() == 1 && warnings[0].contains("right.tif: taken at ISO 200"), "{warnings:?}");
}

/// Light 0.8 of the short exposure clips in the long one; light 0.05 is the same in both.
#[test]
fn a_bracket_is_one_photo_by_its_stated_exposures_or_by_exif() {
    let (folder, mut set) = set_of_automatic_exposure([100; 3]);
    fs::write(folder.path().join("long.tif"), timed(1.0, (4, 50), 100)).unwrap();
    fs::write(folder.path().join("short.tif"), timed(0.8, (1, 50), 100)).unwrap();
    set.shots[0].files = vec!["long.tif".into(), "short.tif".into()];
    let by_exif = mean_lights(&set);
    assert!((by_exif[0] - 0.8).abs() < 1e-3 && (by_exif[1] - 0.25).abs() < 1e-3, "{by_exif:?}");
    set.shots[0].exposures = vec![4.0, 1.0];
    assert_eq!(mean_lights(&set), by_exif);
    set.shots[0].exposures = vec![8.0, 2.0];
    assert!((mean_lights(&set)[0] - 0.4).abs() < 1e-3, "stated exposures win");

    let store = PhotoStore::default();
    let first = read(&store, &set);
    let decoded = store.decoded_files();
    let again = read(&store, &set);
    assert_eq!(store.decoded_files(), decoded, "a bracket is kept as one photo");
    let photo = |lights: &[ShotLight]| lights[0].as_ref().unwrap().photo.clone();
    assert_eq!(photo(&first), photo(&again));
    assert_eq!(first[0].as_ref().unwrap().files.len(), 2);
}

#[test]
fn a_mask_of_the_whole_picture_is_named_where_some_of_it_is_never_lit() {
    let (folder, mut set) = set();
    set.shots.truncate(3);
    set.mask = Some("mask.png".into());
    fs::write(folder.path().join("mask.png"), grey16_png(&Plane::filled(4, 3, 1.0), 1.0).unwrap()).unwrap();
    let doubts = |set: &CaptureSet| load_object(set, &PhotoStore::default(), &Unattended).unwrap().mask_warnings;
    assert_eq!(doubts(&set), [], "an object that fills the picture");
    for name in ["left.png", "top.png", "right.png"] {
        let dark_corner = Plane::from_fn(4, 3, |x, y| if x + y == 0 { 0.0 } else { 0.4 });
        fs::write(folder.path().join(name), grey16_png(&dark_corner, 1.0).unwrap()).unwrap();
    }
    assert!(matches!(doubts(&set)[..], [ImageWarning::MaskWhole { .. }]));
}
