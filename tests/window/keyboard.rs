//! What a person without a mouse, or without a screen, finds.

use eframe::egui::accesskit::Role;
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};
use firstbounce::app::panels::PanelName;

use crate::harness::Hands;

const CONTROLS: [Role; 12] = [
    Role::Button,
    Role::CheckBox,
    Role::ComboBox,
    Role::Image,
    Role::Link,
    Role::MenuItem,
    Role::RadioButton,
    Role::Slider,
    Role::SpinButton,
    Role::Splitter,
    Role::Tab,
    Role::TextInput,
];

#[test]
fn every_control_of_every_step_has_a_name() {
    let mut hands = Hands::with_demo();
    hands.rest();
    for panel in PanelName::ALL {
        hands.session().panel = panel;
        hands.steps();
        for node in hands.harness.get_all_by(|node| CONTROLS.contains(&node.role())) {
            let node = node.accesskit_node();
            let name = node.label().unwrap_or_default();
            assert!(!name.trim().is_empty(), "{}: a {:?} at {:?}", panel.title(), node.role(), node.bounding_box());
        }
    }
}

#[test]
fn tab_goes_round_and_is_caught_nowhere() {
    let mut hands = Hands::with_demo();
    hands.rest();
    let mut seen = Vec::new();
    for _ in 0..400 {
        hands.harness.key_press_modifiers(Modifiers::NONE, Key::Tab);
        hands.harness.run_steps(2);
        let id = hands.harness.root().accesskit_node().tree_state.focus_id_in_tree();
        if seen.first() == Some(&id) && seen.len() > 1 {
            break;
        }
        assert!(seen.last() != Some(&id), "Tab stays where it is after {} controls", seen.len());
        seen.push(id);
    }
    assert!(seen.len() > 10, "only {} controls", seen.len());
    assert!(seen.len() < 400, "Tab never comes round");
}

#[test]
fn a_step_is_opened_by_its_key_and_a_view_by_the_next() {
    let mut hands = Hands::with_demo();
    for (key, panel) in [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5].into_iter().zip(PanelName::ALL) {
        hands.press(Modifiers::COMMAND, key);
        assert_eq!(hands.session().panel, panel);
    }
    hands.press(Modifiers::COMMAND, Key::Backslash);
    let before = hands.session().views.active().map(|view| view.id);
    hands.press(Modifiers::NONE, Key::F6);
    assert_ne!(hands.session().views.active().map(|view| view.id), before);
    assert!(hands.harness.query_by_label("Split view right").is_none(), "no menu was opened");
}
