//! The Export step: what is chosen there is written, as the command line writes it; and the light file of the Calibrate
//! step.

use std::path::Path;
use std::process::Command;

use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use firstbounce::app::state::panel::PanelName;
use firstbounce::app::state::session::Open;
use firstbounce_capture::mesh_file::OutputFormat;
use serde_json::Value;

use crate::harness::Hands;

fn tick(hands: &mut Hands, label: &str) {
    hands.harness.get_by_role_and_label(Role::CheckBox, label).click_accesskit();
    hands.steps();
}

fn choose(hands: &mut Hands, label: &str) {
    hands.harness.get_by_role_and_label(Role::RadioButton, label).click_accesskit();
    hands.steps();
}

/// Every file of a folder but the reports, which hold times and folders.
fn contents(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let name = |entry: &std::fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
    let entries = std::fs::read_dir(folder).unwrap().map(Result::unwrap);
    let read = |entry: std::fs::DirEntry| (name(&entry), std::fs::read(entry.path()).unwrap());
    let mut files: Vec<_> = entries.map(read).filter(|(name, _)| !name.starts_with("report.")).collect();
    files.sort();
    files
}

#[test]
fn the_window_writes_the_files_of_the_command_line() {
    let mut hands = Hands::with_demo();
    hands.rest();
    hands.session().panel = PanelName::Export;
    hands.steps();
    assert!(hands.sees("glTF (.glb), in m") && hands.sees("x right, z up, y away from the camera"));
    tick(&mut hands, "STL (.stl), in mm");
    tick(&mut hands, "glTF (.glb), in m");
    choose(&mut hands, "z up: x right, z up, y away from the camera");
    choose(&mut hands, "Down, as DirectX reads it");
    tick(&mut hands, "Depth as a 16-bit PNG too");
    tick(&mut hands, "At most this many triangles:");
    hands.type_number("Most triangles of a mesh", "3000");
    let window = hands.folder.path().join("window");
    hands.retype("Folder for the results", &window.display().to_string());
    hands.steps();
    hands.click_button("Write all results");
    hands.wait_to_see("Written into");
    assert!(hands.sees("points lie") && hands.sees("mesh.glb: mesh"));

    let set = hands.session().document().set.folder.clone();
    let line = hands.folder.path().join("line");
    let flags = "--formats obj,ply,stl,glb --z-up --directx --depth-png --triangles 3000 --out";
    let mut program = Command::new(env!("CARGO_BIN_EXE_firstbounce"));
    assert!(program.arg("solve").arg(&set).args(flags.split(' ')).arg(&line).output().unwrap().status.success());
    let (ours, theirs) = (contents(&window), contents(&line));
    let names = |files: &[(String, Vec<u8>)]| files.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&ours), names(&theirs));
    for ((name, ours), (_, theirs)) in ours.iter().zip(&theirs) {
        assert!(ours == theirs, "{name} differs");
    }
    let report = |folder: &Path| -> Value {
        serde_json::from_slice(&std::fs::read(folder.join("report.json")).unwrap()).unwrap()
    };
    assert_eq!(report(&window)["export"], report(&line)["export"]);
}

#[test]
fn what_is_chosen_is_kept_with_the_set_and_can_be_undone() {
    let mut hands = Hands::with_demo();
    let set = hands.session().document().set.folder.clone();
    hands.session().panel = PanelName::Export;
    hands.steps();
    tick(&mut hands, "PLY (.ply), in mm");
    tick(&mut hands, "Depth as a 16-bit PNG too");
    let chosen = hands.session().document().settings.export.clone();
    assert!(chosen.depth_png && !chosen.writes(OutputFormat::Ply) && chosen.writes(OutputFormat::Obj));
    hands.press(Modifiers::COMMAND, Key::Z);
    assert!(!hands.session().document().settings.export.depth_png);
    hands.press(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    hands.press(Modifiers::COMMAND, Key::S);
    hands.open(Open::Set(set));
    assert_eq!(hands.session().document().settings.export, chosen);
}

#[test]
fn the_directions_of_a_light_file_count_as_typed_and_can_be_undone() {
    let mut hands = Hands::with_demo();
    hands.rest();
    hands.session().panel = PanelName::Calibrate;
    hands.steps();
    hands.harness.get_by_label("Use the directions of a light file").click_accesskit();
    hands.steps();
    let path = hands.folder.path().join("dome.lp");
    std::fs::write(&path, "3\ntop-blue.png 0 1 2\nright-blue.png 1 0 2\nleft-blue.png -1 0 0\n").unwrap();
    hands.type_into("Light file", &path.display().to_string());
    hands.press(Modifiers::NONE, Key::Enter);
    hands.wait_until("the directions", |session| session.document().set.calibration.direction.len() == 3);
    assert_eq!(hands.session().document().set.given_direction("left"), Some([-1.0, 0.0, 0.0]));
    assert!(hands.sees("directions of left, top, right taken over by file name"));
    hands.press(Modifiers::COMMAND, Key::Z);
    hands.steps();
    assert!(hands.session().document().set.calibration.direction.is_empty());

    std::fs::write(&path, "2\ntop-blue.png 0 1 2\n").unwrap();
    hands.click_button("Use its directions");
    hands.wait_to_see("dome.lp:1: the count says 2, and 1 lights follow");
    assert!(hands.session().document().set.calibration.direction.is_empty());
}
