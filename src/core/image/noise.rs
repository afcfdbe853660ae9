//! The noise of a photo: photon noise grows with the light, read noise does not.

use rayon::prelude::*;

use crate::{Mask, Photo};

/// Where a noise model comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoiseSource {
    /// Full well and read noise of the camera, as typed.
    Camera,
    /// The scatter of repeated photos.
    Repeats,
    /// The grain of a single photo.
    Grain,
}

/// Variance of a pixel's linear light: `floor + per_signal * light`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseModel {
    /// Variance at no light (read noise and quantisation), in squared linear light.
    pub floor: f64,
    /// Variance per unit of linear light (photon noise), in linear light.
    pub per_signal: f64,
    /// Where the two numbers come from.
    pub source: NoiseSource,
}

/// Grain is measured in this many steps of brightness, equally full.
const BRIGHTNESS_STEPS: usize = 16;
/// A step of fewer pixels than this says nothing about its scatter.
const MIN_PIXELS_PER_STEP: usize = 30;

impl NoiseModel {
    /// The noise of a camera: `full_well_electrons` at linear light 1, `read_noise_electrons` rms, a `frames`-fold mean,
    /// and light divided by `exposure`.
    pub fn of_camera(full_well_electrons: f64, read_noise_electrons: f64, frames: usize, exposure: f64) -> Self {
        let frames = frames.max(1) as f64;
        Self {
            floor: (read_noise_electrons / full_well_electrons / exposure).powi(2) / frames,
            per_signal: 1.0 / (full_well_electrons * exposure * frames),
            source: NoiseSource::Camera,
        }
    }

    /// Fits `variance = floor + per_signal * signal`, both non-negative, to measured pairs by least squares relative to
    /// the variance; `None` without a pair.
    pub fn fit(signal_and_variance: &[(f64, f64)], source: NoiseSource) -> Option<Self> {
        let used: Vec<_> = signal_and_variance.iter().filter(|(s, v)| s.is_finite() && v.is_finite()).collect();
        if used.is_empty() {
            return None;
        }
        let mean_variance = used.iter().map(|(_, v)| v).sum::<f64>() / used.len() as f64;
        // Each measured variance is uncertain in proportion to itself.
        let (mut w, mut ws, mut wss, mut wv, mut wsv) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for &&(signal, variance) in &used {
            let weight = 1.0 / variance.max(1e-3 * mean_variance).max(f64::MIN_POSITIVE).powi(2);
            w += weight;
            ws += weight * signal;
            wss += weight * signal * signal;
            wv += weight * variance;
            wsv += weight * signal * variance;
        }
        let determinant = w * wss - ws * ws;
        let slope = if determinant > 1e-9 * w * wss { (w * wsv - ws * wv) / determinant } else { 0.0 };
        let (floor, per_signal) = match ((wv - slope * ws) / w, slope) {
            (floor, slope) if floor >= 0.0 && slope >= 0.0 => (floor, slope),
            (floor, _) if floor < 0.0 => (0.0, wsv / wss),
            _ => (wv / w, 0.0),
        };
        Some(Self { floor, per_signal, source })
    }

    /// The same with this share of the variance.
    pub fn scaled(self, share: f64) -> Self {
        Self { floor: self.floor * share, per_signal: self.per_signal * share, ..self }
    }

    /// Variance at this linear light.
    pub fn variance(&self, light: f64) -> f64 {
        self.floor + self.per_signal * light.max(0.0)
    }

    /// Standard deviation at this linear light.
    pub fn sigma(&self, light: f64) -> f64 {
        self.variance(light).sqrt()
    }
}

/// Estimates the noise of a photo from its own grain: the response to Immerkaer's mask, which ignores anything that is
/// linear across three pixels, in steps of brightness (J. Immerkaer, "Fast Noise Variance Estimation", CVIU 64(2), 1996).
///
/// `quantisation_step` is the distance of two stored values in linear light; its variance is the least floor. Grain that
/// a camera has smoothed away (JPEG, denoised video) is not seen: the estimate is then too low.
pub fn estimate_noise(photo: &Photo, mask: &Mask, quantisation_step: f64) -> NoiseModel {
    let quantisation = quantisation_step.powi(2) / 12.0;
    let mut grain = grain_of_rows(photo, mask);
    grain.par_sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    let step = grain.len().div_ceil(BRIGHTNESS_STEPS).max(MIN_PIXELS_PER_STEP);
    let pairs: Vec<_> =
        grain.par_chunks_mut(step).filter(|s| s.len() >= MIN_PIXELS_PER_STEP).map(signal_and_variance).collect();
    let fitted = NoiseModel::fit(&pairs, NoiseSource::Grain);
    let model = fitted.unwrap_or(NoiseModel { floor: 0.0, per_signal: 0.0, source: NoiseSource::Grain });
    NoiseModel { floor: model.floor.max(quantisation), ..model }
}

/// (Local mean, absolute response of Immerkaer's mask) at every third pixel whose neighbourhood is good.
fn grain_of_rows(photo: &Photo, mask: &Mask) -> Vec<(f32, f32)> {
    const WEIGHTS: [[f32; 3]; 3] = [[1.0, -2.0, 1.0], [-2.0, 4.0, -2.0], [1.0, -2.0, 1.0]];
    let (width, height) = photo.linear.size();
    let rows = (1..height.saturating_sub(1)).into_par_iter().step_by(3);
    rows.flat_map_iter(|y| {
        (1..width.saturating_sub(1)).step_by(3).filter_map(move |x| {
            let (mut mean, mut response) = (0.0, 0.0);
            for (row, weights) in (y - 1..=y + 1).zip(WEIGHTS) {
                for (column, weight) in (x - 1..=x + 1).zip(weights) {
                    let pixel = row * width + column;
                    if !mask.data()[pixel] || photo.marks.data()[pixel] != 0 {
                        return None;
                    }
                    let light = photo.linear.data()[pixel];
                    mean += light / 9.0;
                    response += weight * light;
                }
            }
            Some((mean, response.abs()))
        })
    })
    .collect()
}

/// Mean signal and robust variance of one step of brightness. Immerkaer's mask multiplies the variance by 36.
fn signal_and_variance(step: &mut [(f32, f32)]) -> (f64, f64) {
    let signal = step.iter().map(|&(mean, _)| f64::from(mean)).sum::<f64>() / step.len() as f64;
    let middle = step.len() / 2;
    let (_, &mut (_, median), _) = step.select_nth_unstable_by(middle, |a, b| a.1.total_cmp(&b.1));
    (signal, (f64::from(median) / 0.6745 / 6.0).powi(2))
}

#[cfg(test)]
mod tests {
    use rand::rngs::StdRng;
    use rand::{RngExt, SeedableRng};
    use rand_distr::StandardNormal;

    use super::*;
    use crate::Plane;

    #[test]
    fn grain_of_a_ramp_gives_back_the_camera() {
        let camera = NoiseModel::of_camera(20_000.0, 30.0, 4, 1.0);
        let mut random = StdRng::seed_from_u64(7);
        let linear = Plane::from_fn(400, 300, |x, y| {
            let light = 0.05 + 0.9 * (x as f64 / 400.0) + 0.05 * (y as f64 / 40.0).sin();
            (light + camera.sigma(light) * random.sample::<f64, _>(StandardNormal)) as f32
        });
        let model = estimate_noise(&Photo::unmarked(linear), &Mask::filled(400, 300, true), 0.0);
        for light in [0.1, 0.5, 0.9] {
            let ratio = model.sigma(light) / camera.sigma(light);
            assert!((ratio - 1.0).abs() < 0.05, "{ratio} at {light}");
        }
    }

    #[test]
    fn a_flat_photo_is_as_noisy_as_its_steps() {
        let photo = Photo::unmarked(Plane::filled(60, 60, 0.3));
        let model = estimate_noise(&photo, &Mask::filled(60, 60, true), 1.0 / 255.0);
        assert!((model.sigma(0.3) - 1.0 / 255.0 / 12_f64.sqrt()).abs() < 1e-9);
    }

    #[test]
    fn shorter_exposure_and_fewer_frames_are_noisier() {
        let long = NoiseModel::of_camera(20_000.0, 10.0, 4, 1.0);
        assert!(NoiseModel::of_camera(20_000.0, 10.0, 1, 1.0).sigma(0.5) > 1.9 * long.sigma(0.5));
        assert!(NoiseModel::of_camera(20_000.0, 10.0, 4, 0.25).sigma(0.5) > 1.9 * long.sigma(0.5));
    }
}
