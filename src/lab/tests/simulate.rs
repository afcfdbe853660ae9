//! Simulated sets: they pass the pipeline as photographed ones do, and it finds the truth they were made with.

#![allow(clippy::unwrap_used, reason = "a test may fail loudly")]

use std::fs;
use std::path::Path;

use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::{Evaluation, Preference, SolveOptions, Unattended, calibrate, evaluate};
use firstbounce_capture::set::Subject;
use firstbounce_core::Unwatched;
use firstbounce_core::light::scene::{Lens, Shape};
use firstbounce_lab::simulate::{
    BallOptions, Exposure, LampOptions, LampPlace, Measures, PlanGrid, RigRecord, Scene, SimulateError,
    SimulateOptions, Simulated, plan_rig, simulate, write_simulated,
};
use firstbounce_lab::{Crosstalk, PlanMethod, Sensor};

/// A set small enough for a test.
fn small(scene: &str) -> SimulateOptions {
    let albedos = SimulateOptions::default().albedos;
    SimulateOptions {
        scene: Scene::built_in(scene, Measures::default()).unwrap(),
        patches: 250,
        size_px: 96,
        truth_bounces: 2,
        balls: Some(BallOptions { size_px: 96, ..BallOptions::for_paint(&albedos) }),
        ..SimulateOptions::default()
    }
}

fn made(options: &SimulateOptions) -> Simulated {
    simulate(options, &Unwatched).unwrap()
}

/// The set on disk, as any command opens it.
fn written(options: &SimulateOptions, place: &Path) -> (CaptureSet, RigRecord) {
    let simulated = made(options);
    let folder = place.join("set");
    write_simulated(&simulated, &folder).unwrap();
    (CaptureSet::open(&folder).unwrap(), simulated.truth.rig)
}

fn evaluated(options: &SimulateOptions) -> Evaluation {
    let place = tempfile::tempdir().unwrap();
    let (set, _) = written(options, place.path());
    evaluate(&set, &SolveOptions::default(), &Unattended).unwrap()
}

#[test]
fn calibration_finds_the_rig_of_a_simulated_set() {
    let place = tempfile::tempdir().unwrap();
    let (set, rig) = written(&small("corner"), place.path());
    assert!(set.check().is_empty() && set.warnings().is_empty(), "{:?}", set.warnings());
    let found = calibrate(&set, Preference::Balls, &Unattended).unwrap();
    assert!(found.warnings.is_empty(), "{:?}", found.warnings);
    let inside = |value: f64, interval: Option<[f64; 2]>| {
        let [low, high] = interval.unwrap();
        assert!(low <= value && value <= high, "{value} not in {low}..{high}");
    };
    for (c, beta) in found.beta.unwrap().iter().enumerate() {
        inside(rig.beta[c], beta.interval);
    }
    for (l, light) in set.lights.iter().enumerate() {
        for (c, alpha) in found.alpha[l].as_ref().unwrap().iter().enumerate() {
            inside(rig.alpha[&light.name][c], alpha.interval);
        }
        inside(rig.intensity[&light.name], found.intensity[l].interval);
        let direction = found.direction[l].as_ref().unwrap();
        let [low, high] = direction.interval.unwrap();
        for (axis, value) in rig.direction[&light.name].iter().enumerate() {
            inside(*value, Some([low[axis], high[axis]]));
        }
    }
}

#[test]
fn separation_beats_the_photos_of_every_scene() {
    for scene in ["corner", "groove", "bowl", "cap"] {
        let evaluation = evaluated(&small(scene));
        let errors = evaluation.normal_error_deg;
        assert!(errors.separated.mean < 0.6 * errors.raw.mean, "{scene}: {errors:?}");
        // Pixels on the bowl's steep rim are large.
        assert!(errors.true_direct.unwrap().mean < 1.0, "{scene}: {errors:?}");
        assert!(evaluation.pixels > 1000, "{scene}: {} pixels", evaluation.pixels);
        // The bowl's rim is as steep as normals can tell.
        let most_mm = if scene == "bowl" { 2.0 } else { 0.2 };
        assert!(evaluation.depth_rmse_true_normals_mm.unwrap() < most_mm, "{scene}: {evaluation:?}");
    }
}

#[test]
fn near_lamps_before_a_pinhole_are_solved_as_such() {
    let place = |x: f64, y: f64| LampPlace::Point([x, y, 700.0]);
    let mut lamps = LampOptions::named([place(-200.0, 40.0), place(30.0, 220.0), place(190.0, -150.0)]);
    lamps[2].place = LampPlace::Area { centre_mm: [190.0, -150.0, 700.0], side_mm: 20.0 };
    let lens = Lens::Perspective { working_distance_mm: 600.0 };
    for scene in ["groove", "corner"] {
        let found = evaluated(&SimulateOptions { lamps: lamps.clone(), lens, ..small(scene) });
        let errors = found.normal_error_deg;
        assert!(errors.separated.mean < 0.5 * errors.raw.mean, "{scene}: {errors:?}");
        assert!(errors.true_direct.unwrap().mean < 1.0, "{scene}: {errors:?}");
        // A pixel shows about 1 mm of either.
        assert!(found.depth_rmse_true_normals_mm.unwrap() < 0.5, "{scene}: {found:?}");
        assert!(found.depth_rmse_mm.unwrap() < 1.5, "{scene}: {found:?}");
    }
}

/// The mean height over the pixels of the mask; before a pinhole that of the geometric mean distance.
fn mean_height_mm(simulated: &Simulated, working_distance_mm: Option<f64>) -> f64 {
    let pixels = simulated.truth.depth_mm.data().iter().zip(simulated.truth.mask.data());
    let heights = pixels.filter(|(_, inside)| **inside).map(|(&height, _)| f64::from(height));
    let count = simulated.truth.mask.count() as f64;
    match working_distance_mm {
        None => heights.sum::<f64>() / count,
        Some(far) => far - (heights.map(|height| (far - height).ln()).sum::<f64>() / count).exp(),
    }
}

#[test]
fn every_scene_lies_where_its_depth_will_be_put() {
    for scene in Scene::BUILT_IN {
        for far in [None, Some(300.0)] {
            let lens = far.map_or(Lens::Orthographic, |working_distance_mm| Lens::Perspective { working_distance_mm });
            let height = mean_height_mm(&made(&SimulateOptions { lens, balls: None, ..small(scene) }), far);
            // The mask leaves out the pixels of the border; a wall is 60 mm long.
            assert!(height.abs() < 0.8, "{scene} through {lens:?}: {height} mm");
        }
    }
}

#[test]
fn a_corner_under_near_lamps_is_as_large_as_it_is() {
    let lamps = LampOptions::near_ring(3, 25.0, 350.0, None);
    let lens = Lens::Perspective { working_distance_mm: 400.0 };
    let found = evaluated(&SimulateOptions { lamps, lens, ..small("corner") });
    assert!(found.normal_error_deg.true_direct.unwrap().mean < 1.0, "{found:?}");
    assert!(found.depth_rmse_true_normals_mm.unwrap() < 0.5, "{found:?}");
    assert!(found.depth_rmse_mm.unwrap() < 1.5, "{found:?}");
}

#[test]
fn an_eight_bit_camera_writes_eight_bits_and_a_mean_of_frames_sixteen() {
    let place = tempfile::tempdir().unwrap();
    let sensor = Sensor { bits: 8, black_level: 4.0, frames: 1, ..Sensor::default() };
    let (one, _) = written(&SimulateOptions { sensor, ..small("groove") }, &place.path().join("one"));
    let mean = Sensor { frames: 16, ..sensor };
    let (many, _) = written(&SimulateOptions { sensor: mean, ..small("groove") }, &place.path().join("many"));
    assert_eq!((one.camera.white_level, one.camera.black_level), (Some(255.0), 4.0));
    assert_eq!((many.camera.white_level, many.camera.black_level), (Some(65535.0), 1028.0));
    let bits = |set: &CaptureSet| image::open(set.resolve(&set.shots[0].files[0])).unwrap().color().bits_per_pixel();
    assert_eq!((bits(&one), bits(&many)), (8, 16));
    let error = |set: &CaptureSet| {
        evaluate(set, &SolveOptions::default(), &Unattended).unwrap().normal_error_deg.separated.mean
    };
    assert!(error(&many) < error(&one), "{} {}", error(&many), error(&one));
}

#[test]
fn what_a_scene_does_not_fit_into_memory_is_computed_and_said() {
    let stored = made(&small("tray"));
    let computed = made(&SimulateOptions { memory_limit_bytes: 0, ..small("tray") });
    assert!(stored.report.factors.stored && !computed.report.factors.stored);
    assert!(computed.report.warnings[0].contains("computed again"), "{:?}", computed.report.warnings);
    for (a, b) in stored.photos.iter().zip(&computed.photos) {
        let difference: f32 = a.stored.data().iter().zip(b.stored.data()).map(|(a, b)| (a - b).abs()).sum();
        let sum: f32 = a.stored.data().iter().sum();
        assert!(difference < 1e-3 * sum, "{difference} of {sum}");
    }
}

#[test]
fn crosstalk_reaches_the_balls_too() {
    let place = tempfile::tempdir().unwrap();
    let leak = 0.05;
    let crosstalk = Some(Crosstalk::even(2, leak).unwrap());
    let simulated = made(&SimulateOptions { crosstalk, ..small("groove") });
    assert!(simulated.report.warnings.iter().any(|warning| warning.contains("without crosstalk")));
    let folder = place.path().join("set");
    write_simulated(&simulated, &folder).unwrap();
    let found = calibrate(&CaptureSet::open(&folder).unwrap(), Preference::Balls, &Unattended).unwrap();
    for (known, pure) in found.alpha.iter().zip(simulated.truth.rig.alpha.values()) {
        // Each photo of a grey ball sees the other colour's lamp by the leak.
        let expected = (pure[1] + leak) / (1.0 + leak * pure[1]);
        let alpha = known.as_ref().unwrap()[1].value;
        assert!((alpha / expected - 1.0).abs() < 2e-3, "{alpha} for {expected}");
    }
}

#[test]
fn the_brightest_pixel_is_as_bright_as_asked_for_with_crosstalk_too() {
    for leak in [0.0, 0.3] {
        let sensor = Sensor::noiseless(16);
        let crosstalk = Some(Crosstalk::even(2, leak).unwrap());
        let simulated =
            made(&SimulateOptions { crosstalk, sensor, exposure: Exposure::Brightest(0.8), ..small("groove") });
        let photos = simulated.photos.iter().filter(|photo| photo.subject != Subject::MirrorSphere);
        let brightest = photos.flat_map(|photo| photo.stored.data().iter().copied()).fold(0.0, f32::max) / 65535.0;
        assert!((brightest - 0.8).abs() < 1e-3, "{brightest} at a leak of {leak}");
        assert_eq!(simulated.report.clipped_pixels, 0);
    }
}

#[test]
fn the_plan_predicts_what_solving_finds() {
    for (scene, frames, ratio) in [("corner", 1, 0.5), ("corner", 16, 0.5), ("corner", 4, 0.85), ("groove", 4, 0.5)] {
        let albedos = vec![0.75, 0.75 * ratio];
        let sensor = Sensor { frames, ..Sensor::default() };
        let balls = Some(BallOptions::for_paint(&albedos));
        let options = SimulateOptions { albedos, sensor, balls, size_px: 160, ..small(scene) };
        let place = tempfile::tempdir().unwrap();
        let (set, _) = written(&options, place.path());
        for method in [PlanMethod::ColoursAndShape, PlanMethod::paper(2)] {
            let grid =
                PlanGrid { method: Some(method), frames: vec![frames], ratios: vec![ratio], ..PlanGrid::default() };
            let plan = plan_rig(&options, &grid, &Unwatched).unwrap();
            let solve = SolveOptions { method: method.method(), ..SolveOptions::of(&set) };
            let errors = evaluate(&set, &solve, &Unattended).unwrap().normal_error_deg;
            let (planned, found, raw) = (&plan.by_frames[0], errors.separated.mean, errors.raw.mean);
            println!("{scene}, {frames} frames, ratio {ratio}: planned {planned:?}, found {errors:?}");
            assert!((planned.error_deg / found - 1.0).abs() < 0.25, "planned {planned:?}, found {found}");
            assert!((plan.raw_deg / raw - 1.0).abs() < 0.1, "planned {}, found {raw}", plan.raw_deg);
            assert_eq!(plan.by_ratio[0].albedos, planned.albedos);
        }
    }
}

#[test]
fn a_fixed_exposure_is_planned_as_it_is_photographed() {
    let plan = |exposure| {
        let grid = PlanGrid { frames: vec![1], ratios: vec![0.5], ..PlanGrid::default() };
        let sensor = Sensor { read_noise_electrons: 0.0, ..Sensor::default() };
        plan_rig(&SimulateOptions { exposure, sensor, ..small("groove") }, &grid, &Unwatched)
    };
    let noise = |light: f64| plan(Exposure::White(light)).unwrap().by_frames[0].noise_deg;
    // Of a quarter of the light, photon noise is twice as large a part; and indirect light that is noisier is averaged less well.
    let ratio = noise(0.1) / noise(0.4);
    assert!((1.9..2.6).contains(&ratio), "{ratio}");
    let other_paint = |exposure| plan(exposure).unwrap().by_ratio[0].noise_deg;
    assert_eq!(other_paint(Exposure::White(0.1)), other_paint(Exposure::Brightest(0.85)), "exposed again");
    let refused = plan(Exposure::White(1e4)).unwrap_err().to_string();
    assert!(refused.contains("lower the exposure"), "{refused}");
}

#[test]
fn a_mesh_is_refined_and_photographed_from_its_front() {
    let coarse = Shape::Corner { wall_mm: 60.0, roll_deg: -10.0 }.mesh(6).unwrap().welded().0;
    let corner = |mesh| SimulateOptions { scene: Scene::Mesh { name: "scan".into(), mesh }, ..small("corner") };
    let simulated = made(&corner(coarse.clone()));
    assert!(simulated.report.factors.patches > 150, "{}", simulated.report.factors.patches);
    // The same light as the built-in corner, whatever the patches.
    let mean = |simulated: &Simulated| {
        let bounce = &simulated.truth.bounces[0][1];
        f64::from(bounce.data().iter().sum::<f32>()) / simulated.truth.rig.radiance_to_linear
    };
    let (of_mesh, built_in) = (mean(&simulated), mean(&made(&small("corner"))));
    assert!((of_mesh / built_in - 1.0).abs() < 0.01, "{of_mesh} {built_in}");

    let mut inside_out = coarse;
    inside_out.triangles.iter_mut().for_each(|[_, b, c]| std::mem::swap(b, c));
    let refused = simulate(&corner(inside_out), &Unwatched).unwrap_err();
    assert!(matches!(refused, SimulateError::InsideOut { percent, .. } if percent > 99.0), "{refused}");
}

#[test]
fn only_a_simulated_set_is_replaced() {
    let place = tempfile::tempdir().unwrap();
    let folder = place.path().join("set");
    let simulated = made(&SimulateOptions { balls: None, ..small("groove") });
    write_simulated(&simulated, &folder).unwrap();
    let photo = folder.join("object/light1-c1.png");
    let before = fs::read(&photo).unwrap();
    write_simulated(&simulated, &folder).unwrap();
    assert_eq!(fs::read(&photo).unwrap(), before, "one seed, one set");

    fs::write(folder.join("notes.txt"), "mine").unwrap();
    let refused = write_simulated(&simulated, &folder).unwrap_err();
    assert!(refused.to_string().contains("notes.txt"), "{refused}");
    fs::remove_file(folder.join("notes.txt")).unwrap();
    fs::remove_file(folder.join("truth/rig.json")).unwrap();
    assert!(matches!(write_simulated(&simulated, &folder), Err(SimulateError::ForeignFiles { .. })));
    let left: Vec<_> = fs::read_dir(place.path()).unwrap().chain(fs::read_dir(&folder).unwrap()).flatten().collect();
    assert!(left.iter().all(|entry| !entry.file_name().to_string_lossy().starts_with('.')), "no staging left");
}

#[test]
fn what_is_out_of_range_is_refused() {
    let refused = |options: SimulateOptions| options.check().unwrap_err().to_string();
    let corner = || small("corner");
    assert!(refused(SimulateOptions { albedos: vec![1.2, 0.3], ..corner() }).contains("albedo 1.2"));
    assert!(refused(SimulateOptions { albedos: vec![0.5], ..corner() }).contains("2 colour names for 1"));
    assert!(refused(SimulateOptions { lamps: vec![], ..corner() }).contains("lamps"));
    assert!(refused(SimulateOptions { patches: 1_000_000, ..corner() }).contains("patches"));
    let lamps = LampOptions::named([LampPlace::Direction([0.0, 1.0, -0.2])]);
    assert!(refused(SimulateOptions { lamps, ..corner() }).contains("light1 is behind the object"));
    let lens = Lens::Perspective { working_distance_mm: 10.0 };
    let too_near = simulate(&SimulateOptions { lens, ..corner() }, &Unwatched).unwrap_err();
    assert!(too_near.to_string().contains("working_distance_mm"), "{too_near}");
}
