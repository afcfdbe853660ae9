//! `calibrate`, and what it writes into capture.toml.

use std::fs;

use crate::run::firstbounce;
use crate::tiny_set::{self, BETA, LIGHTS, alpha, dot, unit};

#[test]
fn balls_tell_lamps_and_paint() {
    let place = tempfile::tempdir().unwrap();
    tiny_set::write(place.path());
    let words = firstbounce(place.path(), ["calibrate", "tiny", "--json"]).json();
    assert!((words["beta"][1].as_f64().unwrap() / BETA[1] - 1.0).abs() < 0.005);
    for (l, (light, direction, intensity)) in LIGHTS.iter().enumerate() {
        assert!((words["alpha"][light][1].as_f64().unwrap() / alpha(l)[1] - 1.0).abs() < 0.003);
        assert!((words["intensity"][light].as_f64().unwrap() / intensity - 1.0).abs() < 0.005);
        let found: Vec<f64> = serde_json::from_value(words["direction"][light].clone()).unwrap();
        let cosine = dot(unit(*direction), [found[0], found[1], found[2]]);
        assert!(cosine.min(1.0).acos().to_degrees() < 0.5, "{light}");
        let interval = &words["interval"]["alpha"][light][1];
        assert!(interval[0].as_f64() < interval[1].as_f64());
    }
    assert_eq!(words["circle"]["grey-sphere"]["radius"], 40.0);
}

#[test]
fn written_values_win_and_comments_stay() {
    let place = tempfile::tempdir().unwrap();
    let set = tiny_set::write(place.path());
    let file = set.join("capture.toml");
    assert_eq!(firstbounce(place.path(), ["calibrate", "tiny", "--write"]).code, 0);
    let once = fs::read_to_string(&file).unwrap();
    assert!(once.starts_with("# A dome for tests.\n") && once.contains("[calibration.alpha]"));
    assert_eq!(firstbounce(place.path(), ["calibrate", "tiny", "--write"]).code, 0);
    assert_eq!(fs::read_to_string(&file).unwrap(), once, "writing twice writes the same");

    // A typed value is what solve uses.
    let typed = once.replace("beta = [", "# typed by hand\nbeta = [ 1.0, 0.4321 ] # was: [");
    fs::write(&file, typed).unwrap();
    let report = firstbounce(place.path(), ["solve", "tiny", "--json"]).json();
    assert_eq!(report["calibration"]["beta"][1], 0.4321);
    assert_eq!(report["calibration"]["source"]["beta"][1], "capture.toml");
}

#[test]
fn balls_are_found_without_a_circle_in_the_file() {
    let place = tempfile::tempdir().unwrap();
    let set = tiny_set::write(place.path());
    let text = fs::read_to_string(set.join("capture.toml")).unwrap();
    let without: Vec<_> = text.split("\n\n").filter(|block| !block.starts_with("[[sphere]]")).collect();
    fs::write(set.join("capture.toml"), without.join("\n\n") + "\n").unwrap();
    let words = firstbounce(place.path(), ["calibrate", "tiny", "--json"]).json();
    for ball in ["grey-sphere", "material-sphere", "mirror-sphere"] {
        let circle = &words["circle"][ball];
        let off = [&circle["centre"][0], &circle["centre"][1]].map(|c| (c.as_f64().unwrap() - 48.0).abs());
        assert!(off[0] < 0.5 && off[1] < 0.5 && (circle["radius"].as_f64().unwrap() - 40.0).abs() < 0.5, "{circle}");
    }
}

#[test]
fn two_sources_of_a_direction_that_disagree_are_both_named() {
    let place = tempfile::tempdir().unwrap();
    let set = tiny_set::write(place.path());
    // The mirror ball's photos of two lamps change places.
    fs::rename(set.join("mirror-sphere/left.png"), set.join("mirror-sphere/x.png")).unwrap();
    fs::rename(set.join("mirror-sphere/right.png"), set.join("mirror-sphere/left.png")).unwrap();
    fs::rename(set.join("mirror-sphere/x.png"), set.join("mirror-sphere/right.png")).unwrap();
    let words = firstbounce(place.path(), ["calibrate", "tiny", "--json"]).json();
    let warnings = words["warnings"].to_string();
    assert!(warnings.contains("mirror ball") && warnings.contains("shading of the grey ball"), "{warnings}");
}

#[test]
fn a_ball_that_is_not_found_takes_its_circle_from_the_command_line() {
    let place = tempfile::tempdir().unwrap();
    let set = tiny_set::write(place.path());
    let file = set.join("capture.toml");
    let text = fs::read_to_string(&file).unwrap();
    let without: Vec<_> =
        text.split("\n\n").filter(|block| !block.contains("[[sphere]]\nsubject = \"mirror-sphere\"")).collect();
    for circle in ["mirror=grey", "mirror=48,48,40", "mirror-sphere=88,48, 48,8, 8,48"] {
        fs::write(&file, without.join("\n\n") + "\n").unwrap();
        let args = ["calibrate", "tiny", "--json", "--write", "--circle", circle];
        let words = firstbounce(place.path(), args).json();
        assert_eq!(words["circle"]["mirror-sphere"]["radius"], 40.0, "{circle}");
        assert!(fs::read_to_string(&file).unwrap().contains("subject = \"mirror-sphere\"\ncentre"), "{circle}");
    }
    for (wrong, code, part) in [
        ("mirror=1,2", 2, "is no circle"),
        ("ball=1,2,3", 2, "names no ball"),
        ("mirror=1,1,2,2,3,3", 1, "lie on one line"),
        ("mirror=1,2,-5", 1, "radius"),
    ] {
        let run = firstbounce(place.path(), ["calibrate", "tiny", "--circle", wrong]);
        assert!(run.code == code && run.err.contains(part), "{wrong}: {} {}", run.code, run.err);
    }
}
