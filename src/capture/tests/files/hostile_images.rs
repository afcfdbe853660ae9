//! Whatever the bytes: an image or an error, never a panic, and an error is one line that names the file.

use std::path::Path;
use std::sync::LazyLock;
use std::time::{Duration, Instant};

use firstbounce_capture::image_file::{
    Content, ExrLayer, ImageError, ReadOptions, layer_names, picture_size, read_image, read_image_as, write_exr,
};
use proptest::prelude::*;
use proptest::sample::select;
use proptest::test_runner::RngSeed;

use crate::codecs;
use crate::pictures::{Folder, one_of_each};

const MAGICS: [&[u8]; 8] = [
    b"\x89PNG\r\n\x1a\n",
    b"II*\0",
    b"MM\0*",
    b"II+\0",
    b"\x76\x2f\x31\x01",
    b"\xff\xd8\xff",
    b"#?RADIANCE\n",
    b"PF\n",
];

/// Sizes of several lengths, in both byte orders.
const SIZES: [&[u8]; 9] = [
    &[0],
    &[0xff],
    &[0, 0],
    &[0xff, 0xff],
    &[0xff, 0xff, 0xff, 0x7f],
    &[0x7f, 0xff, 0xff, 0xff],
    &[0, 0, 0, 0x10],
    &[0xff; 8],
    &[0, 0, 0, 0, 0, 0, 0x10, 0],
];

/// Sound files of all formats in all compressions.
fn every_kind() -> &'static [(String, Vec<u8>)] {
    static FILES: LazyLock<Vec<(String, Vec<u8>)>> = LazyLock::new(|| {
        let formats = one_of_each().into_iter().map(|(name, bytes)| (name.to_owned(), bytes));
        formats.chain(codecs::one_of_each_codec()).collect()
    });
    &FILES
}

fn reads_or_says_why(path: &Path) {
    let layer = ReadOptions { layer: Some("bounce 2".into()), ..ReadOptions::default() };
    for read in [read_image(path), read_image_as(path, &layer)] {
        match read {
            Ok(image) => assert!(image.channels.iter().all(|(_, plane)| plane.size() == image.size())),
            Err(error) => {
                let text = error.to_string();
                assert!(!text.contains('\n') && text.starts_with(&path.display().to_string()), "{text}");
            }
        }
    }
    let _ = layer_names(path);
    let _ = picture_size(path);
}

/// The most memory that this process ever held.
#[cfg(target_os = "linux")]
fn peak_mib() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let peak = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).unwrap();
    peak.trim().trim_end_matches(" kB").parse::<u64>().unwrap() >> 10
}

#[test]
fn sizes_that_cannot_be_are_errors_and_take_neither_memory_nor_time() {
    let folder = Folder::new();
    for (name, bytes) in codecs::damaged() {
        let path = folder.file(name, &bytes);
        let begun = Instant::now();
        assert!(read_image(&path).is_err(), "{name}");
        reads_or_says_why(&path);
        assert!(begun.elapsed() < Duration::from_secs(5), "{name}");
        #[cfg(target_os = "linux")]
        assert!(peak_mib() < 1024, "{name}: {} MiB", peak_mib());
    }
}

#[test]
fn a_name_inside_a_file_does_not_break_the_line() {
    let folder = Folder::new();
    let plane = firstbounce_core::Plane::filled(2, 2, 0.5);
    let layer = |name| ExrLayer { name, channels: vec![("Y", &plane)] };
    let path = folder.path("names.exr");
    write_exr(&path, &[layer("two\nlines"), layer("\u{1b}[31mred")]).unwrap();
    let text = read_image(&path).unwrap_err().to_string();
    assert!(text.contains("two\\nlines") && !text.contains(char::is_control), "{text}");
}

#[test]
fn every_compression_is_read() {
    let folder = Folder::new();
    for (name, bytes) in codecs::one_of_each_codec() {
        let path = folder.file(&name, &bytes);
        let data = ReadOptions { content: Content::Data, layer: None };
        match read_image_as(&path, &data) {
            Ok(image) => assert_eq!((image.size(), picture_size(&path).unwrap().width), ((37, 22), 37), "{name}"),
            // Any bytes may be a NaN.
            Err(error) => assert!(matches!(error, ImageError::BadPixels { .. }), "{error}"),
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, rng_seed: RngSeed::Fixed(2011), ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_behind_a_magic(magic in 0..MAGICS.len(), rest in prop::collection::vec(any::<u8>(), 0..400)) {
        let folder = Folder::new();
        reads_or_says_why(&folder.file("hostile", [MAGICS[magic], &rest].concat()));
    }

    #[test]
    fn truncated_files(kept in 0.0..1.0_f64) {
        let folder = Folder::new();
        for (name, bytes) in one_of_each() {
            reads_or_says_why(&folder.file(name, &bytes[..(bytes.len() as f64 * kept) as usize]));
        }
    }

    #[test]
    fn flipped_bits(flips in prop::collection::vec((any::<prop::sample::Index>(), 0..8), 1..6), in_header in any::<bool>()) {
        let folder = Folder::new();
        for (name, mut bytes) in one_of_each() {
            let reach = if in_header { bytes.len().min(200) } else { bytes.len() };
            for (place, bit) in &flips {
                bytes[place.index(reach)] ^= 1_u8 << bit;
            }
            reads_or_says_why(&folder.file(name, &bytes));
        }
    }

    #[test]
    fn sizes_changed_in_every_compression(
        changes in prop::collection::vec((any::<prop::sample::Index>(), select(SIZES.as_slice())), 1..4), seed in any::<prop::sample::Index>()
    ) {
        let folder = Folder::new();
        let files = every_kind();
        let (name, bytes) = &files[seed.index(files.len())];
        let mut bytes = bytes.clone();
        for (place, size) in &changes {
            let place = place.index(bytes.len());
            let end = bytes.len().min(place + size.len());
            bytes[place..end].copy_from_slice(&size[..end - place]);
        }
        reads_or_says_why(&folder.file(name, &bytes));
    }
}
