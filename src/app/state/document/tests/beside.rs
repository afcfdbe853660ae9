//! Files that the window keeps beside a set that came from elsewhere.

use std::fs;
use std::path::Path;

use firstbounce_capture::WriteError;
use tempfile::tempdir;

use super::super::disk::write_view;
use super::{opened, rename};
use crate::app::state::document::{Editor, SaveError, VIEW_FILE};

/// Not all of it can be read, so that saving keeps it beside the new one.
const HALF_READ: &str = "schema = 1\nname = \"Vase\"\nmaks = \"m.png\"\n";

fn text_of(path: &Path) -> String {
    fs::read_to_string(path).unwrap()
}

#[cfg(unix)]
mod links {
    use firstbounce_testing::{There, everything_in};

    use super::*;

    #[test]
    fn no_link_in_place_of_a_kept_file_is_written_through() {
        for (capture, view, unread) in There::ALL
            .iter()
            .flat_map(|c| There::ALL.iter().flat_map(move |v| There::ALL.iter().map(move |u| (*c, *v, *u))))
        {
            let place = tempdir().unwrap();
            let (set, outside) = (place.path().join("set"), place.path().join("outside"));
            fs::create_dir(&set).unwrap();
            fs::create_dir(&outside).unwrap();
            for (there, name, text) in
                [(capture, "capture.toml", HALF_READ), (view, VIEW_FILE, "{}"), (unread, "capture.toml.unread", "mine")]
            {
                fs::write(outside.join(name), text).unwrap();
                there.put(&set.join(name), text, &outside.join(name));
            }
            let before = everything_in(&outside);

            let opened = Editor::open(&set);
            assert_eq!(
                opened.is_ok(),
                matches!(capture, There::File | There::LinkToFile | There::SecondName),
                "{capture:?}"
            );
            let mut editor = opened.unwrap_or_else(|_| Editor::untitled(&set));
            rename(&mut editor, "Jug");
            let saved = editor.save();
            let may_be_saved = matches!(capture, There::Nothing | There::File | There::SecondName);
            assert_eq!(saved.is_ok(), may_be_saved, "{capture:?}: {saved:?}");
            if let Ok(not_kept) = saved {
                let is_kept = matches!(view, There::Nothing | There::File | There::SecondName);
                assert_eq!(not_kept.is_none(), is_kept, "{view:?}: {not_kept:?}");
            }
            // As when the window is closed.
            let _ = write_view(&set, "layout", "changed".into());
            assert_eq!(everything_in(&outside), before, "{capture:?} {view:?} {unread:?}");
        }
    }
}

#[test]
fn a_text_that_is_not_the_windows_stays_where_its_settings_would_be() {
    let (folder, mut editor) = opened();
    let path = folder.path().join(VIEW_FILE);
    for text in ["alias ls='ls --color'\n", "[1, 2]", "", "\"text\""] {
        fs::write(&path, text).unwrap();
        rename(&mut editor, &format!("Jug {}", text.len()));
        let not_kept = editor.save().unwrap();
        assert!(matches!(not_kept, Some(WriteError::Foreign { .. })), "{not_kept:?}");
        assert!(write_view(folder.path(), "layout", "changed".into()).is_err());
        assert_eq!(text_of(&path), text);
    }
    assert!(text_of(&folder.path().join("capture.toml")).contains("Jug 6"), "the set itself is saved");
}

#[test]
fn what_other_versions_keep_beside_a_set_stays_there() {
    let (folder, mut editor) = opened();
    fs::write(folder.path().join(VIEW_FILE), "{\"later\": [1]}").unwrap();
    assert!(editor.save().unwrap().is_none());
    let kept: serde_json::Value = serde_json::from_str(&text_of(&folder.path().join(VIEW_FILE))).unwrap();
    assert!(kept["later"][0] == 1 && kept["settings"].is_object(), "{kept}");
}

#[test]
fn every_text_that_could_not_be_read_has_a_copy_of_its_own() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("capture.toml");
    let texts = [HALF_READ.to_owned(), format!("{HALF_READ}maks2 = 1\n"), HALF_READ.to_owned()];
    for (number, text) in texts.iter().enumerate() {
        fs::write(&path, text).unwrap();
        let mut editor = Editor::open(folder.path()).unwrap();
        rename(&mut editor, &format!("Jug {number}"));
        editor.save().unwrap();
    }
    let copy = |name: &str| folder.path().join(name);
    assert_eq!(text_of(&copy("capture.toml.unread")), texts[0]);
    assert_eq!(text_of(&copy("capture.toml.unread-2")), texts[1]);
    assert!(!copy("capture.toml.unread-3").exists(), "the third text is the first");
}

#[test]
fn a_set_is_not_saved_over_a_file_that_is_no_text() {
    let (_folder, mut editor) = opened();
    let other = tempdir().unwrap();
    fs::write(other.path().join("capture.toml"), b"caf\xe9").unwrap();
    assert!(matches!(editor.save_as(other.path()), Err(SaveError::OtherSet { .. })));
    let mut untitled = Editor::untitled(other.path());
    rename(&mut untitled, "Jug");
    assert!(matches!(untitled.save(), Err(SaveError::ChangedOnDisk { .. })));
    assert_eq!(fs::read(other.path().join("capture.toml")).unwrap(), b"caf\xe9");
}
