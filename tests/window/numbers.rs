//! Whatever number a field or a file is given: no panic, and the window comes to rest.

use std::time::{Duration, Instant};

use eframe::egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};
use firstbounce::app::state::document::Document;
use firstbounce::app::state::panel::PanelName;
use firstbounce::app::state::session::Open;
use firstbounce::app::window::commands::CommandId;
use firstbounce_capture::CaptureSet;
use firstbounce_capture::set::Projection;
use firstbounce_testing::write_tiny_set;

use crate::harness::Hands;

/// Longer than any machine needs for pictures of 16 x 16 pixels.
const PATIENCE: Duration = Duration::from_secs(20);

const EXTREMES: [f64; 9] =
    [0.0, -0.0, f64::from_bits(1), f64::MIN_POSITIVE, f64::MAX, f64::MIN, f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

/// Nothing is computed any more, and no frame asks for another one.
fn comes_to_rest(hands: &mut Hands, after: &str) {
    let since = Instant::now();
    loop {
        hands.harness.step();
        let document = hands.session().document();
        if hands.session().results.is_at_rest(&document) {
            break;
        }
        assert!(since.elapsed() < PATIENCE, "the results find no rest after {after}");
        std::thread::sleep(Duration::from_millis(2));
    }
    assert!(hands.harness.try_run().is_ok(), "the window repaints without rest after {after}");
}

#[test]
fn every_field_of_every_step_keeps_its_numbers_within_their_ranges() {
    let mut hands = Hands::new();
    let set = hands.folder.path().join("set");
    write_tiny_set(&set);
    hands.open(Open::Set(set));
    hands.rest();
    let mut fields = 0;
    for panel in PanelName::ALL {
        hands.session().panel = panel;
        hands.steps();
        let before = Document::clone(&hands.session().document());
        let count = hands.harness.query_all_by_role(Role::SpinButton).count();
        for index in 0..count {
            for value in EXTREMES {
                let Some(field) = hands.harness.query_all_by_role(Role::SpinButton).nth(index) else { continue };
                field.set_value_accesskit(value);
                hands.harness.step();
                fields += 1;
            }
        }
        let problems = hands.session().document().set.check();
        let beyond = problems.iter().find(|problem| problem.message.contains("expected a number from"));
        assert!(beyond.is_none(), "{panel:?}: {beyond:?}");
        comes_to_rest(&mut hands, &format!("{panel:?}"));
        hands.session().edit("Take it all back", |document| *document = before);
    }
    assert!(fields > 100, "{fields} changes were made");
}

#[test]
fn what_is_typed_beyond_a_range_becomes_its_end() {
    let mut hands = Hands::new();
    let set = hands.folder.path().join("set");
    write_tiny_set(&set);
    hands.open(Open::Set(set));
    hands.rest();
    hands.session().panel = PanelName::Calibrate;
    hands.steps();
    for (typed, kept) in [("1e-300", 1e-4), ("1e300", 1e4), ("nan", 1e4), ("1e400", 1e4), ("-1e308", 1e-4)] {
        hands.type_number("alpha, light1, c2", typed);
        assert_eq!(hands.session().document().set.calibration.alpha["light1"][1], kept, "{typed}");
        comes_to_rest(&mut hands, typed);
    }
}

/// A line of a set's file, and where it is put.
struct Given {
    line: &'static str,
    below: &'static str,
}

const GIVEN: [Given; 18] = [
    Given { below: "[camera]", line: "black_level = ?" },
    Given { below: "[camera]", line: "white_level = ?" },
    Given { below: "[camera]", line: "encoding = { gamma = ? }" },
    Given { below: "[camera]", line: "mm_per_pixel = ?" },
    Given { below: "[camera]", line: "full_well_electrons = ?" },
    Given { below: "[camera]", line: "read_noise_electrons = ?" },
    Given { below: "name = \"light1\"", line: "direction = [?, 0.1, 0.9]" },
    Given { below: "name = \"light1\"", line: "position_mm = [?, 100, 900]" },
    Given { below: "[[shot]]", line: "exposure = ?" },
    Given { below: "[[shot]]", line: "encoding = { gamma = ? }" },
    Given { below: "[[sphere]]", line: "centre = [?, 16]" },
    Given { below: "[[sphere]]", line: "radius = ?" },
    Given { below: "[calibration]", line: "beta = [1.0, ?]" },
    Given { below: "[calibration]", line: "grey_albedo = ?" },
    Given { below: "[calibration]", line: "white_light = ?" },
    Given { below: "[calibration.alpha]", line: "light1 = [1.0, ?]" },
    Given { below: "[calibration.direction]", line: "light1 = [?, 0.1, 0.9]" },
    Given { below: "[calibration.intensity]", line: "light1 = ?" },
];

/// The text with the line below its header, in place of one of the same key that stands there.
fn given(text: &str, Given { below, line }: &Given, value: &str) -> String {
    let line = line.replace('?', value);
    let key = line.split(' ').next().unwrap_or_default();
    let mut lines: Vec<&str> = text.lines().collect();
    let header = lines.iter().position(|line| line == below);
    let header = header.unwrap_or_else(|| {
        lines.push(below);
        lines.len() - 1
    });
    let end =
        lines.iter().skip(header + 1).position(|line| line.starts_with('[')).map_or(lines.len(), |n| header + 1 + n);
    let old = (header + 1..end).find(|&at| lines[at].split(' ').next() == Some(key));
    match old {
        Some(at) => lines[at] = &line,
        None => lines.insert(header + 1, &line),
    }
    lines.join("\n") + "\n"
}

#[test]
fn a_file_with_any_number_is_opened_and_the_window_comes_to_rest() {
    let mut hands = Hands::new();
    let set = hands.folder.path().join("set");
    write_tiny_set(&set);
    let text = std::fs::read_to_string(set.join("capture.toml")).unwrap();
    for what in &GIVEN {
        for value in ["1e300", "1e-300", "-1e160", "nan"] {
            let changed = given(&text, what, value);
            std::fs::write(set.join("capture.toml"), &changed).unwrap();
            let after = what.line.replace('?', value);
            assert!(changed.contains(&after), "{after}");
            hands.open(Open::Set(set.clone()));
            for panel in [PanelName::Captures, PanelName::Calibrate] {
                hands.session().panel = panel;
                hands.harness.run_steps(2);
            }
            comes_to_rest(&mut hands, &after);
        }
    }
}

#[test]
fn numbers_of_the_camera_in_a_file_are_seen_and_the_window_comes_to_rest() {
    let mut hands = Hands::new();
    let folder = hands.folder.path().join("set");
    write_tiny_set(&folder);
    let mut set = CaptureSet::open(&folder).unwrap();
    for extreme in EXTREMES.into_iter().filter(|number| number.is_finite()) {
        set.camera.projection = Projection::Perspective {
            focal_length_px: extreme,
            principal_point: Some([extreme, 8.0]),
            working_distance_mm: extreme,
        };
        std::fs::write(folder.join("capture.toml"), set.to_toml()).unwrap();
        hands.open(Open::Set(folder.clone()));
        comes_to_rest(&mut hands, &format!("{extreme:e}"));
    }
}

#[test]
fn the_settings_beside_a_set_are_taken_within_their_ranges() {
    let mut hands = Hands::new();
    let set = hands.folder.path().join("set");
    write_tiny_set(&set);
    let kept = serde_json::json!({ "settings": {
        "shape": { "shadow_fraction": 1e300, "outlier_fraction": -1e300, "rounds": u64::MAX, "indirect_radius_px": u64::MAX },
        "nayar": { "patches": 0, "max_iterations": u64::MAX },
        "export": { "triangles": u64::MAX },
    }});
    std::fs::write(set.join("firstbounce-view.json"), kept.to_string()).unwrap();
    hands.open(Open::Set(set));
    let document = hands.session().document();
    let (shape, settings) = (&document.set.shape, &document.settings);
    assert_eq!((shape.shadow_share, shape.misfit_share), (0.99, 0.0));
    assert_eq!((shape.rounds, shape.indirect_window_px), (100, 64));
    assert_eq!((settings.nayar.patches, settings.nayar.max_iterations), (16, 100));
    comes_to_rest(&mut hands, "settings without measure");
}

#[test]
fn every_field_of_a_simulated_set_says_what_is_out_of_its_range() {
    let mut hands = Hands::new();
    hands.run(CommandId::NewSimulatedSet);
    hands.steps();
    hands.type_number("Patches that exchange light", "60");
    hands.type_number("Side of the picture", "16");
    for lamps in ["Far away", "Near, small", "Near, square"] {
        hands.harness.get_by_role_and_label(Role::RadioButton, lamps).click_accesskit();
        hands.steps();
        let count = hands.harness.query_all_by_role(Role::SpinButton).count();
        for index in 0..count {
            let field = hands.harness.query_all_by_role(Role::SpinButton).nth(index);
            let Some(old) = field.and_then(|field| field.accesskit_node().numeric_value()) else { continue };
            for value in EXTREMES.into_iter().chain([old]) {
                let Some(field) = hands.harness.query_all_by_role(Role::SpinButton).nth(index) else { continue };
                field.set_value_accesskit(value);
                hands.harness.run_steps(2);
            }
        }
    }
}
