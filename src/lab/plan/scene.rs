//! The scene of a plan: rendered once, photographed in any paint, and its normals found.

use std::f64::consts::PI;

use super::direct::{Expected, colours_and_shape, paper};
use super::{Paint, PlanMethod, PlanOptions, PlanPoint};
use crate::LabError;
use crate::direct::{Direct, Place};
use firstbounce_core::image::evaluate::lit_by_three;
use firstbounce_core::image::noise::NoiseModel;
use firstbounce_core::image::photo::CLIPPED;
use firstbounce_core::light::radiosity::{BounceOptions, FormFactors};
use firstbounce_core::light::scene::{LitPlanes, RenderOptions, Rendering, SceneError, render};
use firstbounce_core::separate::LightPhotos;
use firstbounce_core::stereo::normals::{Lamp as StereoLamp, Normals, Paint as StereoPaint};
use firstbounce_core::{Camera, Mask, NormalMap, Photo, Plane, Projection, Watch};

/// The surface before its camera, lit.
pub(super) struct Scene<'a> {
    rendering: Rendering,
    /// The albedos of `LitPlanes::all`.
    albedos: Vec<f64>,
    /// Pixels that three lamps light.
    lit: Mask,
    lamps: Vec<(StereoLamp, f64)>,
    camera: &'a Camera,
    options: &'a PlanOptions,
}

/// Angles of single pixels, in radians.
pub(super) struct Angles {
    gain: f64,
    /// By noise of a single frame, and without noise.
    pixels: Vec<(f64, f64)>,
}

impl Angles {
    /// The mean of a normally distributed turn is sqrt(pi)/2 of its root mean square, and turns at random add by
    /// squares to what remains without noise.
    pub(super) fn point(&self, paint: &Paint, frames: usize) -> PlanPoint {
        let share = PI.sqrt() / 2.0 / (frames as f64).sqrt();
        let mean = |of: &dyn Fn(f64, f64) -> f64| {
            let sum: f64 = self.pixels.iter().map(|&(noise, remainder)| of(noise * share, remainder)).sum();
            (sum / self.pixels.len().max(1) as f64).to_degrees()
        };
        PlanPoint {
            albedos: paint.albedos.clone(),
            ratio: paint.ratio,
            frames,
            gain: self.gain,
            noise_deg: mean(&|noise, _| noise),
            remainder_deg: mean(&|_, remainder| remainder),
            error_deg: mean(&f64::hypot),
        }
    }
}

impl<'a> Scene<'a> {
    /// Lights the surface for all these albedos.
    pub(super) fn new(
        factors: &FormFactors,
        camera: &'a Camera,
        albedos: Vec<f64>,
        options: &'a PlanOptions,
        watch: &dyn Watch,
    ) -> Result<Self, LabError> {
        // One sample a pixel: no pixel holds two walls, which would cost normals that a finer picture has.
        let render_options = RenderOptions {
            bounces: BounceOptions { albedos: albedos.clone(), bounces: 1, ..BounceOptions::default() },
            samples_per_pixel_side: 1,
            ..RenderOptions::default()
        };
        let (rendering, _) = render(factors, &options.lamps, camera, &render_options, watch)?;
        let direct: Vec<Plane> = rendering.lights.iter().map(|light| light.bounces[0].clone()).collect();
        let lit = lit_by_three(&direct, &rendering.mask).filter(|lit| lit.count() > 0);
        let lamps = options.lamps.iter().map(|lamp| (lamp.stereo(), lamp.intensity())).collect();
        Ok(Self { lit: lit.ok_or(SceneError::NothingToSee)?, rendering, albedos, lamps, camera, options })
    }

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
        let row = |(light, alpha): (&LitPlanes, &Vec<f64>)| {
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

    /// What the method in force makes of a paint.
    pub(super) fn angles(&self, paint: &Paint, watch: &dyn Watch) -> Result<Angles, LabError> {
        let (beta, photos, mask) = (paint.beta(), self.photos(paint), &self.rendering.mask);
        let photos: Vec<Vec<&Photo>> = photos.iter().map(|row| row.iter().collect()).collect();
        let noise = vec![self.noise(); beta.len()];
        let rows = photos.iter().zip(&paint.alpha);
        let lights = rows.map(|(photos, alpha)| LightPhotos { photos, noise: &noise, alpha, beta: &beta, mask });
        let lights: Vec<_> = lights.collect();
        let Expected { gain, lights, paint } = match self.options.method {
            PlanMethod::ColoursAndShape => colours_and_shape(&lights, &self.place(), watch)?,
            PlanMethod::Colours { bounces } => paper(&lights, bounces, &self.options.denoise, watch)?,
        };
        let found = self.normals(&lights, paint, watch)?;
        let pixels = self.compared(&found.map).map(|(pixel, remainder)| {
            let noise = f64::from(found.noise_deg.data()[pixel]).to_radians();
            (noise, remainder)
        });
        let pixels: Vec<_> = pixels.collect();
        if pixels.is_empty() { Err(LabError::Overexposed) } else { Ok(Angles { gain, pixels }) }
    }

    /// The photos of the reference colour taken for direct light.
    pub(super) fn raw_deg(&self, paint: &Paint, watch: &dyn Watch) -> Result<f64, LabError> {
        let lights: Vec<Direct> =
            self.photos(paint).into_iter().filter_map(|row| row.into_iter().next()).map(Direct::of_photo).collect();
        let found = self.normals(&lights, StereoPaint::Any, watch)?;
        let angles: Vec<f64> = self.compared(&found.map).map(|(_, angle)| angle).collect();
        if angles.is_empty() {
            return Err(LabError::Overexposed);
        }
        Ok((angles.iter().sum::<f64>() / angles.len() as f64).to_degrees())
    }

    fn place(&self) -> Place<'_> {
        Place { lamps: &self.lamps, mask: &self.rendering.mask, camera: self.camera }
    }

    fn normals(&self, lights: &[Direct], paint: StereoPaint, watch: &dyn Watch) -> Result<Normals, LabError> {
        let has_scale = !matches!(self.camera.projection, Projection::Orthographic { mm_per_pixel: None });
        self.place().normals(lights, has_scale.then_some(&self.rendering.depth_mm), paint, watch)
    }

    /// The pixels that count, and how far their normals are off in radians.
    fn compared(&self, found: &NormalMap) -> impl Iterator<Item = (usize, f64)> {
        let lit = self.lit.data().iter().enumerate().filter(|(_, lit)| **lit);
        lit.filter_map(|(pixel, _)| {
            let (found, truth) = (found.at_index(pixel)?, self.rendering.normals.at_index(pixel)?);
            Some((pixel, f64::from(found.angle(&truth))))
        })
    }
}

fn largest(plane: &Plane) -> f64 {
    plane.data().iter().copied().fold(0.0_f32, f32::max).into()
}
