//! Beta of a set without a ball of its paint.

use std::fs;

use serde_json::Value;

use crate::run::firstbounce;

/// A bowl with a flat rim, which receives no light from its walls.
#[test]
fn beta_of_a_simulated_bowl_is_measured_on_the_object() {
    let place = tempfile::tempdir().unwrap();
    let place = place.path();
    let bowl =
        ["simulate", "bowl", "--out", "set", "--pixels", "120", "--patches", "400", "--ball-pixels", "96", "--json"];
    firstbounce(place, bowl).json();
    let toml = fs::read_to_string(place.join("set/capture.toml")).unwrap();
    let rig: Value = serde_json::from_str(&fs::read_to_string(place.join("set/truth/rig.json")).unwrap()).unwrap();
    let truth = rig["beta"][1].as_f64().unwrap();
    let of_paint = |table: &&str| !table.contains("\"material-sphere\"");
    let tables: Vec<_> = toml.split("\n\n").filter(of_paint).collect();
    fs::write(place.join("set/capture.toml"), tables.join("\n\n")).unwrap();

    let report = firstbounce(place, ["solve", "set", "--out", "results", "--json"]).json();
    assert_eq!(report["calibration"]["source"]["beta"][1], "measured on the object");
    let found = report["calibration"]["beta"][1].as_f64().unwrap();
    assert!((found / truth - 1.0).abs() < 0.01, "{found} for {truth}: {}", report["warnings"]);
    let interval = &report["calibration"]["interval"]["beta"][1];
    let [low, high] = [0, 1].map(|end| interval[end].as_f64().unwrap());
    assert!(low < truth && truth < high, "{interval} for {truth}");

    let calibration = firstbounce(place, ["calibrate", "set", "--json"]).json();
    assert_eq!(calibration["source"]["beta"][1], "measured on the object");
    assert_eq!(calibration["beta"][1], report["calibration"]["beta"][1]);
}
