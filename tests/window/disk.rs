//! The document on the disk: saving, another program, crashes.

use std::fs;

use eframe::egui::{Key, Modifiers};
use firstbounce::app::state::session::Open;

use crate::harness::Hands;

#[test]
fn saving_keeps_the_comments_of_the_file() {
    let mut hands = Hands::with_demo();
    let path = hands.session().document().set.file_path();
    fs::write(&path, format!("# the lab's rig\n{}", fs::read_to_string(&path).unwrap())).unwrap();
    let set = hands.session().document().set.folder.clone();
    hands.open(Open::Set(set));
    hands.session().edit("Choose one bounce", |document| document.set.separation.bounces = Some(1));
    hands.press(Modifiers::COMMAND, Key::S);
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.starts_with("# the lab's rig\n") && text.contains("bounces = 1"), "{text}");
}

#[test]
fn a_change_by_another_program_is_noticed_and_reloaded_on_demand() {
    let mut hands = Hands::with_demo();
    let path = hands.session().document().set.file_path();
    let text = fs::read_to_string(&path).unwrap();
    fs::write(&path, text.replace("name = \"Blue corner\"", "name = \"Green corner\"")).unwrap();
    let since = std::time::Instant::now();
    while !hands.sees("Another program has changed capture.toml.") {
        assert!(since.elapsed().as_secs() < 20, "nobody noticed");
        std::thread::sleep(std::time::Duration::from_millis(50));
        hands.steps();
    }
    hands.press(Modifiers::COMMAND, Key::S);
    assert!(hands.sees("reload it, save over it"), "saving must not overwrite what nobody has seen");
    hands.click_button("Reload it");
    assert_eq!(hands.session().document().set.title(), "Green corner");
    hands.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(hands.session().document().set.title(), "Blue corner");
}

#[test]
fn a_set_whose_folder_is_gone_is_saved_elsewhere() {
    let mut hands = Hands::with_demo();
    let folder = hands.session().document().set.folder.clone();
    hands.session().edit("Choose one bounce", |document| document.set.separation.bounces = Some(1));
    fs::rename(&folder, folder.with_extension("moved")).unwrap();
    hands.press(Modifiers::COMMAND, Key::S);
    assert!(hands.sees("choose \"Save as\""));
    let new = hands.folder.path().join("elsewhere");
    hands.press(Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    hands.retype("Folder of the new set", &new.display().to_string());
    hands.click_button("Save here");
    let saved = firstbounce_capture::CaptureSet::open(&new).unwrap();
    assert_eq!(saved.bounces(), 1);
    let photo = saved.resolve(&saved.shots[0].files[0]);
    assert!(photo.starts_with(&folder), "photos stay where they were: {}", photo.display());
}

#[cfg(unix)]
#[test]
fn opening_and_closing_a_set_writes_through_no_link_and_says_so_once() {
    let mut hands = Hands::with_demo();
    let set = hands.session().document().set.folder.clone();
    hands.session().leave();
    let victim = hands.folder.path().join("settings of another program");
    fs::write(&victim, "alias ls='ls --color'\n").unwrap();
    let view = set.join("firstbounce-view.json");
    if view.exists() {
        fs::remove_file(&view).unwrap();
    }
    std::os::unix::fs::symlink(&victim, &view).unwrap();
    let before = fs::metadata(&victim).unwrap().modified().unwrap();

    hands.open(Open::Set(set));
    hands.session().edit("Choose one bounce", |document| document.set.separation.bounces = Some(1));
    hands.press(Modifiers::COMMAND, Key::S);
    assert!(hands.sees("Saved "), "the set itself is saved");
    let lines =
        hands.session().log.lines().filter(|line| line.text.contains("firstbounce-view.json is a link")).count();
    assert_eq!(lines, 1);
    hands.session().leave();
    assert_eq!(fs::read_to_string(&victim).unwrap(), "alias ls='ls --color'\n");
    assert_eq!(fs::metadata(&victim).unwrap().modified().unwrap(), before);
    assert!(view.is_symlink());
}
