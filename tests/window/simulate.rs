//! A set that is simulated in the window: seen small, planned for, made and opened.

use eframe::egui::Role;
use egui_kittest::kittest::Queryable;
use firstbounce::app::state::results::SurfaceName;
use firstbounce::app::window::commands::CommandId;

use crate::harness::Hands;

fn small(hands: &mut Hands) {
    hands.type_number("Patches that exchange light", "120");
    hands.type_number("Side of the picture", "40");
}

#[test]
fn a_set_is_seen_planned_made_and_opened() {
    let mut hands = Hands::new();
    hands.click_button("New simulated set...");
    small(&mut hands);
    hands.harness.get_by_role_and_label(Role::RadioButton, "Bowl").click_accesskit();
    hands.steps();
    assert_eq!(hands.number("Radius of the sphere"), 40.0);
    hands.wait_to_see("% of the light bounced twice or more");
    hands.wait_to_see("16 frames at ratio 0.51: ");
    assert!(hands.sees("Error in degrees against the ratio of albedos, 16 frames. 0.10: "));

    // A folder that holds something else is left alone.
    let folder = hands.folder.path().join("bowl");
    std::fs::create_dir(&folder).unwrap();
    std::fs::write(folder.join("diary.txt"), "mine").unwrap();
    hands.type_into("Folder of the simulated set", &folder.display().to_string());
    hands.click_button("Make this set");
    hands.wait_to_see("diary.txt, which is no part of this simulated set");
    assert!(!hands.session().is_open());

    std::fs::remove_file(folder.join("diary.txt")).unwrap();
    hands.click_button("Make this set");
    hands.wait_until("the set", |session| session.is_open());
    assert_eq!(hands.session().document().set.title(), "Simulated bowl");
    assert!(!hands.sees("Rig planner"));
    hands.rest();
    let document = hands.session().document();
    assert!(hands.session().results.finished(SurfaceName::After, &document).is_some());
    assert!(folder.join("truth/rig.json").is_file());
}

#[test]
fn a_paint_that_cannot_be_is_told_and_a_colour_can_be_added() {
    let mut hands = Hands::with_demo();
    hands.run(CommandId::NewSimulatedSet);
    hands.steps();
    small(&mut hands);
    hands.type_number("Albedo in c2", "1.2");
    assert!(hands.sees("albedo 1.2 is not between 0 and 1"));
    hands.type_number("Albedo in c2", "0.5");
    assert!(!hands.sees("is not between 0 and 1"));
    hands.harness.get_by_role_and_label(Role::Button, "Add a colour").click_accesskit();
    hands.steps();
    assert_eq!(hands.number("Albedo in c3"), 0.25);
    assert!(hands.sees("3 colours separate bounces up to order m = 3"));
    hands.wait_to_see("order m = 2; before");
    hands.harness.get_by_role_and_label(Role::RadioButton, "m = 3").click_accesskit();
    hands.wait_to_see("order m = 3; before");
    hands.harness.get_by_role_and_label(Role::RadioButton, "Near, square").click_accesskit();
    hands.steps();
    hands.type_number("Side of a lamp", "-5");
    assert!(hands.sees("light1: side is -5"));
    hands.type_number("Side of a lamp", "80");
    hands.type_number("Number of lights", "4");
    assert_eq!(hands.number("Intensity of light4"), 1.0);
    hands.harness.get_by_role_and_label(Role::RadioButton, "Mesh file").click_accesskit();
    hands.steps();
    assert!(hands.sees("choose a mesh file"));
}
