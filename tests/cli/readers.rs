//! Pipes, devices, files without an end and folders in the place of each file that is read: one line, at once.

use std::fs::{self, File};
use std::os::unix::fs::symlink;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use crate::run::{Ran, firstbounce};
use crate::tiny_set;

/// A second, and room for a machine that has other work.
const AT_ONCE: Duration = Duration::from_secs(4);

/// Puts something into the place of a file.
type Put = fn(&Path);

/// What may stand in the place of a file.
const STRANGERS: [(&str, Put); 4] = [
    ("a pipe", pipe),
    ("a device without an end", |path| symlink("/dev/zero", path).unwrap()),
    ("a file without an end", |path| File::create(path).unwrap().set_len(1 << 42).unwrap()),
    ("a folder", |path| fs::create_dir(path).unwrap()),
];

fn pipe(path: &Path) {
    assert!(Command::new("mkfifo").arg(path).status().unwrap().success());
}

/// Runs the program with each stranger in the place of `file` of a fresh set.
fn with_strangers(file: &str, arguments: &[&str], judge: impl Fn(&str, &Ran)) {
    for (what, put) in STRANGERS {
        let place = tempfile::tempdir().unwrap();
        let set = tiny_set::write(place.path());
        fs::create_dir(set.join("truth")).unwrap();
        fs::write(place.path().join("plane.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        let path = place.path().join(file);
        let _ = fs::remove_file(&path);
        put(&path);
        let begun = Instant::now();
        let ran = firstbounce(place.path(), arguments);
        assert!(begun.elapsed() < AT_ONCE, "{what} as {file}, {arguments:?}: {:?}", begun.elapsed());
        judge(what, &ran);
    }
}

/// Expects one line that names the file.
fn refused(file: &str, arguments: &[&str]) {
    with_strangers(file, arguments, |what, ran| {
        assert!(ran.failure().contains(file), "{what}: {}", ran.err);
    });
}

#[test]
fn a_capture_file_that_is_no_file_is_refused_by_every_command() {
    let folder = "tiny/capture.toml";
    for command in ["info", "solve", "calibrate", "evaluate"] {
        refused(folder, &[command, "tiny"]);
        refused(folder, &[command, "tiny/capture.toml"]);
    }
    refused(folder, &["calibrate", "tiny", "--write"]);
    refused(folder, &["compare", "tiny", "plane.obj"]);
    refused(folder, &["compare", "plane.obj", "tiny/capture.toml"]);
}

#[test]
fn a_photo_that_is_no_file_is_refused() {
    for command in ["solve", "calibrate"] {
        refused("tiny/grey-sphere/left-blue.png", &[command, "tiny"]);
    }
    with_strangers("tiny/object/left-blue.png", &["info", "tiny"], |what, ran| {
        assert!(ran.code == 0 && ran.out.contains("left-blue.png: cannot be read"), "{what}: {}{}", ran.out, ran.err);
    });
}

#[test]
fn a_mesh_that_is_no_file_is_refused() {
    refused("strange.obj", &["compare", "plane.obj", "strange.obj"]);
    refused("strange.stl", &["compare", "strange.stl", "plane.obj"]);
    refused("strange.ply", &["simulate", "strange.ply", "--out", "simulated"]);
}

#[test]
fn a_light_file_that_is_no_file_is_refused() {
    refused("lamps.lp", &["calibrate", "tiny", "--lights-from", "lamps.lp"]);
}

#[test]
fn a_truth_that_is_no_file_is_none() {
    for file in ["tiny/truth/normals.exr", "tiny/truth/rig.json"] {
        with_strangers(file, &["evaluate", "tiny", "--method", "nayar"], |what, ran| {
            assert!(!ran.failure().is_empty(), "{what}");
        });
    }
}

#[test]
fn a_mesh_that_goes_on_in_zeros_is_refused_before_all_of_it_is_read() {
    let place = tempfile::tempdir().unwrap();
    for (name, start) in [("a.obj", "v 0 0 0\n"), ("a.stl", "solid a\nfacet normal 0 0 1\n")] {
        let path = place.path().join(name);
        fs::write(&path, start).unwrap();
        File::options().write(true).open(&path).unwrap().set_len(4 << 30).unwrap();
        let begun = Instant::now();
        let ran = firstbounce(place.path(), ["compare", name, name]);
        assert!(ran.failure().contains(name), "{}", ran.err);
        assert!(begun.elapsed() < AT_ONCE, "{name}: {:?}", begun.elapsed());
    }
}
