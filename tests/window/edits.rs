//! Edits, their names, and what becomes stale.

use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable;
use firstbounce::app::state::panel::PanelName;

use crate::harness::Hands;

#[test]
fn undo_and_redo_carry_the_name_of_the_edit() {
    let mut hands = Hands::with_demo();
    hands.session().edit("Choose one bounce", |document| document.set.separation.bounces = Some(1));
    hands.steps();
    hands.click_button("Edit");
    assert!(hands.sees("Undo: Choose one bounce"));
    hands.press(Modifiers::NONE, Key::Escape);
    hands.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(hands.session().document().set.bounces(), 2);
    hands.click_button("Edit");
    assert!(hands.sees("Redo: Choose one bounce"));
    hands.press(Modifiers::NONE, Key::Escape);
    hands.press(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(hands.session().document().set.bounces(), 1);
}

#[test]
fn the_edits_of_one_drag_are_undone_together_and_an_edit_that_changes_nothing_leaves_no_trace() {
    let mut hands = Hands::with_demo();
    for radius_px in [4, 5, 6] {
        hands.session().edit("Change indirect window", |d| d.set.shape.indirect_window_px = radius_px);
    }
    hands.session().edit("Nothing", |_| ());
    hands.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(hands.session().document().set.shape.indirect_window_px, 3);
}

#[test]
fn an_edit_of_a_direction_leaves_the_bounces_as_they_are() {
    let mut hands = Hands::with_demo_by_colours();
    hands.rest();
    let (loaded, separated) = (hands.session().results.loaded().unwrap(), hands.session().results.separated().unwrap());
    let shapes = hands.session().results.shapes().unwrap();
    let direction = shapes_direction(&mut hands);
    hands.session().edit("Type direction", |d| d.set.lights[0].direction = Some(direction));
    hands.rest();
    let results = &hands.session().results;
    assert!(std::sync::Arc::ptr_eq(&loaded, &results.loaded().unwrap()));
    assert!(std::sync::Arc::ptr_eq(&separated, &results.separated().unwrap()));
    assert!(!std::sync::Arc::ptr_eq(&shapes, &results.shapes().unwrap()));
}

fn shapes_direction(hands: &mut Hands) -> [f64; 3] {
    let calibration = hands.session().results.calibration().expect("the demo is calibrated");
    let [x, y, z] = calibration.calibrated.direction[0].as_ref().expect("the demo has mirror balls").value;
    [x + 0.05, y, z]
}

#[test]
fn the_shape_panel_leaves_no_fewer_than_three_lights_and_shows_before_and_after() {
    let mut hands = Hands::with_demo();
    hands.rest();
    hands.press(Modifiers::NONE, Key::Num4);
    assert_eq!(hands.session().panel, PanelName::Shape);
    hands.unfold("Lights and thresholds");
    assert!(hands.sees("Use left"));
    assert!(hands.sees("Mean change of the normals"));
    hands.harness.get_by_label("Use left").click();
    hands.steps();
    assert!(hands.session().document().set.shape.leave_out.is_empty());
    hands.click_button("Show normals after");
    assert!(hands.sees("Picture: Normals after"));
}
