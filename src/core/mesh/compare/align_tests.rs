//! Alignment on surfaces whose true motion is known.

use nalgebra::{Isometry3, Point3, Vector3, vector};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::test_meshes::{bumps, cut, relief, with_noise};
use super::*;
use crate::{Unwatched, Watch};

/// A turn by `degrees` about `axis` through the middle of the object, then a shift.
fn motion(axis: [f64; 3], degrees: f64, shift_mm: [f64; 3]) -> Isometry3<f64> {
    Isometry3::new(Vector3::from(shift_mm), Vector3::from(axis).normalize() * degrees.to_radians())
}

/// Ten degrees and five millimetres.
fn ten_and_five() -> Isometry3<f64> {
    motion([1.0, 2.0, -0.7], 10.0, [3.0, -2.6, 3.04])
}

/// The largest displacement of a vertex that `found` leaves after `made`, and the turn, in mm and degrees.
fn left_over(mesh: &Mesh, made: &Isometry3<f64>, found: &Isometry3<f64>) -> (f64, f64) {
    let rest = found * made;
    let displacement = |p: &Point3<f32>| (rest * p.cast::<f64>() - p.cast::<f64>()).norm();
    (mesh.positions.iter().map(displacement).fold(0.0, f64::max), rest.rotation.angle().to_degrees())
}

#[test]
fn a_copy_moved_by_ten_degrees_and_five_mm_comes_back() {
    let fixed = relief(160, 0.5, bumps);
    let made = ten_and_five();
    let moving = fixed.clone().moved(&made);
    let found = align(&moving, &fixed, &AlignOptions::default(), &Unwatched).unwrap();
    let (mm, degrees) = left_over(&fixed, &made, &found.moving_to_fixed);
    println!("moved copy: {mm:.6} mm, {degrees:.6} degrees, {} iterations", found.iterations.len());
    assert!(mm < 0.01 && degrees < 0.01, "{mm} mm, {degrees} degrees");
    assert!(found.converged && !found.searched && found.free.is_empty(), "{found:?}");

    let measured = distances(&moving, &fixed, &found.moving_to_fixed, &DistanceOptions::default(), &Unwatched).unwrap();
    assert!(measured.max_mm < 0.01 && measured.orientation_error_deg < 0.1, "{measured:?}");
    assert!((measured.rotation_deg - 10.0).abs() < 0.01);
    assert!((measured.translation_mm - made.inverse().translation.vector).norm() < 0.01);
    assert!(measured.overlap > 0.99);
}

#[test]
fn the_same_surface_in_other_triangles_comes_back() {
    let fixed = relief(160, 0.5, bumps);
    let made = ten_and_five();
    let found = align(&relief(170, 0.37, bumps).moved(&made), &fixed, &AlignOptions::default(), &Unwatched).unwrap();
    let (mm, degrees) = left_over(&fixed, &made, &found.moving_to_fixed);
    println!("other triangles: {mm:.6} mm, {degrees:.6} degrees");
    assert!(mm < 0.01 && degrees < 0.01, "{mm} mm, {degrees} degrees");
}

#[test]
fn a_noisy_copy_with_a_third_cut_away_comes_back() {
    let fixed = relief(160, 0.5, bumps);
    let made = ten_and_five();
    // The cut takes away 30 % of the copy; in turn the reference lacks a corner that the copy has.
    let copy = cut(with_noise(fixed.clone().moved(&made), 0.05, 7), |p| p.x < 16.0);
    let reference = cut(with_noise(fixed.clone(), 0.05, 8), |p| p.x + p.y > -50.0);
    let found = align(&copy, &reference, &AlignOptions::default(), &Unwatched).unwrap();
    let (mm, degrees) = left_over(&fixed, &made, &found.moving_to_fixed);
    println!("noisy cut copy: {mm:.4} mm, {degrees:.4} degrees, rms {:.4} mm", found.rms_mm);
    assert!(mm < 0.05, "{mm} mm, {degrees} degrees");
    assert!(found.overlap > 0.8 && found.overlap < 0.99, "{}", found.overlap);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, rng_seed: RngSeed::Fixed(1), ..ProptestConfig::default() })]
    #[test]
    fn any_ten_degrees_and_five_mm_come_back(
        axis in prop::array::uniform3(-1.0..1.0f64), shift in prop::array::uniform3(-1.0..1.0f64),
    ) {
        prop_assume!(Vector3::from(axis).norm() > 0.1 && Vector3::from(shift).norm() > 0.1);
        let shift_mm: [f64; 3] = (Vector3::from(shift).normalize() * 5.0).into();
        let fixed = relief(100, 0.8, bumps);
        let made = motion(axis, 10.0, shift_mm);
        let found = align(&fixed.clone().moved(&made), &fixed, &AlignOptions::default(), &Unwatched).unwrap();
        let (mm, degrees) = left_over(&fixed, &made, &found.moving_to_fixed);
        prop_assert!(!found.searched && mm < 0.01 && degrees < 0.01, "{} mm, {} degrees", mm, degrees);
    }
}

#[test]
fn a_large_turn_is_found_by_search_and_by_picked_pairs() {
    let fixed = relief(120, 0.7, bumps);
    let made = motion([0.2, 0.3, 1.0], 45.0, [30.0, -80.0, 400.0]);
    let moving = fixed.clone().moved(&made);
    let found = align(&moving, &fixed, &AlignOptions::default(), &Unwatched).unwrap();
    let (mm, _) = left_over(&fixed, &made, &found.moving_to_fixed);
    assert!(found.searched && mm < 0.01, "{mm} mm");

    let picks = [10usize, 110, 121 * 100 + 40].map(|vertex| {
        let pick = fixed.positions[vertex].cast::<f64>();
        // A hand misses by a millimetre or two.
        (made * pick + vector![1.0, -1.0, 0.5], pick)
    });
    let options = AlignOptions { start: Start::Pairs(picks.to_vec()), search: false, ..AlignOptions::default() };
    let found = align(&moving, &fixed, &options, &Unwatched).unwrap();
    let (mm, _) = left_over(&fixed, &made, &found.moving_to_fixed);
    assert!(!found.searched && mm < 0.01, "{mm} mm");
}

/// The bumps as this program finds them: off by half a millimetre, slowly.
fn measured(x: f64, y: f64) -> f64 {
    bumps(x, y) + 0.5 * (x / 15.0 + y / 21.0).sin()
}

#[test]
fn a_scan_in_its_own_frame_is_found_however_far_and_however_turned() {
    let fixed = relief(100, 0.8, bumps);
    let surface = relief(110, 0.7, measured);
    let there = align(&surface, &fixed, &AlignOptions::default(), &Unwatched).unwrap();
    assert!(!there.searched && !there.is_poor() && there.ambiguous.is_none(), "{there:?}");
    let motions = [
        motion([0.0, 0.0, 1.0], 0.0, [300.0, 0.0, 0.0]),
        motion([0.0, 0.0, 1.0], 180.0, [0.0; 3]),
        motion([0.0, 1.0, 0.0], 180.0, [10.0, -5.0, 40.0]),
        motion([1.0, 0.0, 0.0], 90.0, [0.0, 100.0, 0.0]),
        motion([0.3, -0.8, 0.5], 137.0, [-40.0, 900.0, 60.0]),
    ];
    for made in motions {
        let found = align(&surface.clone().moved(&made), &fixed, &AlignOptions::default(), &Unwatched).unwrap();
        let (mm, degrees) = left_over(&surface, &made, &(there.moving_to_fixed.inverse() * found.moving_to_fixed));
        assert!(mm < 0.1 && degrees < 0.1, "{made}: {mm} mm, {degrees} degrees");
        assert!(!found.is_poor() && found.ambiguous.is_none(), "{made}");
    }
}

#[test]
fn a_fit_that_is_as_good_under_another_turn_is_reported() {
    let pyramid = relief(80, 0.5, |x, y| -(x.abs() + y.abs()));
    let turned = pyramid.clone().moved(&motion([0.0, 0.0, 1.0], 130.0, [50.0, 0.0, 0.0]));
    for moving in [&pyramid, &turned] {
        let found = align(moving, &pyramid, &AlignOptions::default(), &Unwatched).unwrap();
        let other = found.ambiguous.unwrap_or_else(|| panic!("{found:?}"));
        let between = (other.rotation * found.moving_to_fixed.rotation.inverse()).angle().to_degrees();
        assert!((between / 90.0 - (between / 90.0).round()).abs() < 0.02, "{between} degrees");
        assert!(!found.is_poor());
    }
}

#[test]
fn a_fit_of_surfaces_that_do_not_belong_together_is_poor() {
    let one = relief(80, 0.5, bumps);
    let other = relief(80, 0.5, |x, y| 3.0 * (x / 3.0).sin() * (y / 5.0 + 1.0).cos());
    let found = align(&other, &one, &AlignOptions::default(), &Unwatched).unwrap();
    assert!(found.is_poor(), "{} mm of {} mm", found.rms_mm, found.relief_mm);
}

#[test]
fn in_one_camera_frame_the_height_alone_is_free() {
    let fixed = relief(100, 0.8, bumps);
    let surface = relief(110, 0.7, measured).moved(&Isometry3::translation(0.0, 0.0, 250.0));
    let options = AlignOptions { freedom: Freedom::AlongZ, ..AlignOptions::default() };
    let found = align(&surface, &fixed, &options, &Unwatched).unwrap();
    let shift = found.moving_to_fixed.translation.vector;
    assert!(found.moving_to_fixed.rotation.angle() < 1e-12 && shift.x.abs() + shift.y.abs() < 1e-9, "{found:?}");
    assert!((shift.z + 250.0).abs() < 0.2, "{}", shift.z);
    assert!(!found.searched && found.free.is_empty() && found.ambiguous.is_none() && !found.is_poor());
}

#[test]
fn coordinates_of_a_kilometre_cost_no_more_than_their_f32_step() {
    let far = Isometry3::translation(1e6, -1e6, 1e6);
    let fixed = relief(100, 0.8, bumps).moved(&far);
    let made = far * ten_and_five() * far.inverse();
    let found = align(&fixed.clone().moved(&made), &fixed, &AlignOptions::default(), &Unwatched).unwrap();
    let (mm, degrees) = left_over(&fixed, &made, &found.moving_to_fixed);
    assert!(mm < 0.0625 && degrees < 0.02, "{mm} mm, {degrees} degrees: an f32 step at 1e6 is 0.0625");
}

#[test]
fn scans_of_two_sides_do_not_overlap() {
    let front = relief(80, 0.5, bumps);
    let elsewhere = relief(80, 0.5, |x, y| bumps(y + 300.0, 70.0 - x)).moved(&Isometry3::translation(0.0, 90.0, 0.0));
    for search in [false, true] {
        let options = AlignOptions { search, ..AlignOptions::default() };
        match align(&elsewhere, &front, &options, &Unwatched) {
            Err(CompareError::NoOverlap { overlap, .. }) => assert!(overlap < 0.01, "{overlap}"),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn a_plane_slides_and_a_sphere_turns() {
    let identity_only = AlignOptions { search: false, ..AlignOptions::default() };
    let plane = relief(60, 1.0, |_, _| 0.0);
    let tilted = plane.clone().moved(&motion([1.0, 0.0, 0.0], 2.0, [0.0, 0.0, 1.0]));
    let found = align(&tilted, &plane, &identity_only, &Unwatched).unwrap();
    assert_eq!(found.free.len(), 3, "two slides and a turn about the normal: {:?}", found.free);
    assert!(found.condition > 1e3);

    let groove = relief(60, 1.0, |x, _| x.abs());
    let found = align(&groove, &groove, &identity_only, &Unwatched).unwrap();
    assert_eq!(found.free.iter().map(FreeMotion::to_string).collect::<Vec<_>>(), ["alignment is free along y"]);

    let cap = relief(60, 1.0, |x, y| (50.0f64.powi(2) - x * x - y * y).sqrt());
    let found = align(&cap, &cap, &identity_only, &Unwatched).unwrap();
    assert_eq!(found.free.len(), 3, "{:?}", found.free);
    for free in found.free {
        let FreeMotion::Turn { axis, through, .. } = free else { panic!("{free}") };
        let off_centre = through.coords.cross(&axis).norm();
        assert!(off_centre < 1.0, "every axis goes through the sphere's centre: {off_centre} mm");
    }
}

#[test]
fn an_object_of_revolution_stays_where_the_camera_saw_it() {
    let bowl = relief(100, 0.8, |x, y| 10.0 * ((x * x + y * y).sqrt() / 8.0).cos());
    let noisy = with_noise(bowl.clone(), 0.3, 3);
    let found = align(&noisy, &bowl, &AlignOptions::default(), &Unwatched).unwrap();
    assert!(!found.searched && found.moving_to_fixed.rotation.angle().to_degrees() < 1.0);
    assert!(found.free.iter().any(|free| free.to_string().starts_with("alignment is free in turning about z")));
}

#[test]
fn what_cannot_be_aligned_says_why() {
    let fine = relief(20, 1.0, bumps);
    let run = |moving: &Mesh, options: &AlignOptions| align(moving, &fine, options, &Unwatched).unwrap_err();
    let pixels = Mesh { unit: LengthUnit::Pixel, ..fine.clone() };
    let default = AlignOptions::default();
    assert_eq!(run(&pixels, &default), CompareError::NotInMillimetres { side: Side::Moving });
    let point = Mesh { positions: vec![Point3::origin(); fine.positions.len()], ..fine.clone() };
    assert_eq!(run(&point, &default), CompareError::NoExtent { side: Side::Moving });
    let inside_out = Mesh { triangles: fine.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(), ..fine.clone() };
    assert!(matches!(run(&inside_out, &default), CompareError::InsideOut { facing_away } if facing_away > 0.9));
    let bad = AlignOptions { trim: 1.0, ..AlignOptions::default() };
    assert!(run(&fine, &bad).to_string().contains("trim is 1; it must be 0 to 0.9"));

    struct Impatient;
    impl Watch for Impatient {
        fn progress(&self, _: f32) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    assert_eq!(align(&fine, &fine, &default, &Impatient), Err(CompareError::Cancelled));
}

/// Whatever its size and its place, a mesh is measured or refused.
#[test]
fn meshes_of_every_size_are_measured_or_refused() {
    for power in (-45..39).step_by(3) {
        for shift in [0.0, 1e-20, 1.0, 1e8, 1e20, 1e38] {
            let scale = 10f32.powi(power);
            let mut mesh = relief(6, 1.0, bumps);
            mesh.positions.iter_mut().for_each(|position| *position = *position * scale + Vector3::repeat(shift));
            let other = relief(6, 1.0, |_, _| 0.0);
            for (a, b) in [(&mesh, &other), (&other, &mesh), (&mesh, &mesh)] {
                if let Ok(found) = distances(a, b, &Isometry3::identity(), &DistanceOptions::default(), &Unwatched) {
                    assert!(found.mean_mm.is_finite() && found.max_mm.is_finite(), "{scale:e} at {shift:e}");
                }
                let _ =
                    align(a, b, &AlignOptions { samples: 100, iterations: 3, ..AlignOptions::default() }, &Unwatched);
            }
        }
    }
}

/// Three walls that meet in a corner, which looks the same after a third of a turn but for `faults`; round outside.
fn corner(faults: impl Fn(f64, f64) -> f64) -> Mesh {
    let wall = |x: f64, y: f64, k: f64| {
        let towards = (k * 120.0 + 15.0).to_radians();
        0.8 * (x * towards.cos() + y * towards.sin())
    };
    let height = |x: f64, y: f64| (0..3).map(|k| wall(x, y, f64::from(k))).fold(f64::MIN, f64::max);
    cut(relief(120, 0.6, |x, y| height(x, y) + faults(x, y)), |p| p.x.hypot(p.y) < 34.0)
}

/// The faults of the moved surface lie a little nearer to those of the turned reference.
#[test]
fn a_corner_that_was_moved_and_fits_as_well_turned_is_not_turned_and_is_reported() {
    let faults = |x: f64, y: f64| 0.25 * bumps(x, y) - 0.5 * (x / 30.0).sin();
    let (sin, cos) = 120.0_f64.to_radians().sin_cos();
    let turned = |x: f64, y: f64| faults(cos * x - sin * y, sin * x + cos * y);
    let fixed = corner(|x, y| 0.2 * faults(x, y));
    let made = Isometry3::translation(0.0, 100.0, 0.0);
    for (own, other) in [(0.095, 0.105), (0.105, 0.095)] {
        let moving = corner(|x, y| own * faults(x, y) + other * turned(x, y)).moved(&made);
        let found = align(&moving, &fixed, &AlignOptions::default(), &Unwatched).unwrap();
        let (mm, degrees) = left_over(&fixed, &made, &found.moving_to_fixed);
        println!("corner: {mm:.4} mm, {degrees:.4} degrees, rms {:.4} mm", found.rms_mm);
        assert!(degrees < 2.0 && mm < 2.0, "{mm} mm, {degrees} degrees");
        assert!(found.ambiguous.is_some(), "{found:?}");
    }
}
