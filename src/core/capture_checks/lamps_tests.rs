//! Lamps of a shell whose directions are known, given with the usual mistakes.

use nalgebra::Vector3;

use super::{LampFault, LampOptions, LampPhoto, Mistake, SmallPhoto, judge_lamps};
use crate::{Mask, Photo, Plane, Unwatched};

const SIZE: usize = 128;

/// A shell under a lamp, curved more along one axis than along the other, and along neither of x and y.
fn photo(lamp: Vector3<f64>) -> SmallPhoto {
    let light = Plane::from_fn(SIZE, SIZE, |x, y| {
        let (u, v) = (x as f64 / 64.0 - 1.0, 1.0 - y as f64 / 64.0);
        let normal = Vector3::new(0.9 * u + 0.4 * v, 0.3 * v + 0.4 * u, 1.0).normalize();
        (0.5 * lamp.dot(&normal)).max(0.0) as f32
    });
    SmallPhoto::of(&Photo::unmarked(light), Some(&Mask::filled(SIZE, SIZE, true))).unwrap()
}

/// Lamps around the camera, not evenly, so that no order of them looks like another.
fn ring(count: usize) -> Vec<Vector3<f64>> {
    let lamp = |l: usize| {
        let azimuth = (l as f64 + 0.07 * (l * l) as f64) * std::f64::consts::TAU / count as f64 + 0.4;
        Vector3::new(0.4 * azimuth.cos(), 0.4 * azimuth.sin(), 0.9).normalize()
    };
    (0..count).map(lamp).collect()
}

fn judged(lamps: &[Vector3<f64>], given: &[Vector3<f64>]) -> Vec<LampFault> {
    let photos: Vec<_> = lamps.iter().map(|lamp| photo(*lamp)).collect();
    let lamps: Vec<_> = photos.iter().zip(given).map(|(photo, toward)| LampPhoto { photo, toward: *toward }).collect();
    judge_lamps(&lamps, true, &LampOptions::default(), &Unwatched).unwrap()
}

fn mistakes(faults: &[LampFault]) -> Vec<Mistake> {
    match faults {
        [LampFault::Mistaken { like, .. }] => like.clone(),
        _ => Vec::new(),
    }
}

#[test]
fn lamps_that_belong_to_their_photos_have_no_fault() {
    for count in [3, 4, 7] {
        assert_eq!(judged(&ring(count), &ring(count)), [], "{count} lamps");
    }
}

#[test]
fn directions_of_another_frame_are_found_and_named() {
    let turn = |mistake: Mistake, v: &Vector3<f64>| match mistake {
        Mistake::Flipped => Vector3::new(-v.x, v.y, v.z),
        Mistake::Swapped => Vector3::new(v.y, v.x, v.z),
        _ => Vector3::new(v.y, -v.x, v.z),
    };
    for count in [3, 5] {
        for mistake in [Mistake::Flipped, Mistake::Swapped, Mistake::SwappedAndFlipped] {
            let given: Vec<_> = ring(count).iter().map(|lamp| turn(mistake, lamp)).collect();
            let found = judged(&ring(count), &given);
            assert!(mistakes(&found).contains(&mistake), "{count} lamps, {mistake:?}: {found:?}");
        }
    }
}

#[test]
fn directions_in_the_rows_of_others_are_found_and_named() {
    for count in [3, 4, 6] {
        let mut given = ring(count);
        given.rotate_right(1);
        let found = judged(&ring(count), &given);
        assert!(mistakes(&found).contains(&Mistake::Shifted), "{count} lamps: {found:?}");
        let mut given = ring(count);
        given.swap(0, 2);
        let found = judged(&ring(count), &given);
        assert!(mistakes(&found).contains(&Mistake::Exchanged(0, 2)), "{count} lamps: {found:?}");
    }
}

#[test]
fn one_lamp_photographed_twice_is_found() {
    for count in [3, 6] {
        let mut lamps = ring(count);
        lamps[1] = lamps[0];
        let found = judged(&lamps, &ring(count));
        assert!(matches!(found[..], [LampFault::Doubled { lamps: [0, 1], .. }]), "{count} lamps: {found:?}");
    }
}

#[test]
fn a_lamp_that_stood_elsewhere_is_named() {
    let mut lamps = ring(6);
    lamps[4] = Vector3::new(0.1, 0.75, 0.65).normalize();
    let found = judged(&lamps, &ring(6));
    assert_eq!(mistakes(&found), [Mistake::Odd(4)], "{found:?}");
}

#[test]
fn intensities_that_are_not_known_are_no_fault() {
    let photos: Vec<_> = ring(6).iter().enumerate().map(|(l, lamp)| photo(*lamp * (1.0 + 0.2 * l as f64))).collect();
    let given = ring(6);
    let lamps: Vec<_> = photos.iter().zip(&given).map(|(photo, toward)| LampPhoto { photo, toward: *toward }).collect();
    assert_eq!(judge_lamps(&lamps, false, &LampOptions::default(), &Unwatched).unwrap(), []);
}
