//! `simulate`, `plan` and `paper`.

use std::fs;

use serde_json::Value;

use crate::run::{Ran, firstbounce};

/// Small enough for a test.
const SMALL: [&str; 6] = ["--pixels", "80", "--patches", "200", "--ball-pixels", "96"];

fn simulated(place: &std::path::Path, arguments: &[&str]) -> Ran {
    firstbounce(place, ["simulate"].iter().chain(arguments).chain(&SMALL).copied())
}

#[test]
fn a_simulated_set_goes_through_every_command() {
    let place = tempfile::tempdir().unwrap();
    let place = place.path();
    let words = simulated(place, &["corner", "--out", "set", "--json"]).json();
    assert_eq!(words["warnings"], serde_json::json!([]));
    assert!(words["reciprocity_residual"].as_f64().unwrap() < 1e-3);
    assert!(words["indirect_share"].as_f64().unwrap() > 0.2);

    let info = firstbounce(place, ["info", "set", "--json"]).json();
    assert_eq!(info["missing_files"], serde_json::json!([]));
    assert_eq!(info["lacks"], serde_json::json!([]));

    let calibration = firstbounce(place, ["calibrate", "set", "--json"]).json();
    let rig: Value = serde_json::from_str(&fs::read_to_string(place.join("set/truth/rig.json")).unwrap()).unwrap();
    for light in ["light1", "light2", "light3"] {
        let (found, truth) = (&calibration["alpha"][light][1], &rig["alpha"][light][1]);
        let (found, truth) = (found.as_f64().unwrap(), truth.as_f64().unwrap());
        assert!((found / truth - 1.0).abs() < 2e-3, "{light}: {found} for {truth}");
    }

    let report = firstbounce(place, ["solve", "set", "--out", "results", "--json"]).json();
    assert_eq!(report["no_shape"], Value::Null);
    let evaluation = firstbounce(place, ["evaluate", "set", "--json"]).json();
    let mean = |of: &str| evaluation["normal_error_deg"][of]["mean"].as_f64().unwrap();
    assert!(mean("separated") < 0.5 * mean("raw"), "{evaluation}");

    // Without a scale depth is in pixels, and no error in mm can be told.
    let toml = fs::read_to_string(place.join("set/capture.toml")).unwrap();
    let without: Vec<_> = toml.lines().filter(|line| !line.starts_with("mm_per_pixel")).collect();
    fs::write(place.join("set/capture.toml"), without.join("\n") + "\n").unwrap();
    let in_pixels = firstbounce(place, ["evaluate", "set", "--json"]).json();
    assert!(in_pixels["depth_rmse_mm"].is_null() && evaluation["depth_rmse_mm"].is_number(), "{in_pixels}");
    fs::write(place.join("set/capture.toml"), toml).unwrap();

    // The set tells how bright its grey ball is, and with that how dark the paint.
    let by_nayar = ["evaluate", "set", "--method", "nayar", "--patches", "300", "--json"];
    let iterations = &firstbounce(place, by_nayar).json()["nayar"]["iterations"];
    let degrees = |k: usize| iterations[k]["error_deg"]["mean"].as_f64().unwrap();
    assert!((1..=3).all(|k| degrees(k) < degrees(0)), "{iterations}");
}

#[test]
fn a_mesh_and_lamps_of_every_kind_make_a_set() {
    let place = tempfile::tempdir().unwrap();
    let place = place.path();
    // An open box in metres, seen from above: a floor and four walls.
    let corners = "v -.05 -.05 0\nv .05 -.05 0\nv .05 .05 0\nv -.05 .05 0\n\
                   v -.06 -.06 .03\nv .06 -.06 .03\nv .06 .06 .03\nv -.06 .06 .03\n";
    let faces = "f 1 2 3 4\nf 2 1 5 6\nf 3 2 6 7\nf 4 3 7 8\nf 1 4 8 5\n";
    fs::write(place.join("box.obj"), format!("{corners}{faces}")).unwrap();
    let lights = "dir:-0.3,0.1,1;point:50,300,900;area:250,-150,900:40";
    let arguments = [
        "box.obj",
        "--unit",
        "m",
        "--lights",
        lights,
        "--albedos",
        "0.7,0.5,0.2",
        "--alpha",
        "1,1.4,3",
        "--out",
        "set",
    ];
    let ran = simulated(place, &arguments);
    assert_eq!(ran.code, 0, "{}", ran.err);
    let evaluation = firstbounce(place, ["evaluate", "set", "--json"]).json();
    let mean = |of: &str| evaluation["normal_error_deg"][of]["mean"].as_f64().unwrap();
    assert!(mean("separated") < mean("raw"), "{evaluation}");
    let text = fs::read_to_string(place.join("set/capture.toml")).unwrap();
    assert!(text.contains("position_mm") && text.contains("Simulated box"), "{text}");

    let flipped = simulated(place, &["box.obj", "--unit", "m", "--flip", "--out", "other"]);
    assert!(flipped.failure().contains("from behind"), "{}", flipped.err);
}

#[test]
fn what_cannot_be_simulated_is_refused_in_one_line() {
    let place = tempfile::tempdir().unwrap();
    let place = place.path();
    fs::write(place.join("points.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\n").unwrap();
    fs::create_dir(place.join("mine")).unwrap();
    fs::write(place.join("mine/letter.txt"), "dear").unwrap();
    for (arguments, words) in [
        (&["ring", "--out", "set"][..], &["no scene \"ring\"", "corner"][..]),
        (&["nowhere.obj", "--out", "set"], &["nowhere.obj"]),
        (&["points.obj", "--out", "set"], &["points.obj", "no triangle"]),
        (&["corner", "--albedos", "0.7,1.4", "--out", "set"], &["albedo 1.4"]),
        (&["corner", "--lights", "dir:0,1,-1", "--out", "set"], &["light1", "behind"]),
        (&["corner", "--intensities", "1,2", "--out", "set"], &["2 intensities for 3 lamps"]),
        (&["cap", "--angle", "120", "--out", "set"], &["half_angle_deg", "120"]),
        (&["corner", "--bits", "20", "--out", "set"], &["bits"]),
        (&["corner", "--angle", "70", "--out", "set"], &["--angle is for groove and cap"]),
        (&["bowl", "--unit", "m", "--out", "set"], &["--unit is for a mesh file"]),
        (&["tray", "--flip", "--out", "set"], &["--flip is for a mesh file"]),
        (&["points.obj", "--size", "50", "--out", "set"], &["--size is for the built-in shapes"]),
        (&["corner", "--out", "mine"], &["mine", "letter.txt"]),
    ] {
        let ran = simulated(place, arguments);
        let line = ran.failure();
        assert!(words.iter().all(|word| line.contains(word)), "{line}");
        assert!(!place.join("set").exists());
    }
    assert_eq!(fs::read_dir(place.join("mine")).unwrap().count(), 1);
    assert_eq!(simulated(place, &["corner", "--lights", "sun", "--out", "set"]).code, 2);
}

#[test]
fn the_plan_tells_noise_from_the_rest_by_each_method() {
    let place = tempfile::tempdir().unwrap();
    let planned = |more: &[&str]| {
        let arguments = ["plan", "groove", "--try-frames", "1,4", "--try-ratios", "0.5,0.9", "--json"];
        firstbounce(place.path(), arguments.iter().chain(more)).json()
    };
    let of = |plan: &Value, list: &str, index: usize, key: &str| plan[list][index][key].as_f64().unwrap();
    let (together, paper) = (planned(&[]), planned(&["--method", "colours"]));
    assert_eq!((&together["method"], &together["bounces"]), (&"colours-and-shape".into(), &1.into()));
    assert_eq!((&paper["method"], &paper["bounces"]), (&"colours".into(), &2.into()));
    for plan in [&together, &paper] {
        // Four times the frames halve the noise and leave the rest; alike colours are noisier.
        let by_noise = |index: usize| of(plan, "by_frames", index, "noise_deg");
        assert!((by_noise(0) / by_noise(1) - 2.0).abs() < 1e-6);
        assert_eq!(of(plan, "by_frames", 0, "tail_deg"), of(plan, "by_frames", 1, "tail_deg"));
        assert!(plan["raw_deg"].as_f64().unwrap() > of(plan, "by_frames", 1, "error_deg"));
    }
    assert!(of(&paper, "by_ratio", 1, "noise_deg") > 1.5 * of(&paper, "by_ratio", 0, "noise_deg"));
    // A mean of photos, not a difference of them.
    assert!(of(&together, "by_frames", 0, "gain") < 1.0 && of(&paper, "by_frames", 0, "gain") > 4.0);
    assert!(of(&together, "by_frames", 1, "error_deg") < of(&paper, "by_frames", 1, "error_deg"));

    let refused = |more: &[&str]| {
        let ran = firstbounce(place.path(), ["plan", "groove"].iter().chain(more));
        ran.failure().to_owned()
    };
    assert!(refused(&["--method", "colours-and-shape", "--bounces", "2"]).contains("--method colours"));
    assert!(refused(&["--method", "colours-and-shape", "--albedos", "0.5"]).contains("two colours"));
    assert_eq!(firstbounce(place.path(), ["plan", "groove", "--method", "shape"]).code, 2);
}

#[test]
fn the_papers_experiments_are_printed_and_plotted() {
    let place = tempfile::tempdir().unwrap();
    let paper = firstbounce(place.path(), ["paper", "--size", "32", "--out", "pages/paper.html", "--json"]).json();
    let rows = paper["table"].as_array().unwrap();
    let named: Vec<_> =
        rows.iter().map(|row| (row["scene"].as_str().unwrap(), row["light"].as_str().unwrap())).collect();
    let expected =
        [("corner", "two bounces"), ("corner", "all bounces"), ("tray", "four bounces"), ("tray", "all bounces")];
    assert_eq!(named, expected);
    for row in rows {
        for key in ["raw_deg", "separated_deg", "direct_error_percent"] {
            assert!(row[key].as_f64().unwrap() > 0.0 && row["noiseless"][key].as_f64().unwrap() >= 0.0, "{row}");
        }
    }
    assert!(rows[0]["noiseless"]["separated_deg"].as_f64().unwrap() <= 0.3);
    for row in rows {
        let together = &row["colours_and_shape"];
        assert_eq!(together.is_object(), row["light"] == "all bounces", "{row}");
        let degrees = together["normals_deg"].as_f64();
        assert!(degrees.is_none_or(|degrees| degrees < row["separated_deg"].as_f64().unwrap()), "{row}");
    }
    let all_bounces = paper["figure3_all_bounces"].as_array().unwrap();
    assert_eq!(all_bounces.len(), paper["figure3"].as_array().unwrap().len());
    let keys = ["ratio", "bits", "raw_deg", "separated_deg", "colours_and_shape_deg"];
    assert!(all_bounces.iter().all(|point| keys.iter().all(|key| point[key].is_number())));
    assert!(paper["figure3"].as_array().unwrap().iter().any(|point| point["ratio"].as_f64().unwrap() > 1.0));
    let page = fs::read_to_string(place.path().join("pages/paper.html")).unwrap();
    assert!(page.contains("<svg") && page.contains("ratio of albedos") && page.contains("7.88"));
    assert!(page.contains("Figure 3 with all bounces") && page.contains("light that bounces without end"));

    let ran = firstbounce(place.path(), ["paper", "--size", "5"]);
    assert!(ran.failure().contains("size_px is 5"), "{}", ran.err);
}

#[test]
fn crosstalk_of_a_simulated_set_is_measured_kept_and_undone() {
    let place = tempfile::tempdir().unwrap();
    let place = place.path();
    let crosstalk = ["corner", "--out", "set", "--crosstalk", "0.04", "--crosstalk-shots", "--frames", "16"];
    assert_eq!(simulated(place, &crosstalk).code, 0);
    simulated(place, &["corner", "--out", "pure", "--frames", "16"]);
    let error_deg = |set: &str| {
        let evaluation = firstbounce(place, ["evaluate", set, "--json"]).json();
        evaluation["normal_error_deg"]["separated"]["mean"].as_f64().unwrap()
    };
    let (measured, pure) = (error_deg("set"), error_deg("pure"));
    assert!((measured - pure).abs() < 0.1, "{measured} degrees, {pure} without crosstalk");

    let calibrate = firstbounce(place, ["calibrate", "set", "--write", "--json"]).json();
    let share = calibrate["crosstalk"][0][1].as_f64().unwrap();
    let interval = &calibrate["interval"]["crosstalk"][0][1];
    assert!((share - 0.04).abs() < 1e-3, "{calibrate}");
    assert!(interval[0].as_f64().unwrap() < 0.04 && interval[1].as_f64().unwrap() > 0.04, "{interval}");
    let toml = fs::read_to_string(place.join("set/capture.toml")).unwrap();
    assert!(toml.contains("crosstalk = [[1.0, 0.0"), "{toml}");
    // The matrix is enough without its shots.
    fs::remove_dir_all(place.join("set/crosstalk")).unwrap();
    let (head, shots) = toml.split_once("[[shot]]").unwrap();
    let (shots, rest) = shots.split_once("[[sphere]]").unwrap();
    let kept: Vec<_> = shots.split("[[shot]]").filter(|shot| !shot.contains("subject = \"crosstalk\"")).collect();
    fs::write(place.join("set/capture.toml"), format!("{head}[[shot]]{}[[sphere]]{rest}", kept.join("[[shot]]")))
        .unwrap();
    let typed = error_deg("set");
    assert!((typed - measured).abs() < 0.05, "{typed} degrees, {measured} by the shots");
    let words = firstbounce(place, ["calibrate", "set"]).out;
    assert!(words.contains("crosstalk, c2 lamp in channel of c1"), "{words}");

    let refused = simulated(place, &["corner", "--out", "four", "--crosstalk-shots", "--no-balls"]);
    assert!(refused.failure().contains("balls"), "{}", refused.err);
}

#[test]
fn a_lens_is_taken_from_a_calibration_of_opencv_and_kept() {
    let place = tempfile::tempdir().unwrap();
    let place = place.path();
    simulated(place, &["corner", "--out", "set", "--perspective", "800"]);
    let yaml = |width: usize, k3: f64| {
        format!(
            "%YAML 1.2\n---\nimage_width: {width}\nimage_height: 80\ncamera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   \
             data: [ 600., 0., 39.5, 0., 600., 39.5, 0., 0., 1. ]\ndistortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   \
             dt: d\n   data: [ -0.1, 0.02, 0.001, -0.002, {k3} ]\n"
        )
    };
    for (text, words) in
        [(yaml(80, 0.3), "0.3 is not 0"), (yaml(640, 0.0), "640 x 80 pixels"), ("a: 1".into(), "no camera calibration")]
    {
        fs::write(place.join("camera.yml"), text).unwrap();
        let ran = firstbounce(place, ["calibrate", "set", "--camera", "camera.yml"]);
        assert!(ran.failure().contains(words), "{}", ran.err);
    }
    fs::write(place.join("camera.yml"), yaml(80, 0.0)).unwrap();
    assert_eq!(firstbounce(place, ["calibrate", "set", "--camera", "camera.yml", "--write"]).code, 0);
    let toml = fs::read_to_string(place.join("set/capture.toml")).unwrap();
    for line in
        ["focal_length_px = 600.0", "principal_point = [40.0, 40.0]", "distortion = [-0.1, 0.02, 0.001, -0.002]"]
    {
        assert!(toml.contains(line), "{line} is not in {toml}");
    }
    assert_eq!(firstbounce(place, ["solve", "set", "--out", "results"]).code, 0);
}
