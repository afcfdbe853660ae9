//! The least error that any separation could leave: the true direct light, with no more than the noise of the photos.

use firstbounce_core::Plane;
use firstbounce_core::separate::Separation;
use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rayon::prelude::*;

use super::super::{Direct, PipelineError, Scene};

/// Any number: the same noise in every run.
const SEED: u64 = 2011;

/// True direct light where the separation solved its pixels.
pub(super) fn true_direct(truth: &[Plane], like: &[Separation]) -> Vec<Direct> {
    let direct = |(light, like): (&Plane, &Separation)| Direct {
        light: light.clone(),
        noise: None,
        marks: like.marks.clone(),
        report: None,
    };
    truth.iter().zip(like).map(direct).collect()
}

/// The same with the noise that the photos of all colours together would leave in it, were there no indirect light to tell
/// apart: `1 / sqrt(sum of beta_c^2 / variance of N_c / alpha_c)`.
pub(super) fn noisy_direct(scene: &Scene, truth: &[Plane], like: &[Separation]) -> Result<Vec<Direct>, PipelineError> {
    let beta = if scene.set.colours.len() > 1 { scene.calibrated.beta_values()? } else { vec![1.0] };
    let mut lights = true_direct(truth, like);
    for (l, direct) in lights.iter_mut().enumerate() {
        let alpha = scene.alpha(l)?;
        let (photos, noise) = (&scene.object.photos[l], &scene.object.noise[l]);
        let sigma = |pixel: usize| {
            let precision = |c: usize| {
                let variance = noise[c].variance(f64::from(photos[c].linear.data()[pixel])) / alpha[c].powi(2);
                if variance > 0.0 { beta[c].powi(2) / variance } else { 0.0 }
            };
            let precision: f64 = (0..beta.len()).map(precision).sum();
            if precision > 0.0 { precision.sqrt().recip() as f32 } else { 0.0 }
        };
        let (width, height) = direct.light.size();
        let sigma = (0..width * height).into_par_iter().map(sigma).collect();
        let sigma = Plane::from_vec(width, height, sigma).unwrap_or_default();
        let mut random = StdRng::seed_from_u64(SEED + l as u64);
        for (light, sigma) in direct.light.data_mut().iter_mut().zip(sigma.data()) {
            *light += sigma * random.sample::<f32, _>(StandardNormal);
        }
        direct.noise = Some(sigma);
    }
    Ok(lights)
}
