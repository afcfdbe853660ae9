use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;

use super::*;
use crate::Unwatched;
use crate::image::noise::NoiseSource;
use crate::image::photo::{CLIPPED, DARK};

const ALPHA: [f64; 3] = [1.0, 2.2, 0.7];
const BETA: [f64; 3] = [1.0, 0.6, 0.3];
const NOISE: NoiseModel = NoiseModel { floor: 1e-8, per_signal: 1e-6, source: NoiseSource::Camera };
const SIZE: (usize, usize) = (300, 230);

/// Two bounces that vary over the picture, and the photos they make under three colours.
fn scene() -> (Vec<Plane>, Vec<Photo>) {
    let direct = Plane::from_fn(SIZE.0, SIZE.1, |x, y| 0.2 + 0.5 * (x as f32 / 300.0) * (y as f32 / 230.0));
    let second = Plane::from_fn(SIZE.0, SIZE.1, |x, _| 0.05 + 0.1 * (x as f32 * 0.02).sin().abs());
    let photos = (0..3).map(|c| {
        let (alpha, beta) = (ALPHA[c] as f32, BETA[c] as f32);
        let light = |x, y| alpha * (beta * direct.at(x, y) + beta * beta * second.at(x, y));
        Photo::unmarked(Plane::from_fn(SIZE.0, SIZE.1, light))
    });
    let photos = photos.collect();
    (vec![direct, second], photos)
}

fn run(photos: &[Photo], colours: usize, bounces: usize, mask: &Mask) -> (Separation, SeparateReport) {
    let photos: Vec<_> = photos.iter().take(colours).collect();
    let light = LightPhotos {
        photos: &photos,
        noise: &[NOISE; 3][..colours],
        alpha: &ALPHA[..colours],
        beta: &BETA[..colours],
        mask,
    };
    separate(&light, &SeparateOptions { bounces }, &Unwatched).unwrap()
}

fn largest_error(found: &Plane, truth: &Plane) -> f32 {
    found.data().iter().zip(truth.data()).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn mixed_light_comes_apart_for_every_number_of_colours() {
    let (truth, photos) = scene();
    for colours in [2, 3] {
        let (separation, report) = run(&photos, colours, 2, &Mask::filled(SIZE.0, SIZE.1, true));
        for (found, truth) in separation.bounces.iter().zip(&truth) {
            assert!(largest_error(found, truth) < 2e-6);
        }
        assert_eq!(report.solved_pixels, SIZE.0 * SIZE.1);
        assert_eq!(separation.residual.is_some(), colours == 3);
        assert!(report.residual_rms.unwrap() < 1e-6);
    }
}

#[test]
fn a_clipped_colour_is_left_out_and_marked() {
    let (truth, mut photos) = scene();
    let bad = 70 * SIZE.0 + 41;
    photos[1].linear.data_mut()[bad] = 0.9;
    photos[1].marks.data_mut()[bad] = CLIPPED;
    let mask = Mask::filled(SIZE.0, SIZE.1, true);

    let (enough, report) = run(&photos, 3, 2, &mask);
    assert!((enough.bounces[0].data()[bad] - truth[0].data()[bad]).abs() < 2e-6);
    assert_eq!((enough.marks.data()[bad], report.reduced_pixels), (CLIPPED, 1));

    let (too_few, report) = run(&photos, 2, 2, &mask);
    assert_eq!((too_few.marks.data()[bad], too_few.bounces[0].data()[bad]), (CLIPPED | UNSOLVED, 0.0));
    assert_eq!((report.unsolved_clipped_pixels, report.unsolved_dark_pixels), (1, 0));
}

#[test]
fn dark_pixels_and_the_background_stay_zero() {
    let (_, mut photos) = scene();
    photos[0].marks.data_mut()[5] = DARK;
    let mask = Mask::from_fn(SIZE.0, SIZE.1, |x, _| x < 200);
    let (separation, report) = run(&photos, 2, 2, &mask);
    assert_eq!((separation.marks.data()[5], separation.marks.data()[250]), (DARK | UNSOLVED, OUTSIDE));
    assert_eq!((separation.bounces[0].data()[5], separation.bounces[1].data()[250]), (0.0, 0.0));
    assert_eq!((report.unsolved_dark_pixels, report.solved_pixels), (1, mask.count() - 1));
}

#[test]
fn predicted_noise_is_the_noise_that_comes_out() {
    let (truth, photos) = scene();
    let mut random = StdRng::seed_from_u64(3);
    let noisy: Vec<_> = photos
        .iter()
        .map(|photo| {
            let mut noisy =
                |light: f32| light + NOISE.sigma(f64::from(light)) as f32 * random.sample::<f32, _>(StandardNormal);
            let data = photo.linear.data().iter().map(|&light| noisy(light)).collect();
            Photo::unmarked(Plane::from_vec(SIZE.0, SIZE.1, data).unwrap())
        })
        .collect();
    for colours in [2, 3] {
        let (separation, report) = run(&noisy, colours, 2, &Mask::filled(SIZE.0, SIZE.1, true));
        let predicted = separation.direct_noise.unwrap();
        let normalised = separation.bounces[0]
            .data()
            .iter()
            .zip(truth[0].data())
            .zip(predicted.data())
            .map(|((found, truth), sigma)| f64::from((found - truth) / sigma).powi(2));
        let spread = (normalised.sum::<f64>() / (SIZE.0 * SIZE.1) as f64).sqrt();
        assert!((spread - 1.0).abs() < 0.02, "{colours} colours: {spread}");
        assert!(colours == 2 || (report.residual_rms.unwrap() / report.residual_expected.unwrap() - 1.0).abs() < 0.1);
    }
}

#[test]
fn reused_planes_give_the_same_answer() {
    let (_, photos) = scene();
    let mask = Mask::filled(SIZE.0, SIZE.1, true);
    let (fresh, _) = run(&photos, 2, 2, &mask);
    let (mut reused, _) = run(&photos, 3, 3, &mask);
    let photos: Vec<_> = photos.iter().take(2).collect();
    let light = LightPhotos { photos: &photos, noise: &[NOISE; 2], alpha: &ALPHA[..2], beta: &BETA[..2], mask: &mask };
    separate_into(&mut reused, &light, &SeparateOptions::default(), &Unwatched).unwrap();
    assert_eq!(fresh, reused);
}

#[test]
fn photos_of_another_size_are_refused() {
    let (_, mut photos) = scene();
    photos[1] = Photo::unmarked(Plane::filled(10, 10, 0.0));
    let photos: Vec<_> = photos.iter().take(2).collect();
    let mask = Mask::filled(SIZE.0, SIZE.1, true);
    let light = LightPhotos { photos: &photos, noise: &[NOISE; 2], alpha: &ALPHA[..2], beta: &BETA[..2], mask: &mask };
    let refused = separate(&light, &SeparateOptions::default(), &Unwatched);
    assert!(matches!(refused, Err(SeparateError::Size { found: (10, 10), .. })));
}
