//! What goes on around a set: the next run, a crash, places that cannot be written, files that are dropped, comparing.

use std::fs;

use eframe::egui::accesskit::Role;
use eframe::egui::{Event, Key, Modifiers, Theme, ThemePreference};
use egui_kittest::kittest::{NodeT, Queryable};
use firstbounce::app::state::document::Recovered;
use firstbounce::app::state::layout::Shown;
use firstbounce::app::state::panel::PanelName;
use firstbounce::app::state::results::{Plain, SurfaceName};
use firstbounce::app::state::session::Open;
use firstbounce::app::window::commands::CommandId;
use tempfile::TempDir;

use crate::harness::Hands;

/// Closes the window; what the next one finds.
fn ended(hands: Hands) -> TempDir {
    let Hands { harness, folder, .. } = hands;
    drop(harness);
    folder
}

#[test]
fn colours_and_size_of_the_window_are_those_of_the_last_run() {
    let mut hands = Hands::with_demo();
    for command in [CommandId::ThemeLight, CommandId::ZoomIn, CommandId::ZoomIn] {
        hands.run(command);
        hands.steps();
    }
    let next = Hands::with_folder(ended(hands));
    assert_eq!(next.harness.ctx.options(|options| options.theme_preference), ThemePreference::Light);
    assert_eq!(next.harness.ctx.theme(), Theme::Light);
    assert!((next.harness.ctx.zoom_factor() - 1.21).abs() < 1e-6);
}

#[test]
fn preferences_that_cannot_be_read_are_the_defaults() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("config")).unwrap();
    fs::write(folder.path().join("config/preferences.json"), "{ \"ui_scale\": 1e9, \"theme\": \"Pink\"").unwrap();
    let hands = Hands::with_folder(folder);
    assert!(hands.sees("Open the demo"));
    assert!((hands.harness.ctx.zoom_factor() - 1.0).abs() < 1e-6);
}

#[test]
fn the_unsaved_set_of_a_run_that_crashed_is_offered_and_restored() {
    let mut hands = Hands::with_demo();
    hands.session().edit("Type beta", |document| document.set.calibration.beta = Some(vec![1.0, 0.6]));
    let document = hands.session().document();
    let set = &document.set;
    let kept = Recovered {
        path: set.file_path(),
        text: set.to_toml(),
        settings: document.settings.clone(),
        title: set.title(),
    };
    // What a panic leaves: the document, and a lock that nobody holds.
    let crashed = hands.folder.path().join("config/recovery/1");
    fs::create_dir_all(&crashed).unwrap();
    fs::write(crashed.join("lock"), "").unwrap();
    fs::write(crashed.join("document.json"), serde_json::to_vec(&kept).unwrap()).unwrap();

    let mut next = Hands::with_folder(ended(hands));
    assert!(next.sees("The last run ended before \"Blue corner\" was saved."));
    next.click_button("Restore Blue corner");
    assert_eq!(next.session().document().set, document.set);
    assert!(!crashed.exists(), "it is offered once");
    next.rest();
    let restored = next.session().document();
    assert_eq!(next.session().results.rig(&restored).beta, Some(vec![1.0, 0.6]));
    next.press(Modifiers::COMMAND, Key::S);
    let saved = firstbounce_capture::CaptureSet::open(&document.set.folder).unwrap();
    assert_eq!(saved.calibration.beta, Some(vec![1.0, 0.6]));
}

#[test]
fn a_folder_that_cannot_be_written_is_told_in_one_line_and_the_set_stays_unsaved() {
    let mut hands = Hands::with_demo();
    hands.session().edit("Choose one bounce", |document| document.set.separation.bounces = Some(1));
    // A folder cannot lie under a file; who is root may write everywhere else.
    let file = hands.folder.path().join("file");
    fs::write(&file, "").unwrap();
    hands.press(Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    hands.retype("Folder of the new set", &file.join("set").display().to_string());
    hands.click_button("Save here");
    assert!(hands.sees("choose \"Save as\""));
    assert!(hands.sees("file/set"));
    hands.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(hands.session().document().set.separation.bounces, None, "the edit was still there to be undone");
    hands.press(Modifiers::COMMAND, Key::S);
    assert!(hands.sees("Saved "), "the set is still that of its own folder");
}

#[test]
fn files_dropped_on_the_first_window_are_a_new_set_of_their_folder() {
    let mut hands = Hands::new();
    let demo = hands.demo();
    let photos = hands.folder.path().join("photos");
    fs::create_dir(&photos).unwrap();
    let names = ["left-blue.png", "left-green.png"];
    for name in names {
        fs::copy(demo.join("object").join(name), photos.join(name)).unwrap();
    }
    hands.drop_files(&names.map(|name| photos.join(name)));
    assert_eq!(hands.session().document().set.folder, photos);
    assert!(hands.sees("2 files to add"));
    assert!(hands.sees("left-green.png: object, left, green"));
}

#[test]
fn a_set_dropped_is_opened_and_photos_dropped_on_it_are_added() {
    let mut hands = Hands::new();
    let demo = hands.demo();
    hands.drop_files(&[demo.join("capture.toml")]);
    assert_eq!(hands.session().document().set.title(), "Blue corner");
    hands.session().panel = PanelName::Export;
    hands.steps();
    hands.drop_files(&[demo.join("object")]);
    assert_eq!(hands.session().panel, PanelName::Captures);
    assert!(hands.sees("6 files to add"));
    hands.click_button("Discard");
    assert!(!hands.sees("files to add"));
}

#[test]
fn what_is_no_picture_is_told_when_it_is_dropped() {
    let mut hands = Hands::with_demo();
    let notes = hands.folder.path().join("notes.txt");
    fs::write(&notes, "lamps").unwrap();
    hands.drop_files(&[notes]);
    assert!(hands.sees("There is no picture in what was dropped"));
}

#[test]
fn another_set_dropped_asks_before_unsaved_edits_are_left() {
    let mut hands = Hands::with_demo();
    hands.session().edit("Choose one bounce", |document| document.set.separation.bounces = Some(1));
    let other = hands.folder.path().join("other");
    firstbounce::demo::unpack(&other).unwrap();
    hands.drop_files(std::slice::from_ref(&other));
    assert!(hands.sees("Save the changes to Blue corner?"));
    hands.click_button("Cancel");
    assert_eq!(hands.session().document().set.bounces(), 1);
    hands.drop_files(std::slice::from_ref(&other));
    hands.click_button("Discard changes");
    assert_eq!(hands.session().document().set.folder, other);
}

/// The demo with its normals in view, compared with those before.
fn comparing() -> Hands {
    let mut hands = Hands::with_demo();
    hands.rest();
    hands.session().views.show(Shown::Normals(SurfaceName::After));
    hands.steps();
    hands.choose_picture("Compare", "Surface", "Normals before");
    hands
}

fn description(hands: &Hands, picture: &str) -> String {
    let node = hands.harness.get_by_role_and_label(Role::Image, picture);
    node.accesskit_node().description().unwrap_or_default()
}

#[test]
fn the_other_picture_is_shown_while_b_is_held() {
    let mut hands = comparing();
    hands.harness.get_by_role_and_label(Role::Image, "Normals after").focus();
    hands.steps();
    let shown = "Shows Normals before";
    assert!(!description(&hands, "Normals after").contains(shown));
    hands.harness.key_down(Key::B);
    hands.steps();
    assert!(description(&hands, "Normals after").contains(shown));
    hands.harness.key_up(Key::B);
    hands.steps();
    assert!(!description(&hands, "Normals after").contains(shown));
}

#[test]
fn a_wipe_divides_two_pictures_and_is_moved_by_keys() {
    let mut hands = comparing();
    hands.click_button("Wipe");
    let wipe = |hands: &Hands| {
        let node = hands.harness.get_by_role_and_label(Role::Slider, "Wipe, Normals after");
        node.accesskit_node().numeric_value().unwrap()
    };
    let before = wipe(&hands);
    hands.harness.get_by_role_and_label(Role::Slider, "Wipe, Normals after").focus();
    hands.steps();
    hands.press(Modifiers::NONE, Key::ArrowRight);
    assert!(wipe(&hands) > before);
    assert!(description(&hands, "Normals after").contains("right of the line Normals before"));
}

#[test]
fn a_paste_of_rubbish_into_the_path_field_is_told() {
    let mut hands = Hands::new();
    let label = "Open a set, or a folder of photos (you can also drop it on this window)";
    hands.harness.get_by_role_and_label(Role::TextInput, label).focus();
    hands.steps();
    hands.harness.input_mut().events.push(Event::Paste("\u{1f600} nowhere".into()));
    hands.steps();
    hands.press(Modifiers::NONE, Key::Enter);
    assert!(!hands.session().is_open());
    assert!(hands.sees("nowhere"));
}

#[test]
fn a_set_that_is_edited_asks_before_the_demo_takes_its_place() {
    let mut hands = Hands::with_demo();
    hands.session().edit("Choose one bounce", |document| document.set.separation.bounces = Some(1));
    hands.run(CommandId::OpenDemo);
    hands.steps();
    assert!(hands.sees("Save the changes to Blue corner?"));
    hands.click_button("Cancel");
    let set = hands.folder.path().join("set");
    assert_eq!(hands.session().document().set.folder, set);
    hands.open(Open::Set(set));
}

#[test]
fn the_next_run_begins_with_the_set_and_the_views_of_the_last() {
    let mut hands = Hands::with_demo();
    hands.press(Modifiers::COMMAND, Key::Backslash);
    hands.session().views.show(Plain::Depth.of(SurfaceName::Before));
    hands.press(Modifiers::COMMAND, Key::S);
    let set = hands.session().document().set.folder.clone();
    let mut next = Hands::with_folder(ended(hands));
    next.harness.state_mut().restore();
    next.steps();
    assert_eq!(next.session().document().set.folder, set);
    let shown: Vec<_> = next.session().views.all().map(|view| view.shown.clone()).collect();
    assert!(shown.len() == 3 && shown.contains(&Plain::Depth.of(SurfaceName::Before).into()), "{shown:?}");
}

#[test]
fn work_that_was_cancelled_says_so_and_is_taken_up_again_on_demand() {
    let mut hands = Hands::new();
    let set = hands.demo();
    hands.session().open(Open::Set(set));
    hands.harness.run_steps(1);
    hands.run(CommandId::CancelJobs);
    hands.harness.run_steps(1);
    hands.wait_to_see("cancelled; \"Retry\" (F9) starts it again");
    hands.press(Modifiers::NONE, Key::F9);
    hands.rest();
    assert!(hands.session().results.meshes().is_some());
}
