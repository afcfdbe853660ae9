//! Memory: what a set would take is told before any picture is decoded.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use crate::run::{Ran, firstbounce};
use crate::{huge_png, tiny_set};

/// A second, and room for a machine that has other work; one of these photos alone takes longer to decode.
const AT_ONCE: Duration = Duration::from_secs(3);

/// The tiny set with six photos of one subject that claim 17000 x 17000 pixels.
fn claiming_much(place: &Path, subject: &str) {
    let set = tiny_set::write(place);
    let first = set.join(format!("{subject}/left-blue.png"));
    huge_png::write(&first);
    for light in ["left", "top", "right"] {
        for colour in ["blue", "green"] {
            let other = set.join(format!("{subject}/{light}-{colour}.png"));
            if other != first {
                fs::copy(&first, other).unwrap();
            }
        }
    }
}

fn at_once(place: &Path, arguments: &[&str]) -> Ran {
    let begun = Instant::now();
    let ran = firstbounce(place, arguments);
    assert!(begun.elapsed() < AT_ONCE, "{arguments:?}: {:?}", begun.elapsed());
    ran
}

#[test]
fn six_photos_that_claim_much_are_refused_with_the_memory_needed_and_free() {
    let place = tempfile::tempdir().unwrap();
    claiming_much(place.path(), "object");
    for command in ["solve", "evaluate"] {
        let ran = at_once(place.path(), &[command, "tiny"]);
        let line = ran.failure();
        for words in ["Tiny dome needs about ", " GB of memory, ", " GB are free: ", "--memory-limit MIB"] {
            assert!(line.contains(words), "no \"{words}\" in: {line}");
        }
    }
    assert!(!place.path().join("out").exists(), "nothing is written");
}

#[test]
fn a_limit_stands_in_the_place_of_what_is_free() {
    let place = tempfile::tempdir().unwrap();
    tiny_set::write(place.path());
    for command in ["solve", "calibrate", "evaluate"] {
        let ran = at_once(place.path(), &[command, "tiny", "--memory-limit", "1"]);
        assert!(ran.failure().contains("needs about 0.1 GB of memory, 0.0 GB are allowed"), "{}", ran.err);
    }
    let ran = firstbounce(place.path(), ["solve", "tiny", "--memory-limit", "1000"]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    let ran = firstbounce(place.path(), ["solve", "tiny", "--memory-limit", "0"]);
    assert_eq!(ran.code, 2, "{}", ran.err);
}

#[test]
fn a_calibration_needs_memory_for_the_balls_alone() {
    let place = tempfile::tempdir().unwrap();
    claiming_much(place.path(), "object");
    let ran = firstbounce(place.path(), ["calibrate", "tiny", "--memory-limit", "1000"]);
    assert_eq!(ran.code, 0, "{}", ran.err);
    let place = tempfile::tempdir().unwrap();
    claiming_much(place.path(), "grey-sphere");
    let ran = at_once(place.path(), &["calibrate", "tiny", "--memory-limit", "1000"]);
    assert!(ran.failure().contains("1.0 GB are allowed"), "{}", ran.err);
}
