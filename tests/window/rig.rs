//! The Calibrate step: a click finds the ball, values are those of the command line, and a typed one wins.

use std::process::Command;

use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use firstbounce::app::state::panel::PanelName;
use firstbounce::app::state::results::{StageState, Step};
use firstbounce_capture::set::{SphereKind, Subject};

use crate::harness::Hands;

/// The demo's balls as they were rendered.
const TRUE_CENTRE_PX: [f64; 2] = [100.0, 100.0];
const TRUE_RADIUS_PX: f64 = 83.333;

/// The demo in the Calibrate step with the grey ball in view.
fn calibrating() -> Hands {
    let mut hands = Hands::with_demo();
    hands.rest();
    hands.session().panel = PanelName::Calibrate;
    hands.steps();
    hands.click_button("Show grey ball");
    hands
}

fn grey_circle(hands: &mut Hands) -> Option<firstbounce_capture::set::Circle> {
    hands.session().document().set.circle(Subject::GreySphere, SphereKind::Grey)
}

#[test]
fn a_click_beside_the_grey_ball_finds_its_edge_and_alpha_is_that_of_the_command_line() {
    let mut hands = calibrating();
    hands.session().edit("Forget the grey ball", |document| {
        document.set.spheres.retain(|sphere| sphere.subject != Subject::GreySphere);
    });
    hands.rest();
    hands.click_picture("Grey ball, left, blue", (200, 200), [188.0, 130.0]);
    hands.wait_until("the ball to be found", |session| {
        session.document().set.circle(Subject::GreySphere, SphereKind::Grey).is_some()
    });
    let circle = grey_circle(&mut hands).unwrap();
    for (found, truth) in
        circle.centre.into_iter().chain([circle.radius]).zip(TRUE_CENTRE_PX.into_iter().chain([TRUE_RADIUS_PX]))
    {
        assert!((found - truth).abs() < 1.0, "{circle:?}");
    }
    hands.rest();

    hands.press(Modifiers::COMMAND, Key::S);
    let folder = hands.session().document().set.folder.clone();
    let program = Command::new(env!("CARGO_BIN_EXE_firstbounce")).arg("calibrate").arg("--json").arg(folder).output();
    let printed: serde_json::Value = serde_json::from_slice(&program.unwrap().stdout).unwrap();
    for (light, index) in [("left", 0), ("top", 1), ("right", 2)] {
        let shown = hands.number(&format!("alpha, {light}, green"));
        let alpha = printed["alpha"][light][1].as_f64().unwrap();
        assert!((shown - alpha).abs() < 1e-12, "{light}: {shown} in the window, {alpha} by the command line");
        let exact = hands.session().results.calibration().unwrap().calibrated.alpha[index].as_ref().unwrap()[1].value;
        assert!((exact - alpha).abs() < 1e-12);
    }
}

#[test]
fn the_arrow_keys_nudge_the_circle_and_undo_puts_it_back() {
    let mut hands = calibrating();
    let before = grey_circle(&mut hands).unwrap();
    hands.harness.get_by_role_and_label(Role::Button, "Grey ball, centre").focus();
    hands.steps();
    hands.press(Modifiers::NONE, Key::ArrowRight);
    let after = grey_circle(&mut hands).unwrap();
    assert!((after.centre[0] - before.centre[0] - 0.5).abs() < 1e-9, "{after:?}");
    hands.harness.get_by_role_and_label(Role::Button, "Grey ball, rim").focus();
    hands.steps();
    hands.press(Modifiers::SHIFT, Key::ArrowLeft);
    let smaller = grey_circle(&mut hands).unwrap();
    assert!((before.radius - smaller.radius - 0.05).abs() < 1e-9, "{smaller:?}");
    hands.run(firstbounce::app::window::commands::CommandId::Undo);
    hands.steps();
    hands.run(firstbounce::app::window::commands::CommandId::Undo);
    hands.steps();
    assert_eq!(grey_circle(&mut hands), Some(before));
}

#[test]
fn a_ball_that_is_not_found_takes_its_circle_from_numbers_from_three_rim_points_or_from_the_grey_ball() {
    let mut hands = calibrating();
    let circle = |hands: &mut Hands| hands.session().document().set.circle(Subject::MirrorSphere, SphereKind::Mirror);
    let is_true = |circle: Option<firstbounce_capture::set::Circle>| {
        let circle = circle.unwrap();
        let off = |found: f64, truth: f64| (found - truth).abs();
        off(circle.centre[0], 100.0) < 1.0
            && off(circle.centre[1], 100.0) < 1.0
            && off(circle.radius, TRUE_RADIUS_PX) < 1.0
    };
    hands.session().edit("Forget the mirror ball", |document| {
        document.set.spheres.retain(|sphere| sphere.subject != Subject::MirrorSphere);
    });
    hands.rest();
    assert!(hands.sees("type its circle"));

    hands.click_button("Same circle as the grey ball, mirror ball");
    assert!(is_true(circle(&mut hands)));
    hands.click_button("Forget mirror ball");
    hands.rest();
    assert_eq!(circle(&mut hands), None);

    hands.type_number("Mirror ball, radius", "83");
    assert!(is_true(circle(&mut hands)));
    hands.click_button("Forget mirror ball");
    hands.rest();

    hands.click_button("Three rim points of mirror ball");
    hands.steps();
    assert!(hands.sees("click on its rim: 0 of 3 points"));
    for point in [[183.3, 100.0], [100.0, 16.7], [41.0, 158.9]] {
        hands.click_picture("Mirror ball, left", (200, 200), point);
    }
    assert!(is_true(circle(&mut hands)), "{:?}", circle(&mut hands));
}

#[test]
fn a_typed_beta_wins_is_judged_at_once_and_goes_back_to_what_was_measured() {
    let mut hands = calibrating();
    let measured = hands.number("beta, green");
    assert!(!hands.sees("do not trust"));
    hands.type_number("beta, green", "0.97");
    assert_eq!(hands.session().document().set.calibration.beta, Some(vec![1.0, 0.97]));
    assert!(hands.sees("do not trust"), "at once");
    assert!(hands.sees("times the noise of a photo"));
    hands.rest();
    hands.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(hands.session().document().set.calibration.beta, None);
    assert!(!hands.sees("do not trust"));

    hands.type_number("beta, green", "0.6");
    hands.click_button("Back to measured, beta, green");
    hands.rest();
    assert_eq!(hands.session().document().set.calibration.beta, None);
    assert_eq!(hands.number("beta, green"), measured);
}

#[test]
fn the_rig_of_another_set_is_taken_over_by_the_names_of_its_lights() {
    let mut hands = calibrating();
    let other = hands.folder.path().join("other");
    firstbounce::demo::unpack(&other).unwrap();
    hands.harness.get_by_label("Use the rig of another set").click_accesskit();
    hands.steps();
    hands.type_into("Set whose rig to use", &other.display().to_string());
    hands.press(Modifiers::NONE, Key::Enter);
    hands.wait_until("the other rig", |session| session.document().set.calibration.alpha.len() == 3);
    let calibration = hands.session().document().set.calibration.clone();
    assert_eq!((calibration.direction.len(), calibration.intensity.len()), (3, 3));
    assert_eq!(calibration.beta, None, "another paint");
    assert!(hands.sees("taken over for left, top, right"));
}

#[test]
fn no_file_is_read_again_for_a_typed_value_or_a_moved_circle() {
    let mut hands = calibrating();
    let folder = hands.session().document().set.folder.clone();
    for ball in ["grey-sphere", "material-sphere", "mirror-sphere"] {
        std::fs::remove_dir_all(folder.join(ball)).unwrap();
    }
    let alpha = hands.number("alpha, left, green");
    hands.type_number("Grey ball, radius", "80");
    hands.type_number("intensity, top", "1.1");
    hands.rest();
    let document = hands.session().document();
    for step in [Step::Measure, Step::Calibrate, Step::Mesh] {
        assert_eq!(hands.session().results.state(step, &document), StageState::Ready, "{step}");
    }
    assert!((hands.number("intensity, top") - 1.1).abs() < 1e-12);
    let fitted = hands.number("alpha, left, green");
    assert!(fitted != alpha && (fitted / alpha - 1.0).abs() < 0.01, "{fitted} for {alpha}: fitted anew");
}

#[test]
fn a_number_that_is_only_looked_at_stays_measured_to_its_last_digit() {
    let mut hands = calibrating();
    let before = hands.session().document();
    let measured = hands.number("beta, green");
    hands.harness.get_by_role_and_label(Role::SpinButton, "beta, green").click();
    hands.steps();
    hands.press(Modifiers::NONE, Key::Tab);
    hands.press(Modifiers::NONE, Key::Tab);
    hands.press(Modifiers::NONE, Key::Enter);
    assert_eq!(hands.session().document(), before);
    assert_eq!(hands.number("beta, green"), measured);
}
