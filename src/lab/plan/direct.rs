//! The direct light that a method finds in photos without noise, and the noise that a single frame would put into it.

use std::f64::consts::PI;

use crate::LabError;
use crate::direct::{Direct, Place};
use firstbounce_core::denoise::{DenoiseOptions, denoise_direct};
use firstbounce_core::image::photo::CLIPPED;
use firstbounce_core::methods::colours_and_shape::{
    ColoursAndShape, ColoursAndShapeOptions, IndirectMaps, SeparatedLight,
};
use firstbounce_core::separate::{BounceSystem, LightPhotos, OUTSIDE, SeparateOptions, UNSOLVED, separate};
use firstbounce_core::stereo::normals::Paint;
use firstbounce_core::{Marks, Plane, Portion, Watch};

/// What a method is expected to find.
pub(super) struct Expected {
    /// Noise of bounce 1 for unit noise on the photos, under the first lamp.
    pub gain: f64,
    /// By light, with the noise of a single frame.
    pub lights: Vec<Direct>,
    /// What photometric stereo may take the paint for.
    pub paint: Paint,
}

/// By the paper's method.
pub(super) fn paper(
    lights: &[LightPhotos],
    bounces: usize,
    denoise: &DenoiseOptions,
    watch: &dyn Watch,
) -> Result<Expected, LabError> {
    let gain = match lights.first() {
        Some(light) => BounceSystem::new(light.alpha, light.beta, &light.typical_sigma(), bounces)?.gain[0],
        None => 1.0,
    };
    let direct = |light: &LightPhotos| {
        let (separation, _) = separate(light, &SeparateOptions { bounces }, &Portion::still(watch, 0.0))?;
        // Only its noise is used: in a picture so small a window spans too much of the scene.
        let denoised = denoise_direct(light, &separation, denoise, &Portion::still(watch, 0.0))?;
        Ok(Direct { noise: Some(denoised.noise), ..Direct::of_separation(separation) })
    };
    let lights = lights.iter().map(direct).collect::<Result<_, LabError>>()?;
    Ok(Expected { gain, lights, paint: Paint::Any })
}

/// By colours and shape together.
pub(super) fn colours_and_shape(
    lights: &[LightPhotos],
    place: &Place,
    watch: &dyn Watch,
) -> Result<Expected, LabError> {
    let ColoursAndShape { lights: separated, maps, report } = place.by_colours_and_shape(lights, watch)?;
    let direct = |((light, separated), maps): ((&LightPhotos, SeparatedLight), &IndirectMaps)| {
        let noise = noise_of_one_frame(light, maps, report.step_px);
        Direct { noise: Some(noise), ..separated.into() }
    };
    let found: Vec<Direct> = lights.iter().zip(separated).zip(&maps).map(direct).collect();
    let gain = lights.first().zip(found.first()).map_or(1.0, |(light, found)| {
        let noise = found.noise.as_ref().map_or(0.0, |noise| typical_noise(noise, &found.marks));
        // Over the noise of a photo of the reference colour at the object's typical light.
        noise * light.alpha[0] / light.typical_sigma()[0].max(f64::MIN_POSITIVE)
    });
    Ok(Expected { gain, lights: found, paint: Paint::Auto })
}

/// What the noise of the photos leaves in L_1: that of the weighted mean of all colours where I is known, and what I itself is
/// off by noise, from its fit in a window. What else the method expects I to be off is no noise, and not in here.
fn noise_of_one_frame(light: &LightPhotos, maps: &IndirectMaps, step_px: usize) -> Plane {
    // Independent cells in a Gaussian window.
    let cells = 4.0 * PI * ColoursAndShapeOptions::default().amount_window_px.powi(2);
    let (width, height) = light.mask.size();
    let sigma = |x: usize, y: usize| {
        if !light.mask.at(x, y) {
            return 0.0;
        }
        let (mut direct, mut mixed, mut indirect) = (0.0, 0.0, 0.0);
        for (c, (photo, noise)) in light.photos.iter().zip(light.noise).enumerate() {
            if photo.marks.at(x, y) & CLIPPED != 0 {
                continue;
            }
            let variance = noise.variance(f64::from(photo.linear.at(x, y))) / light.alpha[c].powi(2);
            let ratio = f64::from(maps.ratio[c].at(x / step_px, y / step_px));
            let information = light.beta[c].powi(2) / variance.max(f64::MIN_POSITIVE);
            direct += information;
            mixed += information * ratio;
            indirect += information * ratio * ratio;
        }
        let (share, determinant) = (mixed / direct, direct * indirect - mixed * mixed);
        // Colours that do not tell light apart leave I to what the window knows of it.
        let of_indirect = if determinant > 0.0 { share * share * direct / (cells * determinant) } else { 0.0 };
        if direct > 0.0 { (direct.recip() + of_indirect).sqrt() as f32 } else { 0.0 }
    };
    Plane::from_fn(width, height, sigma)
}

/// Its mean over the solved pixels.
fn typical_noise(noise: &Plane, marks: &Marks) -> f64 {
    let solved = noise.data().iter().zip(marks.data()).filter(|(_, marks)| **marks & (UNSOLVED | OUTSIDE) == 0);
    let (sum, count) = solved.fold((0.0, 0usize), |(sum, count), (noise, _)| (sum + f64::from(*noise), count + 1));
    sum / count.max(1) as f64
}
