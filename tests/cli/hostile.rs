//! Sets that came from elsewhere, with links under the names that the program writes: nothing outside changes.

use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::PathBuf;

use firstbounce_testing::everything_in;

use crate::run::firstbounce;
use crate::tiny_set;

/// A set beside a folder of the user's own files.
fn place() -> (tempfile::TempDir, PathBuf, PathBuf) {
    let place = tempfile::tempdir().unwrap();
    let set = tiny_set::write(place.path());
    let outside = place.path().join("outside");
    fs::create_dir_all(outside.join("tiny")).unwrap();
    for name in ["thesis.tex", "tiny/report.json", "tiny/mesh.obj", "paper.html", "heat.ply", "capture.toml"] {
        fs::write(outside.join(name), "mine").unwrap();
    }
    (place, set, outside)
}

#[test]
fn results_are_not_written_through_a_link_in_the_set() {
    let (place, set, outside) = place();
    let before = everything_in(&outside);
    symlink(&outside, set.join("out")).unwrap();
    for (folder, arguments) in
        [(&set, &["solve", "."][..]), (&place.path().to_owned(), &["solve", "tiny", "--out", "tiny/out"])]
    {
        let line = firstbounce(folder, arguments).failure().to_owned();
        assert!(line.contains("out is a link"), "{line}");
        assert_eq!(everything_in(&outside), before);
    }
    fs::remove_file(set.join("out")).unwrap();
    fs::create_dir(set.join("out")).unwrap();
    symlink(outside.join("tiny"), set.join("out/tiny")).unwrap();
    let line = firstbounce(&set, ["solve", "."]).failure().to_owned();
    assert!(line.contains("out/tiny is a link"), "{line}");
    assert_eq!(everything_in(&outside), before);
}

#[test]
fn a_default_folder_that_is_a_link_is_refused_and_a_named_one_outside_any_set_is_followed() {
    let (place, _, outside) = place();
    let before = everything_in(&outside);
    symlink(&outside, place.path().join("out")).unwrap();
    for arguments in [&["solve", "tiny"][..], &["paper", "--size", "16"], &["demo", "--no-window"]] {
        let line = firstbounce(place.path(), arguments).failure().to_owned();
        assert!(line.contains("out is a link"), "{line}");
        assert_eq!(everything_in(&outside), before);
    }
    let ran = firstbounce(place.path(), ["solve", "tiny", "--out", "out/new"]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    assert!(outside.join("new/report.json").is_file());
}

#[test]
fn a_page_a_heat_map_and_a_simulated_set_replace_no_link() {
    let (place, set, outside) = place();
    let before = everything_in(&outside);
    symlink(outside.join("paper.html"), place.path().join("paper.html")).unwrap();
    symlink(outside.join("heat.ply"), set.join("heat.ply")).unwrap();
    symlink(&outside, set.join("folder")).unwrap();
    fs::create_dir_all(place.path().join("simulated/truth")).unwrap();
    fs::write(place.path().join("simulated/truth/rig.json"), "{}").unwrap();
    symlink(&outside, place.path().join("simulated/object")).unwrap();
    let mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0.5\nf 1 2 3\nf 2 4 3\n";
    fs::write(place.path().join("a.obj"), mesh).unwrap();
    let simulate = ["simulate", "corner", "--pixels", "32", "--patches", "200", "--ball-pixels", "32"];
    for arguments in [
        vec!["paper", "--size", "16", "--out", "paper.html"],
        vec!["paper", "--size", "16", "--out", "tiny/folder/paper.html"],
        vec!["compare", "a.obj", "a.obj", "--heat-map", "tiny/heat.ply"],
        vec!["compare", "a.obj", "a.obj", "--heat-map", "tiny/folder/heat.ply"],
        [&simulate[..], &["--out", "simulated"]].concat(),
        [&simulate[..], &["--out", "tiny/folder/new"]].concat(),
    ] {
        let line = firstbounce(place.path(), &arguments).failure().to_owned();
        assert!(line.contains(" is a link, and nothing is written through"), "{line}");
        assert_eq!(everything_in(&outside), before, "{arguments:?}");
    }
}

#[test]
fn measured_values_are_not_written_through_a_link() {
    let (place, set, outside) = place();
    fs::rename(set.join("capture.toml"), outside.join("capture.toml")).unwrap();
    symlink(outside.join("capture.toml"), set.join("capture.toml")).unwrap();
    let before = everything_in(&outside);
    let line = firstbounce(place.path(), ["calibrate", "tiny", "--write"]).failure().to_owned();
    assert!(line.contains("capture.toml is a link"), "{line}");
    assert_eq!(everything_in(&outside), before);
}

#[test]
fn a_report_of_an_earlier_run_takes_nothing_away_outside_its_folder() {
    let (_place, set, outside) = place();
    let out = set.join("out/tiny");
    fs::create_dir_all(&out).unwrap();
    symlink(&outside, out.join("d")).unwrap();
    fs::write(out.join("notes.txt"), "mine").unwrap();
    let names = ["d/thesis.tex", "d/tiny/mesh.obj", "../../../outside/thesis.tex", "bounces-..exr", "notes.txt", "d"];
    let files: BTreeMap<_, _> = names.iter().chain(&["report.json"]).map(|name| (name.to_string(), "a file")).collect();
    let report = serde_json::json!({ "program": "Firstbounce 0.1.0", "files": files });
    fs::write(out.join("report.json"), report.to_string()).unwrap();
    let before = everything_in(&outside);
    let ran = firstbounce(&set, ["solve", "."]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    assert_eq!(everything_in(&outside), before);
    assert!(out.join("d").is_symlink() && out.join("notes.txt").is_file() && out.join("mesh.obj").is_file());
}
