//! The other method in the Shape step, off until it is asked for.

use eframe::egui::{Key, Modifiers, Role};
use egui_kittest::kittest::Queryable;
use firstbounce::app::state::layout::Shown;
use firstbounce::app::state::panel::PanelName;
use firstbounce::app::state::results::{Plain, StageState, Step, SurfaceName};
use firstbounce::app::state::surfaces::LayerName;
use firstbounce::app::views::picture;
use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::{AlbedoScale, Method, SolveOptions, Unattended, solve};
use firstbounce_core::methods::by_shape::ByShapeOptions;

use crate::harness::Hands;

const PATCHES: usize = 150;
const ITERATIONS: usize = 2;
const SURFACE: SurfaceName = SurfaceName::By(Method::Shape);
const BY_NAYAR: LayerName = LayerName::Surface(SURFACE);
const TICK: &str = "Also solve by Nayar's method";

fn at_shape() -> Hands {
    let mut hands = Hands::with_demo();
    hands.rest();
    hands.press(Modifiers::NONE, Key::Num4);
    assert_eq!(hands.session().panel, PanelName::Shape);
    hands
}

fn tick(hands: &mut Hands) {
    hands.harness.get_by_role_and_label(Role::CheckBox, TICK).click_accesskit();
    hands.steps();
}

fn offered(hands: &mut Hands) -> bool {
    let document = hands.session().document();
    Shown::offered(&document).iter().flat_map(|(_, shown)| shown).any(|shown| shown.by_method().is_some())
}

fn state(hands: &mut Hands) -> StageState {
    let document = hands.session().document();
    hands.session().results.state(Step::ByMethod(Method::Shape), &document)
}

#[test]
fn nayars_method_is_asked_for_compared_and_undone() {
    let mut hands = at_shape();
    assert!(!offered(&mut hands) && !hands.sees("Albedo of the grey ball"));
    tick(&mut hands);
    hands.type_number("Patches", &PATCHES.to_string());
    hands.type_number("Most iterations", &ITERATIONS.to_string());
    hands.rest();
    // The demo's file does not tell how bright its grey ball is.
    assert!(hands.sees("type the grey ball's albedo"), "{:?}", state(&mut hands));
    hands.type_number("Albedo of the grey ball", "0.6");
    assert_eq!(hands.session().document().set.calibration.grey_albedo, Some(0.6));
    hands.rest();
    assert_eq!(state(&mut hands), StageState::Ready);
    assert!(hands.sees("Convergence of Nayar's method. Normals turned, degrees: iteration 1: "));
    assert!(offered(&mut hands));

    // What the window shows is what the command line computes.
    let set = CaptureSet::open(hands.session().document().set.folder.clone()).unwrap();
    let options = SolveOptions {
        method: Method::Shape,
        nayar: ByShapeOptions { patches: PATCHES, max_iterations: ITERATIONS, ..ByShapeOptions::default() },
        scale: AlbedoScale { grey_albedo: Some(0.6), ..AlbedoScale::default() },
        ..SolveOptions::default()
    };
    let solved = solve(&set, &options, &Unattended).unwrap();
    let found = hands.session().results.by_method(Method::Shape).unwrap();
    assert_eq!(found.solved.report, solved.report);
    let chosen = solved.report.nayar().unwrap().report.chosen;
    let surfaced = solved.after.unwrap();
    assert_eq!(found.surface.shape.normals.map, surfaced.shape.normals.map);
    let solved_mesh = surfaced.mesh;

    // Its pictures compare with those of the method in force.
    hands.click_button("Show normals by Nayar's method");
    hands.click_button("Show direct light by Nayar's method, left minus Direct light, left");
    let document = hands.session().document();
    let by_both = Shown::difference(Plain::Albedo.of(SURFACE), Plain::Albedo.of(SurfaceName::After));
    assert!(picture(&by_both, &document, &hands.session().results).is_ok());

    // Its surface is a layer of the 3D view.
    hands.session().views.show(Shown::Surface);
    hands.wait_until("the surface by Nayar's method", |session| session.surfaces.layer(BY_NAYAR).is_some());
    assert_eq!(*hands.session().surfaces.layer(BY_NAYAR).unwrap().source, *solved_mesh);

    // It is exported like any other.
    hands.session().panel = PanelName::Export;
    hands.steps();
    let out = hands.folder.path().join("by-nayar");
    hands.retype("Folder for the results", &out.display().to_string());
    hands.harness.get_by_role_and_label(Role::RadioButton, "Nayar's method").click_accesskit();
    hands.steps();
    hands.click_button("Write all results");
    hands.wait_to_see("Written into");
    let report: serde_json::Value = serde_json::from_slice(&std::fs::read(out.join("report.json")).unwrap()).unwrap();
    assert_eq!((&report["method"], &report["nayar"]["chosen"]), (&"shape".into(), &chosen.into()));
    assert!(out.join("mesh.obj").is_file() && out.join("bounce1-left.exr").is_file());
    assert!(!out.join("bounce2-left.exr").exists(), "its bounces are not told apart");
    hands.session().panel = PanelName::Shape;
    hands.steps();

    // Untouched by it, and gone with it.
    hands.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(hands.session().document().set.calibration.grey_albedo, None);
    tick(&mut hands);
    assert!(!offered(&mut hands) && !hands.sees("Convergence of Nayar's method"));
    let document = hands.session().document();
    let why = picture(&Shown::Normals(SURFACE), &document, &hands.session().results).unwrap_err().to_string();
    assert!(why.contains(TICK), "{why}");
}

#[test]
fn the_truth_judges_both_methods_after_every_iteration() {
    let mut hands = at_shape();
    hands.session().edit("Ask for Nayar's method", |document| {
        document.settings.compare(Method::Shape, true);
        document.settings.nayar.patches = PATCHES;
        document.settings.nayar.max_iterations = ITERATIONS;
        document.set.calibration.grey_albedo = Some(0.6);
    });
    hands.rest();
    hands.wait_to_see("Normal error by Nayar's method, mean");
    assert!(hands.sees("Normal error, degrees: iteration 0: 15."));
}
