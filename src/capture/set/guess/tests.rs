use std::path::PathBuf;

use proptest::prelude::*;

use super::super::word::Word;
use super::*;

fn pattern(text: &str) -> Pattern {
    text.parse().unwrap()
}

fn read(text: &str, file: &str) -> Option<Guess> {
    pattern(text).read(Path::new(file))
}

fn guess(subject: Option<Subject>, light: &str, colour: &str, repeat: Option<u64>) -> Guess {
    let name = |name: &str| Some(name.to_owned()).filter(|name| !name.is_empty());
    Guess { subject, light: name(light), colour: name(colour), repeat }
}

const USUAL: &str = "{subject}/{light}-{colour}[-{repeat}]";

#[test]
fn names_of_the_usual_form_are_read() {
    let cases = [
        ("object/left-blue.png", guess(Some(Subject::Object), "left", "blue", None)),
        ("/a/b/grey-sphere/left-blue-2.tif", guess(Some(Subject::GreySphere), "left", "blue", Some(2))),
        ("Gray_Ball/L1-RED-03.TIF", guess(Some(Subject::GreySphere), "L1", "RED", Some(3))),
        ("chrome ball/top-left-blue.png", guess(Some(Subject::MirrorSphere), "top-left", "blue", None)),
        ("paint/top-450nm.png", guess(Some(Subject::MaterialSphere), "top", "450nm", None)),
    ];
    for (file, expected) in cases {
        assert_eq!(read(USUAL, file), Some(expected), "{file}");
    }
}

#[test]
fn names_of_another_form_are_left_alone() {
    for file in ["left-blue.png", "holiday/left-blue.png", "object/left.png", "object/.png", "", "/", "object/-.png"] {
        assert_eq!(read(USUAL, file), None, "{file}");
    }
}

#[test]
fn a_pattern_that_cannot_be_read_says_why() {
    let cases = [
        ("{light", "unknown field"),
        ("{lamp}", "unknown field {lamp}"),
        ("{light}}", "a \"}\" without its partner"),
        ("[{light}", "a \"[\" without its partner"),
        ("{light}]", "a \"]\" without its partner"),
        ("{light}[[x]]", "brackets can hold"),
        ("{light}-{light}", "twice"),
        ("{any}", "needs"),
        ("", "needs"),
    ];
    for (text, reason) in cases {
        let error = text.parse::<Pattern>().unwrap_err().to_string();
        assert!(error.contains(reason) || error.contains("without its partner"), "{text}: {error}");
    }
}

#[test]
fn an_rgb_photo_is_a_shot_of_every_colour() {
    let mut set = CaptureSet { folder: "/rig".into(), ..CaptureSet::default() };
    let options = GuessOptions { pattern: pattern("{subject}/{light}"), subject: Subject::Object, rgb: true };
    let files = ["/rig/object/left.png", "/rig/mirror/left.png", "/rig/dark/1.png", "/rig/notes.txt"];
    let became = add_files(&mut set, &files, &options);
    assert_eq!(became[0], Became::Shots(vec![0, 1, 2]));
    let channels: Vec<_> = set.colours.iter().map(|colour| colour.channel).collect();
    assert_eq!(channels, [Channel::R, Channel::G, Channel::B]);
    assert!(set.shots[..3].iter().all(|shot| shot.files == ["object/left.png"]));
    assert_eq!((set.shots[3].subject, &set.shots[3].colour), (Subject::MirrorSphere, &None));
    assert_eq!((set.shots[4].subject, &set.shots[4].light), (Subject::Dark, &None));
    assert!(matches!(&became[3], Became::Unassigned(reason) if reason.contains("{subject}/{light}")));
}

#[test]
fn a_photo_without_what_its_subject_needs_stays_unassigned() {
    let mut set = CaptureSet::default();
    let options = GuessOptions { pattern: pattern("{light}"), subject: Subject::GreySphere, rgb: false };
    let became = add_files(&mut set, &["left.png"], &options);
    assert_eq!(became, [Became::Unassigned("a photo of grey-sphere needs a colour".into())]);
    assert!(set.shots.is_empty());
}

#[test]
fn dark_frames_and_flat_fields_beside_the_photos_follow_no_pattern() {
    let mut set = CaptureSet::default();
    let options = GuessOptions { pattern: pattern("{light}-{colour}"), subject: Subject::Object, rgb: false };
    let files = ["a/dark.png", "a/dark_02.png", "a/Flat-Field 3.tif", "a/darkroom.png", "a/White.png"];
    let became = add_files(&mut set, &files, &options);
    assert_eq!(became[0], became[1], "two dark frames are one shot");
    let subjects: Vec<_> = set.shots.iter().map(|shot| (shot.subject, shot.files.len())).collect();
    assert_eq!(subjects, [(Subject::Dark, 2), (Subject::FlatField, 1)]);
    assert!(became[3..].iter().all(|became| matches!(became, Became::Unassigned(_))));
}

#[test]
fn files_that_are_there_already_are_not_added_twice() {
    let mut set = CaptureSet { folder: "/rig".into(), ..CaptureSet::default() };
    let options = GuessOptions { pattern: pattern(USUAL), subject: Subject::Object, rgb: false };
    let files = ["/rig/object/left-blue-1.png", "/rig/object/left-blue-2.png", "/elsewhere/object/left-blue-3.png"];
    add_files(&mut set, &files, &options);
    let once = set.clone();
    add_files(&mut set, &files, &options);
    assert_eq!(set, once);
    let expected = ["object/left-blue-1.png", "object/left-blue-2.png", "/elsewhere/object/left-blue-3.png"];
    assert_eq!(set.shots[0].files, expected);
}

#[test]
fn names_without_a_system_have_no_pattern_of_two() {
    let proposed = propose(&["DSC001.NEF.png", "DSC002.NEF.png"]);
    assert!(proposed.is_none_or(|pattern| !pattern.names_subject()));
    let in_a_folder = propose(&["shoot/DSC001.png", "shoot/DSC002.png"]);
    assert!(in_a_folder.is_none_or(|pattern| !pattern.names_colour()), "a folder is no colour");
    assert!(propose::<PathBuf>(&[]).is_none());
}

#[test]
fn the_sets_of_the_format_have_the_usual_pattern() {
    let files: Vec<String> = ["object", "grey-sphere", "material-sphere"]
        .iter()
        .flat_map(|s| ["left", "top", "right"].map(|l| format!("{s}/{l}")))
        .flat_map(|stem| ["blue", "green"].map(|colour| format!("{stem}-{colour}.png")))
        .collect();
    assert_eq!(propose(&files).unwrap().to_string(), USUAL);

    let mirror = ["left", "top", "right"].map(|light| format!("mirror-sphere/{light}.png"));
    let all: Vec<String> = files.into_iter().chain(mirror).chain(["dark/1.png".into()]).collect();
    let proposed = propose(&all).unwrap();
    assert_eq!(proposed.to_string(), "{subject}/{light}[-{colour}][-{repeat}]");
    let mut set = CaptureSet::default();
    let options = GuessOptions { pattern: proposed, subject: Subject::Object, rgb: false };
    assert!(add_files(&mut set, &all, &options).iter().all(|became| matches!(became, Became::Shots(_))));
    assert_eq!((set.shots.len(), set.lights.len(), set.colours.len()), (22, 3, 2));
    assert_eq!(set.check(), []);
}

const SUBJECTS: [Subject; 3] = [Subject::Object, Subject::GreySphere, Subject::MaterialSphere];

/// Names as users give them, none within another.
fn names(prefix: &'static str) -> impl Strategy<Value = Vec<String>> {
    prop::collection::btree_set("[a-z]{1,6}[0-9]{0,2}", 2..5)
        .prop_map(move |names| names.into_iter().map(|name| format!("{prefix}{name}")).collect())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    /// A set of names that was made from a pattern comes back, and the pattern that is proposed for it reads it too.
    #[test]
    fn names_made_from_a_pattern_come_back(
        lights in names("lamp"),
        colours in prop::sample::subsequence(vec!["red", "green", "blue", "amber", "cyan"], 2..5),
        repeats in 1_u64..4,
        separator in prop::sample::select(vec!["-", "_", " "]),
        light_first in any::<bool>(),
        subject_end in prop::sample::select(vec!["/", "_"]),
    ) {
        let (first, second) = if light_first { ("light", "colour") } else { ("colour", "light") };
        let text = format!("{{subject}}{subject_end}{{{first}}}{separator}{{{second}}}[{separator}{{repeat}}]");
        let mut files = Vec::new();
        for subject in SUBJECTS {
            for (light, colour) in lights.iter().flat_map(|light| colours.iter().map(move |colour| (light, colour))) {
                for repeat in 1..=repeats {
                    let (one, two) = if light_first { (light.as_str(), *colour) } else { (*colour, light.as_str()) };
                    let number = if repeats > 1 { format!("{separator}{repeat}") } else { String::new() };
                    let path = format!("{}{subject_end}{one}{separator}{two}{number}.png", subject.word());
                    let repeat = (repeats > 1).then_some(repeat);
                    files.push((path, guess(Some(subject), light, colour, repeat)));
                }
            }
        }
        let paths: Vec<&str> = files.iter().map(|(path, _)| path.as_str()).collect();
        let proposed = propose(&paths).unwrap();
        for (path, expected) in &files {
            prop_assert_eq!(pattern(&text).read(Path::new(path)), Some(expected.clone()), "{} by {}", path, text);
            prop_assert_eq!(proposed.read(Path::new(path)), Some(expected.clone()), "{} by {}", path, proposed);
        }
    }

    /// Whatever the user types is a pattern or an error, and no pattern fails on any name.
    #[test]
    fn no_text_breaks_a_pattern(text in "[a-z{}\\[\\]/.-]{0,20}|\\PC{0,20}", file in "\\PC{0,30}") {
        if let Ok(pattern) = text.parse::<Pattern>() {
            let _ = pattern.read(Path::new(&file));
        }
    }
}
