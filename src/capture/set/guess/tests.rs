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
    let options = GuessOptions { rgb: true, ..GuessOptions::of(pattern("{subject}/{light}")) };
    let files = ["/rig/object/left.png", "/rig/mirror/left.png", "/rig/dark/1.png", "/rig/notes.txt"];
    let became = add_files(&mut set, &files, &options);
    assert_eq!(became[0], Became::Shots(vec![0, 1, 2]));
    let channels: Vec<_> = set.colours.iter().map(|colour| colour.channel).collect();
    assert_eq!(channels, [Channel::R, Channel::G, Channel::B]);
    assert!(set.shots[..3].iter().all(|shot| shot.files == ["object/left.png"]));
    assert_eq!((set.shots[3].subject, &set.shots[3].colour), (Subject::MirrorSphere, &None));
    assert_eq!((set.shots[4].subject, &set.shots[4].light), (Subject::Dark, &None));
    assert!(matches!(&became[3], Became::Unassigned(doubt) if doubt.to_string().contains("{subject}/{light}")));
}

#[test]
fn a_photo_without_what_its_subject_needs_stays_unassigned() {
    let mut set = CaptureSet::default();
    let options = GuessOptions { subject: Subject::GreySphere, ..GuessOptions::of(pattern("{light}")) };
    let became = add_files(&mut set, &["left.png"], &options);
    assert_eq!(became, [Became::Unassigned(Doubt::NoColour(Subject::GreySphere))]);
    assert!(set.shots.is_empty());
}

#[test]
fn dark_frames_and_flat_fields_beside_the_photos_follow_no_pattern() {
    let mut set = CaptureSet::default();
    let options = GuessOptions::of(pattern("{light}-{colour}"));
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
    let options = GuessOptions::of(pattern(USUAL));
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
    let options = GuessOptions::of(proposed);
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

/// The set that a folder of such files becomes by the pattern that is proposed for it, and the doubts.
fn taken_in(files: &[&str], options: impl FnOnce(&mut GuessOptions)) -> (CaptureSet, Vec<Option<Doubt>>) {
    let usual = || "{light}-{colour}".parse().unwrap();
    let mut guess = GuessOptions::of(propose(files).unwrap_or_else(usual));
    options(&mut guess);
    let mut set = CaptureSet::default();
    let became = add_files(&mut set, files, &guess).into_iter();
    let doubts = became.map(|became| if let Became::Unassigned(doubt) = became { Some(doubt) } else { None });
    let doubts = doubts.collect();
    (set, doubts)
}

fn table(folders: &[&str], separator: &str) -> Vec<String> {
    let mut files = Vec::new();
    for folder in folders {
        for (light, colour) in [("left", "blue"), ("left", "green"), ("top", "blue"), ("top", "green")] {
            files.push(format!("shoot/{folder}/{light}{separator}{colour}.tif"));
        }
    }
    files
}

#[test]
fn folders_named_in_other_languages_and_plurals_are_no_repeats_of_the_object() {
    let cases = [
        ["Objekt", "Graukugel"],
        ["Objects", "Grey_Spheres"],
        ["objet 3", "boule grise"],
        ["Objetos", "esferas grises"],
        ["oggetto", "sfera grigia"],
        ["对象", "灰球"],
        ["対象物", "グレーボール"],
        ["photos of the sample", "2024-05 grey ball"],
    ];
    for folders in cases {
        let files = table(&folders, "-");
        let (set, doubts) = taken_in(&files.iter().map(String::as_str).collect::<Vec<_>>(), |_| ());
        assert!(doubts.iter().all(Option::is_none), "{folders:?}: {doubts:?}");
        assert_eq!((set.shots.len(), set.lights.len(), set.colours.len()), (8, 2, 2), "{folders:?}");
        assert!(set.shots.iter().all(|shot| shot.files.len() == 1), "{folders:?}");
        assert_eq!(set.subjects(), [Subject::Object, Subject::GreySphere], "{folders:?}");
    }
}

#[test]
fn equal_names_in_folders_that_say_nothing_are_asked_about_and_never_repeats() {
    let mut files = table(&["A", "B"], "_");
    files.push("shoot/B/right_blue.tif".into());
    let files: Vec<&str> = files.iter().map(String::as_str).collect();
    let (set, doubts) = taken_in(&files, |_| ());
    assert!(set.shots.is_empty(), "{:?}", set.shots);
    let folders = vec![PathBuf::from("shoot/A"), PathBuf::from("shoot/B")];
    assert!(doubts.iter().all(|doubt| *doubt == Some(Doubt::SameNames { folders: folders.clone() })), "{doubts:?}");
    // One folder that the user names is enough for its own files.
    let answered = [(folders[0].clone(), Subject::Object), (folders[1].clone(), Subject::GreySphere)];
    let (set, doubts) = taken_in(&files, |options| options.folders.extend(answered));
    assert!(doubts.iter().all(Option::is_none), "{doubts:?}");
    assert_eq!(set.shots_of(Subject::GreySphere).count(), 5);
    // A folder that comes later asks as well.
    let mut set = CaptureSet { folder: "shoot".into(), ..CaptureSet::default() };
    let options = GuessOptions::of(pattern("{light}_{colour}"));
    add_files(&mut set, &files[..4], &options);
    let before = set.clone();
    assert!(add_files(&mut set, &files[4..], &options).iter().all(|became| matches!(became, Became::Unassigned(_))));
    assert_eq!(set, before);
}

#[test]
fn the_subject_is_read_at_any_place_of_the_name() {
    let files = [
        "left_blue_object.tif",
        "left_green_object.tif",
        "top_blue_object.tif",
        "top_green_object.tif",
        "ball_grey_left_blue.png",
        "ball_grey_left_green.png",
        "ball_grey_top_blue.png",
        "ball_grey_top_green.png",
        "chrome_left.png",
        "top_chrome.png",
    ];
    let (set, doubts) = taken_in(&files, |_| ());
    assert!(doubts.iter().all(Option::is_none), "{doubts:?}");
    let names: Vec<&str> = set.colours.iter().map(|colour| colour.name.as_str()).collect();
    assert_eq!((names, set.lights.len(), set.shots.len()), (vec!["blue", "green"], 2, 10));
    assert_eq!(set.shots_of(Subject::MirrorSphere).count(), 2);
    assert_eq!(set.check(), []);
}

#[test]
fn a_camera_count_is_no_light_and_a_number_is_no_colour() {
    let files: Vec<String> = (1..=6)
        .map(|number| format!("object/DSC_{number:04}.tif"))
        .chain((7..=12).map(|number| format!("grey ball/DSC_{number:04}.tif")))
        .collect();
    let files: Vec<&str> = files.iter().map(String::as_str).collect();
    let (set, _) = taken_in(&files, |_| ());
    assert_eq!((set.lights.len(), set.colours.len(), set.shots.len()), (0, 0, 0));
    let subjects = named_subjects(&files);
    assert_eq!((subjects[0], subjects[11]), (Some(Subject::Object), Some(Subject::GreySphere)));
}

#[test]
fn a_word_that_is_no_colour_makes_no_column_until_the_user_says_so() {
    let files = ["left-c1.png", "left-c2.png", "top-c1.png", "top-c2.png"];
    let (set, doubts) = taken_in(&files, |_| ());
    assert!(set.shots.is_empty() && doubts[0] == Some(Doubt::NoColourWord("c1".into())), "{doubts:?}");
    let (set, doubts) = taken_in(&files, |options| options.any_colour = true);
    assert!(doubts.iter().all(Option::is_none) && set.colours.len() == 2, "{doubts:?}");
}

#[test]
fn an_exposure_bracket_is_no_list_of_repeats() {
    let brackets = [
        ["left-blue-1-60", "left-blue-1-125", "left-green-1-60", "left-green-1-125"],
        ["left_blue_0.5s", "left_blue_2s", "left_green_0.5s", "left_green_2s"],
        ["left-blue-60", "left-blue-250", "left-green-60", "left-green-250"],
        ["left_blue", "left_blue_+2EV", "left_green", "left_green_+2EV"],
    ];
    for names in brackets {
        let files: Vec<String> = names.iter().map(|name| format!("{name}.tif")).collect();
        let (set, doubts) = taken_in(&files.iter().map(String::as_str).collect::<Vec<_>>(), |_| ());
        assert!(set.shots.is_empty(), "{names:?}: {:?}", set.shots);
        assert!(doubts.iter().all(|doubt| matches!(doubt, Some(Doubt::Exposures { .. }))), "{names:?}: {doubts:?}");
    }
    let (set, doubts) = taken_in(&["left-blue-1-60.tif", "left-green-1-30.tif", "top-blue-1-60.tif"], |_| ());
    assert!(doubts.iter().all(Option::is_none), "one exposure each is no bracket: {doubts:?}");
    assert_eq!(set.shots.len(), 3);
}

#[test]
fn a_ball_of_an_unknown_kind_and_a_photo_in_two_formats_are_doubts() {
    let (set, doubts) = taken_in(&["kugel_left_blue.png", "left_blue.jpg", "left_blue.tif", "Left_green.tif"], |_| ());
    assert_eq!(doubts[0], Some(Doubt::SomeBall));
    assert_eq!(doubts[1], Some(Doubt::SamePhoto { other: "left_blue.tif".into() }));
    assert_eq!((&doubts[2], &doubts[3], set.lights.len()), (&None, &None, 1));
}

#[test]
fn only_the_object_has_a_mask_of_its_own_and_it_is_known_by_its_word() {
    for name in ["mask.png", "object-mask.tif", "Maske_2.bmp", "x/masque.png", "掩膜.png"] {
        assert!(is_mask_name(Path::new(name)), "{name}");
    }
    for name in ["masked.png", "left-blue.png", "grey ball/mask.png"] {
        assert!(!is_mask_name(Path::new(name)), "{name}");
    }
}
