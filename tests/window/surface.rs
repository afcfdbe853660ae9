//! The surface in 3D: walking around it, measuring on it, comparing it with a scan.

use std::path::PathBuf;
use std::process::Command;

use eframe::egui::accesskit::Role;
use eframe::egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use firstbounce::app::state::layout::Shown;
use firstbounce::app::state::panel::PanelName;
use firstbounce::app::state::surfaces::{Shade, SurfaceLook};
use firstbounce::app::window::commands::CommandId;
use firstbounce::gpu::mesh::Lens;
use firstbounce_capture::mesh_file::write_ply;
use firstbounce_core::Mesh;
use nalgebra::{Isometry3, Point3, Vector3};

use crate::harness::Hands;

const VIEW: &str = "Surface in 3D";

fn with_surface() -> Hands {
    let mut hands = Hands::with_demo();
    hands.rest();
    hands.press(Modifiers::NONE, Key::Num4);
    hands.run(CommandId::OneView);
    hands.wait_until("the surface in 3D", |session| {
        session.surfaces.is_at_rest()
            && session.surfaces.layer(firstbounce::app::state::surfaces::LayerName::AFTER).is_some()
    });
    hands
}

/// Pushes a button of the panel, in sight or not.
fn push(hands: &mut Hands, label: &str) {
    hands.harness.get_by_role_and_label(Role::Button, label).click_accesskit();
    hands.steps();
}

fn look(hands: &mut Hands) -> SurfaceLook {
    hands.session().views.active().expect("a view").surface.clone()
}

/// The 3D view: there is one.
fn view(hands: &Hands) -> egui_kittest::Node<'_> {
    let mut views =
        hands.harness.query_all_by_label_contains(VIEW).filter(|node| node.accesskit_node().role() == Role::Image);
    views.next().expect("a view in 3D")
}

fn value(hands: &Hands) -> String {
    let view = view(hands);
    view.accesskit_node().value().unwrap_or_default()
}

fn rect(hands: &Hands) -> Rect {
    view(hands).rect()
}

fn click_at(hands: &mut Hands, pos: Pos2) {
    hands.harness.hover_at(pos);
    for pressed in [true, false] {
        let button = PointerButton::Primary;
        hands.harness.event(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
        hands.harness.run_steps(1);
    }
    // Two clicks in a row would be a double click.
    hands.harness.run_steps(40);
}

fn after(hands: &mut Hands) -> std::sync::Arc<Mesh> {
    hands.session().results.meshes().expect("meshes").after.clone()
}

#[test]
fn keys_turn_and_stand_the_eye_and_enter_picks_the_middle() {
    let mut hands = with_surface();
    assert!(value(&hands).starts_with("the surface after, Studio, scale bar "), "{}", value(&hands));
    view(&hands).focus();
    hands.steps();
    hands.press(Modifiers::NONE, Key::ArrowRight);
    let turned = look(&mut hands).camera.expect("the eye was moved");
    assert!((turned.yaw_deg - 20.0).abs() < 1e-9 && (turned.pitch_deg - 25.0).abs() < 1e-9, "{turned:?}");
    hands.press(Modifiers::NONE, Key::Plus);
    assert!((look(&mut hands).camera.unwrap().distance / turned.distance - 0.8).abs() < 1e-9);
    hands.press(Modifiers::NONE, Key::F);
    assert_eq!(look(&mut hands).camera, None);

    hands.press(Modifiers::ALT, Key::P);
    hands.run(CommandId::FrontView);
    hands.steps();
    let front = look(&mut hands);
    assert_eq!(
        (front.lens, front.camera.unwrap().yaw_deg, front.camera.unwrap().pitch_deg),
        (Lens::Orthographic, 0.0, 0.0)
    );
    view(&hands).focus();
    hands.steps();
    hands.press(Modifiers::NONE, Key::Enter);
    assert!(hands.sees("Point on the surface after: x "));
    // From the front the middle of the view is the middle of the surface's box.
    let mesh = after(&mut hands);
    let (low, high) = mesh.bounds().unwrap();
    let middle = nalgebra::center(&low, &high);
    let id = hands.session().views.active().unwrap().id;
    let picked = hands.harness.state_mut().canvases().surface(id).picked[0].point;
    assert!((picked.x - f64::from(middle.x)).abs() < 1e-3 && (picked.y - f64::from(middle.y)).abs() < 1e-3);
    let near = |p: &&Point3<f32>| (p.xy() - middle.xy()).norm();
    let vertex = mesh.positions.iter().min_by(|a, b| near(a).total_cmp(&near(b))).unwrap();
    assert!((picked.z - f64::from(vertex.z)).abs() < 2.0 * f64::from(near(&vertex)) + 0.5, "{picked} {vertex}");
    assert!(value(&hands).contains("Point on the surface after"));
}

#[test]
fn two_clicks_are_a_distance_and_a_section_is_plotted() {
    let mut hands = with_surface();
    hands.harness.get_by_label("Distance").click();
    hands.steps();
    let middle = rect(&hands).center();
    click_at(&mut hands, middle);
    click_at(&mut hands, middle + vec2(40.0, 10.0));
    let id = hands.session().views.active().unwrap().id;
    let picked = hands.harness.state_mut().canvases().surface(id).picked.clone();
    assert_eq!(picked.len(), 2);
    let length = (picked[1].point - picked[0].point).norm();
    assert!(length > 0.0 && hands.sees(&format!("Distance: {length:.3} mm")));

    hands.harness.get_by_label("Section").click();
    hands.steps();
    assert!(hands.sees("Profile of After, "));
    assert!(hands.sees("Section at"));
    hands.harness.get_by_label("Through two points").click();
    hands.steps();
    assert!(hands.sees("Click two points on a surface."));
    let middle = rect(&hands).center();
    click_at(&mut hands, middle);
    click_at(&mut hands, middle + vec2(50.0, 0.0));
    assert!(hands.sees("z over distance from the first point"));
}

#[test]
fn layers_flicker_and_shading_are_chosen_and_kept_with_the_layout() {
    let mut hands = with_surface();
    hands.click_button("Layers");
    hands.harness.get_by_role_and_label(Role::CheckBox, "Show the surface before").click();
    hands.steps();
    assert!(
        look(&mut hands)
            .layer(firstbounce::app::state::surfaces::LayerName::Surface(
                firstbounce::app::state::results::SurfaceName::Before
            ))
            .visible
    );
    hands.press(Modifiers::NONE, Key::Escape);
    assert!(value(&hands).starts_with("the surface after and the surface before, "), "{}", value(&hands));
    hands.click_button("Layers");
    hands.harness.get_by_role_and_label(Role::CheckBox, "Show the surface before").click();
    hands.steps();
    hands.press(Modifiers::NONE, Key::Escape);

    view(&hands).focus();
    hands.steps();
    hands.harness.key_down(Key::B);
    hands.harness.run_steps(2);
    assert!(value(&hands).starts_with("the surface before, "), "{}", value(&hands));
    hands.harness.key_up(Key::B);
    hands.harness.run_steps(2);
    assert!(value(&hands).starts_with("the surface after, "));

    hands.click_button("Shading: Studio");
    hands.harness.get_by_label("Height").click();
    hands.steps();
    assert_eq!(look(&mut hands).shade, Shade::Height);
    let kept = hands.session().views.to_json();
    let mut again = firstbounce::app::state::layout::Views::from_json(kept).unwrap();
    again.turn_to(PanelName::Shape, &hands.session().document());
    let view = again.all().find(|view| view.shown == Shown::Surface).unwrap();
    assert_eq!(view.surface.shade, Shade::Height);
}

#[test]
fn a_lamp_is_dragged_over_the_surface_and_stays_with_the_view() {
    let mut hands = with_surface();
    hands.session().views.active_mut().unwrap().surface.shade = Shade::Drag;
    hands.steps();
    let before = look(&mut hands).dragged;
    let lamp = hands.harness.get_by_role_and_label(Role::Slider, "Lamp to drag").rect();
    hands.harness.drag_at(lamp.center());
    hands.harness.hover_at(lamp.center() + vec2(0.5 * lamp.width() * 0.6, 0.0));
    hands.steps();
    hands.harness.drop_at(lamp.center() + vec2(0.5 * lamp.width() * 0.6, 0.0));
    hands.steps();
    let [x, y, z] = look(&mut hands).dragged.0;
    assert_ne!(look(&mut hands).dragged, before);
    assert!((x - 0.6).abs() < 0.05 && y.abs() < 0.05 && (z - 0.8).abs() < 0.05, "{x} {y} {z}");
    let again = firstbounce::app::state::layout::Views::from_json(hands.session().views.to_json());
    assert!(again.is_some(), "what was changed is kept");
}

/// Writes a mesh, and loads it as the reference by its path.
fn load(hands: &mut Hands, name: &str, mesh: &Mesh) -> PathBuf {
    let path = hands.folder.path().join(name);
    write_ply(&path, mesh, None).unwrap();
    load_path(hands, &path);
    hands.wait_until("the reference", |session| session.reference.loaded().is_some());
    path
}

fn load_path(hands: &mut Hands, path: &std::path::Path) {
    hands.retype("Reference file (OBJ, PLY, STL)", &path.display().to_string());
    push(hands, "Load reference");
}

fn compared(hands: &mut Hands) {
    hands.wait_until("the comparison", |session| {
        session.reference.comparing().is_none() && session.reference.compared().is_some()
    });
}

fn command(args: &[&str]) -> serde_json::Value {
    let output = Command::new(env!("CARGO_BIN_EXE_firstbounce")).args(args).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn a_reference_is_loaded_aligned_and_measured_as_by_the_command() {
    let mut hands = with_surface();
    let mesh = after(&mut hands);
    let made = Isometry3::new(Vector3::new(2.0, -1.0, 1.5), Vector3::new(0.02, 0.05, -0.03));
    let scan = load(&mut hands, "scan.ply", &Mesh::clone(&mesh).moved(&made));
    assert!(hands.sees("scan.ply: "));
    push(&mut hands, "Align automatically");
    compared(&mut hands);

    let own = hands.folder.path().join("after.ply");
    write_ply(&own, &mesh, None).unwrap();
    let told = command(&["compare", own.to_str().unwrap(), scan.to_str().unwrap(), "--align", "--json"]);
    let outcome = hands.session().reference.compared().unwrap().clone().unwrap();
    let shown = &outcome.after.comparison;
    let numbers = [
        ("mean_mm", shown.mean_mm),
        ("bias_mm", shown.bias_mm),
        ("rms_mm", shown.rms_mm),
        ("p95_mm", shown.p95_mm),
        ("max_mm", shown.max_mm),
        ("overlap", shown.overlap),
        ("orientation_error_deg", shown.orientation_error_deg),
        ("rotation_deg", shown.rotation_deg),
    ];
    for (name, number) in numbers {
        let command = told[name].as_f64().unwrap();
        assert!((command - number).abs() < 1e-6 * (1.0 + number.abs()), "{name}: {command} {number}");
    }
    let rms = &told["alignment"]["iterations"];
    assert_eq!(rms.as_array().unwrap().len(), outcome.after.alignment.as_ref().unwrap().iterations.len());
    assert!(hands.sees(&format!("{:.3} degrees", told["rotation_deg"].as_f64().unwrap())));
    assert!(hands.sees("Histogram of the distances") && hands.sees("iterations of the alignment"));

    push(&mut hands, "Show the heat map");
    assert!(value(&hands).contains("Distance to the reference"), "{}", value(&hands));
    assert!(!hands.sees("there is no distance yet"));

    // The choice survives saving, and undo takes the alignment back.
    let poses = |hands: &mut Hands| hands.session().document().settings.reference.clone().and_then(|r| r.poses);
    assert!(poses(&mut hands).is_some());
    hands.press(Modifiers::COMMAND, Key::S);
    let folder = hands.session().document().set.folder.clone();
    // A field that is being typed in would keep the undo for itself.
    view(&hands).focus();
    hands.steps();
    hands.press(Modifiers::COMMAND, Key::Z);
    assert!(poses(&mut hands).is_none());
    assert!(hands.sees("Surface or alignment changed since: compare again."));
    hands.open(firstbounce::app::state::session::Open::Set(folder));
    assert!(poses(&mut hands).is_some());
}

#[test]
fn three_picked_pairs_align_a_scan_that_lies_elsewhere() {
    let mut hands = with_surface();
    let mesh = after(&mut hands);
    let far = Vector3::new(400.0, -30.0, 250.0);
    load(&mut hands, "far.ply", &Mesh::clone(&mesh).moved(&Isometry3::new(far, Vector3::zeros())));
    hands.wait_until("the reference in 3D", |session| {
        session.surfaces.layer(firstbounce::app::state::surfaces::LayerName::Reference).is_some()
    });
    push(&mut hands, "Pick three pairs of points");
    assert!(hands.sees("Point 1 of 3: click a place on the surface"));
    // Both are seen from the same side in a view of their own: the same place of the screen is the same place of the object.
    for offset in [vec2(0.0, 0.0), vec2(60.0, 5.0), vec2(10.0, 50.0)] {
        let middle = rect(&hands).center();
        click_at(&mut hands, middle + offset);
        assert!(hands.sees("click the same place on the reference"));
        let middle = rect(&hands).center();
        click_at(&mut hands, middle + offset);
    }
    assert!(hands.sees("3 pairs are picked"));
    push(&mut hands, "Align from the pairs");
    compared(&mut hands);
    let poses = hands.session().document().settings.reference.clone().unwrap().poses.unwrap();
    let motion = Isometry3::from(poses.after);
    assert!((motion.translation.vector - far).norm() < 0.05, "{motion}");
}

#[test]
fn what_cannot_be_compared_says_why_in_one_line() {
    let mut hands = with_surface();
    let text = hands.folder.path().join("notes.obj");
    std::fs::write(&text, "no mesh at all\n").unwrap();
    load_path(&mut hands, &text);
    hands.wait_to_see("notes.obj: ");
    assert!(hands.session().reference.mesh().is_none());

    let mut speck = Mesh::clone(&after(&mut hands));
    let first = speck.triangles[0];
    speck.positions =
        first.iter().map(|&corner| speck.positions[corner as usize] + Vector3::new(0.0, 0.0, 900.0)).collect();
    (speck.triangles, speck.normals, speck.colours) = (vec![[0, 1, 2]], vec![], vec![]);
    load(&mut hands, "speck.ply", &speck);
    push(&mut hands, "Align automatically");
    compared(&mut hands);
    assert!(hands.sees("the meshes overlap by"), "the overlap is told");
}
