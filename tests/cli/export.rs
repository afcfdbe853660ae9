//! What `solve` writes by its flags, as other programs read it, and light files both ways.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::run::{Ran, firstbounce};
use crate::tiny_set::{self, LIGHTS, dot, unit};

/// Solves the tiny set in `place` with these flags; its report.
fn solved(place: &Path, flags: &[&str]) -> Value {
    firstbounce(place, [&["solve", "tiny", "--json"], flags].concat()).json()
}

fn calibrate(place: &Path, file: &str, flags: &[&str]) -> Ran {
    firstbounce(place, [&["calibrate", "tiny", "--lights-from", file], flags].concat())
}

#[test]
fn every_flag_is_in_the_files_and_in_the_report() {
    let place = tempfile::tempdir().unwrap();
    tiny_set::write(place.path());
    let flags = [
        "--formats",
        "obj,ply,stl,glb",
        "--z-up",
        "--triangles",
        "900",
        "--depth-png",
        "--texture",
        "16",
        "--lights-per-colour",
    ];
    let report = solved(place.path(), &flags);
    let out = place.path().join("out/tiny");
    let files: Vec<_> = report["files"].as_object().unwrap().keys().map(String::as_str).collect();
    for file in &files {
        assert!(out.join(file).is_file(), "{file}");
    }
    for file in ["mesh.mtl", "albedo.png", "mesh.stl", "mesh-raw.glb", "depth.png", "lights.lp", "lights-green.lp"] {
        assert!(files.contains(&file), "{file} in {files:?}");
    }

    // The dome bulges toward the camera, which with z up is -y; its texture is there.
    let (models, materials) = tobj::load_obj(out.join("mesh.obj"), &tobj::GPU_LOAD_OPTIONS).unwrap();
    let mesh = &models[0].mesh;
    assert!(mesh.indices.len() <= 3 * 900 && mesh.indices.len() > 3 * 800);
    let highest = mesh.positions.chunks(3).min_by(|a, b| a[1].total_cmp(&b[1])).unwrap();
    assert!(highest[0].abs() < 6.0 && highest[2].abs() < 6.0, "the top lies in the middle: {highest:?}");
    let texture = materials.unwrap()[0].diffuse_texture.clone().unwrap();
    let texture = image::open(out.join(texture)).unwrap();
    assert_eq!((texture.width(), texture.color()), (tiny_set::SIZE, image::ColorType::L16));

    let export = &report["export"];
    assert_eq!(export["meshes"]["obj"]["axes"], "x right, z up, y away from the camera");
    assert_eq!(export["meshes"]["glb"], serde_json::json!({"axes": "x right, y up, z toward the camera", "unit": "m"}));
    let decimation = &export["decimation"]["mesh"];
    assert_eq!(decimation["triangles"].as_u64().unwrap() as usize, mesh.indices.len() / 3);
    let [mean, largest] = ["mean_distance", "largest_distance"].map(|key| decimation[key].as_f64().unwrap());
    assert!(mean > 0.0 && mean < 0.05 && largest < 0.3 && mean < largest, "{decimation}");
    assert_eq!(decimation["unit"], "mm");
    assert!(fs::read_to_string(out.join("report.html")).unwrap().contains("points lie"));

    // Depth from the PNG is the depth of the mesh, whose top it shows.
    let scale = &export["depth_png"]["depth.png"];
    let [offset, step] = ["offset", "scale"].map(|key| scale[key].as_f64().unwrap());
    let depth = image::open(out.join("depth.png")).unwrap().into_luma16();
    let largest = f64::from(depth.pixels().map(|pixel| pixel.0[0]).max().unwrap());
    assert!((offset + step * largest + f64::from(highest[1])).abs() < 0.02, "{scale} and {highest:?}");
}

#[test]
fn no_mesh_and_no_texture_are_choices_too() {
    let place = tempfile::tempdir().unwrap();
    tiny_set::write(place.path());
    let report = solved(place.path(), &["--formats", "none"]);
    assert!(report["files"].as_object().unwrap().keys().all(|file| !file.starts_with("mesh")));
    let report = solved(place.path(), &["--formats", "obj", "--texture", "none", "--out", "plain"]);
    assert!(report["files"]["albedo.png"].is_null() && report["files"]["mesh.ply"].is_null());
    let (models, _) = tobj::load_obj(place.path().join("plain/mesh.obj"), &tobj::GPU_LOAD_OPTIONS).unwrap();
    assert!(!models[0].mesh.vertex_color.is_empty());
    let ran = firstbounce(place.path(), ["solve", "tiny", "--triangles", "2"]);
    assert!(ran.failure().contains("2 triangles are too few"));
    assert_eq!(firstbounce(place.path(), ["solve", "tiny", "--formats", "fbx"]).code, 2);
}

#[test]
fn what_an_earlier_run_wrote_and_this_one_does_not_is_taken_away() {
    let place = tempfile::tempdir().unwrap();
    tiny_set::write(place.path());
    solved(place.path(), &["--formats", "stl,glb", "--depth-png"]);
    let out = place.path().join("out/tiny");
    fs::write(out.join("notes.txt"), "mine").unwrap();
    // Somebody went on with this one.
    let since = std::time::SystemTime::now() + std::time::Duration::from_secs(60);
    fs::File::options().append(true).open(out.join("mesh.glb")).unwrap().set_modified(since).unwrap();
    let report = solved(place.path(), &["--formats", "obj"]);
    for gone in ["mesh.stl", "mesh-raw.stl", "mesh-raw.glb", "depth.png"] {
        assert!(report["files"][gone].is_null() && !out.join(gone).exists(), "{gone}");
    }
    for kept in ["notes.txt", "mesh.glb", "mesh.obj", "normals.png"] {
        assert!(out.join(kept).is_file(), "{kept}");
    }
}

#[test]
fn no_file_of_a_person_is_replaced() {
    let place = tempfile::tempdir().unwrap();
    let set = tiny_set::write(place.path());
    // A model of somebody's own, in a folder that results are asked into.
    fs::create_dir_all(place.path().join("mine")).unwrap();
    fs::write(place.path().join("mine/mesh.obj"), "# mine").unwrap();
    let ran = firstbounce(place.path(), ["solve", "tiny", "--out", "mine"]);
    assert!(ran.failure().contains("mesh.obj is a file of yours"), "{}", ran.err);
    assert_eq!(fs::read_dir(place.path().join("mine")).unwrap().count(), 1);

    // A photo of the set by the name of a result, and an earlier run that says it wrote one of that name.
    let text = fs::read_to_string(set.join("capture.toml")).unwrap();
    fs::rename(set.join("object/left-blue.png"), set.join("albedo.png")).unwrap();
    fs::write(set.join("capture.toml"), text.replace("object/left-blue.png", "albedo.png")).unwrap();
    solved(place.path(), &["--out", "fresh"]);
    fs::copy(place.path().join("fresh/report.json"), set.join("report.json")).unwrap();
    let before = fs::read(set.join("albedo.png")).unwrap();
    assert!(firstbounce(place.path(), ["solve", "tiny", "--out", "tiny"]).failure().contains("albedo.png"));
    assert_eq!(fs::read(set.join("albedo.png")).unwrap(), before);
}

#[test]
fn the_lights_that_are_written_come_back() {
    let place = tempfile::tempdir().unwrap();
    let set = tiny_set::write(place.path());
    let report = solved(place.path(), &["--formats", "none"]);
    let text = fs::read_to_string(place.path().join("out/tiny/lights.lp")).unwrap();
    assert!(text.starts_with("3\nobject/left-blue.png -0."), "{text}");

    let words = calibrate(place.path(), "out/tiny/lights.lp", &["--json", "--write"]).json();
    let written = fs::read_to_string(set.join("capture.toml")).unwrap();
    assert!(written.contains("[calibration.direction]"), "{written}");
    let again = solved(place.path(), &["--formats", "none"]);
    for (light, ..) in LIGHTS {
        let of = |words: &Value| -> [f64; 3] { serde_json::from_value(words["direction"][light].clone()).unwrap() };
        assert_eq!(words["source"]["direction"][light], "light file");
        let measured = of(&report["calibration"]);
        for taken in [of(&words), of(&again["calibration"])] {
            assert!(measured.iter().zip(taken).all(|(a, b)| (a - b).abs() < 1e-5), "{measured:?} {taken:?}");
        }
    }
}

#[test]
fn directions_by_name_win_over_the_balls_and_by_order_where_no_name_fits() {
    let place = tempfile::tempdir().unwrap();
    tiny_set::write(place.path());
    let text =
        "\u{feff}# a dome\r\n3\r\nD:\\rti\\top-blue.jpg 0 1 2\r\nright-blue.jpg 1 0 2\r\nleft-blue.jpg -1 0 2\r\n";
    fs::write(place.path().join("dome.lp"), text).unwrap();
    let direction =
        |words: &Value, light: &str| -> [f64; 3] { serde_json::from_value(words["direction"][light].clone()).unwrap() };
    let words = calibrate(place.path(), "dome.lp", &["--json"]).json();
    assert!(dot(direction(&words, "top"), unit([0.0, 1.0, 2.0])) > 1.0 - 1e-9);
    assert!(dot(direction(&words, "left"), unit([-1.0, 0.0, 2.0])) > 1.0 - 1e-9);
    assert!(words["warnings"].to_string().contains("differ by"), "the balls say otherwise: {}", words["warnings"]);
    assert!(words["alpha"]["left"][1].as_f64().unwrap() > 1.5, "the balls tell the rest");

    fs::write(place.path().join("order.lp"), "3\nx1 -1 0 2\nx2 0 1 2\nx3 1 0 2\n").unwrap();
    let words = calibrate(place.path(), "order.lp", &["--json"]).json();
    assert!(dot(direction(&words, "right"), unit([1.0, 0.0, 2.0])) > 1.0 - 1e-9);
    assert!(words["warnings"].to_string().contains("in the order of its lines"));
}

#[test]
fn a_bad_light_file_is_one_line_that_names_its_own() {
    let place = tempfile::tempdir().unwrap();
    let set = tiny_set::write(place.path());
    let before = fs::read_to_string(set.join("capture.toml")).unwrap();
    let cases: [(&[u8], &[&str]); 8] = [
        (b"", &["bad.lp: holds no light"]),
        (b"4\na 0 0 1\n", &["bad.lp:1:", "the count says 4, and 1 lights follow"]),
        (b"# dome\n2\na 0 0 1\nb 0 0 0\n", &["bad.lp:4:", "points nowhere"]),
        (b"1\n0.1 0.2 0.9\n", &["bad.lp:2:", "file name is missing"]),
        (b"left-blue.png 0 0 1\n", &["bad.lp:1:", "expected the count"]),
        (b"1\nleft-blue.png 0 1\n", &["bad.lp:2:", "expected 'file x y z'"]),
        (b"1\nimg_1.png 0 0 1\n", &["bad.lp: none of its file names is a photo", "img_1.png", "3"]),
        (b"1\0", &["bad.lp: is no text"]),
    ];
    for (bytes, words) in cases {
        fs::write(place.path().join("bad.lp"), bytes).unwrap();
        let ran = calibrate(place.path(), "bad.lp", &["--write"]);
        let line = ran.failure();
        assert!(words.iter().all(|word| line.contains(word)), "{line}");
    }
    assert!(calibrate(place.path(), "none.lp", &[]).failure().contains("none.lp: cannot be read"));
    assert_eq!(fs::read_to_string(set.join("capture.toml")).unwrap(), before);
}
