use std::fs;
use std::path::Path;

use firstbounce_core::Plane;
use tempfile::{TempDir, tempdir};

use super::*;
use crate::image_file::grey16_png;
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
