//! A picture that someone damaged, or made to do harm: one line, or a result, soon and in little memory.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use firstbounce_capture::image_file::{Content, ReadOptions, read_image_as};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use crate::run::{Ran, firstbounce, firstbounce_within};
use crate::{codecs, tiny_set};

/// What a run may map on the way to its one line; a decoder's own process may as well.
const MAX_MIB: u64 = 1024;

/// Puts a picture in place of a photo and of the mask of a fresh set, and runs every command that reads it.
fn shown_everywhere(name: &str, picture: &[u8]) {
    for place_of in ["object/left-blue", "mask"] {
        let place = tempfile::tempdir().unwrap();
        let set = tiny_set::write(place.path());
        let file = format!("{place_of}-{name}");
        fs::write(set.join(&file), picture).unwrap();
        let toml = fs::read_to_string(set.join("capture.toml")).unwrap();
        let toml = match place_of {
            "mask" => toml.replacen("name = \"Tiny dome\"", &format!("name = \"Tiny dome\"\nmask = \"{file}\""), 1),
            _ => toml.replacen("object/left-blue.png", &file, 1),
        };
        fs::write(set.join("capture.toml"), toml).unwrap();
        for command in ["info", "calibrate", "solve"] {
            let begun = Instant::now();
            let ran = firstbounce_within(place.path(), MAX_MIB, [command, "tiny"]);
            one_line_or_a_result(&ran);
            assert!(
                begun.elapsed() < Duration::from_secs(5),
                "{name} as {place_of}: {command} took {:?}",
                begun.elapsed()
            );
        }
    }
}

fn one_line_or_a_result(ran: &Ran) {
    if ran.code != 0 {
        ran.failure();
    }
}

#[test]
fn sizes_that_cannot_be_are_refused_with_one_line() {
    for (name, picture) in codecs::damaged() {
        shown_everywhere(name, &picture);
    }
}

#[test]
fn the_damaged_pictures_beside_the_project_are_refused_with_one_line() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/cases/damaged");
    let Ok(entries) = fs::read_dir(&folder) else {
        eprintln!("skipped: no ../shared/cases/damaged");
        return;
    };
    for path in entries.map(|entry| entry.unwrap().path()) {
        let name = path.file_name().unwrap().to_string_lossy();
        if [".exr", ".tif", ".png"].iter().any(|extension| name.ends_with(extension)) {
            shown_everywhere(&name, &fs::read(&path).unwrap());
        }
    }
}

#[test]
fn a_decoder_in_a_process_of_its_own_gives_the_same_picture() {
    for name in ["lines-piz.exr", "tiles-dwaa.exr", "lines-dwab.exr", "jpeg.tif", "fax.tif"] {
        let (_, picture) = codecs::one_of_each_codec().into_iter().find(|(known, _)| known == name).unwrap();
        let place = tempfile::tempdir().unwrap();
        let path = place.path().join(name);
        fs::write(&path, picture).unwrap();
        let here = read_image_as(&path, &ReadOptions { content: Content::Data, layer: None }).unwrap();
        let output = std::process::Command::new(env!("CARGO_BIN_EXE_firstbounce"))
            .args(["decode-picture", "1000000000", "5"])
            .stdin(fs::File::open(&path).unwrap())
            .output()
            .unwrap();
        assert!(output.status.success() && output.stderr.is_empty(), "{name}: {output:?}");
        let samples = here.channels.iter().flat_map(|(_, plane)| plane.data().to_vec());
        let bytes = samples.flat_map(f32::to_le_bytes).collect::<Vec<_>>();
        assert!(output.stdout.ends_with(&bytes), "{name}");
    }
}

#[test]
fn a_picture_that_is_decoded_apart_is_measured_like_any_other() {
    for name in ["lines-piz.exr", "tiles-piz.exr", "jpeg.tif"] {
        let (_, picture) = codecs::one_of_each_codec().into_iter().find(|(known, _)| known == name).unwrap();
        let place = tempfile::tempdir().unwrap();
        let set = tiny_set::write(place.path());
        fs::write(set.join(name), picture).unwrap();
        let toml = fs::read_to_string(set.join("capture.toml")).unwrap();
        fs::write(set.join("capture.toml"), toml.replacen("object/left-blue.png", name, 1)).unwrap();
        let ran = firstbounce_within(place.path(), MAX_MIB, ["solve", "tiny"]);
        assert!(ran.failure().contains("37 x 22"), "{}", ran.err);
    }
}

#[test]
fn a_decoder_stays_within_its_memory() {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("large.pfm");
    let mut picture = b"Pf\n4000 4000\n-1.0\n".to_vec();
    picture.resize(picture.len() + 4 * 4000 * 4000, 0);
    fs::write(&path, picture).unwrap();
    let ends = |memory_bytes: &str| {
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_firstbounce"));
        command.args(["decode-picture", memory_bytes, "60"]).stdin(fs::File::open(&path).unwrap());
        command.output().unwrap().status.success()
    };
    assert!(ends("4000000000"));
    assert!(!cfg!(target_os = "linux") || !ends("100000000"));
}

#[test]
fn the_decoder_is_not_among_the_commands() {
    let ran = firstbounce(Path::new("."), ["--help"]);
    assert!(ran.out.contains("solve") && !ran.out.contains("decode-picture"), "{}", ran.out);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, rng_seed: RngSeed::Fixed(10), ..ProptestConfig::default() })]

    #[test]
    fn bytes_changed_in_any_compression_end_in_one_line_or_a_result(
        seed in any::<prop::sample::Index>(),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 1..9_usize), 1..5),
    ) {
        let files = codecs::one_of_each_codec();
        let (name, mut picture) = files[seed.index(files.len())].clone();
        for (at, byte, count) in changes {
            let at = at.index(picture.len());
            let end = picture.len().min(at + count);
            picture[at..end].fill(byte);
        }
        let place = tempfile::tempdir().unwrap();
        let set = tiny_set::write(place.path());
        fs::write(set.join(&name), picture).unwrap();
        let toml = fs::read_to_string(set.join("capture.toml")).unwrap();
        fs::write(set.join("capture.toml"), toml.replacen("object/left-blue.png", &name, 1)).unwrap();
        one_line_or_a_result(&firstbounce_within(place.path(), MAX_MIB, ["info", "tiny"]));
    }
}
