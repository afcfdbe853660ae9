//! Whatever the bytes: an image or an error, never a panic, and an error is one line that names the file.

use std::path::Path;

use firstbounce_capture::image_file::{ReadOptions, layer_names, read_image, read_image_as};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

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
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, rng_seed: RngSeed::Fixed(2011), ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_behind_a_magic(magic in 0..MAGICS.len(), rest in prop::collection::vec(any::<u8>(), 0..400)) {
        let folder = Folder::new();
        reads_or_says_why(&folder.file("hostile", &[MAGICS[magic], &rest].concat()));
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
}
