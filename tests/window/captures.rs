//! The Captures step: what files become, by their names or by hand.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use eframe::egui::accesskit::Role;
use eframe::egui::{DroppedFile, Key, Modifiers};
use egui_kittest::kittest::Queryable;
use firstbounce_capture::image_file::grey16_png;
use firstbounce_capture::set::{Channel, Subject};
use firstbounce_core::Plane;

use crate::harness::Hands;

/// A file as the system drops it.
#[derive(Debug)]
pub struct Dropped(pub PathBuf);

impl DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        fs::read(&self.0).map_err(|error| error.to_string())
    }
}

/// A folder of small photos.
fn folder(hands: &Hands, names: &[&str]) -> PathBuf {
    let folder = hands.folder.path().join("shoot");
    let photo = grey16_png(&Plane::from_fn(24, 16, |x, y| 0.01 * (x + y) as f32), 1.0).unwrap();
    for name in names {
        let path = folder.join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, &photo).unwrap();
    }
    folder
}

fn drop_on_window(hands: &mut Hands, path: PathBuf) {
    hands.harness.input_mut().dropped_files.push(Arc::new(Dropped(path)));
    hands.harness.run_steps(1);
    hands.harness.input_mut().dropped_files.clear();
    hands.steps();
}

/// Opens a choice of names and types a new one.
fn name_by_hand(hands: &mut Hands, choice: &str, name: &str) {
    hands.harness.get_by_role_and_label(Role::ComboBox, choice).click();
    hands.steps();
    hands.type_into("New name", name);
    hands.press(Modifiers::NONE, Key::Enter);
}

#[test]
fn a_folder_of_unnamed_files_is_assigned_by_hand() {
    let mut hands = Hands::new();
    let folder = folder(&hands, &["DSC0001.png", "DSC0002.png"]);
    drop_on_window(&mut hands, folder.clone());
    assert!(hands.sees("2 files to add"));
    assert!(hands.sees("2 files do not say what they are"));
    for (file, colour) in [("DSC0001.png", "blue"), ("DSC0002.png", "green")] {
        name_by_hand(&mut hands, &format!("Light of {file}"), "left");
        name_by_hand(&mut hands, &format!("Colour of {file}"), colour);
    }
    assert!(hands.sees("DSC0002.png: object, left, green"));
    hands.click_button("Add 2 files");
    let set = hands.session().document().set.clone();
    assert_eq!(set.folder, folder);
    assert_eq!(set.shot(Subject::Object, Some("left"), Some("green")).unwrap().files, ["DSC0002.png"]);
    assert_eq!(set.shot(Subject::Object, Some("left"), Some("blue")).unwrap().files, ["DSC0001.png"]);
    assert!(set.check().is_empty(), "{:?}", set.check());
    hands.press(Modifiers::COMMAND, Key::Z);
    assert!(hands.session().document().set.shots.is_empty());
}

#[test]
fn a_folder_whose_names_have_a_system_is_assigned_by_its_pattern() {
    let mut hands = Hands::new();
    let names =
        ["object/left-blue.png", "object/left-green.png", "object/top-blue.png", "object/top-green.png", "mask.png"];
    let folder = folder(&hands, &names);
    drop_on_window(&mut hands, folder);
    assert!(hands.sees("object/top-green.png: object, top, green"));
    assert!(hands.sees("mask.png: the object's mask"));
    hands.click_button("Add 5 files");
    let set = hands.session().document().set.clone();
    assert_eq!((set.lights.len(), set.colours.len(), set.shots.len()), (2, 2, 4));
    assert_eq!(set.mask.as_deref(), Some("mask.png"));
}

#[test]
fn one_rgb_photo_holds_all_colours() {
    let mut hands = Hands::new();
    let folder = folder(&hands, &["object/left.png", "object/top.png", "grey-sphere/left.png", "grey-sphere/top.png"]);
    drop_on_window(&mut hands, folder);
    hands.click_button("Add 4 files");
    let set = hands.session().document().set.clone();
    let channels: Vec<_> = set.colours.iter().map(|colour| colour.channel).collect();
    assert_eq!((channels, set.shots.len()), (vec![Channel::R, Channel::G, Channel::B], 12));
}

#[test]
fn the_table_shows_every_photo_of_the_demo_and_how_it_is_exposed() {
    let mut hands = Hands::with_demo();
    hands.rest();
    hands.wait_until("the look at the photos", |session| session.jobs.running().is_empty());
    for title in ["Select Photo, left, blue", "Select Grey ball, top, green", "Select Mirror ball, right"] {
        assert!(hands.harness.query_by_role_and_label(Role::Button, title).is_some(), "{title}");
    }
    assert_eq!(hands.harness.query_all_by_label_contains("clipped ").count(), 21);
    assert!(hands.sees("green (channel grey)"));
}

#[test]
fn a_file_that_is_gone_is_one_red_cell_that_says_why() {
    let mut hands = Hands::new();
    let set = hands.demo();
    fs::remove_file(set.join("grey-sphere/top-green.png")).unwrap();
    hands.open(firstbounce::app::session::Open::Set(set));
    hands.rest();
    assert!(hands.harness.query_all_by_label_contains("top-green.png: cannot be read").count() >= 1);
    assert!(hands.session().results.loaded().unwrap().object.is_ok());
}
