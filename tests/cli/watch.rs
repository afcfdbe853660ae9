//! Photos that arrive while a folder is watched.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use firstbounce_testing::write_tiny_set;

use crate::run::firstbounce;

fn copy(from: &Path, to: &Path) {
    fs::create_dir_all(to.parent().unwrap()).unwrap();
    fs::copy(from, to).unwrap();
}

fn files_in(folder: &Path) -> Vec<std::path::PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = entries.flat_map(|path| if path.is_dir() { files_in(&path) } else { vec![path] }).collect();
    files.sort();
    files
}

#[test]
fn photos_are_checked_as_they_arrive_and_the_set_is_solved_when_it_is_complete() {
    let place = tempfile::tempdir().unwrap();
    let (source, watched, out) = (place.path().join("card"), place.path().join("watched"), place.path().join("out"));
    write_tiny_set(&source);
    copy(&source.join("capture.toml"), &watched.join("capture.toml"));
    let mut child = Command::new(env!("CARGO_BIN_EXE_firstbounce"))
        .args(["watch", "--until-complete", "--poll", "0.2", "--out"])
        .args([&out, &watched])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    for file in files_in(&source).iter().filter(|file| !file.ends_with("capture.toml")) {
        copy(file, &watched.join(file.strip_prefix(&source).unwrap()));
        std::thread::sleep(Duration::from_millis(20));
    }
    let lines: Vec<String> = BufReader::new(child.stdout.take().unwrap()).lines().map(Result::unwrap).collect();
    assert!(child.wait().unwrap().success(), "{lines:#?}");
    let said = |words: &str| lines.iter().any(|line| line.contains(words));
    assert!(said("mean light") && said("is complete (") && said("solved "), "{lines:#?}");
    assert!(out.join("report.json").is_file());
}

#[test]
fn a_folder_that_cannot_be_watched_is_one_line() {
    let place = tempfile::tempdir().unwrap();
    assert!(firstbounce(place.path(), ["watch", "nowhere"]).failure().contains("nowhere"));
    write_tiny_set(&place.path().join("set"));
    assert!(firstbounce(place.path(), ["watch", "set", "--poll=-1"]).failure().contains("--poll"));
}
