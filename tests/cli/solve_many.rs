//! `solve SET... --rig RIGSET`: many objects under one rig.

use std::fs;
use std::path::Path;

use serde_json::Value;

use crate::run::firstbounce;
use crate::tiny_set;

/// A set of the object alone, which needs a rig.
fn object_alone(place: &Path, name: &str) {
    let folder = place.join(name);
    let tiny = place.join("tiny");
    fs::create_dir_all(folder.join("object")).unwrap();
    for entry in fs::read_dir(tiny.join("object")).unwrap().map(Result::unwrap) {
        fs::copy(entry.path(), folder.join("object").join(entry.file_name())).unwrap();
    }
    let text = fs::read_to_string(tiny.join("capture.toml")).unwrap();
    let kept: Vec<&str> = text.split("\n[[").filter(|part| !part.contains("sphere\"")).collect();
    fs::write(folder.join("capture.toml"), kept.join("\n[[")).unwrap();
}

fn states(report: &Value) -> Vec<&str> {
    report["sets"].as_array().unwrap().iter().map(|set| set["state"].as_str().unwrap()).collect()
}

#[test]
fn many_sets_are_solved_with_one_rig_and_only_what_changed_is_solved_again() {
    let place = tempfile::tempdir().unwrap();
    tiny_set::write(place.path());
    for name in ["one", "two", "three"] {
        object_alone(place.path(), name);
    }
    fs::write(place.path().join("two/object/left-blue.png"), "no picture").unwrap();
    let run = ["solve", "one", "two", "three", "--rig", "tiny", "--same-paint", "--out", "all", "--json"];
    let first = firstbounce(place.path(), run);
    assert_eq!(first.code, 1, "{}", first.err);
    assert!(first.err.contains("1 of 3 sets failed"), "{}", first.err);
    let table: Value = serde_json::from_str(&first.out).unwrap();
    assert_eq!(states(&table), ["solved", "failed", "solved"]);
    assert!(table["sets"][1]["error"].as_str().unwrap().contains("left-blue.png"), "{table}");
    assert!(table["sets"][0]["verdict"].is_string() && table["sets"][0]["solved_pixels"].as_u64() > Some(1000));
    for file in ["report.json", "mesh.ply"] {
        assert!(place.path().join("all/three").join(file).is_file(), "{file}");
    }

    // The second is mended, and of the third a result is gone.
    fs::copy(place.path().join("one/object/left-blue.png"), place.path().join("two/object/left-blue.png")).unwrap();
    fs::remove_file(place.path().join("all/three/mesh.ply")).unwrap();
    let table = firstbounce(place.path(), run).json();
    assert_eq!(states(&table), ["unchanged", "solved", "solved"]);
    assert!(table["sets"][0]["verdict"].is_string());
    // Other options, or another rig, make all of them anew.
    let other = [&run[..], &["--shadow-share", "0.1"]].concat();
    assert_eq!(states(&firstbounce(place.path(), other).json()), ["solved"; 3]);

    let csv =
        firstbounce(place.path(), ["solve", "one", "two", "--rig", "tiny", "--same-paint", "--out", "all", "--csv"]);
    assert_eq!(csv.code, 0, "{}", csv.err);
    let lines: Vec<_> = csv.out.lines().collect();
    assert_eq!((lines.len(), lines[0].starts_with("set,folder,state,verdict")), (3, true), "{}", csv.out);
}

#[test]
fn sets_that_would_share_a_folder_and_rigs_that_fit_no_light_are_refused() {
    let place = tempfile::tempdir().unwrap();
    let tiny = tiny_set::write(place.path());
    object_alone(place.path(), "one");
    let twice = firstbounce(place.path(), ["solve", "one", "one"]);
    assert!(twice.failure().contains("name each set once"), "{}", twice.err);
    let text = fs::read_to_string(tiny.join("capture.toml")).unwrap();
    let other = text.replace("\"left\"", "\"a\"").replace("\"top\"", "\"b\"").replace("\"right\"", "\"c\"");
    fs::write(tiny.join("capture.toml"), other).unwrap();
    let stranger = firstbounce(place.path(), ["solve", "one", "--rig", "tiny"]);
    assert_eq!(stranger.code, 1);
    assert!(stranger.out.contains("no light of this set has the name"), "{}{}", stranger.out, stranger.err);
}

/// The indented line of the page that begins so.
fn example(page: &str, beginning: &str) -> String {
    let line = page.lines().map(str::trim).find(|line| line.starts_with(beginning));
    line.unwrap_or_else(|| panic!("the page has no line that begins with {beginning:?}")).to_owned()
}

#[cfg(unix)]
#[test]
fn the_example_of_the_manual_spreads_sets_over_processes_as_it_is_written() {
    use std::process::Command;

    if !Command::new("xargs").arg("--version").output().is_ok_and(|output| output.status.success()) {
        println!("skipped: no xargs");
        return;
    }
    let page = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/many-objects.md")).unwrap();
    let place = tempfile::tempdir().unwrap();
    tiny_set::write(place.path());
    for name in ["objects/bowl", "objects/cup", "objects/vase"] {
        object_alone(place.path(), name);
        let file = place.path().join(name).join("capture.toml");
        let text = fs::read_to_string(&file).unwrap();
        fs::write(
            file,
            text + "
[calibration]
beta = [1, 0.5]
",
        )
        .unwrap();
    }
    fs::rename(place.path().join("tiny"), place.path().join("balls")).unwrap();
    let program = Path::new(env!("CARGO_BIN_EXE_firstbounce")).parent().unwrap();
    let path = std::env::var_os("PATH").unwrap();
    let paths = std::iter::once(program.to_owned()).chain(std::env::split_paths(&path));
    let output = Command::new("sh")
        .args(["-c", &example(&page, "ls -d objects/* | xargs")])
        .env("PATH", std::env::join_paths(paths).unwrap())
        .current_dir(place.path())
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    for name in ["bowl", "cup", "vase"] {
        assert!(place.path().join("results").join(name).join("report.json").is_file(), "{name}");
    }
    // As the page says, all of them are found done.
    let run = ["solve", "objects/bowl", "objects/cup", "objects/vase", "--rig", "balls", "--out", "results", "--json"];
    assert_eq!(states(&firstbounce(place.path(), run).json()), ["unchanged"; 3]);
}
