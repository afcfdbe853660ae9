//! The whole way through the window, by accessible names alone: what a technician and a researcher do.

use std::process::Command;

use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use firstbounce_core::Mesh;

use crate::harness::Hands;

/// The demo's grey ball as it was rendered: centre and radius.
const TRUE_CIRCLE_PX: [f64; 3] = [100.0, 100.0, 83.333];

#[test]
fn from_the_demo_by_click_and_order_to_a_mesh_that_others_read() {
    let mut hands = Hands::new();
    hands.click_button("Open the demo");
    hands.rest();

    // Calibrate: beside the grey ball, not on its edge.
    hands.open_step("2  Calibrate");
    hands.click_button("Show grey ball");
    hands.click_button("Forget grey ball");
    hands.rest();
    hands.click_picture("Grey ball, left, blue", (200, 200), [188.0, 130.0]);
    hands.wait_to_see("Grey ball: centre");
    hands.rest();
    for (what, truth) in ["x", "y", "radius"].into_iter().zip(TRUE_CIRCLE_PX) {
        let found = hands.number(&format!("Grey ball, {what}"));
        assert!((found - truth).abs() < 1.0, "{what} is {found}, rendered with {truth}");
    }
    hands.press(Modifiers::COMMAND, Key::S);
    let printed = calibrate_json(&hands);
    for light in ["left", "top", "right"] {
        let shown = hands.number(&format!("alpha, {light}, green"));
        let alpha = printed["alpha"][light][1].as_f64().unwrap();
        assert!((shown - alpha).abs() < 1e-9, "{light}: {shown} in the window, {alpha} by the command line");
    }

    // Separate: colours and shape together are fine; the paper's bounces are not, and their verdict follows m and beta at once.
    hands.open_step("3  Separate");
    hands.rest();
    assert!(hands.sees("Fine") && !hands.sees("too dark"));
    hands.harness.get_by_role_and_label(Role::RadioButton, "Colours (the paper's bounces)").click();
    hands.steps();
    hands.harness.get_by_role_and_label(Role::RadioButton, "m = 2").click();
    hands.steps();
    assert!(hands.sees("Take care") && hands.sees("too dark"));
    assert!(!hands.sees("Do not trust"));
    hands.type_number("beta of green", "0.97");
    assert!(hands.sees("Do not trust") && !hands.sees("Take care"));
    hands.rest();
    hands.press(Modifiers::COMMAND, Key::Z);
    assert!(!hands.sees("Do not trust") && hands.sees("Take care"));

    // Look at the normals, and take the mesh along.
    hands.choose_picture("Picture: Photo, left, blue", "Surface", "Normals after");
    hands.rest();
    hands.harness.get_by_role_and_label(Role::Image, "Normals after");
    hands.open_step("5  Export");
    let out = hands.folder.path().join("out");
    hands.retype("Folder for the results", &out.display().to_string());
    hands.click_button("Write all results");
    hands.wait_to_see("Written into");
    let after = hands.session().results.meshes().unwrap();
    assert_is(&tobj_mesh(&out.join("mesh.obj")), &after.after);
}

/// `firstbounce calibrate SET --json` of the set that is open.
fn calibrate_json(hands: &Hands) -> serde_json::Value {
    let set = hands.folder.path().join("config/demo");
    let program = Command::new(env!("CARGO_BIN_EXE_firstbounce")).arg("calibrate").arg("--json").arg(set).output();
    serde_json::from_slice(&program.unwrap().stdout).unwrap()
}

fn tobj_mesh(path: &std::path::Path) -> tobj::Mesh {
    let options = tobj::LoadOptions { single_index: true, ..tobj::LoadOptions::default() };
    let (mut models, _) = tobj::load_obj(path, &options).unwrap();
    assert_eq!(models.len(), 1);
    models.remove(0).mesh
}

/// As many vertices and faces, the same bounds, and every normal toward the camera.
fn assert_is(read: &tobj::Mesh, shown: &Mesh) {
    let [vertices, normals] = [&read.positions, &read.normals].map(|all| all.as_chunks::<3>().0);
    assert!(!vertices.is_empty() && !read.indices.is_empty());
    assert_eq!(vertices.len(), shown.positions.len());
    assert_eq!(read.indices.len(), 3 * shown.triangles.len());
    for axis in 0..3 {
        let bounds = |all: &mut dyn Iterator<Item = f32>| {
            all.fold([f32::INFINITY, f32::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
        };
        let read = bounds(&mut vertices.iter().map(|vertex| vertex[axis]));
        let shown = bounds(&mut shown.positions.iter().map(|position| position[axis]));
        assert_eq!(read, shown, "axis {axis}");
    }
    assert_eq!(normals.len(), vertices.len());
    assert!(normals.iter().all(|normal| normal[2] > 0.0));
    // Wound so that readers which make normals of their own make them face the camera too.
    let toward = read.indices.as_chunks::<3>().0.iter().filter(|face| {
        let [a, b, c] = face.map(|index| vertices[index as usize]);
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]) > 0.0
    });
    assert_eq!(toward.count(), shown.triangles.len());
}

/// Six photos of the demo's object under names that tell nothing, in the order in which a camera counts.
const UNNAMED: [(&str, &str, &str); 6] = [
    ("img_0001.png", "left", "blue"),
    ("img_0002.png", "left", "green"),
    ("img_0003.png", "top", "blue"),
    ("img_0004.png", "top", "green"),
    ("img_0005.png", "right", "blue"),
    ("img_0006.png", "right", "green"),
];

#[test]
fn a_folder_of_names_that_tell_nothing_is_dropped_assigned_by_hand_and_solved() {
    let mut hands = Hands::new();
    let demo = hands.demo();
    let shoot = hands.folder.path().join("shoot");
    std::fs::create_dir(&shoot).unwrap();
    for (file, light, colour) in UNNAMED {
        std::fs::copy(demo.join(format!("object/{light}-{colour}.png")), shoot.join(file)).unwrap();
    }
    hands.drop_files(std::slice::from_ref(&shoot));
    hands.wait_to_see("6 files are not recognised");
    for (file, light, colour) in UNNAMED {
        hands.name_by_hand(&format!("Light of {file}"), light);
        hands.name_by_hand(&format!("Colour of {file}"), colour);
    }
    hands.click_button("Add 6 files");
    hands.rest();
    let why = "Beta is unknown";
    hands.open_step("3  Separate");
    assert!(hands.sees(why), "a step that cannot be done says what is missing");

    // The lamps and the paint of another day's set.
    hands.open_step("2  Calibrate");
    hands.harness.get_by_label("Use the rig of another set").click_accesskit();
    hands.steps();
    hands.harness.get_by_label("The same paint: beta too").click_accesskit();
    hands.steps();
    hands.type_into("Set whose rig to use", &demo.display().to_string());
    hands.press(Modifiers::NONE, Key::Enter);
    hands.wait_to_see("taken over for left, top, right");
    hands.rest();

    hands.open_step("4  Shape");
    assert!(hands.sees("Mean change of the normals"));
    hands.press(Modifiers::COMMAND, Key::S);
    let saved = firstbounce_capture::CaptureSet::open(&shoot).unwrap();
    assert!(saved.check().is_empty());
    assert_eq!((saved.lights.len(), saved.colours.len(), saved.shots.len()), (3, 2, 6));
    // What came out is what the command line makes of the saved set.
    let options = firstbounce_capture::pipeline::SolveOptions::default();
    let solved =
        firstbounce_capture::pipeline::solve(&saved, &options, &firstbounce_capture::pipeline::Unattended).unwrap();
    assert_eq!(hands.session().results.meshes().unwrap().after, solved.after.unwrap().mesh);
}
