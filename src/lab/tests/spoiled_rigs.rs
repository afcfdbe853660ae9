//! Rigs photographed with the mistakes that users make: reflections, room light, circles and values that are off.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::path::Path;

use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::{Calibrated, Preference, Source, Unattended, calibrate};
use firstbounce_capture::set::{SphereKind, Subject};
use firstbounce_core::Unwatched;
use firstbounce_core::trust::Level;
use firstbounce_lab::simulate::{BallOptions, LampOptions, SimulateOptions, Simulated, simulate, write_simulated};
use nalgebra::Vector3;

/// Side of the balls' pictures, and the ball's radius in them.
const SIDE: usize = 120;
const RADIUS: f64 = 50.0;

fn small(lamps: usize) -> SimulateOptions {
    let albedos = SimulateOptions::default().albedos;
    SimulateOptions {
        patches: 60,
        size_px: 32,
        truth_bounces: 1,
        lamps: LampOptions::ring(lamps, 20.0),
        balls: Some(BallOptions { size_px: SIDE, ..BallOptions::for_paint(&albedos) }),
        ..SimulateOptions::default()
    }
}

fn made(lamps: usize) -> Simulated {
    simulate(&small(lamps), &Unwatched).unwrap()
}

fn written(simulated: &Simulated, place: &Path) -> CaptureSet {
    let folder = place.join("set");
    write_simulated(simulated, &folder).unwrap();
    CaptureSet::open(&folder).unwrap()
}

fn calibrated(simulated: &Simulated) -> Calibrated {
    calibrate(&written(simulated, tempfile::tempdir().unwrap().path()), Preference::Balls, &Unattended).unwrap()
}

fn without(simulated: &mut Simulated, subject: Subject) {
    simulated.photos.retain(|photo| photo.subject != subject);
    simulated.set.shots.retain(|shot| shot.subject != subject);
    simulated.set.spheres.retain(|sphere| sphere.subject != subject);
}

/// Adds light, a share of white, to every pixel of a subject's photos.
fn add_light(simulated: &mut Simulated, subject: Subject, light: impl Fn(usize, f64, f64) -> f64) {
    let camera = &simulated.set.camera;
    let (black, white) = (camera.black_level, camera.white_level.unwrap());
    for photo in simulated.photos.iter_mut().filter(|photo| photo.subject == subject) {
        let width = photo.stored.width();
        for (index, value) in photo.stored.data_mut().iter_mut().enumerate() {
            let (x, y) = ((index % width) as f64 + 0.5, (index / width) as f64 + 0.5);
            let added = light(photo.light, x, y) * (white - black);
            *value = (f64::from(*value) + added).min(white).round() as f32;
        }
    }
}

/// A round spot of this light on the mirror ball, in pixels from its centre.
fn spot(at: (f64, f64), radius: f64, light: f64) -> impl Fn(f64, f64) -> f64 {
    let centre = SIDE as f64 / 2.0;
    move |x, y| if (x - centre - at.0).hypot(y - centre - at.1) < radius { light } else { 0.0 }
}

/// Where the mirror ball shows what lies in this direction, in pixels from its centre.
fn seen_at(direction: [f64; 3]) -> (f64, f64) {
    let half_way = (Vector3::from(direction) + Vector3::z()).normalize();
    (RADIUS * half_way.x, -RADIUS * half_way.y)
}

/// The angle between a light's directions in two calibrations, in degrees.
fn off_deg_of(a: &Calibrated, b: &Calibrated, l: usize) -> f64 {
    let [a, b] = [a, b].map(|calibrated| Vector3::from(calibrated.direction[l].as_ref().unwrap().value));
    a.angle(&b).to_degrees()
}

/// The largest of them.
fn off_deg(a: &Calibrated, b: &Calibrated) -> f64 {
    (0..a.direction.len()).map(|l| off_deg_of(a, b, l)).fold(0.0, f64::max)
}

/// Whether a warning names a light and what is the matter.
fn warns(calibrated: &Calibrated, light: &str, of: &str) -> bool {
    calibrated.warnings.iter().any(|warning| warning.contains(&format!("light {light}")) && warning.contains(of))
}

#[test]
fn reflections_that_stay_on_the_mirror_ball_do_not_pass_for_lamps() {
    let window = spot((-25.0, -20.0), 12.0, 3.0);
    let table = spot((10.0, 34.0), 9.0, 0.6);
    let user = spot((30.0, 3.0), 5.0, 2.0);
    for lamps in [2, 3, 6] {
        for grey_ball in [true, false] {
            let mut plain = made(lamps);
            if !grey_ball {
                without(&mut plain, Subject::GreySphere);
            }
            let truth = calibrated(&plain);
            let brightness = |l: usize| 1.0 + 0.15 * l as f64;
            for count in 1..=3 {
                let mut spoiled = plain.clone();
                add_light(&mut spoiled, Subject::MirrorSphere, |l, x, y| {
                    let all = [window(x, y), table(x, y) * brightness(l), user(x, y)];
                    all.iter().take(count).sum()
                });
                let found = calibrated(&spoiled);
                let off = off_deg(&found, &truth);
                assert!(off < 0.5, "{lamps} lamps, {count} reflections: {off} degrees, {:?}", found.warnings);
                assert_eq!(found.warnings, truth.warnings, "{lamps} lamps, {count} reflections");
            }
        }
    }
}

#[test]
fn a_lamp_whose_own_reflection_in_a_wall_is_larger_is_found_by_the_grey_ball_or_doubted() {
    for lamps in [2, 3, 6] {
        let mut plain = made(lamps);
        let truth = calibrated(&plain);
        // Each lamp is seen again in a wall on its other side.
        let walls: Vec<(f64, f64)> = (0..lamps)
            .map(|l| seen_at(truth.direction[l].as_ref().unwrap().value))
            .map(|(x, y)| (-1.8 * x - 8.0, -1.8 * y))
            .collect();
        let add_walls = |simulated: &mut Simulated| {
            add_light(simulated, Subject::MirrorSphere, |l, x, y| spot(walls[l], 4.0, 3.0)(x, y));
        };
        let mut spoiled = plain.clone();
        add_walls(&mut spoiled);
        let off = off_deg(&calibrated(&spoiled), &truth);
        assert!(off < 0.5, "{lamps} lamps: {off} degrees");

        without(&mut plain, Subject::GreySphere);
        add_walls(&mut plain);
        let found = calibrated(&plain);
        for (l, light) in plain.set.lights.iter().enumerate() {
            let warned = warns(&found, &light.name, "two highlights");
            assert!(warned || off_deg_of(&found, &truth, l) < 0.5, "{lamps} lamps: {:?}", found.warnings);
        }
    }
}

#[test]
fn a_lamp_that_a_reflection_hides_is_named() {
    for (lamps, grey_ball) in [(2, false), (3, false), (6, false), (3, true)] {
        let mut simulated = made(lamps);
        if !grey_ball {
            without(&mut simulated, Subject::GreySphere);
        }
        let truth = calibrated(&simulated);
        let (x, y) = seen_at(truth.direction[1].as_ref().unwrap().value);
        let first = simulated.set.lights[1].name.clone();
        // Hidden in whole, and in part.
        for aside in [0.0, 8.0] {
            let mut spoiled = simulated.clone();
            let window = spot((x + aside, y), 8.5, 3.0);
            add_light(&mut spoiled, Subject::MirrorSphere, |_, x, y| window(x, y));
            let found = calibrated(&spoiled);
            let warned = warns(&found, &first, "reflection of the room") || warns(&found, &first, "seen under");
            let off = off_deg(&found, &truth);
            assert!(warned || off < 0.5, "{lamps} lamps, {aside} px: {off} degrees, {:?}", found.warnings);
        }
    }
}

#[test]
fn one_photo_of_the_mirror_ball_under_two_lights_gives_them_one_direction_and_a_warning() {
    let mut simulated = made(3);
    without(&mut simulated, Subject::GreySphere);
    let mirror = |l: usize| simulated.photos.iter().position(|p| p.subject == Subject::MirrorSphere && p.light == l);
    let (from, to) = (mirror(0).unwrap(), mirror(2).unwrap());
    simulated.photos[to].stored = simulated.photos[from].stored.clone();
    let found = calibrated(&simulated);
    for l in [0, 2] {
        assert!(warns(&found, &simulated.set.lights[l].name, "its direction is that of light"), "{:?}", found.warnings);
        assert_eq!(found.judge_direction(l).unwrap().level, Level::DoNotTrust);
    }
    assert_eq!(found.judge_direction(1).unwrap().level, Level::Fine);
}

#[test]
fn room_light_is_reported_and_the_intervals_hold_the_truth_all_the_same() {
    let plain = made(3);
    let clean = calibrated(&plain);
    assert!(clean.room_light.iter().all(Option::is_none) && clean.warnings.is_empty(), "{:?}", clean.warnings);
    let side = Vector3::new(0.8, 0.0, 0.6);
    for (share, from_one_side) in [(0.02, false), (0.005, false), (0.02, true), (0.1, false)] {
        let mut spoiled = plain.clone();
        for subject in [Subject::Object, Subject::GreySphere, Subject::MaterialSphere] {
            add_light(&mut spoiled, subject, |_, x, y| {
                let [x, y] = [(x - 60.0) / RADIUS, (60.0 - y) / RADIUS];
                let normal = Vector3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt());
                if from_one_side { share * (1.0 + 0.5 * normal.dot(&side)) } else { share }
            });
        }
        let found = calibrated(&spoiled);
        let rig = &spoiled.truth.rig;
        let inside = |what: &str, value: f64, [low, high]: [f64; 2]| {
            assert!(low <= value && value <= high, "{share} {from_one_side}: {what} {value} not in {low}..{high}");
        };
        inside("beta", rig.beta[1], found.beta.as_ref().unwrap()[1].interval.unwrap());
        for (l, light) in spoiled.set.lights.iter().enumerate() {
            inside("alpha", rig.alpha[&light.name][1], found.alpha[l].as_ref().unwrap()[1].interval.unwrap());
            inside("intensity", rig.intensity[&light.name], found.intensity[l].interval.unwrap());
            let [low, high] = found.direction[l].as_ref().unwrap().interval.unwrap();
            for (axis, value) in rig.direction[&light.name].iter().enumerate() {
                inside("direction", *value, [low[axis], high[axis]]);
            }
            assert!(found.room_light[l].is_some());
            assert!(found.warnings.iter().any(|w| w.contains("all lamps off") && w.contains(&light.name)));
            assert!(found.judge_alpha(l, 1).unwrap().level > Level::Fine);
        }
        assert!(found.judge_beta(&spoiled.set, 1).unwrap().level > Level::Fine);
    }
}

#[test]
fn a_circle_inside_the_edge_of_its_ball_is_no_good() {
    let plain = made(3);
    let clean = calibrated(&plain);
    for kind in [SphereKind::Grey, SphereKind::Material] {
        let mut spoiled = plain.clone();
        let sphere = spoiled.set.spheres.iter_mut().find(|sphere| sphere.kind == kind).unwrap();
        sphere.circle.radius -= 3.6;
        let found = calibrated(&spoiled);
        let warning = found.warnings.iter().find(|warning| warning.contains("off its edge")).unwrap();
        assert!(warning.contains(&format!("{kind} ball")), "{warning}");
        assert_eq!(found.warnings.len(), 1, "{:?}", found.warnings);
        let verdict = match kind {
            SphereKind::Grey => found.judge_direction(0).unwrap(),
            _ => found.judge_beta(&spoiled.set, 1).unwrap(),
        };
        assert!(verdict.level > Level::Fine && clean.judge_direction(0).unwrap().level == Level::Fine, "{verdict:?}");
    }
    assert!(clean.warnings.is_empty());
}

#[test]
fn typed_values_that_the_balls_contradict_are_no_good() {
    let place = tempfile::tempdir().unwrap();
    let mut set = written(&made(3), place.path());
    let clean = calibrate(&set, Preference::Balls, &Unattended).unwrap();
    let light = set.lights[1].name.clone();
    let alpha = clean.alpha[1].as_ref().unwrap()[1].value;
    for share in [1.2, 1.0] {
        set.calibration.alpha.insert(light.clone(), vec![1.0, share * alpha]);
        for preference in [Preference::Balls, Preference::File] {
            let found = calibrate(&set, preference, &Unattended).unwrap();
            assert_eq!(
                warns(&found, &light, "in capture.toml, and the ball says"),
                share > 1.0,
                "{:?}",
                found.warnings
            );
        }
        let level = |calibrated: Calibrated| calibrated.judge_alpha(1, 1).unwrap().level;
        let at_once = level(clean.clone().with_given(&set));
        assert_eq!(at_once, level(calibrate(&set, Preference::File, &Unattended).unwrap()));
        assert_eq!(at_once > Level::Fine, share > 1.0);
    }

    // A highlight on the other side of the ball.
    let [x, y, z] = clean.direction[1].as_ref().unwrap().value;
    set.put_direction(&light, [-x, -y, z]);
    let found = calibrate(&set, Preference::File, &Unattended).unwrap();
    assert_eq!(found.direction[1].as_ref().unwrap().source, Source::File);
    for calibrated in [found, clean.with_given(&set)] {
        assert_eq!(calibrated.judge_direction(1).unwrap().level, Level::DoNotTrust);
    }
}

/// Leaves a ball's circle to be found.
fn without_circle(simulated: &mut Simulated, subject: Subject) {
    simulated.set.spheres.retain(|sphere| sphere.subject != subject);
}

#[test]
fn a_ball_that_is_not_found_is_left_out_where_others_suffice_and_an_error_where_not() {
    // Of the mirror ball nothing but the highlight shows.
    let mut simulated = made(3);
    let truth = calibrated(&simulated);
    without_circle(&mut simulated, Subject::MirrorSphere);
    let half_white = (simulated.set.camera.white_level.unwrap() / 2.0) as f32;
    for photo in simulated.photos.iter_mut().filter(|photo| photo.subject == Subject::MirrorSphere) {
        let dark = photo.stored.data()[0];
        photo.stored.data_mut().iter_mut().filter(|value| **value < half_white).for_each(|value| *value = dark);
    }
    let found = calibrated(&simulated);
    assert_eq!(found.not_found.len(), 1);
    assert!(
        found.warnings.iter().any(|warning| warning.contains("the mirror ball is left out")),
        "{:?}",
        found.warnings
    );
    assert!(off_deg(&found, &truth) < 0.5);
    without(&mut simulated, Subject::GreySphere);
    let place = tempfile::tempdir().unwrap();
    let error = calibrate(&written(&simulated, place.path()), Preference::Balls, &Unattended).unwrap_err().to_string();
    assert!(error.starts_with("mirror-sphere: no ball found") && error.contains("--circle"), "{error}");

    // A grey ball that is as dark as its background, where alpha and intensities are typed.
    let mut simulated = made(3);
    without_circle(&mut simulated, Subject::GreySphere);
    for photo in simulated.photos.iter_mut().filter(|photo| photo.subject == Subject::GreySphere) {
        photo.stored.data_mut().fill(300.0);
    }
    let place = tempfile::tempdir().unwrap();
    let mut set = written(&simulated, place.path());
    let error = calibrate(&set, Preference::File, &Unattended).unwrap_err().to_string();
    assert!(error.starts_with("grey-sphere: no ball found"), "{error}");
    for light in set.lights.clone() {
        set.calibration.alpha.insert(light.name.clone(), simulated.truth.rig.alpha[&light.name].clone());
        set.calibration.intensity.insert(light.name.clone(), 1.0);
    }
    set.calibration.beta = Some(simulated.truth.rig.beta.clone());
    let found = calibrate(&set, Preference::File, &Unattended).unwrap();
    assert!(found.not_found.iter().all(|ball| ball.kind == SphereKind::Grey));
}

#[test]
fn a_mirror_ball_without_a_highlight_under_one_light_leaves_that_light_to_the_grey_ball() {
    let mut simulated = made(3);
    let truth = calibrated(&simulated);
    let mirror = simulated.photos.iter_mut().find(|p| p.subject == Subject::MirrorSphere && p.light == 1).unwrap();
    let dark = mirror.stored.data()[0];
    mirror.stored.data_mut().fill(dark);
    let found = calibrated(&simulated);
    assert!(off_deg(&found, &truth) < 0.5);
    assert!(warns(&found, &simulated.set.lights[1].name, "the mirror ball is left out"), "{:?}", found.warnings);
}
