use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;

use super::*;
use crate::image::noise::{NoiseModel, NoiseSource};
use crate::separate::{SeparateOptions, separate};
use crate::{Mask, Photo, Unwatched};

const SIZE: (usize, usize) = (240, 180);
const ALPHA: [f64; 2] = [1.0, 3.0];
const BETA: [f64; 2] = [1.0, 0.5];
const NOISE: NoiseModel = NoiseModel { floor: 4e-6, per_signal: 2e-5, source: NoiseSource::Camera };

/// Direct light with fine texture and a crease; indirect light that is slow but jumps at the crease too.
fn scene(random: &mut StdRng) -> (Plane, Vec<Photo>) {
    let left = |x: usize| x < 120;
    let direct = Plane::from_fn(SIZE.0, SIZE.1, |x, y| {
        let texture = 0.03 * ((x as f32 * 1.3).sin() + (y as f32 * 0.9).cos());
        texture + if left(x) { 0.5 } else { 0.25 }
    });
    let indirect = Plane::from_fn(SIZE.0, SIZE.1, |x, y| {
        let slow = 0.02 * (y as f32 / 60.0).sin() - 0.0004 * (x as f32 - 120.0).abs();
        0.1 + slow + if left(x) { 0.04 } else { 0.0 }
    });
    let photos = (0..2).map(|c| {
        let (alpha, beta) = (ALPHA[c] as f32, BETA[c] as f32);
        Photo::unmarked(Plane::from_fn(SIZE.0, SIZE.1, |x, y| {
            let light = alpha * (beta * direct.at(x, y) + beta * beta * indirect.at(x, y));
            light + NOISE.sigma(f64::from(light)) as f32 * random.sample::<f32, _>(StandardNormal)
        }))
    });
    let photos = photos.collect();
    (direct, photos)
}

fn rms_error(found: &Plane, truth: &Plane, columns: std::ops::Range<usize>) -> f64 {
    let mut squares = 0.0;
    for y in 0..SIZE.1 {
        squares += columns.clone().map(|x| f64::from(found.at(x, y) - truth.at(x, y)).powi(2)).sum::<f64>();
    }
    (squares / (SIZE.1 * columns.len()) as f64).sqrt()
}

#[test]
fn direct_light_is_less_noisy_as_predicted_and_keeps_texture_and_crease() {
    let (truth, photos) = scene(&mut StdRng::seed_from_u64(5));
    let photos: Vec<_> = photos.iter().collect();
    let mask = Mask::filled(SIZE.0, SIZE.1, true);
    let light = LightPhotos { photos: &photos, noise: &[NOISE; 2], alpha: &ALPHA, beta: &BETA, mask: &mask };
    let (separation, _) = separate(&light, &SeparateOptions::default(), &Unwatched).unwrap();
    let denoised = denoise_direct(&light, &separation, &DenoiseOptions::default(), &Unwatched).unwrap();

    let before = rms_error(&separation.bounces[0], &truth, 0..SIZE.0);
    let after = rms_error(&denoised.direct, &truth, 0..SIZE.0);
    let photo = NOISE.sigma(0.5);
    assert!(before > 1.5 * photo && after < 1.1 * photo, "{before} before, {after} after; a photo has {photo}");
    assert!(rms_error(&denoised.direct, &truth, 110..130) < 0.75 * before, "at the crease");
    let predicted = denoised.report.noise_after;
    assert!((0.7..1.4).contains(&(after / predicted)), "{after} for a predicted {predicted}");
}

#[test]
fn without_a_window_the_separation_stays_as_it_is() {
    let (_, photos) = scene(&mut StdRng::seed_from_u64(6));
    let photos: Vec<_> = photos.iter().collect();
    let mask = Mask::from_fn(SIZE.0, SIZE.1, |x, _| x > 10);
    let light = LightPhotos { photos: &photos, noise: &[NOISE; 2], alpha: &ALPHA, beta: &BETA, mask: &mask };
    let (separation, _) = separate(&light, &SeparateOptions::default(), &Unwatched).unwrap();
    let options = DenoiseOptions { radius_px: 0, ..DenoiseOptions::default() };
    let same = denoise_direct(&light, &separation, &options, &Unwatched).unwrap();
    assert_eq!(same.direct, separation.bounces[0]);
    let denoised = denoise_direct(&light, &separation, &DenoiseOptions::default(), &Unwatched).unwrap();
    assert_eq!(denoised.direct.at(3, 50), 0.0);
}
