use std::fs;
use std::io::Cursor;
use std::path::Path;

use firstbounce_core::Plane;
use firstbounce_core::image::distortion::Lens;
use tempfile::{TempDir, tempdir};
use tiff::encoder::colortype::Gray16;
use tiff::encoder::{Rational, TiffEncoder};
use tiff::tags::Tag;

use super::*;
use crate::camera_file::CameraFile;
use crate::image_file::{ImageWarning, grey16_png};
use crate::pipeline::Unattended;
use crate::set::{Camera, CaptureSet, Colour, Light, Projection, Shot, Subject, write_lens};

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

const LENS: Lens =
    Lens { focal_length_px: 120.0, principal_point_px: (50.0, 36.0), coefficients: [-0.2, 0.05, 0.001, -0.002] };

fn pattern((x, y): (f64, f64)) -> f64 {
    0.4 + 0.2 * (x / 6.0).sin() * (y / 7.0).cos()
}

/// A photo of a pattern as a lens draws it, in a set that knows the lens.
fn set_behind_a_lens() -> (TempDir, CaptureSet) {
    let (folder, mut set) = set();
    set.shots.truncate(3);
    let drawn = |x, y| pattern(LENS.undistorted((x as f64 + 0.5, y as f64 + 0.5)).unwrap()) as f32;
    let png = grey16_png(&Plane::from_fn(96, 72, drawn), 1.0).unwrap();
    for name in ["left", "top", "right"] {
        fs::write(folder.path().join(format!("{name}.png")), &png).unwrap();
    }
    let principal_point = Some([LENS.principal_point_px.0, LENS.principal_point_px.1]);
    let projection =
        Projection::Perspective { focal_length_px: LENS.focal_length_px, principal_point, working_distance_mm: 500.0 };
    set.camera = Camera { projection, distortion: Some(LENS.coefficients), ..Camera::default() };
    (folder, set)
}

#[test]
fn distortion_is_undone_when_a_photo_is_read_and_its_noise_with_it() {
    let (_folder, mut set) = set_behind_a_lens();
    let store = PhotoStore::default();
    let light = read(&store, &set)[0].clone().unwrap();
    for (index, found) in light.photo.linear.data().iter().enumerate() {
        let truth = pattern(((index % 96) as f64 + 0.5, (index / 96) as f64 + 0.5));
        assert!((f64::from(*found) - truth).abs() < 0.005, "{index}: {found} for {truth}");
    }
    assert!((0.4..0.99).contains(&light.variance_share) && light.combined_noise.is_some(), "{}", light.variance_share);
    set.camera.full_well_electrons = Some(10_000.0);
    set.camera.read_noise_electrons = Some(5.0);
    let noise = load_object(&set, &store, &Unattended).unwrap().noise[0][0];
    let expected = 0.4 / 10_000.0 * light.variance_share;
    assert!((noise.variance(0.4) / expected - 1.0).abs() < 0.02, "{noise:?} for {expected}");
    // Another lens is another photo.
    set.camera.distortion = None;
    assert_ne!(read(&store, &set)[0].as_ref().unwrap().photo, light.photo);
}

#[test]
fn a_lens_that_folds_the_picture_is_one_line_that_names_the_photo() {
    let (_folder, mut set) = set_behind_a_lens();
    set.camera.distortion = Some([-9.0, 0.0, 0.0, 0.0]);
    let error = load_object(&set, &PhotoStore::default(), &Unattended).unwrap_err().to_string();
    assert!(error.contains("left.png: the distortion folds the picture") && !error.contains('\n'), "{error}");
}

#[test]
fn a_calibration_of_pictures_of_another_size_is_refused_and_one_of_this_size_is_taken() {
    let (_folder, mut set) = set_behind_a_lens();
    let file = |size| CameraFile {
        focal_length_px: 130.0,
        principal_point: [48.5, 36.5],
        distortion: [0.1, 0.0, 0.0, 0.0],
        size,
    };
    let path = Path::new("camera.yml");
    let error = file(Some((640, 480))).put_into(&mut set, path).unwrap_err();
    assert!(error.to_string().contains("640 x 480 pixels") && error.to_string().contains("96 x 72"), "{error}");
    file(Some((96, 72))).put_into(&mut set, path).unwrap();
    assert_eq!(set.camera.distortion, Some([0.1, 0.0, 0.0, 0.0]));
    let text = write_lens(&set.to_toml(), &set.camera).unwrap();
    assert!(text.contains("distortion = [0.1, 0.0, 0.0, 0.0]") && text.contains("focal_length_px = 130.0"), "{text}");
    set.camera = Camera::default();
    assert!(file(None).put_into(&mut set, path).unwrap_err().to_string().contains("perspective"));
}
