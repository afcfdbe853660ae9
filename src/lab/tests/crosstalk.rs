//! Crosstalk between the channels of RGB photos: measured under one lamp colour at a time, undone, or told.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::path::Path;

use firstbounce_capture::CaptureSet;
use firstbounce_capture::image_file::{grey16_png, rgb16_png};
use firstbounce_capture::pipeline::{
    Calibrated, Method, PipelineError, Preference, SolveOptions, Solved, Source, Unattended, calibrate, solve,
};
use firstbounce_capture::set::Subject;
use firstbounce_core::image::mixing::MixingError;
use firstbounce_core::light::scene::Shape;
use firstbounce_core::{NormalMap, Plane, Unwatched};
use firstbounce_lab::simulate::{
    BallOptions, LampOptions, Measures, Scene, SimulateOptions, simulate, write_simulated,
};
use firstbounce_lab::{Crosstalk, Sensor};

fn options(albedos: &[f64], leak: f64) -> SimulateOptions {
    SimulateOptions {
        scene: Scene::built_in("groove", Measures::default()).unwrap(),
        patches: 250,
        size_px: 96,
        truth_bounces: 1,
        sensor: Sensor { frames: 64, ..Sensor::default() },
        colours: SimulateOptions::colour_names(albedos.len()),
        balls: Some(BallOptions { size_px: 96, ..BallOptions::for_paint(albedos) }),
        albedos: albedos.to_vec(),
        crosstalk: (leak != 0.0).then(|| Crosstalk::even(albedos.len(), leak).unwrap()),
        crosstalk_shots: leak != 0.0,
        ..SimulateOptions::default()
    }
}

fn written(options: &SimulateOptions, place: &Path) -> CaptureSet {
    let folder = place.join("set");
    write_simulated(&simulate(options, &Unwatched).unwrap(), &folder).unwrap();
    CaptureSet::open(&folder).unwrap()
}

fn without_shots(set: &CaptureSet) -> CaptureSet {
    let mut set = set.clone();
    set.shots.retain(|shot| shot.subject != Subject::Crosstalk);
    set
}

fn solved(set: &CaptureSet, method: Method) -> Solved {
    solve(set, &SolveOptions { method, ..SolveOptions::of(set) }, &Unattended).unwrap()
}

fn normals(solved: &Solved) -> &NormalMap {
    &solved.after.as_ref().unwrap().shape.normals.map
}

/// Mean angle between the normals of two sets, in degrees.
fn apart_deg(a: &Solved, b: &Solved) -> f64 {
    let (a, b) = (normals(a), normals(b));
    let pixels = a.x().width() * a.x().height();
    let angles = (0..pixels).filter_map(|pixel| Some(a.at_index(pixel)?.angle(&b.at_index(pixel)?).to_degrees()));
    let angles: Vec<f64> = angles.map(f64::from).collect();
    assert!(angles.len() > 1000);
    angles.iter().sum::<f64>() / angles.len() as f64
}

#[test]
fn with_measured_crosstalk_the_normals_are_those_of_the_set_without_it() {
    for (albedos, leak) in [(&[0.75, 0.3][..], 0.15), (&[0.75, 0.45, 0.2], 0.04)] {
        let place = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let pure = written(&options(albedos, 0.0), place[0].path());
        let mixed = written(&options(albedos, leak), place[1].path());
        for method in [Method::ColoursAndShape, Method::Shape] {
            let truth = solved(&pure, method);
            let found = solved(&mixed, method);
            let spoiled = solved(&without_shots(&mixed), method);
            let (off, spoiled) = (apart_deg(&found, &truth), apart_deg(&spoiled, &truth));
            let words =
                format!("{} colours, {leak}, {method:?}: {off} degrees, with crosstalk {spoiled}", albedos.len());
            assert!(off < 0.1 && spoiled > 4.0 * off, "{words}");
            for row in &found.calibrated.crosstalk {
                for known in row.iter().filter(|known| known.source == Source::GreyBall) {
                    let [low, high] = known.interval.unwrap();
                    assert!((known.value - leak).abs() < 1e-3 && high - low < 4e-3, "{known:?}");
                }
            }
        }
    }
}

fn calibrated(set: &CaptureSet) -> Calibrated {
    calibrate(set, Preference::Balls, &Unattended).unwrap()
}

#[test]
fn crosstalk_that_is_not_known_is_told_where_beta_differs_from_light_to_light() {
    let place = tempfile::tempdir().unwrap();
    let mut lamps = LampOptions::ring(3, 20.0);
    lamps.iter_mut().zip([0.5, 2.0, 6.0]).for_each(|(lamp, alpha)| lamp.alpha = Some(vec![1.0, alpha]));
    let set = written(&SimulateOptions { lamps, ..options(&[0.75, 0.25], 0.08) }, place.path());
    let warns = |calibrated: &Calibrated| calibrated.warnings.iter().any(|line| line.contains("\"crosstalk\" shots"));
    assert!(warns(&calibrated(&without_shots(&set))), "{:?}", calibrated(&without_shots(&set)).warnings);
    let measured = calibrated(&set);
    assert!(!warns(&measured), "{:?}", measured.warnings);
    let beta = measured.beta.unwrap()[1].value;
    assert!((beta / (1.0 / 3.0) - 1.0).abs() < 0.005, "{beta}");
}

#[test]
fn typed_crosstalk_wins_and_is_held_against_the_shots() {
    let place = tempfile::tempdir().unwrap();
    let mut set = written(&options(&[0.75, 0.3], 0.04), place.path());
    set.camera.crosstalk = Some(vec![vec![1.0, 0.2], vec![0.04, 1.0]]);
    let contradicted = calibrated(&set);
    let lines: Vec<_> =
        contradicted.warnings.iter().filter(|line| line.contains("delete the line to use the shots'")).collect();
    assert!(lines.len() == 1 && lines[0].contains("0.2000") && lines[0].contains("0.0400"), "{lines:?}");
    let in_force = calibrate(&set, Preference::File, &Unattended).unwrap();
    assert_eq!(in_force.crosstalk_rows(), set.camera.crosstalk);
}

#[test]
fn crosstalk_shots_that_cannot_be_used_are_one_clear_line() {
    let place = tempfile::tempdir().unwrap();
    let set = written(&options(&[0.75, 0.3], 0.04), place.path());
    let refused = |set: &CaptureSet| calibrate(set, Preference::Balls, &Unattended).unwrap_err();
    let shots: Vec<_> = set.shots_of(Subject::Crosstalk).map(|shot| set.resolve(&shot.files[0])).collect();
    let bytes = std::fs::read(&shots[1]).unwrap();

    // Under the same lamp twice: both channels see it.
    std::fs::copy(&shots[0], &shots[1]).unwrap();
    let error = refused(&set);
    assert!(matches!(error, PipelineError::Crosstalk(MixingError::TooStrong { .. })), "{error}");

    let small = Plane::filled(48, 48, 600.0);
    std::fs::write(&shots[1], rgb16_png([&small; 3], 65535.0).unwrap()).unwrap();
    assert!(matches!(refused(&set), PipelineError::PhotoSize { .. }), "{}", refused(&set));

    let dark = Plane::filled(96, 96, 512.0);
    std::fs::write(&shots[1], rgb16_png([&dark; 3], 65535.0).unwrap()).unwrap();
    let error = refused(&set);
    assert!(matches!(error, PipelineError::Calibrate { .. }) && !error.to_string().contains('\n'), "{error}");

    std::fs::write(&shots[1], grey16_png(&dark, 65535.0).unwrap()).unwrap();
    assert!(!refused(&set).to_string().contains('\n'));

    std::fs::write(&shots[1], bytes).unwrap();
    let mut one = set.clone();
    one.shots.retain(|shot| shot.subject != Subject::Crosstalk || shot.colour.as_deref() == Some("c1"));
    assert!(one.check()[0].to_string().contains("no crosstalk shot under \"c2\" alone"), "{:?}", one.check());
    let mut grey = set.clone();
    grey.colours[1].channel = firstbounce_capture::set::Channel::Grey;
    assert!(grey.check()[0].to_string().contains("channel of its own"), "{:?}", grey.check());
    let mut shape = set;
    shape.camera.crosstalk = Some(vec![vec![1.0, 1.0], vec![1.0, 1.0]]);
    assert!(shape.check()[0].to_string().contains("can be undone"), "{:?}", shape.check());
}

#[test]
fn crosstalk_shots_need_balls_and_two_or_three_colours() {
    let with = |change: &dyn Fn(&mut SimulateOptions)| {
        let mut options = options(&[0.75, 0.3], 0.04);
        options.scene = Scene::Shape(Shape::Tray { side_mm: 100.0 });
        change(&mut options);
        options.check()
    };
    assert!(with(&|_| {}).is_ok());
    assert!(with(&|options| options.balls = None).is_err());
    assert!(
        with(&|options| {
            options.albedos = vec![0.5];
            options.colours.truncate(1);
        })
        .is_err()
    );
}
