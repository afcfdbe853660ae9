//! Photos that arrive in folders of every kind.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use super::{ArrivalOptions, Arrivals, Doubt, Sequence, TakenFor, take_arrivals};
use crate::image_file::TimeTaken;
use crate::set::{CaptureSet, Colour, Light, Shot, Subject};

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn set(&self) -> CaptureSet {
        CaptureSet { folder: self.0.path().to_owned(), ..CaptureSet::default() }
    }

    fn files(&self, names: &[&str]) -> Vec<PathBuf> {
        let path = |name: &&str| {
            let path = self.0.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(&path, []).unwrap();
            path
        };
        names.iter().map(path).collect()
    }
}

fn shown(arrivals: &Arrivals) -> Vec<String> {
    arrivals.taken.iter().map(|taken| taken.described(&arrivals.set)).collect()
}

fn by_rank(ranks: &[(&'static str, u64)]) -> impl Fn(&Path) -> Option<TimeTaken> {
    let ranks = ranks.to_vec();
    move |file| {
        let name = file.file_name()?.to_str()?.to_owned();
        let rank = ranks.iter().find(|(of, _)| *of == name)?.1;
        Some(TimeTaken::Camera(SystemTime::UNIX_EPOCH + Duration::from_secs(rank)))
    }
}

#[test]
fn photos_whose_names_say_what_they_show_need_no_capture_file() {
    let folder = Folder::new();
    let files = folder.files(&["object/left-blue.png", "object/left-green.png", "mirror/left.png", "mask.png"]);
    let arrivals = take_arrivals(&folder.set(), &files, &ArrivalOptions::default(), |_| None);
    let shown = shown(&arrivals);
    assert!(shown[0].starts_with("Object left blue (by its name"), "{shown:?}");
    assert!(shown[2].starts_with("Mirror ball left (by its name"), "{shown:?}");
    assert_eq!(arrivals.set.mask.as_deref(), Some("mask.png"));
    // One after the other they become the same.
    let mut set = folder.set();
    for file in &files {
        set = take_arrivals(&set, &[file], &ArrivalOptions::default(), |_| None).set;
    }
    assert_eq!(set.shots, arrivals.set.shots);
    let again = take_arrivals(&set, &files, &ArrivalOptions::default(), |_| None);
    assert_eq!((&again.set.shots, &again.taken[0]), (&set.shots, &TakenFor::Named(vec![0])));
}

#[test]
fn a_camera_count_is_doubted_without_an_order_and_follows_the_times_with_one() {
    let folder = Folder::new();
    let files = folder.files(&["IMG_0001.png", "IMG_0002.png", "IMG_0003.png", "IMG_0004.png", "IMG_0005.png"]);
    let set = folder.set();
    let doubted = take_arrivals(&set, &files, &ArrivalOptions::default(), |_| None);
    assert!(doubted.taken.iter().all(|taken| matches!(taken, TakenFor::Unassigned(_))), "{:?}", shown(&doubted));
    let sequence = Sequence {
        lights: vec!["left".into(), "top".into()],
        colours: vec!["blue".into(), "green".into()],
        ..Sequence::default()
    };
    let options = ArrivalOptions { sequence: Some(sequence), pattern: None };
    let taken = take_arrivals(&set, &files, &options, |_| None);
    assert_eq!(
        shown(&taken),
        [
            "Object left blue (in order, by the number in its name)",
            "Object left green (in order, by the number in its name)",
            "Object top blue (in order, by the number in its name)",
            "Object top green (in order, by the number in its name)",
            "not assigned: every place of the order has its photo; take it away, or name what it shows",
        ]
    );
    let ranks = [("IMG_0001.png", 40), ("IMG_0002.png", 10), ("IMG_0003.png", 20), ("IMG_0004.png", 30)];
    let by_time = take_arrivals(&set, &files[..4], &options, by_rank(&ranks));
    let shown = shown(&by_time);
    assert!(shown[1].starts_with("Object left blue (in order, by the time it was taken; times and names"), "{shown:?}");
    assert!(shown[0].starts_with("Object top green"), "{shown:?}");
}

#[test]
fn photos_in_order_fill_what_the_capture_file_planned_and_replace_nothing_that_is_there() {
    let folder = Folder::new();
    let files = folder.files(&["left.png", "DSC_0007.png", "DSC_0008.png"]);
    let shot = |light: &str, file: &str| Shot {
        light: Some(light.into()),
        colour: Some("blue".into()),
        files: vec![file.into()],
        ..Shot::default()
    };
    let set = CaptureSet {
        lights: ["left", "top"].map(|name| Light { name: name.into(), ..Light::default() }).to_vec(),
        colours: vec![Colour { name: "blue".into(), channel: Default::default() }],
        shots: vec![shot("left", "left.png"), shot("top", "top.png")],
        ..folder.set()
    };
    let options = ArrivalOptions { sequence: Some(Sequence::default()), pattern: None };
    let arrivals = take_arrivals(&set, &files, &options, |_| None);
    assert_eq!(arrivals.taken[0], TakenFor::Named(vec![0]));
    assert_eq!(arrivals.set.shots[0].files, ["left.png"]);
    assert_eq!(arrivals.set.shots[1].files, ["DSC_0007.png"]);
    assert_eq!(arrivals.taken[2], TakenFor::Unassigned(Doubt::OrderIsFull));
}

#[test]
fn the_last_photos_of_an_order_are_dark_frames() {
    let folder = Folder::new();
    let files = folder.files(&["1.png", "2.png", "3.png", "4.png"]);
    let sequence = Sequence {
        subjects: vec![Subject::MirrorSphere, Subject::Dark],
        lights: vec!["left".into(), "top".into()],
        ..Sequence::default()
    };
    let options = ArrivalOptions { sequence: Some(sequence), pattern: None };
    let arrivals = take_arrivals(&folder.set(), &files, &options, |_| None);
    let counts = [Subject::MirrorSphere, Subject::Dark].map(|subject| arrivals.set.shots_of(subject).count());
    assert_eq!(counts, [2, 1]);
    assert_eq!(arrivals.set.shots_of(Subject::Dark).next().unwrap().files, ["3.png", "4.png"]);
}
