//! How far the separation of a set can be trusted: the verdict that reports print and the window shows.

use std::sync::Arc;

use firstbounce_core::Photo;
use firstbounce_core::interval::Estimate;
use firstbounce_core::separate::{SeparateReport, typical_light};
use firstbounce_core::stereo::normals::Lamp;
use firstbounce_core::stereo::shape::Shape;
use firstbounce_core::trust::{self, ColoursAndShapeLevels, LightLevels, Limits, Rig, Trust, TrustOptions};
use nalgebra::{DMatrix, DVector, Point3, Vector3};

use super::{Calibrated, ColoursAndShapeSolved, Known, ObjectPhotos, PipelineError};
use crate::set::{CaptureSet, Light, Subject};

/// Enough pixels for a mean.
const SAMPLED_PIXELS: usize = 50_000;

/// What a verdict needs of the object's photos: a few numbers, so that it follows every change of alpha, beta and the
/// order m without another look at them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ObjectLevels {
    /// By light, then colour: mean linear light of the object.
    pub mean: Vec<Vec<f64>>,
    /// By light, then colour: noise of a pixel at that light.
    pub sigma: Vec<Vec<f64>>,
    /// Mean over the object of the product of every two photos, light by light and in each colour by colour.
    pub products: DMatrix<f64>,
    /// Frames averaged in each photo; the fewest where photos differ.
    pub frames: usize,
}

impl ObjectLevels {
    /// Of the object's photos.
    pub fn of(set: &CaptureSet, object: &ObjectPhotos) -> Self {
        let means = |row: &Vec<Arc<Photo>>| row.iter().map(|photo| typical_light(photo, &object.mask)).collect();
        let mean: Vec<Vec<f64>> = object.photos.iter().map(means).collect();
        let noise = mean.iter().zip(&object.noise);
        let sigma = noise.map(|(row, noise)| row.iter().zip(noise).map(|(light, noise)| noise.sigma(*light)).collect());
        let sigma = sigma.collect();
        let frames = set.shots_of(Subject::Object).map(|shot| shot.files.len()).min().unwrap_or(1);
        Self { mean, sigma, products: products_of(object), frames }
    }
}

/// From a sparse sample of the pixels that are good in every photo.
fn products_of(object: &ObjectPhotos) -> DMatrix<f64> {
    let photos: Vec<_> = object.photos.iter().flatten().collect();
    let pixels = object.mask.data().len();
    let good = |pixel: &usize| object.mask.data()[*pixel] && photos.iter().all(|photo| photo.marks.data()[*pixel] == 0);
    let mut products = DMatrix::zeros(photos.len(), photos.len());
    let mut count = 0.0;
    for pixel in (0..pixels).step_by((pixels / SAMPLED_PIXELS).max(1)).filter(good) {
        let light =
            DVector::from_iterator(photos.len(), photos.iter().map(|photo| f64::from(photo.linear.data()[pixel])));
        products.ger(1.0, &light, &light, 1.0);
        count += 1.0;
    }
    products / f64::max(count, 1.0)
}

/// Judges the separation of `options.bounces` bounces.
pub fn judge(
    set: &CaptureSet,
    levels: &ObjectLevels,
    calibrated: &Calibrated,
    options: &TrustOptions,
) -> Result<Trust, PipelineError> {
    Ok(trust::judge(&rig_of(set, levels, calibrated)?, options)?)
}

/// Judges what colours and shape together found, by the method's own numbers.
pub fn judge_method(
    calibrated: &Calibrated,
    lights: &[SeparateReport],
    solved: &ColoursAndShapeSolved,
    shape: Option<&Shape>,
) -> Trust {
    let beta = calibrated.beta.as_deref().map_or_else(Vec::new, estimates);
    let levels = ColoursAndShapeLevels {
        lights,
        normal_noise_deg: shape.map(|shape| shape.report.normals.mean_noise_deg),
        beta: &beta,
        closure: solved.report.closure.as_ref(),
    };
    trust::judge_colours_and_shape(&levels, &Limits::default())
}

/// Everything that a verdict depends on but the order m. A value that the set's file gives goes before a measured one, as
/// when the set is calibrated: a typed beta counts at once.
pub fn rig_of(set: &CaptureSet, levels: &ObjectLevels, calibrated: &Calibrated) -> Result<Rig, PipelineError> {
    let measured = || calibrated.beta.as_deref().map(estimates);
    let typed = set.calibration.beta.as_deref().filter(|beta| beta.len() == set.colours.len());
    let beta = typed.map(exact).or_else(measured).ok_or(PipelineError::NoBeta)?;
    let light = |(l, light): (usize, &Light)| light_levels(set, levels, calibrated, l, light);
    let lights = set.lights.iter().enumerate().map(light).collect::<Result<Vec<_>, _>>()?;
    Ok(Rig { beta, lights, products: levels.products.clone(), frames: levels.frames })
}

fn light_levels(
    set: &CaptureSet,
    levels: &ObjectLevels,
    calibrated: &Calibrated,
    l: usize,
    light: &Light,
) -> Result<LightLevels, PipelineError> {
    let typed = set.calibration.alpha.get(&light.name).filter(|alpha| alpha.len() == set.colours.len());
    let measured = || calibrated.alpha.get(l)?.as_deref().map(estimates);
    let missing = || PipelineError::NoAlpha { light: light.name.clone() };
    let alpha = typed.map(|alpha| exact(alpha)).or_else(measured).ok_or_else(missing)?;
    let of = |values: &[Vec<f64>]| values.get(l).filter(|row| row.len() == alpha.len()).cloned().ok_or_else(missing);
    let measured_intensity = || calibrated.intensity.get(l).map(|known| known.value);
    let intensity = set.calibration.intensity.get(&light.name).copied().or_else(measured_intensity).unwrap_or(1.0);
    let (mean, sigma) = (of(&levels.mean)?, of(&levels.sigma)?);
    let toward = direction_of(set, calibrated, l, light).map(|direction| direction * intensity);
    Ok(LightLevels { alpha, mean, sigma, toward })
}

/// Unit direction to a light from the object's middle.
fn direction_of(set: &CaptureSet, calibrated: &Calibrated, l: usize, light: &Light) -> Option<Vector3<f64>> {
    if let Some(position) = light.position_mm {
        return Some(Lamp::Near(Point3::from(position)).irradiance_vector(Point3::origin()));
    }
    let measured = || Some(calibrated.direction.get(l)?.as_ref()?.value);
    let direction = set.given_direction(&light.name).or_else(measured)?;
    Vector3::from(direction).try_normalize(0.0)
}

fn estimates(known: &[Known<f64>]) -> Vec<Estimate> {
    known.iter().map(Known::estimate).collect()
}

fn exact(values: &[f64]) -> Vec<Estimate> {
    values.iter().map(|value| Estimate::exact(*value)).collect()
}

#[cfg(test)]
mod tests {
    use firstbounce_core::trust::{Level, Names, Reason};

    use super::*;
    use crate::pipeline::{Method, PhotoStore, SolveOptions, Unattended, calibrate_for, evaluate, load_object};

    fn demo() -> CaptureSet {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../assets/demo");
        CaptureSet::open(std::path::Path::new(folder)).unwrap()
    }

    fn verdict(set: &CaptureSet) -> Trust {
        let object = load_object(set, &PhotoStore::default(), &Unattended).unwrap();
        let levels = ObjectLevels::of(set, &object);
        let calibrated =
            calibrate_for(&demo(), &object, &SolveOptions::default(), &PhotoStore::default(), &Unattended).unwrap();
        judge(set, &levels, &calibrated, &TrustOptions { bounces: 2, ..TrustOptions::default() }).unwrap()
    }

    /// Rendered with every bounce: two bounces leave a tail that makes bounce 1 about a tenth too dark.
    #[test]
    fn the_demo_asks_for_care_because_of_its_tail() {
        let trust = verdict(&demo());
        assert_eq!(trust.level, Level::TakeCare);
        assert!(matches!(trust.reasons[0].1, Reason::Truncation { percent, .. } if (-14.0..-8.0).contains(&percent)));
        assert!((trust.lights[0].gain[0] - 4.13).abs() < 0.02);
    }

    #[test]
    fn a_beta_typed_as_097_is_not_trusted() {
        let mut set = demo();
        set.calibration.beta = Some(vec![1.0, 0.97]);
        let trust = verdict(&set);
        assert_eq!(trust.level, Level::DoNotTrust);
        let colours = ["blue".to_owned(), "green".to_owned()];
        let names = Names { colours: &colours, lights: &[] };
        let words = trust.reasons.iter().map(|(_, reason)| reason.words(&names)).collect::<Vec<_>>().join("; ");
        assert!(words.contains("blue and green see the paint alike"), "{words}");
    }

    /// The mean error of bounce 1 and of the normals, against the truth of the rendered sets.
    #[test]
    fn the_verdict_predicts_the_error_of_rendered_sets() {
        for (name, bounces) in [("corner-blue", 1), ("corner-blue", 2), ("groove-rgb", 2), ("bowl-four", 2)] {
            let Some(folder) = firstbounce_testing::shared_set(name) else { continue };
            let set = CaptureSet::open(&folder).unwrap();
            let options = SolveOptions { bounces: Some(bounces), method: Method::Colours, ..Default::default() };
            let truth = evaluate(&set, &options, &Unattended).unwrap();
            let object = load_object(&set, &PhotoStore::default(), &Unattended).unwrap();
            let calibrated = calibrate_for(&set, &object, &options, &PhotoStore::default(), &Unattended).unwrap();
            let levels = ObjectLevels::of(&set, &object);
            let trust = judge(&set, &levels, &calibrated, &TrustOptions { bounces, ..Default::default() }).unwrap();
            let error = 100.0 * truth.bounce_relative_error[0];
            println!(
                "{name} m = {bounces}: {:.1} % foretold, {error:.1} % found; {:?}",
                trust.error_percent(),
                trust.normal
            );
            println!("  {:?}", trust.lights[0]);
            assert!((0.4..2.5).contains(&(trust.error_percent() / error)));
        }
    }
}
