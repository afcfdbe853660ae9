//! Views by their accessible names: tiles, comparison, zoom.

use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};
use firstbounce::app::state::layout::Shown;
use firstbounce::app::state::results::{Plain, SurfaceName};
use firstbounce::app::state::session::Open;

use crate::harness::Hands;

/// What a view tells about itself: its zoom, the legend, what is held.
fn told(hands: &Hands, label: &str) -> String {
    let canvas = hands.harness.get_by_role_and_label(Role::Image, label);
    canvas.accesskit_node().value().unwrap_or_default()
}

#[test]
fn tiles_are_there_again_when_the_set_is_opened_again() {
    let mut hands = Hands::with_demo();
    hands.press(Modifiers::COMMAND, Key::Backslash);
    hands.session().views.show(Plain::Depth.of(SurfaceName::After));
    hands.press(Modifiers::COMMAND, Key::T);
    hands.session().views.show(Plain::Albedo.of(SurfaceName::Before));
    hands.steps();
    let all = |hands: &mut Hands| -> Vec<_> { hands.session().views.all().map(|view| view.shown.title()).collect() };
    let mut before = all(&mut hands);
    before.sort();
    assert_eq!(before, ["Albedo before", "All photos", "Depth after", "Photo, left, blue"]);
    let set = hands.session().document().set.folder.clone();
    hands.session().leave();
    hands.steps();
    hands.open(Open::Set(set));
    let mut after = all(&mut hands);
    after.sort();
    assert_eq!(after, before);
    assert!(hands.session().views.all().all(|view| view.linked));
}

#[test]
fn pictures_are_fitted_and_shown_one_to_one_by_key_and_by_menu() {
    let mut hands = Hands::with_demo();
    hands.rest();
    let label = "Photo, left, blue";
    let fitted = told(&hands, label);
    hands.press(Modifiers::NONE, Key::Num0);
    assert!(told(&hands, label).starts_with("Zoom 100 %"), "{}", told(&hands, label));
    hands.click_button("View");
    hands.harness.get_by_label_contains("Fit pictures to their views").click();
    hands.steps();
    assert_eq!(told(&hands, label), fitted);
    hands.click_button("One to one, Photo, left, blue");
    assert!(told(&hands, label).starts_with("Zoom 100 %"), "{}", told(&hands, label));
    hands.click_button("Fit, Photo, left, blue");
    assert_eq!(told(&hands, label), fitted);
}

#[test]
fn two_pictures_are_compared_by_a_held_key_by_wipe_and_in_numbers_with_units() {
    let mut hands = Hands::with_demo();
    hands.rest();
    hands.session().views.show(Plain::Depth.of(SurfaceName::After));
    hands.session().views.active_mut().unwrap().against = Some(Plain::Depth.of(SurfaceName::Before).into());
    hands.steps();
    hands.harness.get_by_role_and_label(Role::Image, "Depth after").focus();
    hands.steps();
    hands.harness.key_down(Key::B);
    hands.harness.step();
    assert!(told(&hands, "Depth after").contains("shows Depth before"));
    hands.harness.key_up(Key::B);
    hands.harness.step();
    assert!(!told(&hands, "Depth after").contains("shows Depth before"));

    hands.harness.get_by_label("Wipe").click();
    hands.steps();
    let line = "Wipe, Depth after";
    hands.harness.get_by_role_and_label(Role::Slider, line).set_value_accesskit(0.25);
    hands.steps();
    let slider = hands.harness.get_by_role_and_label(Role::Slider, line).accesskit_node().numeric_value();
    assert_eq!(slider, Some(0.25));

    hands.click_button("Difference");
    hands.wait_to_see("largest");
    let (mean, rms, max) = depth_difference(&mut hands);
    assert!(mean.abs() < 1e-6 * rms && hands.sees("mean 0 mm"), "depths are known but for a constant: {mean}");
    for (name, value) in [("rms", rms), ("largest", max)] {
        assert!(hands.sees(&format!("{name} {value:.4} mm")), "{name} {value}");
    }
}

/// Mean, root mean square and largest difference of the depths inside the object, in mm.
fn depth_difference(hands: &mut Hands) -> (f64, f64, f64) {
    let results = &hands.session().results;
    let plane = |when| results.pictures().plane(&Plain::Depth.of(when).into()).unwrap().plane.plane.clone();
    let (after, before) = (plane(SurfaceName::After), plane(SurfaceName::Before));
    let loaded = results.loaded().unwrap();
    let mask = &loaded.object.as_ref().unwrap().mask;
    let differences: Vec<f64> = (0..after.data().len())
        .filter(|&pixel| mask.data()[pixel])
        .map(|pixel| f64::from(after.data()[pixel]) - f64::from(before.data()[pixel]))
        .filter(|difference| difference.is_finite())
        .collect();
    let count = differences.len() as f64;
    let mean = differences.iter().sum::<f64>() / count;
    let rms = (differences.iter().map(|d| d * d).sum::<f64>() / count).sqrt();
    (mean, rms, differences.iter().fold(0.0, |largest, d| d.abs().max(largest)))
}

#[test]
fn normals_differ_by_an_angle() {
    let mut hands = Hands::with_demo();
    hands.rest();
    let turned = hands.session().results.shapes().unwrap().turned.unwrap();
    let (after, before) = (Shown::Normals(SurfaceName::After), Shown::Normals(SurfaceName::Before));
    hands.session().views.show(Shown::difference(after, before));
    hands.steps();
    hands.wait_to_see("degrees, rms");
    assert!(told(&hands, "Angle between normals after and before").contains("Viridis"));
    assert!(turned.mean_deg > 1.0);
}
