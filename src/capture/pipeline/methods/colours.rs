//! Liao, Huang and Yang 2011: photos in several colours tell the bounces apart, and bounce 1 loses most of the noise.

use firstbounce_core::denoise::{DenoiseOptions, denoise_direct};
use firstbounce_core::separate::{LightPhotos, SeparateOptions, Separation, separate};

use super::super::watch::Part;
use super::super::{Direct, PipelineError, PipelineWatch, Scene, Separated, Stage};
use super::{Found, Input, MethodReport, Needs, OnShape, Row};

pub(super) const ROW: Row = Row {
    title: "the paper's method",
    purpose: "Photos in several colours tell the bounces apart (Liao, Huang and Yang 2011)",
    needs: Needs { all_colours: true, absolute_albedo: false, surface_before: false },
    compares_albedo: false,
    one_paint: false,
    stage: Stage::Separate,
    direct_light,
};

fn direct_light(input: &Input, watch: &dyn PipelineWatch, _: &mut OnShape) -> Result<Found, PipelineError> {
    let Input { scene, options, .. } = input;
    let separated = separate_lights(scene, options.bounces_of(&scene.set), watch)?;
    let direct = denoise_lights(scene, &separated, &options.denoise, watch)?;
    Ok(Found { separated, indirect: Vec::new(), direct, shape: None, report: MethodReport::None })
}

/// Separates every light into `bounces` bounces.
pub fn separate_lights(scene: &Scene, bounces: usize, watch: &dyn PipelineWatch) -> Result<Separated, PipelineError> {
    let beta = scene.calibrated.beta_values()?;
    let count = scene.object.photos.len();
    let one = |l: usize| {
        let part = Part::of(watch, Stage::Separate, l, count);
        with_light(scene, &beta, l, |light| Ok(separate(light, &SeparateOptions { bounces }, &part)?))
    };
    let all = (0..count).map(one).collect::<Result<Vec<_>, PipelineError>>()?;
    let (lights, reports) = all.into_iter().unzip();
    Ok(Separated { lights, reports })
}

/// Takes most of the noise of the indirect light out of bounce 1.
pub fn denoise_lights(
    scene: &Scene,
    separated: &Separated,
    options: &DenoiseOptions,
    watch: &dyn PipelineWatch,
) -> Result<Vec<Direct>, PipelineError> {
    let beta = scene.calibrated.beta_values()?;
    let denoised = |(l, separation): (usize, &Separation)| {
        let part = Part::of(watch, Stage::Separate, l, separated.lights.len());
        let denoised = with_light(scene, &beta, l, |light| Ok(denoise_direct(light, separation, options, &part)?))?;
        Ok(Direct {
            light: denoised.direct,
            noise: Some(denoised.noise),
            marks: separation.marks.clone(),
            report: Some(denoised.report),
        })
    };
    separated.lights.iter().enumerate().map(denoised).collect()
}

/// Lends all that is known of light `l` to `work`.
fn with_light<T>(
    scene: &Scene,
    beta: &[f64],
    l: usize,
    work: impl FnOnce(&LightPhotos) -> Result<T, PipelineError>,
) -> Result<T, PipelineError> {
    let alpha = scene.alpha(l)?;
    let photos: Vec<_> = scene.object.photos[l].iter().map(|photo| &**photo).collect();
    let (noise, mask) = (&scene.object.noise[l], &scene.object.mask);
    work(&LightPhotos { photos: &photos, noise, alpha: &alpha, beta, mask })
}
