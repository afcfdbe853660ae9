//! The inspector, by typed pixels and corners: what it says is what the pipeline computed.

use eframe::egui::Role;
use egui_kittest::kittest::Queryable;
use firstbounce::app::state::layout::Shown;
use firstbounce::app::state::results::{Plain, PlaneName, SurfaceName};

use crate::harness::Hands;

fn measured(hands: &mut Hands) {
    hands.wait_until("the statistics", |session| session.jobs.running().is_empty());
    hands.steps();
}

#[test]
fn a_typed_pixel_shows_the_values_of_every_plane() {
    let mut hands = Hands::with_demo_by_colours();
    hands.rest();
    hands.type_number("Column", "240");
    hands.type_number("Row", "200");
    let value = |hands: &mut Hands, name: &PlaneName| {
        hands.session().results.pictures().plane(name).unwrap().plane.plane.at(240, 200)
    };
    let depth = value(&mut hands, &Plain::Depth.of(SurfaceName::After).into());
    let bounce = value(&mut hands, &PlaneName::Bounce("left".into(), 1));
    assert!(hands.sees("Depth after"));
    assert!(hands.sees(&format!("{depth:.2}")), "no {depth}");
    assert!(hands.sees(&format!("{bounce:.4}")), "no {bounce}");
    assert!(hands.sees("Light left, column 240, row 200"));
}

#[test]
fn statistics_of_the_whole_object_are_those_of_the_report() {
    let mut hands = Hands::with_demo_by_colours();
    hands.rest();
    hands.session().views.show(Shown::Bounce { light: "left".into(), k: 1 });
    hands.steps();
    measured(&mut hands);
    let mean = hands.session().results.separated().unwrap().reports[0].mean[0];
    assert!(hands.sees("Bounce 1, left: whole object"));
    assert!(hands.sees(&format!("{mean:.4}")), "no {mean}");
}

#[test]
fn a_typed_rectangle_is_measured_and_cleared() {
    let mut hands = Hands::with_demo();
    hands.rest();
    hands.session().views.show(Shown::Bounce { light: "left".into(), k: 1 });
    hands.harness.get_by_role_and_label(Role::RadioButton, "Rectangle").click();
    hands.steps();
    for (field, px) in [("Left", "200"), ("Top", "180"), ("Right", "240"), ("Bottom", "210")] {
        hands.type_number(field, px);
    }
    hands.wait_to_see("40.00 x 30.00 px");
    hands.wait_to_see("1200");
    hands.click_button("Clear region");
    hands.wait_to_see("whole object");
}

#[test]
fn a_typed_line_has_a_profile() {
    let mut hands = Hands::with_demo();
    hands.rest();
    hands.harness.get_by_role_and_label(Role::RadioButton, "Line").click();
    hands.steps();
    hands.type_number("From x", "100");
    assert!(hands.sees("Profile of 1 pictures"));
}
