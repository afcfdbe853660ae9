//! Capture warnings: none of a sound set, and those of the rig and of the lens beside those of single photos.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::path::Path;

use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::{CaptureWarning, Unattended, survey};
use firstbounce_capture::set::Subject;
use firstbounce_core::{Plane, Unwatched};
use firstbounce_lab::simulate::{Measures, Scene, SimulateOptions, Simulated, simulate, write_simulated};
use firstbounce_testing::shared_set;

fn warnings(set: &CaptureSet) -> Vec<CaptureWarning> {
    survey(set, &Unattended).unwrap().captures.warnings
}

fn lines(warnings: &[CaptureWarning]) -> Vec<String> {
    warnings.iter().map(ToString::to_string).collect()
}

fn written(simulated: &Simulated, place: &Path) -> CaptureSet {
    let folder = place.join("set");
    write_simulated(simulated, &folder).unwrap();
    CaptureSet::open(&folder).unwrap()
}

/// As `firstbounce simulate` makes it with defaults; fewer patches change no edge.
fn made(scene: &str) -> Simulated {
    let scene = Scene::built_in(scene, Measures::default()).unwrap();
    simulate(&SimulateOptions { scene, patches: 400, ..SimulateOptions::default() }, &Unwatched).unwrap()
}

#[test]
fn no_scene_of_simulate_gives_a_capture_warning() {
    for scene in Scene::BUILT_IN {
        let place = tempfile::tempdir().unwrap();
        let found = warnings(&written(&made(scene), place.path()));
        assert!(found.is_empty(), "{scene}: {:#?}", lines(&found));
    }
}

#[test]
fn no_sound_set_gives_a_capture_warning_and_the_cat_only_that_it_has_eight_bits() {
    let sound =
        ["birdbath-dslr", "bowl-four", "bowl-quiet", "corner-blue", "corner-quiet", "groove-quiet", "groove-rgb"];
    for name in sound {
        let Some(folder) = shared_set(name) else { continue };
        let found = warnings(&CaptureSet::open(&folder).unwrap());
        assert!(found.is_empty(), "{name}: {:#?}", lines(&found));
    }
    let Some(cat) = shared_set("psbox-cat") else { return };
    let found = warnings(&CaptureSet::open(&cat).unwrap());
    assert!(found.iter().all(|warning| warning.kind() == "eight-bit"), "{:#?}", lines(&found));
    assert_eq!(found.len(), 2, "of the object and of the mirror ball: {:#?}", lines(&found));
}

#[test]
fn room_light_on_the_balls_is_a_capture_warning() {
    let mut simulated = made("corner");
    let camera = &simulated.set.camera;
    let added = 0.03 * (camera.white_level.unwrap() - camera.black_level);
    for photo in simulated.photos.iter_mut().filter(|photo| photo.subject == Subject::GreySphere) {
        photo.stored.data_mut().iter_mut().for_each(|value| *value += added.round() as f32);
    }
    let place = tempfile::tempdir().unwrap();
    let found = warnings(&written(&simulated, place.path()));
    assert!(found.iter().any(|warning| warning.kind() == "room-light"), "{:#?}", lines(&found));
}

/// A picture magnified about its middle by a share.
fn magnified(plane: &Plane, by: f64) -> Plane {
    let (width, height) = plane.size();
    Plane::from_fn(width, height, |x, y| {
        let from = |at: usize, side: usize| {
            let half = (side as f64 - 1.0) / 2.0;
            ((at as f64 - half) / (1.0 + by) + half).clamp(0.0, side as f64 - 1.001)
        };
        let (x, y) = (from(x, width), from(y, height));
        let (left, top) = (x as usize, y as usize);
        let (across, down) = ((x - left as f64) as f32, (y - top as f64) as f32);
        let row = |y: usize| plane.at(left, y) * (1.0 - across) + plane.at(left + 1, y) * across;
        (row(top) * (1.0 - down) + row(top + 1) * down).round()
    })
}

#[test]
fn a_lens_that_magnifies_one_colour_more_is_told_in_pixels_with_the_remedy() {
    let mut simulated = made("corner");
    let is_second = |colour: &str| colour == "c2";
    for photo in simulated.photos.iter_mut().filter(|photo| photo.subject == Subject::Object) {
        if is_second(&simulated.set.colours[photo.colour.unwrap_or_default()].name) {
            photo.stored = magnified(&photo.stored, 0.02);
        }
    }
    let place = tempfile::tempdir().unwrap();
    let found = warnings(&written(&simulated, place.path()));
    let line = lines(&found).join("\n");
    assert!(found.iter().any(|warning| warning.kind() == "colour-fringe"), "{line}");
    assert!(line.contains("edges in c2 lie up to") && line.contains("lateral colour"), "{line}");
    let CaptureWarning::ColourFringe { shift_px: [x, y], .. } = found[0] else { panic!("{line}") };
    // Up to 128 px from the middle 2 percent are 2.6 px along each axis.
    assert!((0.8..3.7).contains(&x.hypot(y)), "{line}");
}
