//! Amount against albedo, and beta of the object, on rendered sets with truth.

use std::borrow::Cow;

use firstbounce_core::Mask;
use firstbounce_core::methods::colours_and_shape::{ClosureFinding, ClosureReport};
use firstbounce_testing::shared_set;

use super::super::calibrate::Source;
use super::super::{
    Calibrated, ObjectPhotos, PhotoStore, Scene, SolveOptions, Solved, Unattended, calibrate_for, evaluate,
    load_object, reconstruct,
};
use crate::set::{CaptureSet, Subject};

/// The rendered sets' grey balls.
const GREY_ALBEDO: f64 = 0.5;

fn opened(name: &str) -> Option<CaptureSet> {
    let mut set = CaptureSet::open(shared_set(name)?).unwrap();
    set.calibration.grey_albedo = Some(GREY_ALBEDO);
    Some(set)
}

fn without_paint_ball(mut set: CaptureSet) -> CaptureSet {
    set.shots.retain(|shot| shot.subject != Subject::MaterialSphere);
    set.spheres.retain(|sphere| sphere.subject != Subject::MaterialSphere);
    set
}

/// Photos and rig, as the command line takes them.
fn photographed(set: &CaptureSet) -> (ObjectPhotos, Calibrated) {
    let object = load_object(set, &PhotoStore::default(), &Unattended).unwrap();
    let options = SolveOptions::of(set);
    let calibrated = calibrate_for(set, &object, &options, &PhotoStore::default(), &Unattended).unwrap();
    (object, calibrated)
}

fn solved(set: &CaptureSet, object: ObjectPhotos, calibrated: Calibrated) -> Solved {
    let scene = Scene { set: Cow::Borrowed(set), object: Cow::Owned(object), calibrated: Cow::Owned(calibrated) };
    reconstruct(scene, None, &SolveOptions::of(set), Vec::new(), &Unattended).unwrap()
}

fn closure(solved: &Solved) -> &ClosureReport {
    solved.report.colours_and_shape().unwrap().report.closure.as_ref().unwrap()
}

fn of_beta(finding: &ClosureFinding) -> bool {
    matches!(finding, ClosureFinding::BetaOff { .. } | ClosureFinding::BeyondBeta { .. })
}

/// Name of the set, the paint's albedo in the reference colour, and whether walls are out of view.
const ALBEDOS: [(&str, f64, bool); 6] = [
    ("corner-quiet", 0.75, true),
    ("corner-blue", 0.75, true),
    ("groove-quiet", 0.72, true),
    ("groove-rgb", 0.72, true),
    ("bowl-quiet", 0.78, false),
    ("bowl-four", 0.78, false),
];

#[test]
fn albedo_and_what_is_in_view_of_rendered_sets() {
    for (name, albedo, is_cut) in ALBEDOS {
        let Some(set) = opened(name) else { continue };
        let (object, calibrated) = photographed(&set);
        let solved = solved(&set, object, calibrated);
        let closure = closure(&solved);
        let found = closure.albedo.unwrap();
        println!("{name}: k {found:.4} for {albedo}, s / k {:?}, {:?}", closure.s_over_k, closure.findings);
        assert!((found / albedo - 1.0).abs() < 0.005, "{name}: {found}");
        assert!(!closure.findings.iter().any(of_beta), "{name}: {:?}", closure.findings);
        let told = closure.findings.iter().any(|finding| matches!(finding, ClosureFinding::OutOfView { .. }));
        assert_eq!(told, is_cut, "{name}: {:?}", closure.findings);
    }
}

#[test]
fn a_wrong_beta_of_a_bowl_is_told_and_which_way() {
    let Some(mut set) = opened("bowl-quiet") else { return };
    let (object, right) = photographed(&set);
    let right = right.beta_values().unwrap();
    for (factor, way) in [(1.02, "large"), (0.98, "small")] {
        let wrong = right.iter().enumerate().map(|(c, beta)| if c == 0 { 1.0 } else { beta * factor });
        set.calibration.beta = Some(wrong.collect());
        let options = SolveOptions::of(&set);
        let calibrated = calibrate_for(&set, &object, &options, &PhotoStore::default(), &Unattended).unwrap();
        let solved = solved(&set, object.clone(), calibrated);
        let warnings = solved.report.warnings(0).join("; ");
        println!("{factor}: {warnings}");
        assert!(warnings.contains(&format!("too {way}")), "{warnings}");
        assert!(!warnings.contains("out of view"), "{warnings}");
        assert!(solved.trust.level > firstbounce_core::trust::Level::Fine);
    }
}

#[test]
fn a_bowl_with_a_third_cut_away_is_out_of_view() {
    let Some(set) = opened("bowl-quiet") else { return };
    let (mut object, calibrated) = photographed(&set);
    let (width, height) = object.mask.size();
    object.mask = Mask::from_fn(width, height, |x, y| object.mask.at(x, y) && 3 * x < 2 * width);
    let solved = solved(&set, object, calibrated);
    let findings = &closure(&solved).findings;
    assert!(matches!(findings[..], [ClosureFinding::OutOfView { .. }]), "{findings:?}");
}

/// Name of the set, the true beta, and how far off it may be found.
const BETAS: [(&str, &[f64], f64); 2] =
    [("bowl-quiet", &[0.59 / 0.78, 0.39 / 0.78, 0.2 / 0.78], 0.004), ("corner-quiet", &[0.38 / 0.75], 0.015)];

#[test]
fn beta_without_a_ball_of_the_paint() {
    for (name, truth, most) in BETAS {
        let Some(set) = opened(name).map(without_paint_ball) else { continue };
        let (_, calibrated) = photographed(&set);
        let beta = calibrated.beta.as_ref().unwrap();
        for (known, truth) in beta.iter().skip(1).zip(truth) {
            println!("{name}: {:.4} for {truth:.4}, {:?}", known.value, known.interval);
            assert_eq!(known.source, Source::Object);
            assert!((known.value / truth - 1.0).abs() < most, "{name}: {} for {truth}", known.value);
            let [low, high] = known.interval.unwrap();
            assert!(low <= *truth && *truth <= high, "{name}: {low} to {high} for {truth}");
        }
        assert!(calibrated.warnings.is_empty(), "{name}: {:?}", calibrated.warnings);
    }
}

#[test]
fn normals_of_a_corner_without_a_ball_of_the_paint() {
    let Some(set) = opened("corner-quiet").map(without_paint_ball) else { return };
    let found = evaluate(&set, &SolveOptions::of(&set), &Unattended).unwrap();
    let degrees = found.normal_error_deg.separated.mean;
    assert!(degrees <= 0.65, "{degrees}");
}

/// In a corner light from other walls falls in everywhere; without an albedo nothing tells how much.
#[test]
fn a_corner_without_paint_ball_and_grey_albedo_is_a_guess_with_a_wide_interval() {
    let Some(mut set) = opened("corner-quiet").map(without_paint_ball) else { return };
    set.calibration.grey_albedo = None;
    let (_, calibrated) = photographed(&set);
    let [low, high] = calibrated.beta.as_ref().unwrap()[1].interval.unwrap();
    assert!(low < 0.38 / 0.75 && high > 0.38 / 0.75, "{low} to {high}");
    assert!(calibrated.warnings.iter().any(|line| line.contains("is a guess")), "{:?}", calibrated.warnings);
}
