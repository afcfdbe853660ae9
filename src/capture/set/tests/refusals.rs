//! Every way in which a file can be wrong: the line, the key, what was found and what was expected.

use std::path::Path;

use super::{FULL, parse};
use crate::set::{CaptureSet, Location, Reading, SetError};

/// Changes `old` in the full set to `new`, and asserts that the first line of the error points at the line of the first
/// `here` in the changed text and holds every word.
#[track_caller]
fn refuses(old: &str, new: &str, here: &str, words: &[&str]) {
    assert!(FULL.contains(old), "{old}");
    let text = FULL.replacen(old, new, 1);
    let line = 1 + text[..text.find(here).unwrap()].matches('\n').count();
    let error = CaptureSet::parse(&text, Path::new("set/capture.toml")).unwrap_err();
    let message = error.to_string();
    assert!(message.starts_with(&format!("set/capture.toml:{line}: ")), "expected line {line}: {message}");
    assert_eq!(message.lines().count(), 1, "{message}");
    for word in words {
        assert!(message.contains(word), "expected {word}: {message}");
    }
    assert!(error.problems().iter().all(|problem| problem.position.is_some()), "{:?}", error.problems());
}

/// The same where the changed text itself is where the error points.
#[track_caller]
fn refuses_here(old: &str, new: &str, words: &[&str]) {
    refuses(old, new, new, words);
}

#[test]
fn the_line_names_the_part_the_key_the_value_and_what_was_expected() {
    let text = FULL.replace("exposure = 0.5", "exposure = \"fast\"");
    let error = CaptureSet::parse(&text, Path::new("capture.toml")).unwrap_err();
    assert_eq!(
        error.to_string(),
        "capture.toml:42: [[shot]] exposure: expected a number from 1e-9 to 1000000000, found \"fast\""
    );
    let text = FULL.replace("black_level", "blak_level");
    let error = CaptureSet::parse(&text, Path::new("corner/capture.toml")).unwrap_err();
    assert_eq!(
        error.to_string(),
        "corner/capture.toml:12: [camera] unknown key \"blak_level\"; did you mean \"black_level\"?"
    );
}

#[test]
fn text_that_is_no_toml_is_refused_where_it_ends_to_be() {
    refuses_here("black_level = 512", "black_level = = 512", &[]);
    refuses_here("[[shot]]", "[[shot]", &[]);
    refuses("encoding = \"srgb\"", "files = []", "files = []", &["duplicate key"]);
}

#[test]
fn unknown_keys_are_refused_everywhere() {
    refuses_here("mask =", "masc =", &["unknown key \"masc\"", "did you mean \"mask\""]);
    refuses_here("channel = \"b\"", "chanel = \"b\"", &["[[colour]] unknown key", "\"channel\""]);
    refuses_here("position_mm", "position", &["[[light]] unknown key \"position\""]);
    refuses_here("exposure = 0.5", "flash = true", &["[[shot]] unknown key \"flash\""]);
    refuses_here(
        "centre = [100.0",
        "center = [100.0",
        &["[[sphere]] unknown key \"center\"; did you mean \"centre\"?"],
    );
    refuses_here("bounces = 2", "bounce = 2", &["[separation]", "did you mean \"bounces\""]);
    refuses("beta =", "bta =", "bta =", &["[calibration] unknown key \"bta\"; did you mean \"beta\""]);
    refuses_here("bounce = \"true", "bounces = \"true", &["[truth]"]);
}

#[test]
fn wrong_types_are_refused() {
    refuses_here("name = \"Every part\"", "name = 7", &["name: expected a text, found 7"]);
    refuses_here(
        "white_level = 65535",
        "white_level = \"max\"",
        &["white_level: expected a number from 1e-9 to 1000000000, found \"max\""],
    );
    refuses_here("bounces = 2", "bounces = 2.0", &["expected a whole number", "found 2.0"]);
    refuses_here("bounces = 2", "bounces = -1", &["expected a whole number", "found -1"]);
    refuses_here("files = [\"object", "files = [1, \"object", &["[[shot]] files: expected a list of file paths"]);
    refuses_here("files = [\"dark.png\"]", "files = \"dark.png\"", &["list of file paths, found \"dark.png\""]);
    refuses_here("centre = [20, 30]", "centre = [20]", &["centre: expected two numbers [x, y], found [20]"]);
    refuses_here("left = [1.0, 3.2]", "left = 3.2", &["[calibration] alpha.left: expected a list of numbers"]);
    refuses_here("encoding = { gamma = 2.2 }", "encoding = { gama = 2.2 }", &["\"srgb\" or { gamma = 2.2 }"]);
}

#[test]
fn parts_are_tables() {
    let text = "schema = 1\ncamera = 3\nshot = \"a\"\n[light]\nname = \"left\"\n[calibration]\nalpha = 1";
    let error = CaptureSet::parse(text, Path::new("capture.toml")).unwrap_err();
    let found: Vec<_> = error.problems().iter().map(|p| (p.position.map(|at| at.line), p.to_string())).collect();
    let expected = [
        (2, "camera: expected [camera], a table, found integer"),
        (3, "shot: expected [[shot]], a list of tables, found string"),
        (4, "light: expected [[light]], a list of tables, found table"),
        (7, "[calibration] alpha: expected a table of lights, found 1"),
    ];
    assert_eq!(found, expected.map(|(line, message)| (Some(line), message.to_owned())));
}

#[test]
fn unknown_words_are_refused_with_those_that_are_known() {
    refuses_here("subject = \"dark\"", "subject = \"darkness\"", &["\"flat-field\"", "found \"darkness\""]);
    refuses_here("kind = \"mirror\"", "kind = \"glass\"", &["\"grey\", \"material\" or \"mirror\""]);
    refuses_here("channel = \"g\"", "channel = \"green\"", &["\"r\", \"g\", \"b\" or \"grey\", found \"green\""]);
    refuses_here("\"perspective\"", "\"fisheye\"", &["\"orthographic\" or \"perspective\""]);
    refuses_here("encoding = \"srgb\"", "encoding = \"rec709\"", &["[[shot]] encoding: expected \"linear\""]);
}

#[test]
fn missing_keys_are_refused_at_their_part() {
    refuses("schema = 1\n", "", "# A set", &["schema: missing; expected schema = 1"]);
    refuses("focal_length_px = 3400.0\n", "", "[camera]", &["focal_length_px: missing; expected a number from 1 to"]);
    refuses("subject = \"flat-field\"\n", "", "[[shot]]\nfiles = [\"flat.png\"]", &["subject: missing"]);
    refuses("files = [\"dark.png\"]\n", "", "[[shot]]\nsubject = \"dark\"", &["files: missing"]);
    refuses("kind = \"mirror\"\n", "", "[[sphere]]\nsubject = \"object\"", &["kind: missing; expected \"grey\""]);
    refuses("light = \"left\"\nfiles", "files", "[[shot]]\nsubject = \"mirror", &["light: missing"]);
}

#[test]
fn numbers_out_of_range_are_refused() {
    refuses_here("exposure = 0.5", "exposure = 0", &["exposure: expected a number from 1e-9 to 1000000000, found 0"]);
    refuses_here("exposure = 0.5", "exposure = nan", &["exposure", "found nan"]);
    refuses_here("exposure = 0.5", "exposure = inf", &["exposure", "found inf"]);
    refuses_here(
        "radius = 83.3",
        "radius = -1.5",
        &["[[sphere]] radius: expected a number from 0.001 to 1000000, found -1.5"],
    );
    refuses_here("centre = [20, 30]", "centre = [20, inf]", &["centre: expected two numbers [x, y], found [20, inf]"]);
    refuses_here("white_level = 65535", "white_level = 512", &["white_level: expected more than black_level 512"]);
    refuses_here("{ gamma = 2.2 }", "{ gamma = 0 }", &["encoding: expected a number from 0.1 to 10, found 0"]);
    refuses_here("focal_length_px = 3400.0", "focal_length_px = 0", &["focal_length_px"]);
    refuses_here("left = 1.0\n", "left = -1\n", &["intensity.left: expected a number from 0.0001 to 10000, found -1"]);
    refuses_here("bounces = 2", "bounces = 0", &["bounces: expected a whole number from 1 to 16, found 0"]);
    refuses("full_well_electrons = 30000\n", "", "read_noise", &["needs full_well_electrons"]);
}

#[test]
fn directions_point_somewhere() {
    refuses_here("direction = [-0.27, 0.06, 0.96]", "direction = [0, 0, 0]", &["not all zero", "[0.0, 0.0, 0.0]"]);
    refuses_here("[-390, 83, 1390]", "[nan, 83, 1390]", &["position_mm"]);
    refuses_here("left = [-0.269, 0.058, 0.961]", "left = [0.0, 0, 0]", &["direction.left"]);
    refuses("position_mm", "direction = [0, 0, 1]\nposition_mm", "direction = [0, 0, 1]", &["keep one of the two"]);
}

#[test]
fn a_direction_from_behind_is_a_warning() {
    let set = parse(&FULL.replace("direction = [-0.27, 0.06, 0.96]", "direction = [-0.27, 0.06, -0.96]"));
    let warnings = set.warnings();
    assert_eq!(warnings.len(), 1);
    assert_eq!(warnings[0].location, Location::Light(0));
    assert!(warnings[0].message.contains("behind the object"));
    assert!(parse(FULL).warnings().is_empty());
}

#[test]
fn a_schema_of_the_future_is_refused() {
    refuses_here("schema = 1", "schema = 2", &["schema: expected 1, found 2"]);
}

#[test]
fn names_are_distinct_even_for_file_systems_that_fold_case() {
    refuses("\"green\"\nchannel", "\"blue\"\nchannel", "\"blue\"\nchannel = \"g\"", &["\"blue\" is already the name"]);
    refuses("name = \"top right\"", "name = \"LEFT\"", "name = \"LEFT\"", &["\"LEFT\" differs from \"left\""]);
}

#[test]
fn names_can_stand_in_file_names() {
    refuses_here("name = \"top right\"", "name = \"top/right\"", &["'/'", "output files"]);
    refuses_here("name = \"top right\"", "name = 'top\\right'", &["'\\\\'"]);
    refuses_here("name = \"top right\"", "name = \"top\\u0000\"", &["'\\0'"]);
    refuses_here("name = \"top right\"", "name = \"\"", &["expected a name, found \"\""]);
    refuses_here("name = \"top right\"", "name = \" top\"", &["begins or ends with a space"]);
    refuses_here("name = \"green\"", "name = \"a:b\"", &["':'"]);
}

#[test]
fn shots_name_lights_and_colours_of_the_set_once() {
    refuses(
        "light = \"left\"",
        "light = \"lift\"",
        "light = \"lift\"",
        &["unknown light \"lift\"; did you mean \"left\"?"],
    );
    refuses("colour = \"blue\"\nf", "colour = \"red\"\nf", "colour = \"red\"", &["unknown colour \"red\""]);
    let second =
        "[[shot]]\nsubject = \"object\"\nlight = \"left\"\ncolour = \"blue\"\nfiles = [\"again.png\"]\n\n# The balls";
    refuses("# The balls", second, second, &["second shot of \"object\", light \"left\", colour \"blue\"", "number 1"]);
    refuses(
        "subject = \"dark\"",
        "subject = \"dark\"\nlight = \"left\"",
        "light = \"left\"\nfiles = [\"dark",
        &["a shot of \"dark\" is taken without one"],
    );
}

#[test]
fn a_light_with_a_colour_missing_is_named() {
    let green =
        "[[shot]]\nsubject = \"object\"\nlight = \"left\"\ncolour = \"green\"\nfiles = [\"object/left-1.png\"]\n";
    refuses(green, "", "[[light]]", &["[[light]] \"left\" has no \"green\" object shot"]);
    let grey = "light = \"left\"\ncolour = \"green\"\nfiles = [\"grey/left-green.png\"]\n";
    let grey = format!("[[shot]]\nsubject = \"grey-sphere\"\n{grey}");
    refuses(&grey, "", "[[light]]", &["\"left\" has no \"green\" grey-sphere shot"]);
    refuses(
        "[[shot]]",
        "[[light]]\nname = \"low\"\n[[shot]]",
        "[[light]]\nname = \"low\"",
        &["\"low\" has no object shot"],
    );
}

#[test]
fn every_shot_has_files() {
    refuses_here("files = [\"dark.png\"]", "files = []", &["at least one file path"]);
    refuses_here("files = [\"dark.png\"]", "files = [\"\"]", &["expected file paths, found \"\""]);
    refuses_here("mask = \"mask.png\"", "mask = \"\"", &["mask: expected a file path"]);
}

#[test]
fn circles_lie_in_shots_of_a_ball_once() {
    refuses(
        "\"grey-sphere\"\ncentre",
        "\"dark\"\ncentre",
        "\"dark\"\ncentre",
        &["shots that show a ball, found \"dark\""],
    );
    refuses(
        "radius = 83.3",
        "radius = 83.3\nkind = \"mirror\"",
        "kind = \"mirror\"",
        &["expected \"grey\"", "found \"mirror\""],
    );
    let again = "[[sphere]]\nsubject = \"grey-sphere\"\ncentre = [1, 2]\nradius = 3\n\n[calibration]";
    refuses("[calibration]", again, again, &["second circle for the grey ball"]);
}

#[test]
fn calibration_fits_the_colours_and_the_lights() {
    refuses_here("beta = [1.0, 0.51]", "beta = [1.0]", &["beta: expected 2 numbers, one per colour, found 1"]);
    refuses_here("beta = [1.0, 0.51]", "beta = [0.9, 0.51]", &["expected 1 for the reference colour", "found 0.9"]);
    refuses_here("left = [1.0, 3.2]", "left = [1.0, 3.2, 1]", &["alpha.left: expected 2 numbers", "found 3"]);
    refuses_here("left = [1.0, 3.2]", "left = [2.0, 3.2]", &["alpha.left: expected 1 for the reference"]);
    refuses_here("left = 1.0\n", "laft = 1.0\n", &["intensity.laft: unknown light \"laft\"; did you mean \"left\"?"]);
}

#[test]
fn colours_of_nearly_the_same_beta_are_named() {
    for beta in ["0.98", "1.0", "1.02", "0.99"] {
        refuses_here("beta = [1.0, 0.51]", &format!("beta = [1.0, {beta}]"), &["\"green\"", "within 0.02 of \"blue\""]);
    }
    for beta in [0.97, 1.03] {
        assert!(parse(FULL).check_beta_distances(&[1.0, beta]).is_empty());
    }
    let close = parse(FULL).check_beta_distances(&[1.0, 0.985]);
    assert_eq!(close.len(), 1);
    assert_eq!(close[0].location, Location::Calibration);
}

#[test]
fn more_bounces_than_colours_are_refused() {
    refuses_here("bounces = 2", "bounces = 3", &["3 bounces need 3 colours; this set has 2"]);
}

#[test]
fn the_pattern_of_the_true_bounces_tells_them_apart() {
    refuses_here("true/{light}/{k}.exr", "true/{light}.exr", &["[truth] bounce", "{k}"]);
    refuses_here("true/{light}/{k}.exr", "true/{k}.exr", &["[truth] bounce", "{light}"]);
}

#[test]
fn keys_of_the_other_projection_are_refused() {
    refuses(
        "black_level",
        "mm_per_pixel = 0.2\nblack_level",
        "mm_per_pixel",
        &["belongs to projection = \"orthographic\""],
    );
    refuses("\"perspective\"", "\"orthographic\"", "focal_length_px", &["focal_length_px: belongs to"]);
}

#[test]
fn an_empty_set_says_what_it_needs() {
    let error = CaptureSet::parse("schema = 1", Path::new("capture.toml")).unwrap_err();
    let messages: Vec<String> = error.problems().iter().map(ToString::to_string).collect();
    for (message, word) in messages.iter().zip(["[[colour]]", "[[light]]", "[[shot]]"]) {
        assert!(message.starts_with(&format!("no {word}")), "{message}");
    }
    assert!(error.to_string().ends_with("(and 2 more)"), "{error}");
}

#[test]
fn all_problems_are_told_in_the_order_of_the_file_each_at_its_part() {
    let text = FULL
        .replace("exposure = 0.5", "exposure = \"fast\"")
        .replace("radius = 9", "radius = 0")
        .replace("mask =", "masc =");
    let reading = Reading::of(&text, Path::new("set/capture.toml"));
    let locations: Vec<Location> = reading.problems.iter().map(|problem| problem.location).collect();
    assert_eq!(locations, [Location::Set, Location::Shot(0), Location::Sphere(1)]);
    assert!(reading.problems.is_sorted_by_key(|problem| problem.position));
    assert!(!reading.complete);
    assert_eq!(reading.set.shots.len(), parse(FULL).shots.len());
}

#[test]
fn one_slip_is_one_problem() {
    for (old, new) in [
        ("\"perspective\"", "\"perspektive\""),
        ("subject = \"object\"\nkind", "subject = \"objekt\"\nkind"),
        ("subject = \"grey-sphere\"\ncentre", "subject = \"gray-sphere\"\ncentre"),
        ("focal_length_px", "focal_lenght_px"),
        ("light = \"left\"", "light = \"lift\""),
        ("light = \"left\"", "light = 1"),
        ("exposure = 0.5", "exposure = -0.5"),
    ] {
        let reading = Reading::of(&FULL.replacen(old, new, 1), Path::new("set/capture.toml"));
        assert_eq!(reading.problems.len(), 1, "{old} -> {new}: {:?}", reading.problems);
    }
}

#[test]
fn a_set_in_memory_is_checked_without_lines() {
    let mut set = parse(FULL);
    assert!(set.check().is_empty());
    set.shots[1].exposure = Some(-1.0);
    let problems = set.check();
    assert_eq!(problems.len(), 1);
    assert_eq!(
        problems[0].to_string(),
        "[[shot]] number 2 exposure: expected a number from 1e-9 to 1000000000, found -1"
    );
}

#[test]
fn what_cannot_be_read_at_all_is_one_line() {
    let folder = tempfile::tempdir().unwrap();
    assert!(matches!(CaptureSet::open(folder.path()), Err(SetError::NoSetFile { .. })));
    let missing = folder.path().join("nowhere");
    let message = CaptureSet::open(&missing).unwrap_err().to_string();
    assert!(message.starts_with(&missing.display().to_string()) && message.lines().count() == 1, "{message}");
    let file = folder.path().join("capture.toml");
    std::fs::write(&file, b"schema = 1\nname = \"caf\xe9\"").unwrap();
    let message = CaptureSet::open(folder.path()).unwrap_err().to_string();
    assert!(message.contains("capture.toml:2: expected UTF-8 text"), "{message}");
}
