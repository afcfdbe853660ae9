//! Bad input: one line that says what to do, exit 1, and what is on the disk stays as it is.

use std::fs;
use std::path::Path;

use crate::run::firstbounce;
use crate::tiny_set;

/// Spoils a fresh set and expects `solve` to fail with a line that holds all `words`, and to write nothing.
fn refused(spoil: impl Fn(&Path), words: &[&str]) {
    let place = tempfile::tempdir().unwrap();
    let set = tiny_set::write(place.path());
    spoil(&set);
    let before = names(place.path());
    let ran = firstbounce(place.path(), ["solve", "tiny", "--bounces", "2"]);
    let line = ran.failure();
    for word in words {
        assert!(line.contains(word), "no \"{word}\" in: {line}");
    }
    assert_eq!(names(place.path()), before, "nothing is written: {line}");
}

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

/// Replaces text in the set's file.
fn edit(set: &Path, from: &str, to: &str) {
    let path = set.join("capture.toml");
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.contains(from), "{from}");
    fs::write(path, text.replacen(from, to, 1)).unwrap();
}

#[test]
fn a_missing_photo() {
    refused(|set| fs::remove_file(set.join("object/left-blue.png")).unwrap(), &["object/left-blue.png"]);
}

#[test]
fn a_truncated_photo() {
    let cut = |set: &Path| {
        let path = set.join("object/top-blue.png");
        let bytes = fs::read(&path).unwrap();
        fs::write(&path, &bytes[..bytes.len() / 2]).unwrap();
    };
    refused(cut, &["object/top-blue.png"]);
}

#[test]
fn a_text_that_is_named_like_a_photo() {
    refused(|set| fs::write(set.join("object/top-blue.png"), "no picture").unwrap(), &["top-blue.png", "not an image"]);
}

#[test]
fn a_photo_of_another_size() {
    let small = |set: &Path| {
        image::ImageBuffer::from_pixel(50, 40, image::Luma([9000u16])).save(set.join("object/top-blue.png")).unwrap();
    };
    refused(small, &["object/top-blue.png", "50 x 40", "96 x 96"]);
}

#[test]
fn a_light_with_a_colour_missing() {
    let shot =
        "[[shot]]\nsubject = \"object\"\nlight = \"top\"\ncolour = \"green\"\nfiles = [\"object/top-green.png\"]\n";
    refused(|set| edit(set, shot, ""), &["top", "green"]);
}

#[test]
fn a_shot_that_is_there_twice() {
    let shot =
        "[[shot]]\nsubject = \"object\"\nlight = \"top\"\ncolour = \"green\"\nfiles = [\"object/top-green.png\"]\n";
    refused(|set| edit(set, shot, &format!("{shot}\n{shot}")), &["capture.toml:", "top", "green"]);
}

#[test]
fn an_unknown_key_and_a_wrong_type_name_their_line() {
    refused(|set| edit(set, "mm_per_pixel", "mm_per_pixl"), &["capture.toml:7", "mm_per_pixl", "mm_per_pixel"]);
    refused(|set| edit(set, "mm_per_pixel = 0.5", "mm_per_pixel = \"half\""), &["capture.toml:7", "half", "number"]);
}

#[test]
fn more_bounces_than_colours() {
    let place = tempfile::tempdir().unwrap();
    tiny_set::write(place.path());
    let ran = firstbounce(place.path(), ["solve", "tiny", "--bounces", "3"]);
    assert!(ran.failure().contains('3'), "{}", ran.err);
    assert_eq!(names(place.path()), ["tiny"]);
}

#[test]
fn colours_that_see_the_paint_alike() {
    refused(|set| edit(set, "[camera]", "[calibration]\nbeta = [1.0, 0.985]\n\n[camera]"), &["beta", "blue", "green"]);
    // The same, measured: the ball of the paint looks like the grey ball.
    let alike = |set: &Path| {
        for light in ["left", "top", "right"] {
            for colour in ["blue", "green"] {
                let file = format!("{light}-{colour}.png");
                fs::copy(set.join("grey-sphere").join(&file), set.join("material-sphere").join(&file)).unwrap();
            }
        }
    };
    refused(alike, &["beta", "blue", "green"]);
}

#[test]
fn lights_in_a_plane_still_give_direct_light() {
    let place = tempfile::tempdir().unwrap();
    let set = tiny_set::write(place.path());
    for (light, x) in [("left", -0.3), ("top", 0.0), ("right", 0.3)] {
        let name = format!("[[light]]\nname = \"{light}\"\n");
        edit(&set, &name, &format!("{name}direction = [{x:.1}, 0.0, 1.0]\n"));
    }
    let ran = firstbounce(place.path(), ["solve", "tiny"]);
    assert!(ran.failure().contains("in a plane"), "{}", ran.err);
    assert!(place.path().join("out/tiny/separated-left.exr").is_file());
}

#[test]
fn an_empty_mask_and_one_of_another_size() {
    let masked = |width: u32, value: u8| {
        move |set: &Path| {
            image::ImageBuffer::from_pixel(width, 96, image::Luma([value])).save(set.join("mask.png")).unwrap();
            edit(set, "name = \"Tiny dome\"", "name = \"Tiny dome\"\nmask = \"mask.png\"");
        }
    };
    refused(masked(96, 0), &["mask.png", "empty"]);
    refused(masked(95, 255), &["mask.png", "95 x 96"]);
}

/// One pixel does not spoil a photo: it is left out, and the file is named with their count.
#[test]
fn pixels_that_are_no_light() {
    for bad in [f32::NAN, -0.25, f32::INFINITY] {
        let place = tempfile::tempdir().unwrap();
        let set = tiny_set::write(place.path());
        let photo = image::open(set.join("object/left-blue.png")).unwrap().into_luma16();
        let mut bytes = b"Pf\n96 96\n-1.0\n".to_vec();
        // Rows from the bottom up.
        for y in (0..96).rev() {
            for x in 0..96 {
                let light = f32::from(photo.get_pixel(x, y).0[0]) / 65535.0;
                bytes.extend(if (x, y) == (40, 50) { bad } else { light }.to_le_bytes());
            }
        }
        fs::write(set.join("object/left-blue.pfm"), bytes).unwrap();
        edit(&set, "object/left-blue.png", "object/left-blue.pfm");
        let report = firstbounce(place.path(), ["solve".as_ref(), set.as_os_str(), "--json".as_ref()]).json();
        let named = |warning: &&serde_json::Value| {
            ["object/left-blue.pfm", "are NaN, infinite or negative"]
                .iter()
                .all(|words| warning.to_string().contains(words))
        };
        assert_eq!(
            report["warnings"].as_array().unwrap().iter().filter(named).count(),
            1,
            "{bad}: {}",
            report["warnings"]
        );
    }
}

#[test]
fn a_ball_that_cannot_be_found() {
    let spoil = |set: &Path| {
        for light in ["left", "top", "right"] {
            for colour in ["blue", "green"] {
                tiny_set::save_png(&set.join(format!("grey-sphere/{light}-{colour}.png")), |x, _| 0.2 + x / 500.0);
            }
        }
        edit(set, "[[sphere]]\nsubject = \"grey-sphere\"\ncentre = [48, 48]\nradius = 40\n", "");
    };
    refused(spoil, &["grey-sphere", "no ball found"]);
}

#[test]
fn a_clipped_ball() {
    let spoil = |set: &Path| tiny_set::save_png(&set.join("grey-sphere/left-blue.png"), |_, _| 1.0);
    refused(spoil, &["left", "clipped", "exposure"]);
}

#[test]
fn an_output_folder_that_is_a_file() {
    let place = tempfile::tempdir().unwrap();
    tiny_set::write(place.path());
    fs::write(place.path().join("results"), "a file").unwrap();
    let ran = firstbounce(place.path(), ["solve", "tiny", "--out", "results"]);
    assert!(ran.failure().contains("results"), "{}", ran.err);
    assert_eq!(fs::read_to_string(place.path().join("results")).unwrap(), "a file");
}

#[test]
fn a_folder_that_is_no_set() {
    let place = tempfile::tempdir().unwrap();
    let ran = firstbounce(place.path(), ["solve", "."]);
    assert!(ran.failure().contains("no capture.toml"), "{}", ran.err);
}

#[test]
fn a_set_without_truth_cannot_be_evaluated() {
    let place = tempfile::tempdir().unwrap();
    tiny_set::write(place.path());
    let ran = firstbounce(place.path(), ["evaluate", "tiny"]);
    assert!(ran.failure().contains("no true normals"), "{}", ran.err);
}
