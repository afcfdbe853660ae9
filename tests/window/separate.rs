//! The Separate step: the verdict follows the order m and beta in the frame in which they change.

use eframe::egui::{Key, Modifiers, Role};
use egui_kittest::kittest::Queryable;
use firstbounce::app::state::panel::PanelName;

use crate::harness::Hands;

fn at_separate() -> Hands {
    let mut hands = Hands::with_demo_by_colours();
    hands.rest();
    hands.press(Modifiers::NONE, Key::Num3);
    assert_eq!(hands.session().panel, PanelName::Separate);
    hands
}

fn choose_order(hands: &mut Hands, m: usize) {
    hands.harness.get_by_role_and_label(Role::RadioButton, &format!("m = {m}")).click();
    hands.steps();
}

#[test]
fn a_beta_typed_too_close_to_one_is_not_trusted_until_it_is_undone() {
    let mut hands = at_separate();
    choose_order(&mut hands, 2);
    // Rendered with every bounce: two of them leave a tail.
    assert!(hands.sees("Take care") && hands.sees("too dark"));
    assert!(!hands.sees("Do not trust"));

    hands.type_number("beta of green", "0.97");
    assert_eq!(hands.session().document().set.calibration.beta, Some(vec![1.0, 0.97]));
    assert!(hands.sees("Do not trust"));
    assert!(hands.sees("Beta of green is 0.970: blue and green see the paint alike"));

    // A typed value that was computed with, and is taken back, must not outlive its edit.
    hands.rest();
    hands.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(hands.session().document().set.calibration.beta, None);
    assert!(!hands.sees("Do not trust"));
    assert!(hands.sees("Take care"));
}

#[test]
fn a_better_order_is_one_button_away_and_can_be_undone() {
    let mut hands = at_separate();
    choose_order(&mut hands, 1);
    assert!(hands.sees("Do not trust") && hands.sees("too bright"));
    hands.click_button("Use m = 2");
    assert_eq!(hands.session().document().set.bounces(), 2);
    assert!(hands.sees("Take care"));
    hands.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(hands.session().document().set.bounces(), 1);
}

#[test]
fn the_plot_says_in_words_where_the_set_stands() {
    let hands = at_separate();
    assert!(hands.sees("green / blue: ratio 0.51, gain 4.1"));
}

#[test]
fn a_typed_beta_gives_way_to_the_measured_one() {
    let mut hands = at_separate();
    hands.type_number("beta of green", "0.6");
    hands.click_button("Use the measured beta");
    assert_eq!(hands.session().document().set.calibration.beta, None);
}

#[test]
fn a_negative_bounce_1_is_told_in_words() {
    let mut hands = at_separate();
    hands.session().edit("Type alpha", |document| {
        for light in ["left", "top", "right"] {
            document.set.calibration.alpha.insert(light.into(), vec![1.0, 30.0]);
        }
    });
    hands.steps();
    assert!(hands.sees("Do not trust") && hands.sees("bounce 1 comes out negative"));
    assert!(hands.sees("bounce 1 is negative"), "in the place of percentages");
    assert!(!hands.sees("inf ") && !hands.sees("NaN"));
}
