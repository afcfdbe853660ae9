//! Numbers beyond all measure: one line that says where and what is expected, and never a crash or an endless run.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use crate::run::{Ran, firstbounce};
use crate::tiny_set;

/// As long as a command may take with what it refuses.
const PATIENCE: Duration = Duration::from_secs(5);

fn at_once(place: &Path, arguments: &[&str]) -> Ran {
    let since = Instant::now();
    let ran = firstbounce(place, arguments);
    assert!(since.elapsed() < PATIENCE, "{arguments:?} took {:?}", since.elapsed());
    ran
}

/// All values of the rig, typed.
const TYPED: &str = "
[calibration]
beta = [1.0, 0.5]
[calibration.alpha]
left = [1.0, 1.1]
top = [1.0, 1.2]
right = [1.0, 0.9]
[calibration.direction]
left = [-0.5, 0.1, 0.86]
top = [0.1, 0.6, 0.79]
right = [0.55, -0.2, 0.81]
";

#[test]
fn a_number_of_a_set_beyond_its_range_is_refused_with_its_line_by_every_command() {
    let place = tempfile::tempdir().unwrap();
    let set = tiny_set::write(place.path());
    let plain = fs::read_to_string(set.join("capture.toml")).unwrap() + TYPED;
    let first_light = "name = \"left\"\n";
    let first_shot = "files = [\"object/left-blue.png\"]\n";
    for (old, new, words) in [
        (
            "beta = [1.0, 0.5]",
            "beta = [1.0, 1e300]",
            "[calibration] beta: expected a number from 0.0001 to 10000, found 1e300",
        ),
        ("left = [1.0, 1.1]", "left = [1.0, 1e-300]", "[calibration] alpha.left: expected a number from"),
        (
            first_light,
            "name = \"left\"\nposition_mm = [1e160, 0, 1e160]\n",
            "[[light]] position_mm: expected three numbers",
        ),
        (first_shot, &format!("{first_shot}exposure = 1e-300\n"), "[[shot]] exposure: expected a number from 1e-9"),
        (
            "encoding = \"linear\"",
            "encoding = { gamma = 1e-300 }",
            "[camera] encoding: expected a number from 0.1 to 10",
        ),
        ("encoding = \"linear\"", "white_level = 1e-300", "[camera] white_level: expected a number from 1e-9"),
    ] {
        assert!(plain.contains(old), "{old}");
        let text = plain.replacen(old, new, 1);
        let line = 1 + text[..text.find(words_at(new)).unwrap()].matches('\n').count();
        fs::write(set.join("capture.toml"), &text).unwrap();
        for command in ["info", "calibrate", "solve"] {
            let ran = at_once(place.path(), &[command, "tiny"]);
            let failure = ran.failure();
            assert!(
                failure.contains(&format!("capture.toml:{line}: ")) && failure.contains(words),
                "{command}: {failure}"
            );
        }
    }
}

/// What of a change stands in the line that is to blame.
fn words_at(change: &str) -> &str {
    change.lines().last().unwrap_or(change)
}

const GOOD: &str = "v 0 0 0\nv 10 0 0\nv 0 10 1\nf 1 2 3\n";

/// Files whose numbers no surface has.
const MESHES: [(&str, &str); 9] = [
    ("v 1e38 0 0\nv 1e38 1 0\nv 1e38 0 1e38\nf 1 2 3\n", "at most 1e9 mm"),
    ("v 3e9 0 0\nv 3e9 1e9 0\nv 3e9 0 1\nf 1 2 3\n", "at most 1e9 mm"),
    ("v 1e-30 0 0\nv 0 1e-30 0\nv 0 0 1e-30\nf 1 2 3\n", "at least 1e-6 mm"),
    ("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "not finite"),
    ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf -9223372036854775808 2 3\n", "line 4: a face names vertex -9223372036854775808"),
    ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf\t1 9223372036854775807 3\n", "line 4: a face names vertex 9223372036854775807"),
    ("v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/-9223372036854775808 2/1 3/1\n", "names texture coordinate"),
    ("v 0 0 0\nv 1 0 0\nv 0 1 0\nl -9223372036854775808 2\n", "no triangle"),
    ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 2 3\n", "line 4: a face names vertex 0"),
];

#[test]
fn a_mesh_whose_numbers_no_surface_has_is_one_line() {
    let place = tempfile::tempdir().unwrap();
    fs::write(place.path().join("good.obj"), GOOD).unwrap();
    for (text, words) in MESHES {
        fs::write(place.path().join("bad.obj"), text).unwrap();
        for arguments in [
            vec!["compare", "bad.obj", "good.obj"],
            vec!["compare", "good.obj", "bad.obj", "--align"],
            vec!["simulate", "bad.obj", "--out", "set"],
            vec!["plan", "bad.obj"],
        ] {
            let ran = at_once(place.path(), &arguments);
            let line = ran.failure();
            assert!(line.contains("bad.obj") && line.contains(words), "{arguments:?}: {line}");
        }
    }
}

#[test]
fn a_surface_that_rays_cannot_be_traced_over_is_refused_by_its_size() {
    let place = tempfile::tempdir().unwrap();
    fs::write(place.path().join("far.obj"), GOOD.replace("10", "9e8")).unwrap();
    let ran = at_once(place.path(), &["simulate", "far.obj", "--out", "set", "--pixels", "32"]);
    assert!(ran.failure().contains("from end to end; it must be from 1e-6 to 1e7 mm"), "{}", ran.err);
}

#[test]
fn numbers_of_the_command_line_have_ends() {
    let place = tempfile::tempdir().unwrap();
    let small = ["--pixels", "16", "--patches", "20", "--samples", "1", "--ball-pixels", "32"];
    for (option, value) in [
        ("--albedos", "1e-300,0.5"),
        ("--intensities", "1,1e300,1"),
        ("--alpha", "1,1e300"),
        ("--lights", "point:1e160,0,1e160"),
        ("--lights", "dir:1e300,0,1e300"),
        ("--lights", "area:0,0,900:1e300"),
        ("--size", "1e300"),
        ("--size", "1e-300"),
        ("--angle", "1e300"),
        ("--perspective", "1e300"),
        ("--perspective", "1e8"),
        ("--full-well", "1e-300"),
        ("--full-well", "1e300"),
        ("--read-noise", "1e300"),
        ("--black-level", "1e300"),
        ("--exposure", "1e-300"),
        ("--exposure", "white:1e300"),
        ("--exposure", "white:1e-300"),
        ("--crosstalk", "1e300"),
        ("--grey", "1e-300"),
    ] {
        let shape = if option == "--angle" { "groove" } else { "corner" };
        let arguments = [["simulate", shape, "--out", "set", option, value].as_slice(), &small].concat();
        let ran = at_once(place.path(), &arguments);
        assert!(!ran.failure().is_empty() && !place.path().join("set").exists(), "{option} {value}");
    }
    let ran = at_once(place.path(), &["plan", "corner", "--try-ratios", "1e300", "--patches", "20"]);
    assert!(ran.failure().contains("ratio"), "{}", ran.err);
    fs::write(place.path().join("good.obj"), GOOD).unwrap();
    let ran = at_once(place.path(), &["compare", "good.obj", "good.obj", "--limit", "1e300"]);
    assert!(ran.failure().contains("limit_mm"), "{}", ran.err);
}

/// Those that were found first, where they are at hand.
#[test]
fn the_damaged_cases_are_one_line_or_a_result() {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/cases");
    if !cases.join("damaged").is_dir() {
        println!("skipped: there are no cases at ../shared/cases/damaged");
        return;
    }
    let place = tempfile::tempdir().unwrap();
    copy(&cases.join("tiny"), &place.path().join("tiny"));
    for name in ["F4-beta-1e300.capture.toml", "F5-lamp-1e160.capture.toml"] {
        let text = fs::read(cases.join("damaged").join(name)).unwrap();
        fs::write(place.path().join("tiny/capture.toml"), text).unwrap();
        for command in ["info", "calibrate", "solve"] {
            let ran = at_once(place.path(), &[command, "tiny"]);
            assert!(ran.failure().contains("capture.toml:"), "{name}, {command}: {}", ran.err);
        }
    }
    fs::write(place.path().join("good.obj"), GOOD).unwrap();
    for name in ["F8-simulate-far.obj", "F9-obj-min-index.obj"] {
        fs::write(place.path().join("bad.obj"), fs::read(cases.join("damaged").join(name)).unwrap()).unwrap();
        for arguments in [vec!["compare", "bad.obj", "good.obj"], vec!["simulate", "bad.obj", "--out", "set"]] {
            assert!(at_once(place.path(), &arguments).failure().contains("bad.obj"), "{name}");
        }
    }
}

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to).unwrap();
    for entry in fs::read_dir(from).unwrap() {
        let (entry, target) = (entry.as_ref().unwrap().path(), to.join(entry.as_ref().unwrap().file_name()));
        if entry.is_dir() {
            copy(&entry, &target);
        } else {
            fs::write(target, fs::read(entry).unwrap()).unwrap();
        }
    }
}
