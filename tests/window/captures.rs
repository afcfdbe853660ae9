//! The Captures step: what files become, by their names or by hand.

use std::fs;
use std::path::PathBuf;
use std::time::{Duration, SystemTime};

use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};
use firstbounce_capture::image_file::grey16_png;
use firstbounce_capture::set::{Channel, Subject};
use firstbounce_core::Plane;

use crate::harness::Hands;

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

#[test]
fn a_folder_of_unnamed_files_is_assigned_by_hand() {
    let mut hands = Hands::new();
    let folder = folder(&hands, &["DSC0001.png", "DSC0002.png"]);
    hands.drop_files(std::slice::from_ref(&folder));
    assert!(hands.sees("2 files to add"));
    assert!(hands.sees("2 files are not recognised"));
    for (file, colour) in [("DSC0001.png", "blue"), ("DSC0002.png", "green")] {
        hands.name_by_hand(&format!("Light of {file}"), "left");
        hands.name_by_hand(&format!("Colour of {file}"), colour);
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
fn unnamed_files_are_assigned_at_once_by_the_order_in_which_they_were_taken() {
    let mut hands = Hands::new();
    let folder = folder(&hands, &["DSC0001.png", "DSC0002.png", "DSC0003.png", "DSC0004.png"]);
    hands.drop_files(&[folder]);
    hands.harness.get_by_label("By the order in which they were taken").click_accesskit();
    hands.harness.run_steps(30);
    hands.type_into("Lights in order", "left, top");
    hands.type_into("Colours in order", "blue");
    assert!(hands.sees("This names 2 photos, for 4 files."));
    hands.retype("Colours in order", "blue, green");
    hands.click_button("Assign these 4 files in order");
    assert!(hands.sees("DSC0003.png: object, top, blue"));
    hands.click_button("Add 4 files");
    let set = hands.session().document().set.clone();
    assert_eq!(set.shot(Subject::Object, Some("left"), Some("green")).unwrap().files, ["DSC0002.png"]);
    assert!(set.check().is_empty(), "{:?}", set.check());
}

#[test]
fn a_camera_dump_is_object_balls_and_mirror_in_the_order_of_its_times_across_the_end_of_the_count() {
    let mut hands = Hands::new();
    // 21 photos, of which the camera called the first DSC_9995.
    let count = |photo: usize| if photo < 5 { 9995 + photo } else { photo - 5 };
    let names: Vec<String> = (0..21).map(|photo| format!("DSC_{:04}.png", count(photo))).collect();
    let folder = folder(&hands, &names.iter().map(String::as_str).collect::<Vec<_>>());
    for (photo, name) in (0..).zip(&names) {
        let taken = SystemTime::UNIX_EPOCH + Duration::from_secs(1_700_000_000 + 7 * photo);
        fs::File::options().write(true).open(folder.join(name)).unwrap().set_modified(taken).unwrap();
    }
    hands.drop_files(&[folder]);
    hands.harness.get_by_label("By the order in which they were taken").click_accesskit();
    hands.harness.run_steps(30);
    assert!(hands.sees("By the time they were taken, from DSC_9995.png to DSC_0015.png"));
    for subject in ["Grey ball", "Ball of the paint", "Mirror ball"] {
        hands.harness.get_by_role_and_label(Role::CheckBox, subject).click_accesskit();
        hands.steps();
    }
    hands.type_into("Lights in order", "left, top, right");
    hands.type_into("Colours in order", "blue, green");
    hands.click_button("Assign these 21 files in order");
    hands.click_button("Add 21 files");
    let set = hands.session().document().set.clone();
    assert!(set.check().is_empty(), "{:?}", set.check());
    let file = |subject, light, colour| set.shot(subject, Some(light), colour).unwrap().files.clone();
    assert_eq!(file(Subject::Object, "left", Some("blue")), ["DSC_9995.png"]);
    assert_eq!(file(Subject::GreySphere, "left", Some("blue")), ["DSC_0001.png"]);
    assert_eq!(file(Subject::MirrorSphere, "right", None), ["DSC_0015.png"]);
}

#[test]
fn folders_of_equal_names_are_asked_about_before_any_file_is_taken() {
    let mut hands = Hands::new();
    let names = ["one/left-blue.png", "one/top-blue.png", "two/left-blue.png", "two/top-blue.png", "two/ball.png"];
    let folder = folder(&hands, &names);
    hands.drop_files(&[folder]);
    assert!(hands.sees("5 files are not recognised"));
    assert!(hands.sees("choose what each folder shows"));
    for (folder, subject) in [("one", "Object"), ("two", "Grey ball")] {
        hands.harness.get_by_role_and_label(Role::ComboBox, &format!("Folder {folder} shows")).click_accesskit();
        hands.steps();
        hands.harness.get_by_role_and_label(Role::Button, subject).click_accesskit();
        hands.steps();
    }
    assert!(hands.sees("two/top-blue.png: grey-sphere, top, blue"));
    hands.click_button("Add 4 files");
    let set = hands.session().document().set.clone();
    assert!(set.shots.len() == 4 && set.shots.iter().all(|shot| shot.files.len() == 1), "{:?}", set.shots);
}

#[test]
fn an_exposure_bracket_and_a_word_that_is_no_colour_are_shown_as_doubts() {
    let mut hands = Hands::new();
    let folder = folder(&hands, &["left-blue-1-60.png", "left-blue-1-125.png", "left-c2-1-60.png"]);
    hands.drop_files(&[folder]);
    assert!(hands.sees("left-blue-1-60.png: one photo at several exposures (1-125, 1-60)"));
    hands.harness.get_by_role_and_label(Role::CheckBox, "These are colours: c2").click_accesskit();
    hands.steps();
    assert!(hands.sees("left-c2-1-60.png: object, left, c2"));
}

#[test]
fn a_folder_whose_names_have_a_system_is_assigned_by_its_pattern() {
    let mut hands = Hands::new();
    let names =
        ["object/left-blue.png", "object/left-green.png", "object/top-blue.png", "object/top-green.png", "mask.png"];
    let folder = folder(&hands, &names);
    hands.drop_files(&[folder]);
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
    hands.drop_files(&[folder]);
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
        let photo = hands.harness.get_by_role_and_label(Role::Button, title);
        let told = photo.accesskit_node().description().unwrap_or_default();
        assert!(told.contains("clipped 0.0 %") && told.contains("mean light 0."), "{title}: {told}");
    }
    assert!(!hands.sees("clipped 0.0 %"), "only what is out of the ordinary is written below a photo");
    assert!(hands.sees("green (channel grey)"));
}

#[test]
fn a_file_that_is_gone_is_one_red_cell_that_says_why() {
    let mut hands = Hands::new();
    let set = hands.demo();
    fs::remove_file(set.join("grey-sphere/top-green.png")).unwrap();
    hands.open(firstbounce::app::state::session::Open::Set(set));
    hands.rest();
    assert!(hands.harness.query_all_by_label_contains("top-green.png: cannot be read").count() >= 1);
    assert!(hands.session().results.loaded().unwrap().object.is_ok());
}

#[test]
fn capture_warnings_are_listed_below_the_table_the_worst_first() {
    let mut hands = Hands::new();
    let set = hands.demo();
    fs::copy(set.join("object/left-blue.png"), set.join("object/top-blue.png")).unwrap();
    hands.open(firstbounce::app::state::session::Open::Set(set));
    hands.rest();
    assert!(hands.sees("Capture warnings"));
    assert!(hands.sees("1. object/left-blue.png and object/top-blue.png: the same photo under 2 names"));
}

#[test]
fn a_sound_set_has_no_capture_warnings() {
    let mut hands = Hands::with_demo();
    hands.rest();
    assert!(!hands.sees("Capture warnings"));
}

#[test]
fn a_light_takes_its_new_name_when_it_is_typed_to_its_end_and_never_that_of_another() {
    let mut hands = Hands::with_demo();
    hands.rest();
    hands.session().edit("Leave out a light", |document| document.set.shape.leave_out = vec!["left".into()]);
    hands.harness.get_by_label("Names, lights and colours").click_accesskit();
    hands.steps();
    let lights = |hands: &mut Hands| {
        let document = hands.session().document();
        document.set.lights.iter().map(|light| light.name.clone()).collect::<Vec<_>>()
    };
    hands.retype("Light 1", "top");
    assert_eq!(lights(&mut hands), ["left", "top", "right"], "still being typed");
    hands.press(Modifiers::NONE, Key::Enter);
    assert!(hands.sees("There is a light \"top\" already"));
    hands.retype("Light 1", "topmost");
    hands.press(Modifiers::NONE, Key::Enter);
    assert_eq!(lights(&mut hands), ["topmost", "top", "right"]);
    let document = hands.session().document();
    assert_eq!(document.set.shape.leave_out, ["topmost"]);
    assert!(document.set.check().is_empty());
}
