//! The plan of a rig: the expected error of the normals against the number of frames and the ratio of albedos.
//!
//! The scene is rendered once, small, for every paint in question: form factors do not know the paint. Noise and truncation are
//! then kept apart. The truncation is what `m` bounces make of light that bounces without end, by separation of pictures without
//! noise. The noise is what the camera model predicts, carried through separation, averaging of the indirect light
//! ([`firstbounce_core::denoise`]) and photometric stereo.

use std::f64::consts::PI;

use serde::Serialize;

use super::{LabError, Sensor};
use firstbounce_core::denoise::{DenoiseOptions, denoise_direct};
use firstbounce_core::image::evaluate::lit_by_three;
use firstbounce_core::image::noise::NoiseModel;
use firstbounce_core::image::photo::CLIPPED;
use firstbounce_core::light::radiosity::{BounceOptions, FormFactors};
use firstbounce_core::light::scene::{Lamp, RenderOptions, Rendering, SceneError, render};
use firstbounce_core::options::check_range;
use firstbounce_core::separate::{BounceSystem, LightPhotos, SeparateOptions, Separation, check_order, separate};
use firstbounce_core::stereo::normals::{DirectLight, Normals, NormalsOptions, Surface, normals};
use firstbounce_core::{Camera, Mask, NormalMap, Photo, Plane, Portion, Projection, Watch};

/// What is to be planned.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanOptions {
    /// The paint, by colour, the reference first.
    pub albedos: Vec<f64>,
    /// The lamps, in the reference colour.
    pub lamps: Vec<Lamp>,
    /// By lamp, then colour: intensity over the reference colour's. Empty: each lamp makes up for the paint, alpha = 1 / beta.
    /// For other ratios than the paint's own it always does.
    pub alpha: Vec<Vec<f64>>,
    /// The order m that will be separated.
    pub bounces: usize,
    /// The camera. Its frames are those of the curve over ratios.
    pub sensor: Sensor,
    /// The linear light that the brightest pixel of all photos is exposed to, 1 being where it clips.
    pub brightest: f64,
    /// The linear light of a white facet that faces the first lamp in the reference colour: the exposure of the paint as it is,
    /// instead of `brightest`. Another paint is exposed by itself.
    pub white: Option<f64>,
    /// Numbers of frames to look at.
    pub frames: Vec<usize>,
    /// Ratios of the last albedo to the first to look at; those between are spread evenly on a log scale. One that would
    /// need an albedo of 1 or more, or colours too alike to separate the bounces, is left out.
    pub ratios: Vec<f64>,
    /// How the noise of the indirect light will be averaged.
    pub denoise: DenoiseOptions,
}

impl Default for PlanOptions {
    fn default() -> Self {
        Self {
            albedos: vec![0.75, 0.38],
            lamps: Vec::new(),
            alpha: Vec::new(),
            bounces: 2,
            sensor: Sensor::default(),
            brightest: 0.85,
            white: None,
            frames: vec![1, 2, 4, 8, 16, 32, 64],
            ratios: vec![0.1, 0.15, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95],
            denoise: DenoiseOptions::default(),
        }
    }
}

impl PlanOptions {
    /// Whether every option is in its range; lamps and albedos are checked where they are used.
    pub fn check(&self) -> Result<(), LabError> {
        self.sensor.check()?;
        check_range("brightest", self.brightest, (1e-6..=1.0).contains(&self.brightest), "from 1e-6 to 1")?;
        let white = self.white.unwrap_or(1.0);
        check_range("white", white, (1e-9..=1e9).contains(&white), "from 1e-9 to 1e9")?;
        for &frames in &self.frames {
            check_range("frames", frames as f64, (1..=10_000).contains(&frames), "1 to 10000")?;
        }
        for &ratio in &self.ratios {
            check_range("ratio", ratio, (1e-4..=1e4).contains(&ratio), "from 0.0001 to 10000")?;
        }
        let in_range = (1..=self.albedos.len()).contains(&self.bounces);
        check_range("bounces", self.bounces as f64, in_range, "1 to the number of albedos")?;
        let shapely = self.alpha.iter().all(|alpha| alpha.len() == self.albedos.len());
        let one_each = self.alpha.is_empty() || self.alpha.len() == self.lamps.len();
        let lamps = self.alpha.len() as f64;
        Ok(check_range("alpha", lamps, shapely && one_each, "one value for each lamp and colour")?)
    }
}

/// The error to be expected of one rig. Angles are means over the pixels that three lamps or more light directly.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlanPoint {
    /// The paint.
    pub albedos: Vec<f64>,
    /// The last albedo over the first.
    pub ratio: f64,
    /// Frames averaged in each photo.
    pub frames: usize,
    /// Noise of bounce 1 for unit noise on the photos, under the first lamp.
    pub gain: f64,
    /// Mean angle by noise alone.
    pub noise_deg: f64,
    /// Mean angle by light of more than m bounces alone.
    #[serde(rename = "tail_deg")]
    pub truncation_deg: f64,
    /// Mean angle by both.
    pub error_deg: f64,
}

/// What a rig can be expected to achieve.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The order m.
    pub bounces: usize,
    /// Normals from the photos before separation, without noise.
    pub raw_deg: f64,
    /// For the paint as it is, by number of frames.
    pub by_frames: Vec<PlanPoint>,
    /// For the camera as it is, by ratio.
    pub by_ratio: Vec<PlanPoint>,
}

impl Plan {
    /// The ratio with the least error.
    pub fn best_ratio(&self) -> Option<&PlanPoint> {
        self.by_ratio.iter().min_by(|a, b| a.error_deg.total_cmp(&b.error_deg))
    }
}

/// Plans for the surface of `factors` before a camera, which should be small: 48 pixels across are enough.
pub fn plan(
    factors: &FormFactors,
    camera: &Camera,
    options: &PlanOptions,
    watch: &dyn Watch,
) -> Result<Plan, LabError> {
    options.check()?;
    let paints = paints(options);
    // The paint itself is refused before the work.
    if let [own, ..] = paints.as_slice() {
        for alpha in &own.alpha {
            check_order(alpha, &own.beta(), options.bounces)?;
        }
    }
    let mut albedos: Vec<f64> = options.albedos.clone();
    for &albedo in paints.iter().flat_map(|paint| &paint.albedos) {
        if !albedos.contains(&albedo) {
            albedos.push(albedo);
        }
    }
    // One sample a pixel: no pixel holds two walls, which would cost normals that a finer picture has.
    let render_options = RenderOptions {
        bounces: BounceOptions { albedos: albedos.clone(), bounces: 1, ..BounceOptions::default() },
        samples_per_pixel_side: 1,
        ..RenderOptions::default()
    };
    let (rendering, _) =
        render(factors, &options.lamps, camera, &render_options, &Portion { watch, from: 0.0, to: 0.8 })?;
    let direct: Vec<Plane> = rendering.lights.iter().map(|light| light.bounces[0].clone()).collect();
    let lit = lit_by_three(&direct, &rendering.mask).filter(|lit| lit.count() > 0).ok_or(SceneError::NothingToSee)?;
    let scene = Scene { rendering, albedos, lit, camera, options };

    let portion = |from, to| Portion { watch, from, to };
    let (own, others) = paints.split_first().ok_or(SceneError::NothingToSee)?;
    let own_angles = scene.angles(own, &portion(0.8, 0.82))?;
    let raw_deg = scene.raw_deg(own, &portion(0.82, 0.83))?;
    let mut by_ratio = Vec::with_capacity(others.len());
    for (k, paint) in others.iter().enumerate() {
        let at = |k: usize| 0.83 + 0.17 * k as f32 / others.len() as f32;
        by_ratio.push(scene.angles(paint, &portion(at(k), at(k + 1)))?.point(paint, options.sensor.frames));
    }
    let by_frames = options.frames.iter().map(|&frames| own_angles.point(own, frames)).collect();
    watch.progress(1.0);
    Ok(Plan { bounces: options.bounces, raw_deg, by_frames, by_ratio })
}

/// A paint under its lamps.
struct Paint {
    albedos: Vec<f64>,
    /// The last albedo over the first.
    ratio: f64,
    /// By lamp, then colour.
    alpha: Vec<Vec<f64>>,
    /// As `PlanOptions::white`.
    white: Option<f64>,
}

impl Paint {
    fn beta(&self) -> Vec<f64> {
        self.albedos.iter().map(|albedo| albedo / self.albedos[0]).collect()
    }
}

/// The paint as it is, then one for each ratio.
fn paints(options: &PlanOptions) -> Vec<Paint> {
    let own = &options.albedos;
    let makes_up = |albedos: &[f64]| {
        let alpha: Vec<f64> = albedos.iter().map(|albedo| albedos[0] / albedo).collect();
        vec![alpha; options.lamps.len()]
    };
    let alpha = if options.alpha.is_empty() { makes_up(own) } else { options.alpha.clone() };
    let last = own.len().saturating_sub(1).max(1) as f64;
    let of_ratio = |&ratio: &f64| {
        let albedos: Vec<f64> = (0..own.len()).map(|c| own[0] * ratio.powf(c as f64 / last)).collect();
        Paint { alpha: makes_up(&albedos), albedos, ratio, white: None }
    };
    let physical = |paint: &Paint| paint.albedos.iter().all(|&albedo| albedo < 1.0);
    let separable = |paint: &Paint| {
        let even = vec![1.0; paint.albedos.len()];
        check_order(&even, &paint.beta(), options.bounces).is_ok()
    };
    let varied = if own.len() > 1 { options.ratios.as_slice() } else { &[] };
    let others = varied.iter().map(of_ratio).filter(physical).filter(separable);
    let ratio = own.last().zip(own.first()).map_or(1.0, |(last, first)| last / first);
    std::iter::once(Paint { albedos: own.clone(), alpha, ratio, white: options.white }).chain(others).collect()
}

struct Scene<'a> {
    rendering: Rendering,
    /// The albedos of `LitPlanes::all`.
    albedos: Vec<f64>,
    /// Pixels that three lamps light.
    lit: Mask,
    camera: &'a Camera,
    options: &'a PlanOptions,
}

/// Angles of single pixels, in radians.
struct Angles {
    gain: f64,
    /// By noise of a single frame, and by the truncation.
    pixels: Vec<(f64, f64)>,
}

impl Angles {
    /// The mean of a normally distributed turn is sqrt(pi)/2 of its root mean square, and turns at random add to the truncation
    /// by squares.
    fn point(&self, paint: &Paint, frames: usize) -> PlanPoint {
        let share = PI.sqrt() / 2.0 / (frames as f64).sqrt();
        let mean = |of: &dyn Fn(f64, f64) -> f64| {
            let sum: f64 = self.pixels.iter().map(|&(noise, truncation)| of(noise * share, truncation)).sum();
            (sum / self.pixels.len().max(1) as f64).to_degrees()
        };
        PlanPoint {
            albedos: paint.albedos.clone(),
            ratio: paint.ratio,
            frames,
            gain: self.gain,
            noise_deg: mean(&|noise, _| noise),
            truncation_deg: mean(&|_, truncation| truncation),
            error_deg: mean(&f64::hypot),
        }
    }
}

impl Scene<'_> {
    /// By lamp, then colour: photos without noise, exposed as asked for.
    fn photos(&self, paint: &Paint) -> Vec<Vec<Photo>> {
        let colour = |albedo: &f64| self.albedos.iter().position(|known| known == albedo).unwrap_or_default();
        let colours: Vec<usize> = paint.albedos.iter().map(colour).collect();
        let lights = || self.rendering.lights.iter().zip(&paint.alpha);
        let brightest = lights()
            .flat_map(|(light, alpha)| colours.iter().zip(alpha).map(|(&c, alpha)| alpha * largest(&light.all[c])))
            .fold(f64::MIN_POSITIVE, f64::max);
        let scale = match (paint.white, self.options.lamps.first()) {
            (Some(white), Some(lamp)) => white / lamp.intensity(),
            _ => self.options.brightest / brightest,
        };
        let photo = |plane: &Plane, factor: f64| {
            let mut linear = plane.clone();
            linear.data_mut().iter_mut().for_each(|value| *value *= factor as f32);
            let marks = linear.map(|value| if value >= 1.0 { CLIPPED } else { 0 });
            Photo { linear, marks }
        };
        let row = |(light, alpha): (&firstbounce_core::light::scene::LitPlanes, &Vec<f64>)| {
            colours.iter().zip(alpha).map(|(&c, alpha)| photo(&light.all[c], scale * alpha)).collect()
        };
        lights().map(row).collect()
    }

    /// The noise of a single frame.
    fn noise(&self) -> NoiseModel {
        let sensor = &self.options.sensor;
        let step = 1.0 / (sensor.white_level() - sensor.black_level);
        let camera = NoiseModel::of_camera(sensor.full_well_electrons, sensor.read_noise_electrons, 1, 1.0);
        NoiseModel { floor: camera.floor + step * step / 12.0, ..camera }
    }

    fn angles(&self, paint: &Paint, watch: &dyn Watch) -> Result<Angles, LabError> {
        let (beta, bounces) = (paint.beta(), self.options.bounces);
        let noise = vec![self.noise(); beta.len()];
        let mut direct = Vec::with_capacity(paint.alpha.len());
        let mut gain = 1.0;
        for (l, (photos, alpha)) in self.photos(paint).iter().zip(&paint.alpha).enumerate() {
            let photos: Vec<&Photo> = photos.iter().collect();
            let light = LightPhotos { photos: &photos, noise: &noise, alpha, beta: &beta, mask: &self.rendering.mask };
            if l == 0 {
                gain = BounceSystem::new(alpha, &beta, &light.typical_sigma(), bounces)?.gain[0];
            }
            let (separation, _) = separate(&light, &SeparateOptions { bounces }, &Portion::still(watch, 0.0))?;
            // Only its noise is used: in a picture so small a window spans too much of the scene.
            let denoised = denoise_direct(&light, &separation, &self.options.denoise, &Portion::still(watch, 0.0))?;
            direct.push((separation, denoised.noise));
        }
        let found = self.normals(&direct, watch)?;
        let pixels = self.compared(&found.map).map(|(pixel, truncation)| {
            let noise = f64::from(found.noise_deg.data()[pixel]).to_radians();
            (noise, truncation)
        });
        let pixels: Vec<_> = pixels.collect();
        if pixels.is_empty() { Err(LabError::Overexposed) } else { Ok(Angles { gain, pixels }) }
    }

    /// The photos of the reference colour taken for direct light.
    fn raw_deg(&self, paint: &Paint, watch: &dyn Watch) -> Result<f64, LabError> {
        let noise = [self.noise()];
        let mut lights = Vec::new();
        for photos in self.photos(paint) {
            let light = LightPhotos {
                photos: &[&photos[0]],
                noise: &noise,
                alpha: &[1.0],
                beta: &[1.0],
                mask: &self.rendering.mask,
            };
            let (separation, _) = separate(&light, &SeparateOptions { bounces: 1 }, &Portion::still(watch, 0.0))?;
            let denoised = Plane::filled(self.lit.width(), self.lit.height(), 0.0);
            lights.push((separation, denoised));
        }
        let found = self.normals(&lights, watch)?;
        let angles: Vec<f64> = self.compared(&found.map).map(|(_, angle)| angle).collect();
        if angles.is_empty() {
            return Err(LabError::Overexposed);
        }
        Ok((angles.iter().sum::<f64>() / angles.len().max(1) as f64).to_degrees())
    }

    fn normals(&self, lights: &[(Separation, Plane)], watch: &dyn Watch) -> Result<Normals, LabError> {
        let lights: Vec<DirectLight> =
            lights.iter().zip(&self.options.lamps).map(|(light, lamp)| direct_light(light, lamp)).collect();
        let has_scale = !matches!(self.camera.projection, Projection::Orthographic { mm_per_pixel: None });
        let surface = Surface { camera: self.camera, depth_mm: has_scale.then_some(&self.rendering.depth_mm) };
        Ok(normals(&lights, &self.rendering.mask, surface, &NormalsOptions::default(), &Portion::still(watch, 0.0))?.0)
    }

    /// The pixels that count, and how far their normals are off in radians.
    fn compared<'a>(&'a self, found: &'a NormalMap) -> impl Iterator<Item = (usize, f64)> + 'a {
        let lit = self.lit.data().iter().enumerate().filter(|(_, lit)| **lit);
        lit.filter_map(|(pixel, _)| {
            let (found, truth) = (found.at_index(pixel)?, self.rendering.normals.at_index(pixel)?);
            Some((pixel, f64::from(found.angle(&truth))))
        })
    }
}

fn direct_light<'a>((separation, noise): &'a (Separation, Plane), lamp: &Lamp) -> DirectLight<'a> {
    DirectLight {
        direct: &separation.bounces[0],
        noise: Some(noise),
        marks: &separation.marks,
        lamp: lamp.stereo(),
        intensity: lamp.intensity(),
    }
}

fn largest(plane: &Plane) -> f64 {
    plane.data().iter().copied().fold(0.0_f32, f32::max).into()
}
