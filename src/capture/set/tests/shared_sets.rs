//! The sets that come with the project's data, where they are at hand.

use firstbounce_testing::shared_set;

use crate::set::{CaptureSet, Channel, Projection, Subject, write_calibration};

/// Colours, lights, shots and circles of each.
const SETS: [(&str, [usize; 4]); 5] = [
    ("birdbath-dslr", [2, 3, 21, 3]),
    ("bowl-four", [4, 3, 39, 3]),
    ("corner-blue", [2, 3, 21, 3]),
    ("groove-rgb", [3, 4, 40, 3]),
    ("psbox-cat", [1, 12, 24, 0]),
];

#[test]
fn every_shared_set_is_read_whole() {
    for (name, counts) in SETS {
        let Some(folder) = shared_set(name) else { continue };
        let set = CaptureSet::open(&folder).unwrap();
        assert_eq!(set, CaptureSet::open(set.file_path()).unwrap());
        assert_eq!([set.colours.len(), set.lights.len(), set.shots.len(), set.spheres.len()], counts, "{name}");
        for file in set.distinct_files().keys() {
            assert!(set.resolve(file).is_file(), "{name}: {file}");
        }
        for (light, bounce) in set.lights.iter().zip(1..=2) {
            assert!(name == "psbox-cat" || set.truth_bounce(bounce, &light.name).is_file(), "{name}");
        }
        let text = std::fs::read_to_string(set.file_path()).unwrap();
        assert_eq!(write_calibration(&text, &set.calibration, &set.spheres).unwrap(), text);
        match name {
            "birdbath-dslr" => assert!(matches!(set.camera.projection, Projection::Perspective { .. })),
            "groove-rgb" => {
                assert_eq!(set.distinct_files().len(), 16);
                let blue = set.shot(Subject::Object, Some("east"), Some("blue")).unwrap();
                assert_eq!(set.channel_of(blue), Channel::B);
            }
            "psbox-cat" => assert_eq!(set.bounces(), 1),
            _ => assert_eq!(set.bounces(), 2),
        }
    }
}
