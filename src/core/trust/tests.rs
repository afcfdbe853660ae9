use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;

use super::*;
use crate::interval::Interval;

fn exact(values: &[f64]) -> Vec<Estimate> {
    values.iter().map(|value| Estimate::exact(*value)).collect()
}

fn within(value: f64, half_width: f64) -> Estimate {
    Estimate { value, interval: Interval::around(value, half_width) }
}

/// Three lamps 35 degrees off the axis, and photos of an object that sends the share `share` of its light back to itself.
fn rig(beta: &[f64], share: f64, sigma: f64) -> Rig {
    let light = |l: usize| {
        let turn = std::f64::consts::TAU * l as f64 / 3.0;
        let toward = Vector3::new(0.57 * turn.cos(), 0.57 * turn.sin(), 0.82);
        let alpha: Vec<_> = (0..beta.len()).map(|c| 1.0 + 0.7 * c as f64).collect();
        let mean = (0..beta.len()).map(|c| alpha[c] * 0.2 * beta[c] / (1.0 - beta[c] * share)).collect();
        let sigma = alpha.iter().map(|alpha| alpha * sigma).collect();
        LightLevels { alpha: exact(&alpha), mean, sigma, toward: Some(toward) }
    };
    Rig { beta: exact(beta), lights: (0..3).map(light).collect(), products: DMatrix::zeros(0, 0), frames: 1 }
}

fn of_order(bounces: usize) -> TrustOptions {
    TrustOptions { bounces, ..TrustOptions::default() }
}

fn names() -> ([String; 3], [String; 3]) {
    (["blue", "green", "red"].map(String::from), ["left", "top", "right"].map(String::from))
}

fn said(trust: &Trust) -> String {
    let (colours, lights) = names();
    let names = Names { colours: &colours, lights: &lights };
    trust.reasons.iter().map(|(level, reason)| format!("{}: {}\n", level.words(), reason.words(&names))).collect()
}

#[test]
fn clean_photos_of_two_good_colours_are_fine() {
    let trust = judge(&rig(&[1.0, 0.5], 0.1, 1e-4), &of_order(2)).unwrap();
    assert_eq!(trust.level, Level::Fine, "{}", said(&trust));
    assert!(trust.reasons.is_empty());
}

/// METHOD.md, equation (b): the gain at 0.97 is sqrt(1 + 0.97^4) / (0.97 * 0.03) = 47.
#[test]
fn colours_that_see_the_paint_alike_are_not_trusted() {
    let trust = judge(&rig(&[1.0, 0.97], 0.1, 1e-4), &of_order(2)).unwrap();
    assert_eq!(trust.level, Level::DoNotTrust);
    assert!(said(&trust).contains("beta of green is 0.970: blue and green see the paint alike"), "{}", said(&trust));
    assert!(said(&trust).contains("47 times"));
}

#[test]
fn colours_too_alike_to_solve_are_a_verdict_and_not_an_error() {
    let trust = judge(&rig(&[1.0, 0.5, 0.51], 0.1, 1e-4), &of_order(2)).unwrap();
    assert_eq!(trust.level, Level::DoNotTrust);
    assert!(matches!(trust.advice[0], Advice::LeaveOut { gain, .. } if gain < 5.0), "{:?}", trust.advice);
    assert!(matches!(judge(&rig(&[1.0, 0.5], 0.1, 1e-4), &of_order(3)), Err(SeparateError::Order { .. })));
}

#[test]
fn one_bounce_leaves_the_indirect_light_in_and_two_are_advised() {
    let trust = judge(&rig(&[1.0, 0.5], 0.3, 1e-4), &of_order(1)).unwrap();
    assert_eq!(trust.level, Level::DoNotTrust);
    assert!(said(&trust).contains("too bright"), "{}", said(&trust));
    assert!(matches!(trust.advice[0], Advice::Order { bounces: 2, instead: 1, .. }), "{:?}", trust.advice);
}

#[test]
fn noise_asks_for_frames_that_take_it_below_the_limit() {
    let mut noisy = rig(&[1.0, 0.5], 0.1, 0.008);
    noisy.frames = 4;
    let trust = judge(&noisy, &of_order(2)).unwrap();
    let frames = trust.advice.iter().find_map(|advice| match advice {
        Advice::Frames { frames, instead: 4, degrees, .. } => Some((*frames, *degrees)),
        _ => None,
    });
    let (frames, degrees) = frames.unwrap();
    let scale = (4.0 / frames as f64).sqrt();
    noisy.lights.iter_mut().for_each(|light| light.sigma.iter_mut().for_each(|sigma| *sigma *= scale));
    let then = judge(&noisy, &of_order(2)).unwrap().normal.unwrap().denoised_noise_deg;
    assert!((then - degrees).abs() < 1e-9 && then <= 2.0, "{then}");
}

#[test]
fn a_wrong_beta_contradicts_the_photos() {
    let mut wrong = rig(&[1.0, 0.5], 0.1, 1e-4);
    wrong.beta = exact(&[1.0, 0.4]);
    let trust = judge(&wrong, &of_order(2)).unwrap();
    assert!(matches!(trust.reasons[0], (Level::DoNotTrust, Reason::Contradicted { .. })), "{}", said(&trust));
}

/// The law of a spherical cap is exact: what truncation is charged with is what a fit of its photos gets wrong.
#[test]
fn the_truncation_error_of_a_cap_is_predicted_exactly() {
    for (beta, bounces) in
        [(vec![1.0, 0.5], 1), (vec![1.0, 0.5], 2), (vec![1.0, 0.7, 0.3], 2), (vec![1.0, 0.7, 0.3], 3)]
    {
        for share in [0.1, 0.3, 0.5] {
            let rig = rig(&beta, share, 1e-4);
            let trust = judge(&rig, &of_order(bounces)).unwrap();
            for light in &trust.lights {
                assert!((light.return_share.unwrap() - share).abs() < 1e-4);
                let error = 100.0 * (light.bounces[0] / 0.2 - 1.0);
                assert!((light.truncation_percent.unwrap() - error).abs() < 0.05, "{bounces} bounces, share {share}");
            }
        }
    }
}

/// Every random draw of alpha and beta from its interval, separated again, against the first-order formulas.
#[test]
fn calibration_errors_are_those_of_random_calibrations() {
    let mut truth = rig(&[1.0, 0.55], 0.2, 1e-4);
    truth.beta[1] = within(0.55, 0.006);
    truth.lights.iter_mut().for_each(|light| light.alpha[1] = within(light.alpha[1].value, 0.01));
    let predicted = assess(&truth, &of_order(2)).unwrap();

    let mut random = StdRng::seed_from_u64(3);
    let (mut light_squares, mut turn_squares) = (0.0, 0.0);
    const DRAWS: usize = 20_000;
    let matrix = nalgebra::Matrix3::from_rows(&[0, 1, 2].map(|l| truth.lights[l].toward.unwrap().transpose()));
    let inverse = matrix.try_inverse().unwrap();
    let direct = |l: usize, alpha: &[f64], beta: &[f64]| {
        let light = &truth.lights[l];
        let system = BounceSystem::new(alpha, beta, &light.sigma, 2).unwrap();
        (system.operator * DVector::from_column_slice(&light.mean))[0]
    };
    let normal_of = |lights: [f64; 3]| (inverse * Vector3::from(lights)).normalize();
    let right = normal_of([0, 1, 2].map(|l| predicted.lights[l].bounces[0]));
    for _ in 0..DRAWS {
        let mut draw = |estimate: &Estimate| estimate.value + estimate.sd() * random.sample::<f64, _>(StandardNormal);
        let beta = [1.0, draw(&truth.beta[1])];
        let lights = [0, 1, 2].map(|l| direct(l, &[1.0, draw(&truth.lights[l].alpha[1])], &beta));
        light_squares += (lights[0] / predicted.lights[0].bounces[0] - 1.0).powi(2);
        turn_squares += normal_of(lights).cross(&right).norm_squared();
    }
    let percent = 100.0 * (light_squares / DRAWS as f64).sqrt();
    let degrees = (turn_squares / DRAWS as f64).sqrt().to_degrees();
    assert!((percent / predicted.lights[0].calibration_percent.unwrap() - 1.0).abs() < 0.03, "{percent}");
    assert!((degrees / predicted.normal.unwrap().calibration_deg - 1.0).abs() < 0.03, "{degrees}");
}

/// Noise through the same lamps, by the normals stage itself.
#[test]
fn noise_in_degrees_is_that_of_photometric_stereo() {
    use crate::stereo::normals::{DirectLight, Lamp, NormalsOptions, Surface, normals};
    use crate::{Camera, Marks, Mask, Plane, Projection, Unwatched};

    let rig = rig(&[1.0, 0.5], 0.2, 5e-4);
    let trust = assess(&rig, &of_order(2)).unwrap();
    let plane = |value: f64| Plane::filled(1, 1, value as f32);
    let direct: Vec<_> = trust.lights.iter().map(|light| plane(light.bounces[0])).collect();
    let noise: Vec<_> =
        trust.lights.iter().map(|light| plane(light.noise_percent / 100.0 * light.bounces[0])).collect();
    let marks = Marks::filled(1, 1, 0);
    let lights: Vec<_> = (0..3)
        .map(|l| DirectLight {
            direct: &direct[l],
            noise: Some(&noise[l]),
            marks: &marks,
            lamp: Lamp::Distant(rig.lights[l].toward.unwrap()),
            intensity: rig.lights[l].toward.unwrap().norm(),
        })
        .collect();
    let camera = Camera { projection: Projection::Orthographic { mm_per_pixel: None }, size: (1, 1) };
    let surface = Surface { camera: &camera, depth_mm: None };
    let (_, report) =
        normals(&lights, &Mask::filled(1, 1, true), surface, &NormalsOptions::default(), &Unwatched).unwrap();
    assert!((report.mean_noise_deg / trust.normal.unwrap().noise_deg - 1.0).abs() < 1e-4);
}

#[test]
fn the_best_pair_is_named() {
    let trust = judge(&rig(&[1.0, 0.8, 0.5], 0.1, 1e-4), &of_order(2)).unwrap();
    let pair = trust.advice.iter().find_map(|advice| match advice {
        Advice::Pair { best, worst } => Some((*best, *worst)),
        _ => None,
    });
    let (best, worst) = pair.unwrap();
    assert_eq!((best.first, best.second, worst.first, worst.second), (0, 2, 0, 1));
    assert!((best.gain - 4.12).abs() < 0.01 && (worst.gain - 7.42).abs() < 0.01);
}

proptest! {
    #[test]
    fn the_curve_of_figure_three_is_the_gain_of_the_system(ratio in prop_oneof![0.05..0.97_f64, 1.03..4.0_f64]) {
        let system = BounceSystem::new(&[1.0; 2], &[1.0, ratio], &[1.0; 2], 2).unwrap();
        prop_assert!((gain_of_ratio(ratio) / system.gain[0] - 1.0).abs() < 1e-6);
    }

    #[test]
    fn whatever_is_typed_gets_a_verdict(
        beta in prop::collection::vec(0.01..3.0_f64, 1..4),
        share in -0.4..0.9_f64,
        bounces in 1usize..5,
    ) {
        let rig = rig(&beta, share.min(0.9 / beta.iter().copied().fold(1.0, f64::max)), 1e-3);
        if let Ok(trust) = judge(&rig, &of_order(bounces)) {
            prop_assert!(trust.reasons.iter().all(|(level, _)| *level > Level::Fine && *level <= trust.level));
        } else {
            prop_assert!(bounces > beta.len());
        }
    }
}

/// Too little light in the darker colour for its alpha: two bounces then leave nothing, or less, for bounce 1.
#[test]
fn a_negative_bounce_1_is_told_in_words_and_no_percentage_of_it() {
    let mut negative = rig(&[1.0, 0.5], 0.1, 1e-3);
    negative.lights.iter_mut().for_each(|light| light.mean[1] *= 0.2);
    let trust = judge(&negative, &of_order(2)).unwrap();
    assert_eq!(trust.level, Level::DoNotTrust);
    let words = said(&trust);
    assert!(words.contains("bounce 1 comes out negative"), "{words}");
    assert!(!words.contains("inf") && !words.contains("NaN"), "{words}");
}

#[test]
fn colours_of_one_albedo_are_compared_with_no_result_in_words() {
    let trust = judge(&rig(&[1.0, 1.0], 0.1, 1e-3), &of_order(2)).unwrap();
    let (colours, lights) = names();
    let names = Names { colours: &colours, lights: &lights };
    let words: String = trust.advice.iter().map(|advice| advice.words(&names)).collect();
    assert!(!words.contains("inf") && !words.contains("NaN"), "{words}");
}
