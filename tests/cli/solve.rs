//! `solve`, `evaluate`, `info` and `demo`.

use std::fs;
use std::path::Path;

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

    // Its indirect light bounced exactly twice and comes from no surface in view: the paper's case. What no surface explains
    // is taken to have the colour ratio of the whole object.
    dome_within(&out.join("mesh.obj"), 2.5);
    assert_eq!(firstbounce(place.path(), ["solve", "tiny", "--method", "colours"]).code, 0);
    dome_within(&out.join("mesh.obj"), 1.5);
}

/// The mesh, as an independent reader sees it, is the dome: in mm, facing the camera.
fn dome_within(mesh: &Path, limit_deg: f64) {
    let (models, _) = tobj::load_obj(mesh, &tobj::LoadOptions::default()).unwrap();
    let mesh = &models[0].mesh;
    let mut worst: f64 = 0.0;
    for (position, normal) in mesh.positions.chunks(3).zip(mesh.normals.chunks(3)) {
        let pixel = (f64::from(position[0]) / 0.5 + 48.0, 48.0 - f64::from(position[1]) / 0.5);
        let truth = dome_normal(pixel.0, pixel.1);
        let found = unit([normal[0], normal[1], normal[2]].map(f64::from));
        worst = worst.max(dot(truth, found).clamp(-1.0, 1.0).acos().to_degrees());
    }
    assert!(worst < limit_deg, "{worst} degrees");
    let height = |n: &[f32]| f64::from(n[2]);
    let heights = mesh.positions.chunks(3).map(height);
    let range = heights.clone().fold(f64::MIN, f64::max) - heights.fold(f64::MAX, f64::min);
    // The dome's sagitta from its centre to the outermost pixel.
    let sagitta = 0.5 * (120.0 - (120.0_f64.powi(2) - 2.0 * 47.5_f64.powi(2)).sqrt());
    assert!((range / sagitta - 1.0).abs() < 0.02 * limit_deg, "{range} for {sagitta} mm");
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
fn the_demo_tells_how_far_each_method_is_off() {
    let place = tempfile::tempdir().unwrap();
    let ran = firstbounce(place.path(), ["demo", "--no-window"]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    // Degrees are the first number of a row.
    let degrees = |row: &str| -> f64 {
        let line = ran.out.lines().find(|line| line.starts_with(row)).unwrap_or_else(|| panic!("{row}: {}", ran.out));
        line[row.len()..].split_whitespace().find_map(|word| word.parse().ok()).unwrap()
    };
    let [before, paper, together] =
        ["photos before separation", "the paper's method, 2 bounces", "colours and shape"].map(degrees);
    assert!(together < 0.3 * paper && paper < 0.3 * before, "{}", ran.out);
    for words in ["3 lamps in 2 colours", "solved by colours and shape", "open report.html there", "firstbounce open"] {
        assert!(ran.out.contains(words), "{words}: {}", ran.out);
    }

    // The set is the user's to change: without a truth the demo still ends with its results.
    let set = place.path().join("out/demo/set/capture.toml");
    let toml = fs::read_to_string(&set).unwrap();
    fs::write(&set, format!("{toml}\n[truth]\nnormals = \"none.exr\"\n")).unwrap();
    let again = firstbounce(place.path(), ["demo", "--no-window"]);
    assert!(again.code == 0 && !again.out.contains("before separation"), "{}{}", again.out, again.err);
    let record = firstbounce(place.path(), ["demo", "--no-window", "--json"]).json();
    assert!(record["evaluations"].as_object().unwrap().is_empty() && record["shape"].is_object());
}

#[test]
fn bounces_of_a_single_lamp_come_out_although_normals_cannot() {
    let place = tempfile::tempdir().unwrap();
    let set = tiny_set::write(place.path());
    let text = fs::read_to_string(set.join("capture.toml")).unwrap();
    fs::write(set.join("capture.toml"), without_lights(&text, &["top", "right"])).unwrap();
    let ran = firstbounce(place.path(), ["solve", "tiny", "--method", "colours"]);
    assert!(ran.failure().contains("at least three"), "{}", ran.err);
    assert!(place.path().join("out/tiny/bounce2-left.exr").is_file());
    let ran = firstbounce(place.path(), ["solve", "tiny"]);
    assert!(ran.failure().contains("at least three"), "{}", ran.err);
    assert!(ran.err.contains("each light has one colour ratio"), "{}", ran.err);
    assert!(place.path().join("out/tiny/indirect-left.exr").is_file());
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

#[test]
fn shape_settings_of_the_file_count_and_flags_go_before_them() {
    let place = tempfile::tempdir().unwrap();
    let set = tiny_set::write(place.path());
    let file = set.join("capture.toml");
    let text = fs::read_to_string(&file).unwrap();
    fs::write(&file, format!("{text}\n[shape]\nshadow_share = 0.9\nindirect_window_px = 5\n")).unwrap();
    let report = firstbounce(place.path(), ["solve", "tiny", "--json"]).json();
    let shape = &report["options"]["shape"];
    assert_eq!((shape["shadow_share"].as_f64(), shape["indirect_window_px"].as_u64()), (Some(0.9), Some(5)));
    // With so high a threshold a light is in shadow almost everywhere.
    let unsolved = |report: &Value| report["shape"]["shadow_used_pixels"].as_u64().unwrap();
    let default = firstbounce(place.path(), ["solve", "tiny", "--shadow-share", "0.08", "--json"]).json();
    assert_eq!(default["options"]["shape"]["shadow_share"].as_f64(), Some(0.08));
    assert!(unsolved(&report) > unsolved(&default), "{} {}", unsolved(&report), unsolved(&default));

    let line = firstbounce(place.path(), ["solve", "tiny", "--shadow-share", "1.5"]).failure().to_owned();
    assert!(line.contains("[shape] shadow_share: expected a number from 0 to 0.99, found 1.5"), "{line}");
}

#[test]
fn a_light_that_is_left_out_is_named_and_a_misspelt_one_refused() {
    let place = tempfile::tempdir().unwrap();
    tiny_set::write(place.path());
    let line = firstbounce(place.path(), ["solve", "tiny", "--leave-out", "rihgt"]).failure().to_owned();
    assert!(line.contains("unknown light \"rihgt\"; did you mean \"right\"?"), "{line}");
    // Two lights tell no normals; the bounces of all three are written all the same.
    let ran = firstbounce(place.path(), ["solve", "tiny", "--leave-out", "right", "--json"]);
    let report: Value = serde_json::from_str(&ran.out).unwrap();
    assert!(ran.code != 0 && report["no_shape"].is_string());
    assert_eq!(report["options"]["shape"]["leave_out"], serde_json::json!(["right"]));
    assert!(report["separation"].as_object().unwrap().contains_key("right"));
}

#[test]
fn the_report_names_its_form_its_time_and_the_content_of_every_input() {
    let place = tempfile::tempdir().unwrap();
    let set = tiny_set::write(place.path());
    let report = firstbounce(place.path(), ["solve", "tiny", "--json"]).json();
    assert_eq!(report["schema"], 1);
    assert!(report["time"].as_str().unwrap().ends_with('Z'));
    let inputs = report["inputs"].as_object().unwrap();
    assert_eq!(inputs.len(), 1 + 3 * (3 * 2 + 1));
    let file = &inputs["capture.toml"];
    assert_eq!(file["bytes"].as_u64().unwrap(), fs::metadata(set.join("capture.toml")).unwrap().len());
    assert!(inputs.values().all(|input| input["sha256"].as_str().unwrap().len() == 64));
}
