//! Where to begin, and what goes on around a set.

use std::fs;
use std::path::{Path, PathBuf};

use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use firstbounce::app::state::session::Open;

use crate::harness::Hands;

#[test]
fn the_first_window_says_where_to_begin_and_the_demo_opens() {
    let mut hands = Hands::new();
    assert!(hands.sees("Open a set, or a folder of photos"));
    hands.click_button("Open the demo");
    assert!(hands.session().is_open());
    assert_eq!(hands.session().document().set.title(), "Blue corner");
    assert!(hands.sees("Opened Blue corner"));
    assert!(hands.session().problems().is_empty());
}

#[test]
fn a_set_is_opened_by_its_typed_path_and_offered_again() {
    let mut hands = Hands::new();
    let set = hands.demo();
    hands.type_into(
        "Open a set, or a folder of photos (you can also drop it on this window)",
        &set.display().to_string(),
    );
    hands.press(Modifiers::NONE, Key::Enter);
    assert_eq!(hands.session().document().set.folder, set);
    hands.press(Modifiers::COMMAND, Key::O);
    assert!(!hands.session().is_open());
    let recent = set.display().to_string();
    hands.harness.get_by_label(&recent).click();
    hands.steps();
    assert!(hands.session().is_open());
}

#[test]
fn a_dialog_answers_off_the_ui_thread() {
    let mut hands = Hands::new();
    let set = hands.demo();
    hands.answers.0.lock().unwrap().push(set.clone());
    hands.click_button("Browse...");
    hands.wait_until("the dialog's answer", |session| session.is_open());
    assert_eq!(hands.session().document().set.folder, set);
}

#[test]
fn a_path_that_is_no_set_is_told_and_the_window_stays() {
    let mut hands = Hands::new();
    let path = hands.folder.path().join("nowhere/capture.toml");
    hands.open(Open::Set(path));
    assert!(!hands.session().is_open());
    assert!(hands.sees("nowhere"));
    assert!(hands.sees("Open the demo"));
}

#[test]
fn the_palette_finds_a_command_by_a_few_letters() {
    let mut hands = Hands::with_demo();
    hands.press(Modifiers::COMMAND, Key::P);
    hands.type_into("Find a command, a picture or a set", "spltrght");
    hands.press(Modifiers::NONE, Key::Enter);
    assert_eq!(hands.session().views.all().count(), 3);
}

#[test]
fn every_key_of_the_table_is_given_once() {
    use firstbounce::app::window::commands::COMMANDS;
    let keys: Vec<_> = COMMANDS.iter().filter_map(|command| command.shortcut).collect();
    for (index, shortcut) in keys.iter().enumerate() {
        assert!(!keys[..index].contains(shortcut), "{shortcut:?} runs two commands");
    }
}

#[test]
fn the_help_sheet_lists_every_command() {
    let mut hands = Hands::with_demo();
    hands.press(Modifiers::NONE, Key::F1);
    for command in firstbounce::app::window::commands::COMMANDS {
        assert!(hands.sees(command.title), "{}", command.title);
    }
}

#[test]
fn views_split_and_close_and_their_arrangement_comes_back() {
    let mut hands = Hands::with_demo();
    hands.press(Modifiers::COMMAND, Key::Backslash);
    hands.press(Modifiers::COMMAND, Key::T);
    assert_eq!(hands.session().views.all().count(), 4, "the two of Captures, and two more");
    hands.press(Modifiers::COMMAND, Key::W);
    assert_eq!(hands.session().views.all().count(), 3);
    let set = hands.session().document().set.folder.clone();
    hands.press(Modifiers::COMMAND, Key::O);
    hands.open(Open::Set(set));
    assert_eq!(hands.session().views.all().count(), 3);
}

/// What a run leaves that was killed while it opened `set`.
fn killed_while_opening(folder: &Path, set: &Path) -> PathBuf {
    let run = folder.join("config/recovery/1");
    fs::create_dir_all(&run).unwrap();
    fs::write(run.join("lock"), "").unwrap();
    fs::write(run.join("opening.json"), serde_json::json!({ "set": set }).to_string()).unwrap();
    run
}

/// A window that remembers a set as its last one, and was killed while it opened it.
fn after_a_kill() -> (Hands, PathBuf, PathBuf) {
    let mut hands = Hands::with_demo();
    hands.rest();
    let set = hands.session().document().set.folder.clone();
    let Hands { harness, folder, .. } = hands;
    drop(harness);
    let run = killed_while_opening(folder.path(), &set);
    let mut next = Hands::with_folder(folder);
    next.harness.state_mut().restore();
    next.steps();
    (next, set, run)
}

#[test]
fn the_set_that_was_open_when_a_run_was_killed_is_offered_and_not_opened_again() {
    let (mut hands, set, run) = after_a_kill();
    let shown = set.display().to_string();
    assert!(!hands.session().is_open());
    assert!(hands.sees(&format!("The last run did not end well while {shown} was open.")));
    assert!(hands.harness.query_by_role_and_label(Role::Link, &shown).is_some(), "it is still among the recent sets");
    hands.click_button(&format!("Open: {shown}"));
    assert_eq!(hands.session().document().set.folder, set);
    assert!(!run.exists(), "it is offered once");
}

#[test]
fn a_set_that_is_not_opened_now_is_not_opened_at_the_next_start_either() {
    let (mut hands, set, run) = after_a_kill();
    hands.click_button(&format!("Not now: {}", set.display()));
    assert!(!hands.sees("did not end well") && !run.exists());
    assert_eq!(hands.session().preferences.recent, [set]);
    let Hands { harness, folder, .. } = hands;
    drop(harness);
    let mut next = Hands::with_folder(folder);
    next.harness.state_mut().restore();
    next.steps();
    assert!(!next.session().is_open());
}

#[test]
fn that_a_set_is_being_opened_is_noted_until_its_results_were_drawn() {
    let mut hands = Hands::with_demo();
    let note = hands.folder.path().join("config/recovery").join(std::process::id().to_string()).join("opening.json");
    assert!(note.is_file());
    hands.rest();
    hands.steps();
    assert!(!note.exists());
    let nowhere = hands.folder.path().join("nowhere");
    hands.open(Open::Set(nowhere));
    assert!(!note.exists(), "a set that could not be read did not end the run");
}

#[test]
fn the_set_of_the_last_run_is_opened_again_where_that_run_ended_in_order() {
    let hands = Hands::with_demo();
    let Hands { harness, folder, .. } = hands;
    drop(harness);
    let mut next = Hands::with_folder(folder);
    next.harness.state_mut().restore();
    assert!(next.session().is_open());
}
