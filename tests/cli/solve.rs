//! `solve`, `evaluate`, `info` and `demo`.

use std::fs;

use serde_json::Value;

use crate::run::firstbounce;
use crate::tiny_set::{self, dome_normal, dot, unit};

#[test]
fn a_dome_comes_back_from_its_photos() {
    let place = tempfile::tempdir().unwrap();
    tiny_set::write(place.path());
    let report = firstbounce(place.path(), ["solve", "tiny", "--json"]).json();
    let out = place.path().join("out/tiny");
    for file in report["files"].as_object().unwrap().keys() {
        assert!(out.join(file).is_file(), "{file}");
    }
    assert_eq!(report, serde_json::from_str::<Value>(&fs::read_to_string(out.join("report.json")).unwrap()).unwrap());
    assert!(report["stages"].as_array().unwrap().iter().all(|stage| stage["seconds"].as_f64().unwrap() >= 0.0));

    // The mesh, as an independent reader sees it, is the dome: in mm, facing the camera.
    let (models, _) = tobj::load_obj(out.join("mesh.obj"), &tobj::LoadOptions::default()).unwrap();
    let mesh = &models[0].mesh;
    let mut worst: f64 = 0.0;
    for (position, normal) in mesh.positions.chunks(3).zip(mesh.normals.chunks(3)) {
        let pixel = (f64::from(position[0]) / 0.5 + 48.0, 48.0 - f64::from(position[1]) / 0.5);
        let truth = dome_normal(pixel.0, pixel.1);
        let found = unit([normal[0], normal[1], normal[2]].map(f64::from));
        worst = worst.max(dot(truth, found).clamp(-1.0, 1.0).acos().to_degrees());
    }
    assert!(worst < 1.5, "{worst} degrees");
    let height = |n: &[f32]| f64::from(n[2]);
    let heights = mesh.positions.chunks(3).map(height);
    let range = heights.clone().fold(f64::MIN, f64::max) - heights.fold(f64::MAX, f64::min);
    // The dome's sagitta from its centre to the outermost pixel.
    let sagitta = 0.5 * (120.0 - (120.0_f64.powi(2) - 2.0 * 47.5_f64.powi(2)).sqrt());
    assert!((range / sagitta - 1.0).abs() < 0.02, "{range} for {sagitta} mm");
}

#[test]
fn separation_beats_the_raw_photos_on_the_demo_set() {
    let place = tempfile::tempdir().unwrap();
    let demo = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/demo");
    let words = firstbounce(place.path(), ["evaluate", demo, "--json"]).json();
    let mean = |of: &str| words["normal_error_deg"][of]["mean"].as_f64().unwrap();
    assert!((mean("raw") - 15.4).abs() < 0.3, "raw {}", mean("raw"));
    assert!(mean("separated") <= 3.7, "separated {}", mean("separated"));
    assert!(words["depth_rmse_mm"].as_f64() < words["depth_rmse_raw_mm"].as_f64());
    assert!(words["depth_rmse_true_normals_mm"].as_f64().unwrap() <= 0.15);
}

#[test]
fn bounces_of_a_single_lamp_come_out_although_normals_cannot() {
    let place = tempfile::tempdir().unwrap();
    let set = tiny_set::write(place.path());
    let text = fs::read_to_string(set.join("capture.toml")).unwrap();
    fs::write(set.join("capture.toml"), without_lights(&text, &["top", "right"])).unwrap();
    let ran = firstbounce(place.path(), ["solve", "tiny"]);
    assert!(ran.failure().contains("at least three"), "{}", ran.err);
    assert!(place.path().join("out/tiny/bounce2-left.exr").is_file());
    assert!(!place.path().join("out/tiny/mesh.obj").exists());
}

/// The file without these lights and their shots.
fn without_lights(text: &str, lights: &[&str]) -> String {
    let names = |block: &str| {
        lights.iter().any(|l| {
            block.contains(&format!("light = \"{l}\"")) || block.starts_with(&format!("[[light]]\nname = \"{l}\""))
        })
    };
    text.split("\n\n").filter(|block| !names(block)).collect::<Vec<_>>().join("\n\n") + "\n"
}

#[test]
fn a_second_run_replaces_its_own_files_and_nothing_else() {
    let place = tempfile::tempdir().unwrap();
    tiny_set::write(place.path());
    assert_eq!(firstbounce(place.path(), ["solve", "tiny", "--out", "results"]).code, 0);
    fs::write(place.path().join("results/notes.txt"), "mine").unwrap();
    assert_eq!(firstbounce(place.path(), ["solve", "tiny", "--out", "results", "--directx"]).code, 0);
    assert_eq!(fs::read_to_string(place.path().join("results/notes.txt")).unwrap(), "mine");
    let report: Value =
        serde_json::from_str(&fs::read_to_string(place.path().join("results/report.json")).unwrap()).unwrap();
    assert!(report["conventions"]["normals"].as_str().unwrap().contains("y down"));
    let left = fs::read_dir(place.path()).unwrap().chain(fs::read_dir(place.path().join("results")).unwrap());
    assert!(left.flatten().all(|entry| !entry.file_name().to_string_lossy().starts_with('.')), "no staging left");
}

#[test]
fn info_names_what_a_set_holds_and_lacks() {
    let place = tempfile::tempdir().unwrap();
    let set = tiny_set::write(place.path());
    fs::remove_file(set.join("object/top-green.png")).unwrap();
    let info = firstbounce(place.path(), ["info", "tiny", "--json"]).json();
    assert_eq!(info["lights"], serde_json::json!(["left", "top", "right"]));
    assert_eq!(info["missing_files"], serde_json::json!(["object/top-green.png"]));
    assert!(info["lacks"].to_string().contains("mask"));
}

#[test]
fn wrong_usage_exits_with_two() {
    let place = tempfile::tempdir().unwrap();
    for arguments in [vec!["solve"], vec!["fold", "tiny"], vec!["solve", "tiny", "--bounces", "many"]] {
        assert_eq!(firstbounce(place.path(), arguments).code, 2);
    }
}
