//! What a person without a mouse, or without a screen, finds.

use std::collections::HashMap;

use eframe::egui::accesskit::{Action, Role};
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::{NodeT, Queryable};
use firstbounce::app::state::panel::PanelName;
use firstbounce::app::state::preferences::Theme;
use firstbounce::app::state::session::Open;
use firstbounce::app::window::commands::{COMMANDS, Command, CommandId};

use crate::harness::Hands;

/// Far more than any panel has.
const MOST_CONTROLS: usize = 400;

#[test]
fn every_control_of_every_step_has_a_name() {
    let mut hands = Hands::with_demo();
    hands.rest();
    for panel in PanelName::ALL {
        hands.session().panel = panel;
        hands.steps();
        all_named(&hands, panel.title());
    }
    hands.session().open(Open::Demo);
    hands.press(Modifiers::COMMAND, Key::O);
    all_named(&hands, "start");
}

/// Whatever takes the focus says what it is.
fn all_named(hands: &Hands, place: &str) {
    let takes_focus =
        |role: Role| !matches!(role, Role::Window | Role::GenericContainer | Role::ScrollView | Role::Unknown);
    let all = hands.harness.get_all_by(|node| takes_focus(node.role()) && is_focusable(node));
    let mut count = 0;
    for node in all {
        let node = node.accesskit_node();
        let name = node.label().unwrap_or_default();
        assert!(!name.trim().is_empty(), "{place}: a {:?} at {:?}", node.role(), node.bounding_box());
        count += 1;
    }
    assert!(count > 5, "{place}: {count} controls");
}

fn is_focusable(node: &egui_kittest::kittest::AccessKitNode<'_>) -> bool {
    node.data().supports_action(Action::Focus)
}

/// And a number that is only passed over stays what it was measured to be.
#[test]
fn tab_and_shift_tab_go_round_every_step_are_caught_nowhere_and_change_nothing() {
    let mut hands = Hands::with_demo();
    hands.rest();
    let before = hands.session().document();
    for panel in PanelName::ALL {
        hands.session().panel = panel;
        hands.steps();
        let mut names = HashMap::new();
        let forth = round(&mut hands, Modifiers::NONE, panel, &mut names);
        let back = round(&mut hands, Modifiers::SHIFT, panel, &mut names);
        let mut backwards = back.clone();
        backwards.reverse();
        let only = |one: &[String], other: &[String]| {
            one.iter().filter(|id| !other.contains(id)).map(|id| names[id].clone()).collect::<Vec<_>>()
        };
        let differences = (only(&forth, &back), only(&back, &forth));
        assert_eq!(forth.len(), back.len(), "{}: another way back: {differences:?}", panel.title());
        let start = forth.iter().position(|id| *id == backwards[0]).expect("the way back leads over the same controls");
        let turned: Vec<_> = forth[start..].iter().chain(&forth[..start]).cloned().collect();
        assert_eq!(turned, backwards, "{}: another order back", panel.title());
    }
    assert_eq!(hands.session().document(), before);
}

/// Every control that a key leads to until the first comes again.
fn round(
    hands: &mut Hands,
    modifiers: Modifiers,
    panel: PanelName,
    names: &mut HashMap<String, String>,
) -> Vec<String> {
    let mut seen = Vec::new();
    loop {
        hands.tab(modifiers);
        // A canvas that gets the focus is measured by the inspector.
        hands.wait_until("the inspector to measure", |session| session.jobs.running().is_empty());
        let root = hands.harness.root();
        let focused = hands.harness.query_by(|node| node.is_focused());
        let label = focused.and_then(|node| node.accesskit_node().label()).unwrap_or_default();
        let id = format!("{:?}", root.accesskit_node().tree_state.focus_id_in_tree());
        names.insert(id.clone(), label);
        if seen.first() == Some(&id) {
            break;
        }
        let name = hands.harness.query_by(|node| node.is_focused()).map(|node| format!("{node:?}"));
        assert!(!seen.contains(&id), "{}: caught after {} controls at {name:?}", panel.title(), seen.len());
        seen.push(id);
        assert!(seen.len() < MOST_CONTROLS, "{}: Tab never comes round", panel.title());
    }
    assert!(seen.len() > 10, "{}: only {} controls", panel.title(), seen.len());
    seen
}

#[test]
fn a_step_is_opened_by_its_key_and_a_view_by_the_next() {
    let mut hands = Hands::with_demo();
    for (key, panel) in [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5].into_iter().zip(PanelName::ALL) {
        hands.press(Modifiers::NONE, key);
        assert_eq!(hands.session().panel, panel);
    }
    hands.press(Modifiers::COMMAND, Key::Backslash);
    let before = hands.session().views.active().map(|view| view.id);
    hands.press(Modifiers::NONE, Key::F6);
    assert_ne!(hands.session().views.active().map(|view| view.id), before);
    assert!(hands.harness.query_by_label("Split view right").is_none(), "no menu was opened");
}

/// Every command by the palette, with what shows that it ran.
#[test]
fn every_command_is_run_by_the_palette() {
    let mut hands = Hands::with_demo();
    hands.rest();
    for command in COMMANDS {
        // To be in force, these need something to act on.
        match command.id {
            CommandId::Undo => hands.session().edit("Name it", |document| document.set.name = "Corner".into()),
            CommandId::Palette => continue,
            _ if !hands.session().is_open() => {
                let set = hands.folder.path().join("set");
                hands.open(Open::Set(set));
            }
            _ => {}
        }
        hands.steps();
        assert!((command.enabled)(hands.session()), "{} cannot be run", command.title);
        run_by_palette(&mut hands, command);
        shows_that_it_ran(&mut hands, command.id);
        hands.press(Modifiers::NONE, Key::Escape);
    }
}

fn run_by_palette(hands: &mut Hands, command: &Command) {
    let field = "Find a command, a picture or a set";
    hands.press(Modifiers::COMMAND, Key::P);
    hands.type_into(field, command.title);
    hands.press(Modifiers::NONE, Key::Enter);
    assert!(hands.harness.query_by_role_and_label(Role::TextInput, field).is_none(), "{}", command.title);
}

fn shows_that_it_ran(hands: &mut Hands, id: CommandId) {
    let views = hands.session().views.all().count();
    match id {
        CommandId::OpenDemo => assert!(hands.session().document().set.folder.ends_with("config/demo")),
        CommandId::CloseSet => assert!(hands.sees("Open the demo")),
        CommandId::Save => assert!(hands.sees("Saved ")),
        CommandId::SaveAs => assert!(hands.sees("Save here")),
        CommandId::ReloadFromDisk => assert!(hands.sees("Reloaded capture.toml")),
        CommandId::Undo => assert_eq!(hands.session().document().set.name, "Blue corner"),
        CommandId::Redo => assert_eq!(hands.session().document().set.name, "Corner"),
        CommandId::ShowCaptures => assert_eq!(hands.session().panel, PanelName::Captures),
        CommandId::ShowCalibrate => assert_eq!(hands.session().panel, PanelName::Calibrate),
        CommandId::ShowSeparate => assert_eq!(hands.session().panel, PanelName::Separate),
        CommandId::ShowShape => assert_eq!(hands.session().panel, PanelName::Shape),
        CommandId::ShowExport => assert_eq!(hands.session().panel, PanelName::Export),
        CommandId::SplitRight => assert_eq!(views, 2),
        CommandId::SplitDown => assert_eq!(views, 3),
        CommandId::NewTab => assert_eq!(views, 4),
        CommandId::CloseView => assert_eq!(views, 3),
        CommandId::OneView => assert_eq!(views, 1),
        CommandId::TwoViews => assert_eq!(views, 2),
        CommandId::FourViews => assert_eq!(views, 4),
        CommandId::ResetLayout => assert_eq!(views, 1, "the surface of Export"),
        CommandId::Maximise => assert!(hands.session().views.maximised().is_some()),
        CommandId::ToggleSteps => assert!(!hands.sees("Folder for the results")),
        CommandId::ToggleInspector => assert!(!hands.sees("Inspector")),
        CommandId::ZoomIn => assert!(hands.session().preferences.ui_scale > 1.0),
        CommandId::ZoomOut | CommandId::ZoomReset => assert!((hands.session().preferences.ui_scale - 1.0).abs() < 1e-6),
        CommandId::ThemeDark => assert_eq!(hands.session().preferences.theme, Theme::Dark),
        CommandId::ThemeLight => assert_eq!(hands.session().preferences.theme, Theme::Light),
        CommandId::ThemeSystem => assert_eq!(hands.session().preferences.theme, Theme::System),
        CommandId::Help => assert!(hands.sees("Keys and commands")),
        CommandId::FrameTimes => assert!(hands.sees("frames steady: mean")),
        CommandId::About => assert!(hands.sees("CVPR 2011")),
        // What the others do shows elsewhere: in a view, in the log, or only while something runs or has failed.
        _ => {}
    }
}
