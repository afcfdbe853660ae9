//! The window as a whole: each step's own tiles, panels that stay as they are, and work by keys alone.

use std::collections::BTreeMap;

use eframe::egui::accesskit::Role;
use eframe::egui::{Event, Key, Modifiers, Rect, Vec2, pos2};
use egui_kittest::kittest::{NodeT, Queryable};
use firstbounce::app::state::layout::Shown;
use firstbounce::app::state::panel::PanelName;
use firstbounce_capture::pipeline::Method;

use crate::harness::Hands;

/// What the tiles of the step show, by the names of their menus.
fn tiles(hands: &Hands) -> Vec<String> {
    let menus = hands.harness.query_all_by_label_contains("Picture: ");
    let mut titles: Vec<String> = menus.filter_map(|menu| menu.accesskit_node().label()).collect();
    titles.iter_mut().for_each(|title| *title = title.replace("Picture: ", ""));
    titles.sort();
    titles.dedup();
    titles
}

fn open(hands: &mut Hands, panel: PanelName) {
    hands.session().panel = panel;
    hands.harness.run_steps(6);
}

#[test]
fn the_centre_follows_the_step_and_has_most_of_the_width() {
    let mut hands = Hands::with_demo();
    hands.rest();
    for (panel, expected) in [
        (PanelName::Captures, &["All photos", "Photo, left, blue"][..]),
        (
            PanelName::Calibrate,
            &[
                "Ball of the paint, left, blue",
                "Grey ball, left, blue",
                "Lights on a dome",
                "Mirror ball, left",
                "Values in force",
            ],
        ),
        (
            PanelName::Separate,
            &[
                "Angle between normals after and before",
                "Direct light, left",
                "Indirect light, left",
                "Photo, left, blue",
            ],
        ),
        (PanelName::Shape, &["Surface in 3D"]),
        (PanelName::Export, &["Surface in 3D"]),
    ] {
        open(&mut hands, panel);
        assert_eq!(tiles(&hands), expected, "{}", panel.title());
        let left = hands.harness.query_all_by_label_contains("Picture: ").map(|menu| menu.rect().left());
        let left = left.fold(f32::INFINITY, f32::min);
        let right = hands.harness.get_by_label("Inspector").rect().left();
        assert!(right - left >= 0.6 * 1280.0, "{}: {} of 1280 points", panel.title(), right - left);
    }
}

#[test]
fn a_step_keeps_what_was_changed_in_it_and_reset_brings_its_own_tiles_back() {
    let mut hands = Hands::with_demo();
    hands.rest();
    open(&mut hands, PanelName::Separate);
    hands.session().views.show(Shown::Bounce { light: "top".into(), k: 1 });
    open(&mut hands, PanelName::Captures);
    open(&mut hands, PanelName::Separate);
    assert!(tiles(&hands).contains(&"Bounce 1, top".to_owned()));
    hands.run(firstbounce::app::window::commands::CommandId::ResetLayout);
    hands.steps();
    assert!(!tiles(&hands).contains(&"Bounce 1, top".to_owned()));
    // What was not changed by hand follows the set.
    hands.choose_method(Method::Colours);
    assert!(tiles(&hands).contains(&"Bounce 2, left".to_owned()), "{:?}", tiles(&hands));
}

#[test]
fn the_button_of_every_step_is_inside_a_small_window() {
    let mut hands = Hands::with_demo();
    hands.rest();
    for size in [Vec2::new(1280.0, 720.0), Vec2::new(900.0, 600.0)] {
        hands.harness.set_size(size);
        let window = Rect::from_min_size(pos2(0.0, 0.0), size);
        for (panel, button) in PanelName::ALL.into_iter().zip([
            "Next: Calibrate",
            "Next: Separate",
            "Next: Shape",
            "Next: Export",
            "Write all results",
        ]) {
            open(&mut hands, panel);
            let rect = hands.harness.get_by_role_and_label(Role::Button, button).rect();
            assert!(window.contains_rect(rect), "{button} at {rect:?} in {size:?}");
        }
    }
}

/// Every named widget that is no value of the inspector, and where it is.
fn places(hands: &Hands) -> BTreeMap<String, Rect> {
    let inspector = hands.harness.get_by_label("Inspector").rect().left();
    let below = hands.harness.get_by_label("Dragging on a picture draws").rect().top();
    let all = hands.harness.query_all_by_role(Role::Button).chain(hands.harness.query_all_by_role(Role::Label));
    let named = all.filter_map(|node| Some((node.accesskit_node().label()?, node.rect())));
    named.filter(|(_, rect)| rect.left() < inspector || rect.top() >= below).collect()
}

#[test]
fn hovering_over_a_picture_moves_nothing() {
    let mut hands = Hands::with_demo();
    hands.rest();
    open(&mut hands, PanelName::Separate);
    let picture = hands.harness.get_by_role_and_label(Role::Image, "Photo, left, blue").rect().shrink(4.0);
    hands.harness.hover_at(picture.center());
    hands.harness.run_steps(4);
    let before = places(&hands);
    for place in 0..200 {
        let (column, row) = (place % 20, place / 20);
        let along = |share: f32, low: f32, length: f32| low + share * length;
        let at = pos2(
            along(column as f32 / 19.0, picture.left(), picture.width()),
            along(row as f32 / 9.0, picture.top(), picture.height()),
        );
        hands.harness.hover_at(at);
        hands.harness.run_steps(2);
        let after = places(&hands);
        let kept = before.iter().filter(|(name, _)| after.contains_key(*name));
        for (name, rect) in kept {
            assert_eq!(after[name], *rect, "{name} moved while the pointer was at {at:?}");
        }
    }
}

/// A person at a keyboard.
struct Typist<'h> {
    hands: &'h mut Hands,
    strokes: usize,
}

impl Typist<'_> {
    fn press(&mut self, modifiers: Modifiers, key: Key) {
        self.strokes += 1;
        self.hands.press(modifiers, key);
    }

    fn write(&mut self, text: &str) {
        for letter in text.chars() {
            self.strokes += 1;
            self.hands.harness.input_mut().events.push(Event::Text(letter.into()));
            self.hands.steps();
        }
    }
}

#[test]
fn from_the_demo_to_a_mesh_by_keys_alone() {
    let mut hands = Hands::new();
    let mut typist = Typist { hands: &mut hands, strokes: 0 };
    typist.press(Modifiers::COMMAND, Key::P);
    typist.write("demo");
    typist.press(Modifiers::NONE, Key::Enter);
    typist.hands.rest();
    assert_eq!(typist.hands.session().panel, PanelName::Shape, "the demo begins with its result");
    typist.press(Modifiers::NONE, Key::Num3);
    typist.press(Modifiers::NONE, Key::K);
    let shown = typist.hands.session().views.active().unwrap().shown.clone();
    assert_eq!(shown, Shown::Bounce { light: "left".into(), k: 1 });
    typist.press(Modifiers::NONE, Key::W);
    assert!(typist.hands.harness.query_by_role_and_label(Role::Slider, "Wipe, Bounce 1, left").is_some());
    typist.press(Modifiers::COMMAND, Key::P);
    typist.write("write all");
    typist.press(Modifiers::NONE, Key::Enter);
    let strokes = typist.strokes;
    hands.wait_to_see("Written into");
    let out = hands.session().document().set.folder.join("out");
    assert!(out.join("mesh.obj").is_file());
    assert!(strokes <= 30, "{strokes} strokes");
}

#[test]
fn every_step_has_a_page_that_says_what_it_is_for() {
    let mut hands = Hands::with_demo();
    for (panel, words) in PanelName::ALL.into_iter().zip([
        "Which photo is which",
        "How strong each lamp is",
        "Direct light apart",
        "Normals and depth, from the photos",
        "What the command line writes",
    ]) {
        open(&mut hands, panel);
        hands.click_button(&format!("About {}", panel.title()));
        hands.steps();
        assert!(hands.sees(words), "{}", panel.title());
        hands.press(Modifiers::NONE, Key::Escape);
        assert!(!hands.sees(words), "{} stays open", panel.title());
    }
}
