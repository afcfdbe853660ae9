use std::fs::File;
use std::path::{Path, PathBuf};

use tempfile::tempdir;

use firstbounce_capture::set::ShapeSettings;

use super::*;

mod beside;

const SET: &str = "schema = 1\nname = \"Vase\"\n";

fn opened() -> (tempfile::TempDir, Editor) {
    let folder = tempdir().unwrap();
    std::fs::write(folder.path().join("capture.toml"), SET).unwrap();
    let editor = Editor::open(folder.path()).unwrap();
    (folder, editor)
}

fn rename(editor: &mut Editor, name: &str) {
    editor.edit("Rename the set", |document| document.set.name = name.into());
}

#[test]
fn edits_of_one_gesture_are_one_step_back_and_of_two_are_two() {
    let (_folder, mut editor) = opened();
    rename(&mut editor, "Jug");
    rename(&mut editor, "Jar");
    editor.begin_gesture();
    rename(&mut editor, "Cup");
    editor.undo();
    assert_eq!(editor.document().set.name, "Jar");
    editor.undo();
    assert_eq!(editor.document().set.name, "Vase");
    assert!(!editor.is_dirty() && editor.undo_name().is_none());
    assert_eq!(editor.redo_name().as_deref(), Some("Rename the set"));
}

#[test]
fn a_drag_that_comes_back_to_where_it_began_is_no_edit() {
    let (_folder, mut editor) = opened();
    rename(&mut editor, "Jug");
    rename(&mut editor, "Vase");
    assert!(editor.undo_name().is_none() && !editor.is_dirty());
}

#[test]
fn undo_past_a_save_is_something_to_save_again() {
    let (_folder, mut editor) = opened();
    rename(&mut editor, "Jug");
    editor.save().unwrap();
    assert!(!editor.is_dirty());
    editor.undo();
    assert!(editor.is_dirty());
}

#[test]
fn what_could_not_be_read_stays_beside_the_file_that_replaces_it() {
    let folder = tempdir().unwrap();
    let text = format!("{SET}maks = \"m.png\"\n");
    std::fs::write(folder.path().join("capture.toml"), &text).unwrap();
    let mut editor = Editor::open(folder.path()).unwrap();
    assert!(!editor.unread().is_empty());
    rename(&mut editor, "Jug");
    editor.save().unwrap();
    assert_eq!(std::fs::read_to_string(folder.path().join("capture.toml.unread")).unwrap(), text);
    assert!(std::fs::read_to_string(folder.path().join("capture.toml")).unwrap().contains("Jug"));
}

#[test]
fn settings_are_kept_beside_the_set() {
    let (folder, mut editor) = opened();
    editor.edit("Change patches", |document| document.settings.nayar.patches = 700);
    editor.save().unwrap();
    assert_eq!(Editor::open(folder.path()).unwrap().document().settings.nayar.patches, 700);
}

#[test]
fn settings_that_earlier_versions_kept_beside_the_set_are_taken_over_once() {
    let (folder, _) = opened();
    let old = r#"{ "settings": { "shape": { "left_out": [], "shadow_fraction": 0.2, "outlier_fraction": 0.3, "rounds": 2,
        "indirect_radius_px": 5 }, "nayar": { "compute": true, "patches": 700, "max_iterations": 4 } } }"#;
    std::fs::write(folder.path().join(VIEW_FILE), old).unwrap();
    let mut editor = Editor::open(folder.path()).unwrap();
    let document = editor.document();
    assert_eq!((document.set.shape.shadow_share, document.set.shape.indirect_window_px), (0.2, 5));
    assert!(document.settings.is_compared(Method::Shape) && document.settings.nayar.patches == 700);
    rename(&mut editor, "Jug");
    editor.save().unwrap();
    assert!(std::fs::read_to_string(folder.path().join("capture.toml")).unwrap().contains("shadow_share = 0.2"));
    assert!(!std::fs::read_to_string(folder.path().join(VIEW_FILE)).unwrap().contains("shadow_fraction"));

    // From then on capture.toml counts.
    editor.edit("Back to the defaults", |document| document.set.shape = ShapeSettings::default());
    editor.save().unwrap();
    let again = Editor::open(folder.path()).unwrap().document();
    assert!(again.set.shape == ShapeSettings::default() && again.settings.is_compared(Method::Shape));
}

#[test]
fn a_moved_set_names_its_photos_by_paths_that_still_lead_there() {
    let set = CaptureSet {
        folder: PathBuf::from("/lab/vase"),
        mask: Some("mask.png".into()),
        shots: vec![firstbounce_capture::set::Shot { files: vec!["a/1.png".into()], ..Default::default() }],
        ..CaptureSet::default()
    };
    let elsewhere = relocated(&set, std::path::Path::new("/home/vase")).unwrap();
    assert_eq!(elsewhere.resolve(&elsewhere.shots[0].files[0]), set.resolve("a/1.png"));
    let above = relocated(&set, std::path::Path::new("/lab")).unwrap();
    assert_eq!((above.mask.as_deref(), above.shots[0].files[0].as_str()), (Some("vase/mask.png"), "vase/a/1.png"));
}

/// One test for all of recovery: what the panic hook writes is one for the whole program.
#[test]
fn a_crash_leaves_the_unsaved_document_to_the_next_run_and_an_orderly_end_leaves_nothing() {
    let root = tempdir().unwrap();
    let (_folder, mut editor) = opened();
    rename(&mut editor, "Jug");

    // A run that crashed: its folder is there, and nothing holds the lock.
    let crashed = root.path().join("0");
    std::fs::create_dir(&crashed).unwrap();
    File::create(crashed.join("lock")).unwrap();
    let run = Recovery::new(root.path().to_owned());
    run.note(Some(editor.document()));
    assert!(save_everything_now());
    let own = root.path().join(std::process::id().to_string());
    std::fs::copy(own.join("document.json"), crashed.join("document.json")).unwrap();

    let found = run.found();
    let [(folder, kept)] = found.as_slice() else { panic!("a living run offers its own document: {found:?}") };
    assert_eq!((folder, kept.title.as_str()), (&crashed, "Jug"));
    let restored = Editor::recovered(&kept.text, kept.path.clone(), kept.settings.clone());
    assert_eq!(restored.document(), editor.document());
    assert!(restored.is_dirty());

    run.discard(&crashed);
    assert!(run.found().is_empty());
    drop(run);
    assert!(!own.exists());
    assert!(!save_everything_now());

    // A run that panics drops its window on the way out, and must not take the document with it.
    let run = Recovery::new(root.path().to_owned());
    run.note(Some(editor.document()));
    assert!(save_everything_now());
    let panicked = std::panic::catch_unwind(std::panic::AssertUnwindSafe(move || {
        let _run = run;
        panic!("as a bug would");
    }));
    assert!(panicked.is_err() && own.join("document.json").is_file());
}

#[test]
fn only_a_run_that_lives_no_more_left_a_set_opening() {
    let root = tempdir().unwrap();
    let (one, other) = (Recovery::new(root.path().to_owned()), Recovery::new(root.path().to_owned()));
    one.note_opening(Path::new("/sets/one"));
    assert_eq!(other.left_opening(), [], "a run that lives opens its own set");
    let killed = root.path().join("1");
    std::fs::create_dir(&killed).unwrap();
    for name in ["lock", "document.json"] {
        std::fs::write(killed.join(name), "").unwrap();
    }
    std::fs::write(killed.join("opening.json"), "{\"set\":\"/sets/two\"}").unwrap();
    let left = other.left_opening();
    assert_eq!(left, one.left_opening());
    assert_eq!(left, [LeftOpening { set: "/sets/two".into(), run: killed.clone() }]);
    other.forget_opening(&left[0]);
    assert!(other.left_opening().is_empty() && killed.join("document.json").is_file());
    other.discard(&killed);
    assert!(!killed.exists());
}

#[test]
fn another_run_of_the_same_number_takes_a_folder_of_its_own() {
    let root = tempdir().unwrap();
    let left_behind = root.path().join(std::process::id().to_string());
    std::fs::create_dir_all(&left_behind).unwrap();
    std::fs::write(left_behind.join("document.json"), "kept").unwrap();
    let _run = Recovery::new(root.path().to_owned());
    assert_eq!(std::fs::read_to_string(left_behind.join("document.json")).unwrap(), "kept");
    assert_eq!(std::fs::read_dir(root.path()).unwrap().count(), 2);
}

#[test]
fn a_set_is_saved_beside_others_and_never_over_them() {
    let (_folder, mut editor) = opened();
    let other = tempdir().unwrap();
    std::fs::write(other.path().join("capture.toml"), "schema = 1\nname = \"Other\"\n").unwrap();
    let line = editor.save_as(other.path()).unwrap_err().to_string();
    assert!(line.contains("another set lies here"), "{line}");
    assert!(std::fs::read_to_string(other.path().join("capture.toml")).unwrap().contains("Other"));
}

#[test]
fn undo_across_save_as_leaves_the_photos_where_they_are() {
    let (folder, mut editor) = opened();
    editor.edit("Choose a mask", |document| document.set.mask = Some("mask.png".into()));
    editor.begin_gesture();
    rename(&mut editor, "Jug");
    let elsewhere = tempdir().unwrap();
    editor.save_as(elsewhere.path()).unwrap();
    editor.undo();
    editor.undo();
    assert_eq!(editor.document().set.name, "Vase");
    editor.save().unwrap();
    let saved = firstbounce_capture::set::Reading::open(elsewhere.path()).unwrap().set;
    assert_eq!(saved.resolve(saved.mask.as_deref().unwrap()), folder.path().join("mask.png"));
}

#[test]
fn settings_that_were_never_saved_are_not_lost_with_a_reload() {
    let (folder, mut editor) = opened();
    editor.edit("Change patches", |document| document.settings.nayar.patches = 700);
    std::fs::write(folder.path().join("capture.toml"), "schema = 1\nname = \"Jar\"\n").unwrap();
    editor.reload().unwrap();
    let document = editor.document();
    assert_eq!((document.set.name.as_str(), document.settings.nayar.patches), ("Jar", 700));
    assert!(editor.is_dirty());
}
