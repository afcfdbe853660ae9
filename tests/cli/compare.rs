//! `firstbounce compare` on meshes whose true place is known, and on files that are none.

use std::f64::consts::TAU;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};

use firstbounce_capture::mesh_file::{write_obj, write_ply, write_stl};
use firstbounce_core::Mesh;
use firstbounce_core::mesh::LengthUnit;
use firstbounce_testing::{Folder, bumps};
use nalgebra::{Isometry3, Matrix4, Point3, Vector3};
use serde_json::Value;

use crate::run::{Ran, firstbounce};

const CELLS: u32 = 120;
const PITCH_MM: f64 = 0.6;

/// Bumps of several widths over 72 mm, as a height field that faces +z.
fn relief() -> Mesh {
    let (positions, triangles) = firstbounce_testing::relief(CELLS, PITCH_MM, 0.0, bumps);
    Mesh {
        positions: positions.into_iter().map(Point3::from).collect(),
        normals: vec![],
        colours: vec![],
        triangles,
        unit: LengthUnit::Millimetre,
    }
}

/// Ten degrees and five millimetres.
fn ten_and_five() -> Isometry3<f64> {
    Isometry3::new(Vector3::new(3.0, -2.6, 3.04), Vector3::new(1.0, 2.0, -0.7).normalize() * 10f64.to_radians())
}

/// Every vertex moved along z by normal noise: Box and Muller's transform of a fixed sequence.
fn with_noise(mut mesh: Mesh, sigma_mm: f64) -> Mesh {
    let mut state = 7_u64;
    let mut uniform = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    };
    for p in &mut mesh.positions {
        p.z += (sigma_mm * (-2.0 * uniform().ln()).sqrt() * (TAU * uniform()).cos()) as f32;
    }
    mesh
}

fn ply(folder: &Folder, name: &str, mesh: &Mesh) -> PathBuf {
    write_ply(&folder.path(name), mesh, None).unwrap();
    folder.path(name)
}

fn compare(a: &Path, b: &Path, options: &[&str]) -> Ran {
    let meshes = ["compare".as_ref(), a.as_os_str(), b.as_os_str()];
    firstbounce(Path::new("."), meshes.into_iter().chain(options.iter().map(OsStr::new)))
}

fn numbers(a: &Path, b: &Path, options: &[&str]) -> Value {
    compare(a, b, &[options, &["--json"]].concat()).json()
}

fn matrix(numbers: &Value) -> Matrix4<f64> {
    Matrix4::from_fn(|row, column| numbers["matrix"][row][column].as_f64().unwrap())
}

/// The largest displacement of a vertex in mm, and the turn in degrees, that `found` leaves after `made`.
fn left_over(mesh: &Mesh, made: &Isometry3<f64>, found: &Matrix4<f64>) -> (f64, f64) {
    let rest = found * made.to_homogeneous();
    let displacement = |p: &Point3<f32>| (rest.transform_point(&p.cast()) - p.cast::<f64>()).norm();
    let turn = rest.fixed_view::<3, 3>(0, 0).into_owned();
    let largest = mesh.positions.iter().map(displacement).fold(0.0, f64::max);
    (largest, nalgebra::Rotation3::from_matrix_unchecked(turn).angle().to_degrees())
}

/// One line on standard error with all of `parts`, nothing on standard output, exit code 1.
fn refused(ran: &Ran, parts: &[&str]) {
    let line = &ran.err;
    assert_eq!(ran.code, 1, "{line}");
    assert_eq!(line.trim_end().lines().count(), 1, "{line}");
    assert!(parts.iter().all(|part| line.contains(part)), "{line}");
    assert!(ran.out.is_empty());
}

#[test]
fn a_moved_copy_comes_back() {
    let (folder, fixed, made) = (Folder::new(), relief(), ten_and_five());
    let (a, b) = (ply(&folder, "a.ply", &fixed.clone().moved(&made)), ply(&folder, "b.ply", &fixed));
    let found = numbers(&a, &b, &["--align"]);
    let (mm, degrees) = left_over(&fixed, &made, &matrix(&found));
    assert!(mm < 0.01 && degrees < 0.01, "{mm} mm, {degrees} degrees");
    assert!(found["max_mm"].as_f64().unwrap() < 0.01 && found["overlap"].as_f64().unwrap() > 0.99);
    assert!((found["rotation_deg"].as_f64().unwrap() - 10.0).abs() < 0.01);
    let shift = Vector3::from_fn(|axis, _| found["translation_mm"][axis].as_f64().unwrap());
    assert!((shift - made.inverse().translation.vector).norm() < 0.01);
    let iterations = found["alignment"]["iterations"].as_array().unwrap();
    assert!(iterations.last().unwrap()["rms_mm"].as_f64() < iterations[0]["rms_mm"].as_f64());
}

#[test]
fn a_surface_of_this_program_moves_onto_the_truth_of_its_set_by_its_height_alone() {
    let place = tempfile::tempdir().unwrap();
    let demo = concat!(env!("CARGO_MANIFEST_DIR"), "/assets/demo");
    let solved = firstbounce(place.path(), ["solve", demo, "--out", "out", "--method", "colours"]);
    assert_eq!(solved.code, 0, "{}", solved.err);
    for mesh in ["out/mesh.ply", "out/mesh.obj"] {
        let found = firstbounce(place.path(), ["compare", mesh, demo, "--align", "--json"]).json();
        assert_eq!(found["rotation_deg"], 0.0);
        let shift = |axis: usize| found["translation_mm"][axis].as_f64().unwrap();
        assert!(shift(0).abs() < 1e-6 && shift(1).abs() < 1e-6, "{found}");
        assert_eq!((&found["alignment"]["poor"], &found["alignment"]["ambiguous"]), (&false.into(), &false.into()));
    }
}

#[test]
fn a_cloud_of_points_is_a_reference() {
    let (folder, fixed) = (Folder::new(), relief());
    let mut text = format!(
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
        fixed.positions.len()
    );
    for p in &fixed.positions {
        text += &format!("{} {} {}\n", p.x, p.y, p.z);
    }
    let cloud = folder.path("cloud.ply");
    fs::write(&cloud, text).unwrap();
    let moved = Isometry3::translation(0.0, 0.0, 0.25);
    let a = ply(&folder, "a.ply", &fixed.clone().moved(&moved));
    let as_it_lies = numbers(&a, &cloud, &[]);
    assert!(as_it_lies["bias_mm"].as_f64().unwrap() > 0.15, "A lies outside: {as_it_lies}");
    assert!(as_it_lies["orientation_error_deg"].is_null());
    let aligned = numbers(&a, &cloud, &["--align"]);
    assert!(aligned["max_mm"].as_f64().unwrap() < 0.01, "{aligned}");
    assert!((aligned["translation_mm"][2].as_f64().unwrap() + 0.25).abs() < 0.01);
    let map = folder.path("map.ply");
    refused(&compare(&a, &cloud, &["--heat-map", map.to_str().unwrap()]), &["cloud.ply", "--heat-map"]);
}

#[test]
fn a_cut_and_noisy_copy_comes_back() {
    let (folder, fixed, made) = (Folder::new(), relief(), ten_and_five());
    let mut copy = with_noise(fixed.clone(), 0.05);
    // 30 % of the width.
    copy.triangles.retain(|corners| corners.iter().all(|&corner| fixed.positions[corner as usize].x < 14.4));
    let (a, b) = (ply(&folder, "a.ply", &copy.moved(&made)), ply(&folder, "b.ply", &fixed));
    let (mm, degrees) = left_over(&fixed, &made, &matrix(&numbers(&a, &b, &["--align"])));
    assert!(mm < 0.05, "{mm} mm, {degrees} degrees");
}

#[test]
fn without_align_nothing_moves_and_the_shift_is_the_distance() {
    let folder = Folder::new();
    let flat = |z: f32| {
        let mut mesh = relief();
        mesh.positions.iter_mut().for_each(|p| p.z = z);
        mesh
    };
    let (a, b) = (ply(&folder, "a.ply", &flat(0.25)), ply(&folder, "b.ply", &flat(0.0)));
    let found = numbers(&a, &b, &[]);
    assert!((found["mean_mm"].as_f64().unwrap() - 0.25).abs() < 1e-5);
    assert!((found["max_mm"].as_f64().unwrap() - 0.25).abs() < 1e-5);
    assert_eq!(matrix(&found), Matrix4::identity());
    assert!(found["alignment"].is_null());
}

#[test]
fn units_of_both_files_can_differ() {
    let (folder, fixed) = (Folder::new(), relief());
    let mut inches = fixed.clone();
    inches.positions.iter_mut().for_each(|p| *p /= 25.4);
    write_stl(&folder.path("a.stl"), &inches).unwrap();
    write_obj(&folder.path("b.obj"), &fixed, None).unwrap();
    let found = numbers(&folder.path("a.stl"), &folder.path("b.obj"), &["--unit", "inch", "--unit-b", "mm"]);
    assert!(found["max_mm"].as_f64().unwrap() < 1e-4);
}

#[test]
fn the_heat_map_lies_on_the_reference_and_holds_the_distances() {
    let (folder, fixed, made) = (Folder::new(), relief(), ten_and_five());
    let (a, b) = (ply(&folder, "a.ply", &fixed.clone().moved(&made)), ply(&folder, "b.ply", &fixed));
    let map = folder.path("new/map.ply");
    let found = numbers(&a, &b, &["--align", "--heat-map", map.to_str().unwrap()]);
    let header = String::from_utf8_lossy(&fs::read(&map).unwrap()).into_owned();
    assert!(header.contains("property uchar red") && header.contains("property float quality"));
    let again = numbers(&map, &b, &[]);
    for key in ["mean_mm", "rms_mm", "max_mm"] {
        assert!((again[key].as_f64().unwrap() - found[key].as_f64().unwrap()).abs() < 1e-4, "{key}");
    }
}

#[test]
fn a_heat_map_without_a_place_costs_no_number() {
    let (folder, fixed) = (Folder::new(), relief());
    let b = ply(&folder, "b.ply", &fixed);
    // A file where its folder should be is told before anything is measured.
    let inside = b.join("map.ply");
    refused(&compare(&b, &b, &["--heat-map", inside.to_str().unwrap()]), &["b.ply"]);
    // A folder of its name is told after the numbers.
    let map = folder.path("map.ply");
    fs::create_dir(&map).unwrap();
    let ran = compare(&b, &b, &["--json", "--heat-map", map.to_str().unwrap()]);
    assert_eq!(ran.code, 1);
    assert!(ran.err.contains("map.ply"));
    let found: Value = serde_json::from_str(&ran.out).unwrap();
    assert!(found["max_mm"].as_f64().unwrap() < 1e-4, "{found}");
}

#[test]
fn a_mesh_in_pixels_has_no_distance_in_mm() {
    let (folder, fixed) = (Folder::new(), relief());
    let b = ply(&folder, "b.ply", &fixed);
    let a = ply(&folder, "a.ply", &Mesh { unit: LengthUnit::Pixel, ..fixed });
    let ran = compare(&a, &b, &[]);
    assert!(ran.code == 1 && ran.err.contains("the mesh to compare is in pixels"), "{}", ran.err);
}

#[test]
fn the_text_has_a_line_for_each_number() {
    let (folder, fixed) = (Folder::new(), relief());
    let b = ply(&folder, "b.ply", &fixed);
    let ran = compare(&b, &b, &["--align"]);
    let text = ran.out;
    for line in ["mean distance", "rms distance", "95 %", "largest", "overlap", "orientation", "rms of each iteration"]
    {
        assert!(text.contains(line), "{text}");
    }
}

#[test]
fn strangers_and_broken_files_are_refused_and_the_output_stands() {
    let (folder, fixed) = (Folder::new(), relief());
    let b = ply(&folder, "b.ply", &fixed);
    let map = folder.path("map.ply");
    fs::write(&map, "mine").unwrap();
    let refused = |a: &Path, options: &[&str], parts: &[&str]| {
        let options = [options, &["--heat-map", map.to_str().unwrap()]].concat();
        refused(&compare(a, &b, &options), parts);
        assert_eq!(fs::read_to_string(&map).unwrap(), "mine");
    };

    let elsewhere = fixed.clone().moved(&Isometry3::translation(0.0, 900.0, 0.0));
    refused(&ply(&folder, "far.ply", &elsewhere), &[], &["align the two first"]);
    let mut stranger = fixed.clone();
    stranger.positions.iter_mut().for_each(|p| p.z = 0.6 * p.x.abs() + 0.05 * p.y * (p.x * 0.3).sin());
    refused(
        &ply(&folder, "stranger.ply", &stranger.moved(&Isometry3::translation(0.0, 70.0, 0.0))),
        &["--align"],
        &["overlap by", "%"],
    );

    fs::write(folder.path("empty.obj"), "").unwrap();
    refused(&folder.path("empty.obj"), &[], &["empty.obj", "is empty"]);
    fs::write(folder.path("nan.obj"), "v 0 0 0\nv 1 0 nan\nv 0 1 0\nf 1 2 3\n").unwrap();
    refused(&folder.path("nan.obj"), &[], &["nan.obj", "not finite"]);
    let bytes = fs::read(&b).unwrap();
    fs::write(folder.path("cut.ply"), &bytes[..bytes.len() / 2]).unwrap();
    refused(&folder.path("cut.ply"), &[], &["cut.ply"]);
    fs::write(folder.path("photo.ply"), b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR").unwrap();
    refused(&folder.path("photo.ply"), &[], &["photo.ply", "PNG"]);
    refused(&folder.path("missing.ply"), &[], &["missing.ply"]);
    refused(folder.root(), &[], &["capture.toml"]);
}

/// The relief as OBJ text, with a change.
fn obj(folder: &Folder, name: &str, change: impl Fn(String) -> String) -> PathBuf {
    let path = folder.path(name);
    write_obj(&path, &relief(), None).unwrap();
    let text = change(fs::read_to_string(&path).unwrap());
    fs::write(&path, text).unwrap();
    path
}

#[test]
fn odd_meshes_are_measured_with_a_line_that_says_what_is_odd() {
    let (folder, fixed) = (Folder::new(), relief());
    let b = ply(&folder, "b.ply", &fixed);
    let side = CELLS + 1;
    let far = format!("f 1 2 {}\nf 1 2 {}\n", 2 * side, 3 * side);
    let quads = |text: String| {
        let corners = |cell: u32| {
            let corner = cell / CELLS * side + cell % CELLS + 1;
            format!("f {corner} {} {} {}\n", corner + 1, corner + side + 1, corner + side)
        };
        let vertices: String =
            text.lines().filter(|line| line.starts_with("v ")).map(|line| format!("{line}\n")).collect();
        vertices + &(0..CELLS * CELLS).map(corners).collect::<String>()
    };
    let doubled = |text: String| {
        let vertices: String =
            text.lines().filter(|line| line.starts_with("v ")).map(|line| format!("{line}\n")).collect();
        let shifted: String = text
            .lines()
            .filter_map(|line| line.strip_prefix("f "))
            .enumerate()
            .map(|(index, line)| {
                let shift = if index % 2 == 0 { 0 } else { side * side };
                let corners = line.split(' ').map(|corner| (corner.parse::<u32>().unwrap() + shift).to_string());
                format!("f {}\n", corners.collect::<Vec<_>>().join(" "))
            })
            .collect();
        vertices.clone() + &vertices + &shifted
    };
    let cases = [
        (obj(&folder, "fan.obj", |text| text + &far), "more than two triangles"),
        (obj(&folder, "quads.obj", quads), "faces of more than three corners split"),
        (obj(&folder, "doubled.obj", doubled), "vertices joined"),
    ];
    for (path, words) in cases {
        let ran = compare(&path, &b, &["--json"]);
        let warnings = ran.err;
        assert_eq!(ran.code, 0, "{warnings}");
        assert!(warnings.starts_with("warning: ") && warnings.contains(words), "{warnings}");
        let found: Value = serde_json::from_str(&ran.out).unwrap();
        assert!(found["mean_mm"].as_f64().unwrap() < 1e-3, "{path:?}: {found}");
    }
}

#[test]
fn hopeless_meshes_are_one_line_each() {
    let (folder, fixed) = (Folder::new(), relief());
    let b = ply(&folder, "b.ply", &fixed);
    let write = |name: &str, bytes: &[u8]| {
        fs::write(folder.path(name), bytes).unwrap();
        folder.path(name)
    };
    let stl = |mesh: &Mesh| {
        write_stl(&folder.path("whole.stl"), mesh).unwrap();
        fs::read(folder.path("whole.stl")).unwrap()
    };
    let whole = stl(&fixed);
    let whole_ply = fs::read(&b).unwrap();
    let far: &[u8] = b"v 1e39 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    let cases: [(PathBuf, &[&str]); 9] = [
        (write("points.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\n"), &["no surface"]),
        (write("flat.obj", b"v 0 0 0\nv 1 0 0\nv 1 0 0\nf 1 2 3\n"), &["no triangle"]),
        (write("lost.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"), &["line 4", "9"]),
        (write("inf.obj", far), &["not finite"]),
        (write("cut.stl", &whole[..whole.len() / 2]), &["cut off"]),
        (write("cut2.ply", &whole_ply[..200]), &["cut2.ply", "PLY"]),
        (write("text.stl", b"just words"), &["without any vertex", "OBJ, PLY or STL"]),
        (write("scene.obj", b"glTF\x02\0\0\0"), &["glTF"]),
        (write("many.ply", b"ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nproperty float y\nproperty float z\nend_header\n"), &["cut off", "99999999999"]),
    ];
    for (path, words) in &cases {
        refused(&compare(path, &b, &[]), words);
        refused(&compare(&b, path, &["--align"]), words);
    }
    // Far from the origin coordinates are coarse: it is told, and there is nothing to compare with.
    let mut huge = fixed.clone();
    huge.positions.iter_mut().for_each(|p| p.x += 4e6);
    let ran = compare(&ply(&folder, "huge.ply", &huge), &b, &[]);
    assert!(ran.code == 1 && ran.err.contains("align the two first"), "{}", ran.err);
}

#[test]
fn the_json_has_the_promised_keys_at_its_top() {
    let (folder, fixed) = (Folder::new(), relief());
    let b = ply(&folder, "b.ply", &fixed);
    let found = numbers(&b, &b, &[]);
    for key in ["mean_mm", "rms_mm", "p95_mm", "max_mm", "overlap", "orientation_error_deg", "rotation_deg"] {
        assert!(found[key].is_f64(), "{key} in {found}");
    }
    assert_eq!(found["translation_mm"].as_array().unwrap().len(), 3);
    assert_eq!(matrix(&found), Matrix4::identity());
}

#[test]
fn a_wrong_name_is_told_and_read_all_the_same() {
    let (folder, fixed) = (Folder::new(), relief());
    let b = ply(&folder, "b.ply", &fixed);
    fs::copy(&b, folder.path("a.obj")).unwrap();
    let found = numbers(&folder.path("a.obj"), &b, &[]);
    assert!(found["warnings"][0].as_str().unwrap().contains("named .obj, but it is PLY"));
}

#[test]
fn what_is_no_comparison_is_wrong_usage() {
    let (folder, fixed) = (Folder::new(), relief());
    let b = ply(&folder, "b.ply", &fixed);
    for options in [["--heat-map", "map.obj"], ["--unit", "furlong"]] {
        assert_eq!(compare(&b, &b, &options).code, 2);
    }
}

#[test]
fn a_forgotten_unit_is_told_and_what_is_compared_is_never_replaced() {
    let folder = Folder::new();
    let mesh = relief();
    let mut in_metres = mesh.clone();
    in_metres.positions.iter_mut().for_each(|p| *p /= 1000.0);
    let (a, b) = (ply(&folder, "metres.ply", &in_metres), ply(&folder, "b.ply", &mesh));
    let warnings = numbers(&a, &b, &[])["warnings"].to_string();
    assert!(warnings.contains("A is 1000 times smaller than B"), "{warnings}");
    let before = std::fs::read(&b).unwrap();
    refused(&compare(&a, &b, &["--heat-map", b.to_str().unwrap()]), &["would replace a mesh that is compared"]);
    assert_eq!(std::fs::read(&b).unwrap(), before);
}
