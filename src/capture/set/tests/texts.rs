//! Writing changes values in a text, and leaves all else alone.

use super::{FULL, parse};
use crate::set::{
    Calibration, CaptureSet, Circle, Colour, Encoding, Shot, Sphere, SphereKind, Subject, update_text,
    write_calibration, write_positions,
};

fn measured() -> Calibration {
    Calibration {
        beta: Some(vec![1.0, 0.506_666_666_666]),
        alpha: [("left".into(), vec![1.0, 3.200_000_04]), ("top right".into(), vec![1.0, 3.428_571_428])].into(),
        direction: [("top right".into(), [0.038_588_400_864, 0.260_471_705, 0.964_710_021])].into(),
        intensity: [("left".into(), 1.0), ("top right".into(), 1.050_000_2)].into(),
        ..Calibration::default()
    }
}

fn circles() -> [Sphere; 2] {
    let grey = Circle { centre: [101.234_567_89, 101.5], radius: 83.333_333_3 };
    let mirror = Circle { centre: [7.0, 8.0], radius: 9.0 };
    [
        Sphere { subject: Subject::GreySphere, kind: SphereKind::Grey, circle: grey, diameter_mm: None },
        Sphere { subject: Subject::MirrorSphere, kind: SphereKind::Mirror, circle: mirror, diameter_mm: Some(3.6) },
    ]
}

fn comments(text: &str) -> Vec<&str> {
    text.lines().filter_map(|line| line.find('#').map(|at| &line[at..])).collect()
}

#[test]
fn calibration_is_written_to_six_digits() {
    let set = parse(&write_calibration(FULL, &measured(), &circles()).unwrap());
    assert_eq!(set.calibration.beta, Some(vec![1.0, 0.506667]));
    assert_eq!(set.calibration.alpha["top right"], [1.0, 3.42857]);
    assert_eq!(set.calibration.alpha["left"], [1.0, 3.2]);
    assert_eq!(set.calibration.direction["top right"], [0.0385884, 0.260472, 0.96471]);
    assert_eq!(set.calibration.direction["left"], [-0.269, 0.058, 0.961]);
    assert_eq!(set.calibration.intensity["top right"], 1.05);
    assert_eq!(set.circle(Subject::GreySphere, SphereKind::Grey).unwrap().centre, [101.235, 101.5]);
    assert_eq!(set.spheres.len(), 3);
}

#[test]
fn positions_of_lamps_are_written_to_their_lights_and_take_the_place_of_directions() {
    let shot = |light: &str| {
        format!("[[shot]]\nsubject = \"object\"\nlight = \"{light}\"\ncolour = \"c\"\nfiles = [\"{light}.png\"]\n")
    };
    let text = format!(
        "schema = 1\n[[colour]]\nname = \"c\"\nchannel = \"grey\"\n[[light]]\nname = \"near\"\n[[light]]\nname = \"typed\"\n\
         direction = [0.0, 0.3, 1.0]\n{}{}[calibration]\ndirection.near = [0.1, 0.2, 0.9]\n",
        shot("near"),
        shot("typed")
    );
    let position = [-150.212_345_6, 60.0, 370.0];
    let written = write_positions(&text, [("near", position), ("typed", position), ("gone", position)]).unwrap();
    let set = parse(&written);
    assert_eq!(set.lights[0].position_mm, Some([-150.212, 60.0, 370.0]));
    assert_eq!((set.lights[1].position_mm, set.calibration.direction.len()), (None, 0));
    assert_eq!(write_positions(&written, [("near", position)]).unwrap(), written);
}

#[test]
fn writing_calibration_keeps_every_comment_and_every_other_line() {
    let text = write_calibration(FULL, &measured(), &circles()).unwrap();
    assert_eq!(comments(&text), comments(FULL));
    let changed: Vec<&str> = FULL.lines().filter(|line| !text.lines().any(|new| new == *line)).collect();
    assert_eq!(changed, ["centre = [100.0, 101.5]", "radius = 83.3", "beta = [1.0, 0.51]"]);
    let mut rest = text.lines();
    for line in FULL.lines().filter(|line| !changed.contains(line)) {
        assert!(rest.any(|new| new == line), "{line} has left its place");
    }
}

#[test]
fn writing_calibration_twice_changes_nothing_more() {
    let bare = FULL.split("[calibration]").next().unwrap();
    for text in [FULL.to_owned(), bare.to_owned(), FULL.replace('\n', "\r\n"), format!("\u{feff}{FULL}")] {
        let once = write_calibration(&text, &measured(), &circles()).unwrap();
        assert_ne!(once, text);
        assert_eq!(write_calibration(&once, &measured(), &circles()).unwrap(), once);
        let returns = if text.contains('\r') { once.matches('\n').count() } else { 0 };
        assert_eq!(once.matches("\r\n").count(), returns);
    }
}

#[test]
fn calibration_follows_what_stands_at_the_end_of_the_file() {
    let bare = FULL.split("[calibration]").next().unwrap().to_owned() + "# kind = \"grey\"\n";
    let text = write_calibration(&bare, &measured(), &[]).unwrap();
    assert_eq!(text.strip_prefix(&bare).unwrap().lines().find(|line| !line.is_empty()), Some("[calibration]"));
}

#[test]
fn comments_inside_a_list_survive_its_new_values() {
    let text = FULL.replace("beta = [1.0, 0.51]", "beta = [\n  1.0, # blue\n  0.51, # green\n]");
    let written = write_calibration(&text, &measured(), &[]).unwrap();
    assert!(written.contains("beta = [\n  1.0, # blue\n  0.506667, # green\n]"), "{written}");
}

#[test]
fn tables_written_in_other_ways_are_updated_in_place() {
    let head = FULL.split("[calibration]").next().unwrap();
    for calibration in [
        "calibration = { beta = [1, 0.51], alpha = { left = [1, 3] } }\n",
        "calibration.beta = [1, 0.51]\ncalibration.alpha.left = [1, 3]\n",
    ] {
        let text = head.replacen("mask", &format!("{calibration}mask"), 1);
        let set = parse(&text);
        let written = write_calibration(&text, &measured(), &circles()).unwrap();
        assert_eq!(parse(&written).calibration.alpha["left"], [1.0, 3.2], "{written}");
        assert_eq!(parse(&written).shots, set.shots);
        assert_eq!(comments(&written), comments(&text));
    }
}

#[test]
fn a_calibration_that_would_make_the_file_wrong_is_refused() {
    let close = Calibration { beta: Some(vec![1.0, 0.99]), ..Calibration::default() };
    let message = write_calibration(FULL, &close, &[]).unwrap_err().to_string();
    assert!(message.contains("within 0.02"), "{message}");
    let error = write_calibration("schema = ", &close, &[]).unwrap_err().to_string();
    assert!(error.starts_with("capture.toml:1: "), "{error}");
}

#[test]
fn an_unchanged_set_leaves_the_text_as_it_is() {
    assert_eq!(update_text(FULL, &parse(FULL)), FULL);
}

/// Saves `change` into the full text; what it says must be read back.
fn saved(change: impl FnOnce(&mut CaptureSet)) -> String {
    let mut set = parse(FULL);
    change(&mut set);
    let text = update_text(FULL, &set);
    assert_eq!(parse(&text), set, "{text}");
    text
}

#[test]
fn a_save_changes_only_the_lines_of_what_was_edited() {
    let text = saved(|set| set.shots[0].exposure = Some(0.25));
    assert_eq!(text, FULL.replace("exposure = 0.5", "exposure = 0.25"));
    let text = saved(|set| set.camera.black_level = 500.0);
    assert_eq!(text, FULL.replace("black_level = 512", "black_level = 500"));
    let text = saved(|set| set.shots[3].encoding = Some(Encoding::Linear));
    assert_eq!(text, FULL.replace("encoding = \"srgb\"", "encoding = \"linear\""));
    let text = saved(|set| set.rename_colour(1, "teal"));
    assert_eq!(
        text,
        FULL.replace("name = \"green\"", "name = \"teal\"").replace("colour = \"green\"", "colour = \"teal\"")
    );
    let text = saved(|set| set.truth = Default::default());
    assert_eq!(text, FULL.replace("true/{light}/{k}.exr", "truth/bounce{k}-{light}.exr"));
}

#[test]
fn a_save_keeps_the_comments_of_what_is_moved_and_drops_those_of_what_is_gone() {
    let text = saved(|set| set.shots.swap(0, 3));
    assert_eq!(comments(&text).len(), comments(FULL).len());
    let text = saved(|set| {
        set.shots.remove(3);
        set.shots.remove(2);
        set.lights.remove(1);
    });
    assert_eq!(comments(&text).len(), comments(FULL).len() - 1);
    let text = saved(|set| set.calibration = Calibration::default());
    assert!(text.contains("# A second lamp colour"));
}

#[test]
fn new_shots_join_the_others() {
    let text = saved(|set| {
        for (name, files) in [("blue", "m-blue.png"), ("green", "m-green.png")] {
            set.shots.push(Shot {
                subject: Subject::MaterialSphere,
                light: Some("left".into()),
                colour: Some(name.into()),
                files: vec![files.into()],
                ..Shot::default()
            });
        }
    });
    assert!(text.find("m-green.png").unwrap() < text.find("[[sphere]]").unwrap());
    assert_eq!(comments(&text), comments(FULL));
}

#[test]
fn a_text_that_cannot_be_changed_is_replaced() {
    let set = parse(FULL);
    for text in ["", "schema = ", "unknown = 1", "schema = 2\ncamera = 3"] {
        let saved = update_text(text, &set);
        assert_eq!(parse(&saved), set);
    }
}

#[test]
fn a_set_still_in_the_making_is_saved_as_it_is() {
    let set =
        CaptureSet { colours: vec![Colour { name: "blue".into(), ..Colour::default() }], ..CaptureSet::default() };
    let reading = crate::set::Reading::of(&set.to_toml(), &set.file_path());
    assert_eq!(reading.set, set);
    assert!(reading.complete && !reading.problems.is_empty());
}

#[test]
fn saving_replaces_the_file_in_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    let mut set = CaptureSet { folder: folder.path().to_owned(), ..parse(FULL) };
    set.save().unwrap();
    assert_eq!(CaptureSet::open(folder.path()).unwrap(), set);
    std::fs::write(set.file_path(), FULL).unwrap();
    set.shots[0].exposure = Some(0.125);
    set.save().unwrap();
    assert_eq!(std::fs::read_to_string(set.file_path()).unwrap(), FULL.replace("exposure = 0.5", "exposure = 0.125"));
}
