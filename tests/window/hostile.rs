//! Sets that were made to do harm: the window says what is wrong, and goes on.

use std::fs;
#[cfg(unix)]
use std::path::Path;

use firstbounce::app::state::results::{StageState, Step};
use firstbounce::app::state::session::Open;

use crate::harness::Hands;
use crate::huge_png;

#[cfg(unix)]
fn put_pipe(path: &Path) {
    let _ = fs::remove_file(path);
    assert!(std::process::Command::new("mkfifo").arg(path).status().unwrap().success());
}

#[cfg(unix)]
#[test]
fn a_set_whose_files_are_pipes_is_told_and_the_window_stays() {
    let mut hands = Hands::new();
    let set = hands.demo();
    put_pipe(&set.join("firstbounce-view.json"));
    hands.open(Open::Set(set.clone()));
    assert!(hands.session().is_open(), "a view that cannot be read is the usual one");
    hands.session().leave();
    put_pipe(&set.join("capture.toml"));
    hands.open(Open::Set(set));
    assert!(!hands.session().is_open());
    assert!(hands.sees("capture.toml: it is not a file"));
}

#[cfg(unix)]
#[test]
fn a_capture_file_that_becomes_a_pipe_is_noticed_and_not_replaced() {
    use eframe::egui::{Key, Modifiers};
    use std::os::unix::fs::FileTypeExt;
    let mut hands = Hands::with_demo();
    let path = hands.session().document().set.file_path();
    put_pipe(&path);
    hands.wait_to_see("Another program has changed capture.toml.");
    hands.session().edit("Choose one bounce", |document| document.set.separation.bounces = Some(1));
    hands.press(Modifiers::COMMAND, Key::S);
    assert!(hands.sees("reload it, save over it"));
    assert!(fs::metadata(&path).unwrap().file_type().is_fifo());
    hands.click_button("Reload it");
    assert!(hands.sees("it is not a file"));
}

#[test]
fn photos_that_claim_more_memory_than_there_is_are_not_decoded() {
    let mut hands = Hands::new();
    let set = hands.demo();
    let photos: Vec<_> = fs::read_dir(set.join("object")).unwrap().map(|entry| entry.unwrap().path()).collect();
    huge_png::write(&photos[0]);
    for photo in &photos[1..] {
        fs::copy(&photos[0], photo).unwrap();
    }
    hands.open(Open::Set(set));
    hands.rest();
    let document = hands.session().document();
    let StageState::Failed { line } = hands.session().results.state(Step::Load, &document) else {
        panic!("the photos were read");
    };
    assert!(line.contains("Blue corner needs about ") && line.contains(" GB are free: close other programs"), "{line}");
    assert!(hands.session().results.loaded().is_none());
}

#[cfg(unix)]
#[test]
fn a_folder_with_links_to_itself_is_looked_through_once() {
    let mut hands = Hands::new();
    let shoot = hands.folder.path().join("shoot");
    fs::create_dir(&shoot).unwrap();
    let photo = fs::read(hands.demo().join("object/left-blue.png")).unwrap();
    for name in ["left-blue.png", "left-green.png"] {
        fs::write(shoot.join(name), &photo).unwrap();
    }
    for name in 0..20 {
        std::os::unix::fs::symlink(&shoot, shoot.join(name.to_string())).unwrap();
    }
    hands.drop_files(&[shoot]);
    assert!(hands.sees("2 files to add"));
}
