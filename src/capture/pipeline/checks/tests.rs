use std::fs;
use std::path::Path;

use firstbounce_core::{Mask, Plane};

use super::*;
use crate::image_file::grey16_png;
use crate::pipeline::Unattended;

const SIZE: usize = 128;
const LIGHTS: [(&str, [f64; 3]); 4] =
    [("left", [-0.5, 0.0, 0.87]), ("right", [0.5, 0.0, 0.87]), ("top", [0.0, 0.5, 0.87]), ("below", [0.0, -0.5, 0.87])];

/// A painted dome under a lamp, moved by some pixels; 1 is the brightest light there is.
fn dome(lamp: [f64; 3], shift_px: [f64; 2]) -> Plane {
    let mut seed = 12345_u32;
    Plane::from_fn(SIZE, SIZE, |x, y| {
        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let grain = 0.004 * (f64::from(seed >> 8) / f64::from(1 << 24) - 0.5);
        let (x, y) = (x as f64 - shift_px[0], y as f64 - shift_px[1]);
        let (u, v) = ((x - 64.0) / 50.0, (64.0 - y) / 50.0);
        let height = 1.0 - u * u - v * v;
        let paint = if ((x / 17.0).floor() + (y / 23.0).floor()) as i64 % 2 == 0 { 0.9 } else { 0.5 };
        let shading = (lamp[0] * u + lamp[1] * v + lamp[2] * height.max(0.0).sqrt()).max(0.0);
        ((if height > 0.0 { paint * shading } else { 0.0 }) + 0.01 + grain) as f32
    })
}

fn write(folder: &Path, name: &str, picture: &Plane) {
    fs::write(folder.join(name), grey16_png(picture, 1.0).unwrap()).unwrap();
}

/// A set of one colour whose photos are written by `photo`, with what else its file says of the camera.
fn set(folder: &Path, camera: &str, photo: impl Fn(usize) -> Plane) -> CaptureSet {
    let mut text = format!("schema = 1\n[camera]\n{camera}\n[[colour]]\nname = \"white\"\n");
    for (l, (light, _)) in LIGHTS.iter().enumerate() {
        write(folder, &format!("{light}.png"), &photo(l));
        text += &format!("[[light]]\nname = \"{light}\"\n");
        text += &format!(
            "[[shot]]\nsubject = \"object\"\nlight = \"{light}\"\ncolour = \"white\"\nfiles = [\"{light}.png\"]\n"
        );
    }
    fs::write(folder.join("capture.toml"), text).unwrap();
    CaptureSet::open(folder).unwrap()
}

fn warnings(set: &CaptureSet) -> Vec<CaptureWarning> {
    check_captures(set, |_| true, &PhotoStore::default(), &CheckOptions::default(), &Unattended)
        .unwrap()
        .report
        .warnings
}

#[test]
fn a_sound_set_has_no_capture_warning() {
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(warnings(&set(folder.path(), "", |l| dome(LIGHTS[l].1, [0.0; 2]))), []);
}

#[test]
fn one_photo_under_two_lamps_is_named_with_both_lamps() {
    let folder = tempfile::tempdir().unwrap();
    let mut set = set(folder.path(), "", |l| dome(LIGHTS[l].1, [0.0; 2]));
    fs::copy(folder.path().join("left.png"), folder.path().join("top.png")).unwrap();
    let copied = warnings(&set);
    assert!(matches!(&copied[..], [CaptureWarning::EqualFiles { files, .. }] if *files == ["left.png", "top.png"]));
    let line = copied[0].to_string();
    assert!(line.contains("light \"left\"") && line.contains("light \"top\""), "{line}");

    set.shots[2].files = vec!["left.png".into()];
    let named_twice = warnings(&set);
    assert!(matches!(&named_twice[..], [CaptureWarning::EqualFiles { files, .. }] if *files == ["left.png"]));
}

#[test]
fn one_rgb_photo_of_three_colours_is_no_equal_file() {
    let folder = tempfile::tempdir().unwrap();
    let mut set = set(folder.path(), "", |l| dome(LIGHTS[l].1, [0.0; 2]));
    set.colours.push(crate::set::Colour { name: "red".into(), channel: crate::set::Channel::R });
    let red = set.shots.clone().into_iter().map(|shot| Shot { colour: Some("red".into()), ..shot });
    set.shots.extend(red.collect::<Vec<_>>());
    assert_eq!(equal_files::equal_files(&set), []);
}

#[test]
fn values_that_end_below_the_white_level_are_named_with_the_white_level_to_set() {
    let folder = tempfile::tempdir().unwrap();
    // Twelve bits in a file of sixteen, a part of them clipped.
    let twelve_bits = |l: usize| dome(LIGHTS[l].1, [0.0; 2]).map(|light| (light * 1.3).min(1.0) * 4095.0 / 65535.0);
    let found = warnings(&set(folder.path(), "", twelve_bits));
    let [CaptureWarning::ValuesEnd { value, files, .. }] = &found[..] else { panic!("{found:?}") };
    assert_eq!((*value, files.files.len()), (4095.0, 4));
    assert!(found[0].to_string().contains("white_level = 4095"), "{}", found[0]);
    // Told, they count as clipped, and that much of the object is.
    let told = warnings(&set(folder.path(), "white_level = 4095", twelve_bits));
    let [CaptureWarning::Clipped { share, .. }] = &told[..] else { panic!("{told:?}") };
    assert!((0.01..0.5).contains(share), "{share}");
}

#[test]
fn a_white_level_that_the_file_type_cannot_reach_is_named_with_what_it_can() {
    let folder = tempfile::tempdir().unwrap();
    let set = set(folder.path(), "white_level = 100000", |l| dome(LIGHTS[l].1, [0.0; 2]));
    let found = warnings(&set);
    let [CaptureWarning::WhiteLevelOutOfReach { maximum, .. }] = &found[..] else { panic!("{found:?}") };
    assert_eq!(*maximum, 65535.0);
}

#[test]
fn photos_of_one_lamp_that_were_shifted_are_named_with_how_far() {
    for shift in [[2.0, 0.0], [-3.0, 3.0], [0.0, 8.0]] {
        let folder = tempfile::tempdir().unwrap();
        let found = warnings(&set(folder.path(), "", |l| dome(LIGHTS[l].1, if l == 1 { shift } else { [0.0; 2] })));
        let [CaptureWarning::Moved { light, shift_px, .. }] = &found[..] else { panic!("{shift:?}: {found:?}") };
        assert_eq!(light, "right");
        assert!((shift_px[0] - shift[0]).hypot(shift_px[1] - shift[1]) < 0.7, "{shift_px:?}");
    }
}

#[test]
fn repeats_that_show_something_else_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let mut set = set(folder.path(), "", |l| dome(LIGHTS[l].1, [0.0; 2]));
    write(folder.path(), "left-2.png", &dome([0.3, -0.4, 0.87], [0.0; 2]));
    set.shots[0].files.push("left-2.png".into());
    let found = warnings(&set);
    assert!(matches!(&found[..], [CaptureWarning::RepeatsDiffer { file, .. }] if file == "left-2.png"), "{found:?}");
}

#[test]
fn an_object_in_two_parts_has_no_depth_between_them() {
    let parts = Mask::from_fn(40, 20, |x, _| !(15..=25).contains(&x));
    let found = check_surface(&parts, &CheckOptions::default());
    let crumb = Mask::from_fn(400, 400, |x, y| x < 300 || (x > 350 && x < 358 && y < 10));
    assert!(check_surface(&crumb, &CheckOptions::default()).is_empty(), "a crumb is no part");
    assert!(matches!(found[..], [CaptureWarning::Islands { islands: 2, .. }]), "{found:?}");
    let speck = Mask::from_fn(40, 20, |x, y| x < 15 || (x > 37 && y > 17));
    assert_eq!(check_surface(&speck, &CheckOptions::default()), []);
}

#[test]
fn the_worst_warning_is_first() {
    let islands = CaptureWarning::Islands { islands: 2, share_beside: 0.1 };
    let equal = CaptureWarning::EqualFiles { files: vec!["a.png".into()], shots: vec![] };
    let report = CaptureReport::of(vec![islands.clone(), equal.clone()]);
    assert_eq!(report.warnings, [equal, islands]);
}
