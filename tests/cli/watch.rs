//! Photos that arrive while a folder is watched.

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

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

/// What `firstbounce watch` prints with these arguments while these files are copied into a folder, one after the other.
fn lines_while(arguments: &[&str], watched: &Path, files: &[(std::path::PathBuf, &str)]) -> Vec<String> {
    fs::create_dir_all(watched).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_firstbounce"))
        .args(["watch", "--until-complete", "--poll", "0.2"])
        .args(arguments)
        .arg(watched)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    for (index, (file, name)) in files.iter().enumerate() {
        // The command ends with the last one: those before it must be at rest by then.
        let pause_ms = if index + 1 == files.len() { 1500 } else { 20 };
        std::thread::sleep(Duration::from_millis(pause_ms));
        copy(file, &watched.join(name));
    }
    let lines: Vec<String> = BufReader::new(child.stdout.take().unwrap()).lines().map(Result::unwrap).collect();
    assert!(child.wait().unwrap().success(), "{lines:#?}");
    lines
}

#[test]
fn a_folder_without_a_capture_file_takes_photos_by_their_names_and_says_for_what() {
    let place = tempfile::tempdir().unwrap();
    let source = place.path().join("card");
    write_tiny_set(&source);
    let photo = files_in(&source.join("object")).remove(0);
    let names =
        ["left-blue", "left-red", "top-blue", "top-red", "right-blue", "right-red"].map(|name| format!("{name}.png"));
    let mut files: Vec<_> = names.iter().map(|name| (photo.clone(), name.as_str())).collect();
    files.insert(2, (photo.clone(), "IMG_0001.png"));
    let watched = place.path().join("watched");
    let lines = lines_while(&["--lights", "left,top,right", "--colours", "blue,red"], &watched, &files);
    let said = |words: &str| lines.iter().any(|line| line.contains(words));
    assert!(said("left-blue.png: Object left blue (by its name") && said("mean light"), "{lines:#?}");
    // Why, depends on what arrived before it.
    assert!(said("IMG_0001.png: not assigned: "), "{lines:#?}");
    assert!(said("is complete (3 of 3)"), "{lines:#?}");
}

/// Issue and manual say so of an optimised program; another is given time.
#[test]
fn a_photo_of_one_megapixel_is_reported_within_half_a_second_after_it_was_closed() {
    let most = if cfg!(debug_assertions) { Duration::from_secs(5) } else { Duration::from_millis(500) };
    let place = tempfile::tempdir().unwrap();
    let source = place.path().join("photo.png");
    let value = |x: u32, y: u32| ((x * 31 + y * 17) % 40_000) as u16 + 5000;
    image::ImageBuffer::from_fn(1000, 1000, |x, y| image::Luma([value(x, y)])).save(&source).unwrap();
    let watched = place.path().join("watched");
    fs::create_dir(&watched).unwrap();
    let mut child = Command::new(env!("CARGO_BIN_EXE_firstbounce"))
        .args(["watch", "--lights", "left,top,right", "--colours", "blue"])
        .arg(&watched)
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    let mut took = Vec::new();
    for light in ["left", "top", "right"] {
        // The first one comes when the folder is watched for sure.
        std::thread::sleep(Duration::from_millis(1500));
        let photo = watched.join(format!("{light}-blue.png"));
        copy(&source, &photo);
        let closed = Instant::now();
        let line = lines.find(|line| line.as_ref().unwrap().contains("-blue.png: ")).unwrap().unwrap();
        took.push(closed.elapsed());
        assert!(line.starts_with(&format!("{light}-blue.png: ")) && line.contains("1000 x 1000 pixels"), "{line}");
    }
    child.kill().unwrap();
    child.wait().unwrap();
    println!("{took:?}");
    assert!(took.iter().all(|took| *took <= most), "{took:?}");
}

#[test]
fn a_camera_count_is_taken_in_order() {
    let place = tempfile::tempdir().unwrap();
    let source = place.path().join("card");
    write_tiny_set(&source);
    let photo = files_in(&source.join("object")).remove(0);
    let names: Vec<_> = (1..=4).map(|number| format!("IMG_{number:04}.png")).collect();
    let files: Vec<_> = names.iter().map(|name| (photo.clone(), name.as_str())).collect();
    let watched = place.path().join("watched");
    let lines = lines_while(&["--in-order", "--lights", "left,top", "--colours", "blue,red"], &watched, &files);
    // The first lay there and was at rest later than those that came after it: they moved on by a place.
    for (name, place) in
        [("IMG_0001.png: ", "Object left blue (in order"), ("IMG_0004.png: ", "Object top red (in order")]
    {
        assert!(lines.iter().any(|line| line.starts_with(name) && line.contains(place)), "{lines:#?}");
    }
    let refused = |arguments: &[&str]| {
        let ran = firstbounce(place.path(), arguments);
        ran.failure().to_owned()
    };
    assert!(refused(&["watch", "watched", "--in-order"]).contains("--lights"));
    assert!(refused(&["watch", "watched", "--until-complete"]).contains("--until-complete"));
}

#[test]
fn a_folder_that_vanishes_is_one_line() {
    let place = tempfile::tempdir().unwrap();
    let watched = place.path().join("watched");
    fs::create_dir(&watched).unwrap();
    let child = Command::new(env!("CARGO_BIN_EXE_firstbounce"))
        .args(["watch", "--poll", "0.1"])
        .arg(&watched)
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(1500));
    fs::remove_dir(&watched).unwrap();
    let output = child.wait_with_output().unwrap();
    let words = String::from_utf8(output.stderr).unwrap();
    assert_eq!((output.status.code(), words.lines().count()), (Some(1), 1), "{words}");
    assert!(words.contains("watch it again when it is back"), "{words}");
}

#[test]
fn a_folder_that_cannot_be_watched_is_one_line() {
    let place = tempfile::tempdir().unwrap();
    assert!(firstbounce(place.path(), ["watch", "nowhere"]).failure().contains("nowhere"));
    write_tiny_set(&place.path().join("set"));
    assert!(firstbounce(place.path(), ["watch", "set", "--poll=-1"]).failure().contains("--poll"));
}
