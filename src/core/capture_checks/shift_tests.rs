//! Photos of a painted dome that were moved by known shifts.

use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;

use super::shift::pair_shifts;
use super::{EdgeWindow, Moved, ShiftOptions, find_moved, pair_shift};
use crate::{Plane, Unwatched};

const SIZE: usize = 160;

/// A painted dome in front of black under a lamp from one side, moved by some pixels, with noise of its own.
fn photo(lamp: [f64; 3], shift_px: [f64; 2], seed: u64) -> Plane {
    let mut random = StdRng::seed_from_u64(seed);
    Plane::from_fn(SIZE, SIZE, |x, y| {
        let (x, y) = (x as f64 - shift_px[0], y as f64 - shift_px[1]);
        let (u, v) = ((x - 80.0) / 60.0, (y - 80.0) / 60.0);
        let height = 1.0 - u * u - v * v;
        let paint = if ((x / 17.0).floor() + (y / 23.0).floor()) as i64 % 2 == 0 { 0.7 } else { 0.4 };
        let shading = (lamp[0] * u + lamp[1] * v + lamp[2] * height.max(0.0).sqrt()).max(0.0);
        let light = if height > 0.0 { paint * shading } else { 0.0 };
        (light + 0.01 * random.sample::<f64, _>(StandardNormal)) as f32
    })
}

const LAMPS: [[f64; 3]; 4] = [[-0.6, 0.0, 0.8], [0.6, 0.0, 0.8], [0.0, -0.6, 0.8], [0.0, 0.6, 0.8]];

fn moved(shifts: [[f64; 2]; 4]) -> Vec<Moved> {
    let window = EdgeWindow::new((SIZE, SIZE), None).unwrap();
    let photo = |l: usize| window.spectrum(&photo(LAMPS[l], shifts[l], l as u64));
    find_moved(&[0, 1, 2, 3].map(photo), &ShiftOptions::default(), &Unwatched).unwrap()
}

#[test]
fn shading_of_other_lamps_is_no_shift() {
    assert_eq!(moved([[0.0; 2]; 4]), []);
}

#[test]
fn the_lamp_whose_photos_moved_is_found_and_how_far() {
    for shift in [[2.0, 0.0], [-3.4, 2.2], [8.0, -5.0]] {
        let mut shifts = [[0.0; 2]; 4];
        shifts[2] = shift;
        let found = moved(shifts);
        assert_eq!(found.len(), 1, "{shift:?}: {found:?}");
        assert_eq!(found[0].photo, 2);
        let miss = length([0, 1].map(|axis| found[0].shift_px[axis] - shift[axis]));
        assert!(miss < 0.5, "{shift:?}: {found:?}");
    }
}

#[test]
fn photos_of_other_things_have_no_shift_beyond_half_the_picture() {
    let window = EdgeWindow::new((SIZE, SIZE), None).unwrap();
    for seed in 0..12 {
        let mut random = StdRng::seed_from_u64(seed);
        let mut noise = || window.spectrum(&Plane::from_fn(SIZE, SIZE, |_, _| random.random::<f32>())).unwrap();
        let [x, y] = pair_shift(&noise(), &noise()).unwrap().shift_px;
        assert!(x.abs() <= SIZE as f64 / 2.0 + 1.0 && y.abs() <= SIZE as f64 / 2.0 + 1.0, "{x}, {y}");
    }
    // Wide pictures lie on a square grid that is larger than they are high.
    let wide = EdgeWindow::new((SIZE, 40), None).unwrap();
    for seed in 0..12 {
        let mut random = StdRng::seed_from_u64(seed);
        let mut noise = || wide.spectrum(&Plane::from_fn(SIZE, 40, |_, _| random.random::<f32>())).unwrap();
        assert!(pair_shift(&noise(), &noise()).unwrap().shift_px[1].abs() <= 21.0);
    }
}

#[test]
fn two_pairs_by_one_transform_are_what_each_is_alone() {
    let window = EdgeWindow::new((SIZE, SIZE), None).unwrap();
    let shifts = [[0.0; 2], [3.0, -2.0], [-6.4, 1.2]];
    let [a, b, c] = [0, 1, 2].map(|l| window.spectrum(&photo(LAMPS[0], shifts[l], l as u64)).unwrap());
    for (together, alone) in
        pair_shifts(&[(&a, &b), (&c, &a)]).into_iter().zip([pair_shift(&a, &b), pair_shift(&c, &a)])
    {
        let (together, alone) = (together.unwrap(), alone.unwrap());
        let off = [0, 1].map(|axis| together.shift_px[axis] - alone.shift_px[axis]);
        assert!(length(off) < 1e-3 && (together.strength - alone.strength).abs() < 1e-2, "{together:?}, {alone:?}");
    }
}

#[test]
fn a_camera_that_was_bumped_halfway_moves_the_later_photos() {
    let found = moved([[0.0; 2], [0.0; 2], [5.0, 1.0], [5.0, 1.0]]);
    assert_eq!(found.iter().map(|moved| moved.photo).collect::<Vec<_>>(), [2, 3]);
}

fn length([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}
