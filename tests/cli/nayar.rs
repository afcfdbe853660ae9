//! Nayar's method on the command line.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::run::firstbounce;
use crate::tiny_set;

const BY_NAYAR: [&str; 6] = ["--method", "nayar", "--patches", "200", "--iterations", "3"];

fn run(place: &Path, command: &[&str]) -> crate::run::Ran {
    firstbounce(place, command.iter().chain(&BY_NAYAR))
}

/// The tiny set as one who has a single lamp colour would take it: no second colour, no ball of the paint.
fn in_one_colour(set: &Path) {
    let text = fs::read_to_string(set.join("capture.toml")).unwrap();
    let other = |block: &&str| {
        block.contains("colour = \"green\"") || block.contains("name = \"green\"") || block.contains("material-sphere")
    };
    let kept: Vec<_> = text.split("\n\n").filter(|block| !other(block)).collect();
    fs::write(set.join("capture.toml"), kept.join("\n\n") + "\n").unwrap();
}

fn type_grey_albedo(set: &Path, albedo: &str) {
    let text = fs::read_to_string(set.join("capture.toml")).unwrap();
    fs::write(set.join("capture.toml"), format!("{text}\n[calibration]\ngrey_albedo = {albedo}\n")).unwrap();
}

#[test]
fn one_colour_and_a_grey_ball_are_enough() {
    let place = tempfile::tempdir().unwrap();
    let set = tiny_set::write(place.path());
    in_one_colour(&set);
    type_grey_albedo(&set, "0.4");
    let info = firstbounce(place.path(), ["info", "tiny", "--json"]).json();
    assert_eq!(info["colours"], serde_json::json!(["blue"]));
    assert!(!info["lacks"].to_string().contains("beta"), "{}", info["lacks"]);
    assert_eq!(firstbounce(place.path(), ["calibrate", "tiny"]).code, 0);

    let report = run(place.path(), &["solve", "tiny", "--json"]).json();
    assert_eq!(report["method"], "shape");
    let nayar = &report["nayar"];
    assert_eq!(nayar["ending"], "converged");
    // The grey ball is 0.4 under a lamp of intensity 1: white is 1.
    assert!((nayar["white_light"].as_f64().unwrap() - 1.0).abs() < 0.01, "{nayar}");
    assert_eq!(nayar["white_light_source"], "grey ball");
    // A dome sends itself no light: its pseudo shape is its shape.
    let iterations = nayar["iterations"].as_array().unwrap();
    assert!(iterations[1]["change_deg"].as_f64().unwrap() < 0.1, "{nayar}");

    let out = place.path().join("out/tiny");
    for file in report["files"].as_object().unwrap().keys() {
        assert!(out.join(file).is_file(), "{file}");
    }
    assert_eq!(report, serde_json::from_str::<Value>(&fs::read_to_string(out.join("report.json")).unwrap()).unwrap());
    assert!(fs::read_to_string(out.join("report.html")).unwrap().contains("Nayar's method"));
    let text = run(place.path(), &["solve", "tiny"]).out;
    assert!(text.contains("pseudo shape") && text.contains("converged after 1 iterations"), "{text}");
}

#[test]
fn without_a_scale_it_says_what_to_type() {
    let place = tempfile::tempdir().unwrap();
    let set = tiny_set::write(place.path());
    let line = run(place.path(), &["solve", "tiny"]).failure().to_owned();
    assert!(line.contains("grey_albedo under [calibration]") && line.contains("--grey-albedo"), "{line}");
    assert!(!place.path().join("out").join("tiny").exists());

    let line = run(place.path(), &["solve", "tiny", "--grey-albedo", "1.5"]).failure().to_owned();
    assert!(line.contains("grey_albedo is 1.5; it must be from 0.0001 to 1"), "{line}");
    type_grey_albedo(&set, "40");
    let line = run(place.path(), &["solve", "tiny"]).failure().to_owned();
    assert!(line.contains("grey_albedo") && line.contains("expected a number from 0.0001 to 1, found 40"), "{line}");
}

#[test]
fn an_order_that_would_be_ignored_is_refused() {
    let place = tempfile::tempdir().unwrap();
    tiny_set::write(place.path());
    let line = run(place.path(), &["solve", "tiny", "--bounces", "2"]).failure().to_owned();
    assert!(line.contains("--bounces is for --method bounces"), "{line}");
    assert!(!place.path().join("out").exists());
}

#[test]
fn a_rendered_set_tells_the_error_after_each_iteration() {
    let place = tempfile::tempdir().unwrap();
    let demo = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/demo");
    let words = run(place.path(), &["evaluate", demo, "--json"]).json();
    // Its file does not tell the grey ball's albedo, but its truth tells the light of white.
    assert_eq!(words["nayar"]["white_light_source"], "the set's truth");
    let iterations = words["nayar"]["iterations"].as_array().unwrap();
    let error = |k: usize| iterations[k]["error_deg"]["mean"].as_f64().unwrap();
    assert_eq!(error(0), words["normal_error_deg"]["raw"]["mean"].as_f64().unwrap());
    assert!((1..=3).all(|k| error(k) < error(0)), "{iterations:?}");
    let text = run(place.path(), &["evaluate", demo, "--grey-albedo", "0.5"]).out;
    assert!(text.contains("Nayar's method, iteration 3") && text.contains("(grey ball)"), "{text}");
}
