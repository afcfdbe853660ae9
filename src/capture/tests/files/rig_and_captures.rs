//! What the captures table and the calibration show of the demo set, whose rig is known.

use std::path::Path;

use firstbounce_capture::CaptureSet;
use firstbounce_capture::image_file::{mask_png, read_mask};
use firstbounce_capture::pipeline::{Calibrated, Preference, Source, Unattended, Verdict, calibrate, survey};
use firstbounce_capture::set::{SphereKind, Subject};
use firstbounce_core::Mask;
use firstbounce_core::calibrate::PixelUse;
use firstbounce_core::trust::Level;

fn demo() -> CaptureSet {
    CaptureSet::open(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/demo")).unwrap()
}

fn measured(set: &CaptureSet) -> Calibrated {
    calibrate(set, Preference::Balls, &Unattended).unwrap()
}

/// The render's own values.
const ALPHA_GREEN: [(&str, f64); 3] =
    [("left", 3.2), ("top", 3.428_571_428_571_428_4), ("right", 3.052_631_578_947_368_5)];

#[test]
fn every_ratio_brings_the_pixels_it_was_made_from() {
    let set = demo();
    let calibrated = measured(&set);
    assert_eq!(calibrated.ratios.len(), 6, "one colour beside the reference, three lights, two balls");
    for (l, (light, alpha)) in ALPHA_GREEN.into_iter().enumerate() {
        assert_eq!(set.lights[l].name, light);
        let report = &calibrated.evidence(SphereKind::Grey, l, 1).unwrap().report;
        let used = report.pixels.uses.iter().filter(|pixel| **pixel == PixelUse::Used).count();
        assert_eq!(report.pixel_ratios.len(), used);
        let mut ratios = report.pixel_ratios.clone();
        ratios.sort_by(f32::total_cmp);
        let median = f64::from(ratios[ratios.len() / 2]);
        assert!((median / alpha - 1.0).abs() < 0.02, "{light}: {median} for {alpha}");
    }
}

#[test]
fn what_is_measured_well_is_fine_and_colours_too_alike_are_not() {
    let fine = |verdict: Option<Verdict>| verdict.is_some_and(|verdict| verdict.level == Level::Fine);
    let mut set = demo();
    let calibrated = measured(&set);
    for l in 0..3 {
        assert!(fine(calibrated.judge_alpha(l, 1)));
        assert!(fine(calibrated.judge_direction(l)));
        assert!(fine(calibrated.judge_intensity(l)));
    }
    assert!(fine(calibrated.judge_beta(&set, 1)));
    assert!(fine(calibrated.judge_beta(&set, 0)));

    set.calibration.beta = Some(vec![1.0, 0.97]);
    let typed = calibrate(&set, Preference::File, &Unattended).unwrap();
    let verdict = typed.judge_beta(&set, 1).unwrap();
    assert_eq!(verdict.level, Level::DoNotTrust);
    assert_eq!(
        calibrated.clone().with_given(&set).judge_beta(&set, 1),
        Some(verdict.clone()),
        "at once, without a second look"
    );
    assert!(verdict.reason().contains("times the noise of a photo"), "{verdict:?}");
    set.calibration.beta = Some(vec![1.0, 0.999]);
    let alike = calibrated.clone().with_given(&set).judge_beta(&set, 1).unwrap();
    assert!(alike.reason().contains("too alike to tell bounces apart"), "{alike:?}");
    set.calibration.beta = Some(vec![1.0, 0.97]);
}

#[test]
fn a_chosen_highlight_is_the_direction_in_force_and_a_deleted_one_gives_way() {
    let mut set = demo();
    let calibrated = measured(&set);
    let candidates = &calibrated.highlights[1].as_ref().unwrap().candidates;
    assert_eq!(calibrated.highlight_without(1, &[]), candidates.first());
    assert_eq!(calibrated.highlight_without(1, &[0]), candidates.get(1));
    assert_eq!(calibrated.highlight_without(9, &[]), None);

    let chosen = [0.6, 0.0, 0.8];
    set.put_direction("top", chosen);
    let direction = calibrate(&set, Preference::File, &Unattended).unwrap().direction[1].clone().unwrap();
    assert_eq!(direction.source, Source::File);
    assert!(direction.value.iter().zip(chosen).all(|(a, b)| (a - b).abs() < 1e-12));
}

#[test]
fn a_rig_carried_to_itself_changes_nothing() {
    let set = demo();
    let values = measured(&set).values(&set);
    let mut other = demo();
    let carried = other.use_rig(&set, &values, true);
    assert_eq!((carried.lights.len(), carried.beta), (3, true));
    assert_eq!(other.calibration, values);
}

#[test]
fn the_demo_is_well_exposed_and_a_shorter_white_level_clips_it() {
    let mut set = demo();
    let seen = survey(&set, &Unattended).unwrap().shots;
    assert_eq!(seen.len(), set.shots.len());
    let mask = read_mask(&set.resolve(set.mask.as_ref().unwrap())).unwrap().mask;
    for (shot, exposed) in set.shots.iter().zip(&seen) {
        let exposed = exposed.as_ref().unwrap();
        assert!(exposed.clipped < 0.05 && (0.0..1.0).contains(&exposed.mean), "{shot:?} {exposed:?}");
        if shot.subject == Subject::Object {
            assert_eq!(exposed.pixels, mask.count());
        }
    }
    set.camera.white_level = Some(6000.0);
    let clipped = survey(&set, &Unattended).unwrap().shots;
    assert!(
        clipped
            .iter()
            .zip(&set.shots)
            .any(|(exposed, shot)| { shot.subject == Subject::Object && exposed.as_ref().unwrap().clipped > 0.2 })
    );
}

#[test]
fn a_mask_comes_back_from_its_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mask.png");
    let mask = Mask::polygon((31, 17), &[[2.0, 2.0], [28.0, 4.0], [10.0, 15.0]]);
    std::fs::write(&path, mask_png(&mask).unwrap()).unwrap();
    assert_eq!(read_mask(&path).unwrap().mask, mask);
    assert!(mask_png(&Mask::filled(0, 0, true)).is_err());
}
