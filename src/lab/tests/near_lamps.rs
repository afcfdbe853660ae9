//! The positions of near lamps, from two mirror balls in one picture and from one ball in two places; the scale of a ball's diameter.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::fs;
use std::path::Path;

use firstbounce_capture::CaptureSet;
use firstbounce_capture::image_file::grey16_png;
use firstbounce_capture::pipeline::{Calibrated, Preference, Unattended, calibrate};
use firstbounce_capture::report::CalibrationRecord;
use firstbounce_capture::set::{self, Projection, Shot, Sphere, SphereKind, Subject};
use firstbounce_core::sphere::{Ball, Circle, View};
use firstbounce_core::stereo::normals::Lamp;
use firstbounce_core::{Plane, Unwatched};
use firstbounce_lab::simulate::{BallOptions, LampOptions, LampPlace, SimulateOptions, simulate, write_simulated};
use firstbounce_lab::{BallPicture, LampSpot};
use nalgebra::{Point3, Vector3};

/// Lamps at 400 mm.
const LAMPS: [[f64; 3]; 3] = [[-150.0, 60.0, 370.0], [40.0, 180.0, 350.0], [170.0, -120.0, 340.0]];
const MM_PER_PIXEL: f64 = 0.1;
const SIZE: (usize, usize) = (1600, 400);
/// A ball of 30 mm in two places, 120 mm apart.
const RADIUS_PX: f64 = 150.0;
const PLACES_PX: [f64; 2] = [200.0, 1400.0];

/// The mirror ball in these places of one picture, under a lamp.
fn picture(lamp: [f64; 3], places: &[f64], white: f64) -> Plane {
    let mut sum = vec![0.0_f32; SIZE.0 * SIZE.1];
    for &x in places {
        let circle = Circle { centre_px: (x, 200.0), radius_px: RADIUS_PX };
        let centre_mm = Vector3::new(MM_PER_PIXEL * (x - 800.0), 0.0, 0.0);
        let lamp = Lamp::Near(Point3::from(Vector3::from(lamp) - centre_mm));
        let spot = LampSpot { half_angle_deg: 1.0, light: 0.9, room: 0.01 };
        let ball = Ball::new(circle, View::Orthographic);
        let radius_mm = MM_PER_PIXEL * RADIUS_PX;
        let picture = BallPicture { ball, radius_mm, size: SIZE, samples_per_pixel_side: 4 }.mirror(&lamp, &spot);
        sum.iter_mut().zip(picture.data()).for_each(|(sum, light)| *sum += light);
    }
    let stored = sum.into_iter().map(|light| (light * white as f32).round()).collect();
    Plane::from_vec(SIZE.0, SIZE.1, stored).unwrap()
}

fn sphere(subject: Subject, x: f64) -> Sphere {
    let circle = set::Circle { centre: [x, 200.0], radius: RADIUS_PX };
    Sphere { subject, kind: SphereKind::Mirror, circle, diameter_mm: None }
}

/// A set under the lamps, whose mirror ball was photographed in the places of each subject.
fn set(place: &Path, seen: &[(Subject, &[f64])]) -> CaptureSet {
    let albedos = SimulateOptions::default().albedos;
    let options = SimulateOptions {
        patches: 60,
        size_px: 32,
        truth_bounces: 1,
        lamps: LampOptions::named(LAMPS.map(LampPlace::Point)),
        balls: Some(BallOptions { size_px: 120, ..BallOptions::for_paint(&albedos) }),
        ..SimulateOptions::default()
    };
    let folder = place.join("set");
    write_simulated(&simulate(&options, &Unwatched).unwrap(), &folder).unwrap();
    let mut set = CaptureSet::open(&folder).unwrap();
    let is_of_mirror = |subject: Subject| subject.sphere_kind() == Some(SphereKind::Mirror);
    set.shots.retain(|shot| shot.subject != Subject::GreySphere && !is_of_mirror(shot.subject));
    set.spheres.retain(|sphere| sphere.subject != Subject::GreySphere && !is_of_mirror(sphere.subject));
    set.camera.projection = Projection::Orthographic { mm_per_pixel: Some(MM_PER_PIXEL) };
    set.lights.iter_mut().for_each(|light| light.position_mm = None);
    let white = set.camera.white_level.unwrap();
    for (subject, places) in seen {
        set.spheres.extend(places.iter().map(|x| sphere(*subject, *x)));
        fs::create_dir_all(folder.join(subject.to_string())).unwrap();
        for (light, lamp) in set.lights.iter().zip(LAMPS) {
            let file = format!("{subject}/{}.png", light.name);
            let png = grey16_png(&picture(lamp, places, white), 65535.0).unwrap();
            fs::write(folder.join(&file), png).unwrap();
            let light = Some(light.name.clone());
            set.shots.push(Shot { subject: *subject, light, files: vec![file], ..Shot::default() });
        }
    }
    assert!(set.check().is_empty(), "{:?}", set.check());
    set
}

fn calibrated(set: &CaptureSet) -> Calibrated {
    calibrate(set, Preference::Balls, &Unattended).unwrap()
}

fn assert_placed_to_one_percent(found: &Calibrated) {
    assert_eq!(found.position.len(), LAMPS.len());
    for (known, truth) in found.position.iter().zip(LAMPS) {
        let known = known.as_ref().unwrap();
        let (found, expected) = (Vector3::from(known.value), Vector3::from(truth));
        let off = (found - expected).norm() / expected.norm();
        println!("{found:?} for {truth:?}: {:.2} %, {:?}", 100.0 * off, known.interval);
        assert!(off < 0.01, "{found:?} for {truth:?}");
        let [low, high] = known.interval.unwrap();
        assert!((0..3).all(|axis| low[axis] <= truth[axis] && truth[axis] <= high[axis]), "{:?}", known.interval);
    }
}

#[test]
fn two_mirror_balls_place_near_lamps_to_one_percent() {
    let place = tempfile::tempdir().unwrap();
    assert_placed_to_one_percent(&calibrated(&set(place.path(), &[(Subject::MirrorSphere, &PLACES_PX)])));
}

#[test]
fn one_mirror_ball_in_two_places_places_near_lamps_to_one_percent() {
    let place = tempfile::tempdir().unwrap();
    let [first, second] = PLACES_PX;
    let mut set = set(place.path(), &[(Subject::MirrorSphere, &[first]), (Subject::MirrorSphereMoved, &[second])]);
    let found = calibrated(&set);
    assert_placed_to_one_percent(&found);
    assert_eq!(found.circles.iter().filter(|ball| ball.sphere.kind == SphereKind::Mirror).count(), 2);

    // The scale of the ball's diameter in place of the camera's.
    set.camera.projection = Projection::Orthographic { mm_per_pixel: None };
    let without = calibrated(&set);
    assert!(without.position.iter().all(Option::is_none));
    assert!(without.warnings.iter().any(|warning| warning.contains("diameter_mm")), "{:?}", without.warnings);
    let mirror = set.spheres.iter_mut().find(|sphere| sphere.subject == Subject::MirrorSphere).unwrap();
    mirror.diameter_mm = Some(2.0 * RADIUS_PX * MM_PER_PIXEL);
    assert_placed_to_one_percent(&calibrated(&set));
    let text = set.to_toml();
    assert!(text.contains("subject = \"mirror-sphere-moved\"") && text.contains("diameter_mm = 30"), "{text}");

    // Without the first place the second says nothing.
    set.shots.retain(|shot| shot.subject != Subject::MirrorSphere);
    assert!(set.check().iter().any(|problem| problem.to_string().contains("second place")), "{:?}", set.check());
}

#[test]
fn pictures_of_another_size_are_of_another_camera_and_place_nothing() {
    let place = tempfile::tempdir().unwrap();
    let [first, second] = PLACES_PX;
    let set = set(place.path(), &[(Subject::MirrorSphere, &[first]), (Subject::MirrorSphereMoved, &[second])]);
    for light in &set.lights {
        let png = grey16_png(&Plane::filled(200, 100, 100.0), 65535.0).unwrap();
        fs::write(set.folder.join(format!("mirror-sphere-moved/{}.png", light.name)), png).unwrap();
    }
    let found = calibrated(&set);
    assert!(found.position.iter().all(Option::is_none) && found.direction.iter().all(Option::is_some));
    let named = |warning: &String| warning.contains("200 x 100") && warning.contains("1600 x 400");
    assert!(found.warnings.iter().any(named), "{:?}", found.warnings);
}

#[test]
fn a_diameter_that_contradicts_the_scale_is_told_with_both_and_one_that_fits_is_not() {
    let place = tempfile::tempdir().unwrap();
    let mut set = set(place.path(), &[(Subject::MirrorSphere, &PLACES_PX[..1])]);
    let contradicted = |set: &CaptureSet| {
        let warnings = calibrated(set).warnings;
        warnings.into_iter().find(|warning| warning.contains("by the diameter of the mirror ball"))
    };
    let scale = |set: &CaptureSet| CalibrationRecord::of(set, &calibrated(set)).mm_per_pixel.unwrap();
    let put = |set: &mut CaptureSet, diameter_mm: f64| {
        set.spheres.iter_mut().filter(|sphere| sphere.kind == SphereKind::Mirror).for_each(|sphere| {
            sphere.diameter_mm = Some(diameter_mm);
        });
    };
    put(&mut set, 30.2);
    assert_eq!(contradicted(&set), None);
    put(&mut set, 36.0);
    let warning = contradicted(&set).unwrap();
    assert!(warning.contains("0.10000 mm by [camera]") && warning.contains("0.12000 mm by the diameter"), "{warning}");
    assert_eq!((scale(&set).value, scale(&set).source), (0.1, "capture.toml"));
    assert!((scale(&set).by_balls.unwrap() - 0.12).abs() < 1e-12);

    set.camera.projection = Projection::Orthographic { mm_per_pixel: None };
    assert_eq!((scale(&set).value, scale(&set).source), (0.12, "diameter of balls"));

    // With perspective the outline is that of a cone that touches the ball.
    let (focal_length_px, working_distance_mm) = (4000.0, 400.0);
    set.camera.projection = Projection::Perspective { focal_length_px, principal_point: None, working_distance_mm };
    let radius_mm = 15.0_f64;
    let outline_px = focal_length_px * radius_mm / (working_distance_mm.powi(2) - radius_mm.powi(2)).sqrt();
    set.spheres.retain(|sphere| sphere.kind == SphereKind::Mirror);
    set.spheres[0].circle.radius = outline_px;
    put(&mut set, 2.0 * radius_mm);
    assert!((set.mm_per_pixel_of_balls().unwrap() - 0.1).abs() < 1e-12);
}
