//! A scene of the experiments, rendered, photographed and solved.

use firstbounce_core::image::evaluate::lit_by_three;
use firstbounce_core::image::noise::{NoiseModel, NoiseSource};
use firstbounce_core::light::radiosity::{BounceOptions, FormFactorOptions, Patches, form_factors};
use firstbounce_core::light::scene::{
    Lamp, RenderOptions, Rendering, SceneError, Shape, directions_on_ring, framed, render,
};
use firstbounce_core::separate::{LightPhotos, SeparateOptions, Separation, UNSOLVED, separate};
use firstbounce_core::stereo::normals::{Lamp as StereoLamp, Paint};
use firstbounce_core::{Camera, Mask, NormalMap, Photo, Plane, Portion, Watch};

use super::{ColoursAndShapeErrors, PaperErrors, PaperOptions, RATIOS, TableRow};
use crate::direct::{Direct, Place};
use crate::{LabError, Sensor};

/// Angle of the lamps to the camera's axis.
const TILT_DEG: f64 = 20.0;
pub(super) const LAMPS: usize = 3;
/// A level of 8 bits.
const LEVEL: f64 = 1.0 / 255.0;

/// A scene and its paint.
pub(super) struct Experiment {
    pub scene: &'static str,
    pub shape: Shape,
    pub patches: usize,
    pub albedos: Vec<f64>,
    pub mean_direct_level: f64,
    /// Ratios of other second albedos to the first, in which the scene is seen too.
    pub ratios: &'static [f64],
    /// What light of as many bounces as albedos is called.
    pub light: &'static str,
}

/// Which light the pictures hold.
#[derive(Clone, Copy)]
enum Bounced {
    /// As many bounces as albedos: the paper's model holds.
    AsModelled,
    /// All of them.
    WithoutEnd,
}

impl Experiment {
    /// The paper's first scene.
    pub fn corner() -> Self {
        Self {
            scene: "corner",
            shape: Shape::Corner { wall_mm: 60.0, roll_deg: 0.0 },
            patches: PaperOptions::default().corner_patches,
            albedos: vec![0.5, 0.25],
            mean_direct_level: 94.0,
            ratios: &RATIOS,
            light: "two bounces",
        }
    }

    /// Its second, which it does not describe.
    pub fn tray() -> Self {
        Self {
            scene: "tray",
            shape: Shape::Tray { side_mm: 100.0 },
            patches: PaperOptions::default().tray_patches,
            albedos: vec![0.78, 0.59, 0.39, 0.2],
            mean_direct_level: 109.0,
            ratios: &[],
            light: "four bounces",
        }
    }

    pub fn render(self, size_px: usize, watch: &dyn Watch) -> Result<Rendered, LabError> {
        let (mesh, camera) = framed(self.shape.mesh(self.patches)?, size_px)?;
        let directions = directions_on_ring(LAMPS, TILT_DEG);
        let lamp = |&direction_to_light: &_| Lamp::Directional { direction_to_light, intensity: 1.0 };
        let lamps: Vec<Lamp> = directions.iter().map(lamp).collect();
        let stereo = lamps.iter().map(|lamp| (lamp.stereo(), lamp.intensity())).collect();
        let portion = |from, to| Portion { watch, from, to };
        let patches = Patches::from_mesh(&mesh)?;
        let (factors, _) = form_factors(patches, &FormFactorOptions::default(), &portion(0.0, 0.5))?;
        let others = self.ratios.iter().map(|ratio| ratio * self.albedos[0]);
        let albedos = self.albedos.iter().copied().chain(others).collect();
        let bounces = BounceOptions { albedos, bounces: self.albedos.len(), ..BounceOptions::default() };
        let options = RenderOptions { bounces, ..RenderOptions::default() };
        let (rendering, _) = render(&factors, &lamps, &camera, &options, &portion(0.5, 1.0))?;
        Rendered::new(self, rendering, camera, stereo)
    }
}

/// A rendered scene, scaled so that its true direct light has the paper's mean.
pub(super) struct Rendered {
    experiment: Experiment,
    rendering: Rendering,
    camera: Camera,
    lamps: Vec<(StereoLamp, f64)>,
    /// Pixels that all lamps light.
    lit: Mask,
}

/// By colour, the lamps' strength and the paint's albedo over the reference colour's.
pub(super) struct Rig {
    pub alpha: Vec<f64>,
    pub beta: Vec<f64>,
}

/// Direct light, and its normals.
pub(super) struct Found {
    pub lights: Vec<Direct>,
    pub normals: NormalMap,
}

impl Rendered {
    fn new(
        experiment: Experiment,
        mut rendering: Rendering,
        camera: Camera,
        lamps: Vec<(StereoLamp, f64)>,
    ) -> Result<Self, LabError> {
        let direct: Vec<Plane> = rendering.lights.iter().map(|light| light.bounces[0].clone()).collect();
        let lit =
            lit_by_three(&direct, &rendering.mask).filter(|lit| lit.count() > 0).ok_or(SceneError::NothingToSee)?;
        let mean = direct.iter().map(|plane| sum_over(&lit, plane)).sum::<f64>() / (lit.count() * direct.len()) as f64;
        let scale = (experiment.mean_direct_level * LEVEL / mean) as f32;
        for light in &mut rendering.lights {
            let planes = light.bounces.iter_mut().chain(&mut light.all);
            planes.for_each(|plane| plane.data_mut().iter_mut().for_each(|value| *value *= scale));
        }
        Ok(Self { experiment, rendering, camera, lamps, lit })
    }

    /// Bounces 1, 2, .. under a lamp.
    pub fn bounces(&self, lamp: usize) -> &[Plane] {
        &self.rendering.lights[lamp].bounces
    }

    /// Under lamps that are equal in every colour.
    fn rig(&self) -> Rig {
        let albedos = &self.experiment.albedos;
        Rig { alpha: vec![1.0; albedos.len()], beta: albedos.iter().map(|albedo| albedo / albedos[0]).collect() }
    }

    pub fn rows(&self, watch: &dyn Watch) -> Result<Vec<TableRow>, LabError> {
        let Experiment { scene, albedos, mean_direct_level, light, .. } = &self.experiment;
        let row = |(bounced, light): (Bounced, &'static str)| {
            Ok(TableRow {
                scene,
                light,
                bounces: albedos.len(),
                albedos: albedos.clone(),
                mean_direct_level: *mean_direct_level,
                noiseless: self.errors(bounced, None, watch)?,
                eight_bit: self.errors(bounced, Some(Sensor::noiseless(8)), watch)?,
            })
        };
        [(Bounced::AsModelled, *light), (Bounced::WithoutEnd, "all bounces")].into_iter().map(row).collect()
    }

    /// Separates pictures by `sensor`, or by none, and compares.
    fn errors(&self, bounced: Bounced, sensor: Option<Sensor>, watch: &dyn Watch) -> Result<PaperErrors, LabError> {
        let rig = self.rig();
        let photos = self.photos(sensor, &rig, |lamp, colour| self.light(bounced, lamp, colour, &rig.beta))?;
        let (raw, separated) = (self.reference(&photos, watch)?, self.by_bounces(&photos, &rig, watch)?);
        let direct = |lamp: usize| vec![Photo::unmarked(self.rendering.lights[lamp].bounces[0].clone())];
        let exact = self.reference(&(0..LAMPS).map(direct).collect::<Vec<_>>(), watch)?;
        let together = match bounced {
            Bounced::AsModelled => None,
            Bounced::WithoutEnd => Some(self.by_colours_and_shape(&photos, &rig, sensor, watch)?),
        };
        let compared = self.compared([Some(&raw), Some(&separated), Some(&exact), together.as_ref()]);
        let (error, truth) = self.direct_error(&separated.lights, &compared);
        let levels = |error: f64| error / (LEVEL * (compared.count() * LAMPS) as f64);
        let colours_and_shape = together.map(|together| {
            let (error, truth) = self.direct_error(&together.lights, &compared);
            Ok::<_, LabError>(ColoursAndShapeErrors {
                normals_deg: self.degrees(&together, &compared)?,
                direct_error_levels: levels(error),
                direct_error_percent: 100.0 * error / truth,
            })
        });
        Ok(PaperErrors {
            raw_deg: self.degrees(&raw, &compared)?,
            separated_deg: self.degrees(&separated, &compared)?,
            true_direct_deg: self.degrees(&exact, &compared)?,
            direct_error_levels: levels(error),
            direct_error_percent: 100.0 * error / truth,
            colours_and_shape: colours_and_shape.transpose()?,
        })
    }

    /// By lamp, then colour, the photos of what `light` says the scene sends under lamps that are equal in every colour.
    pub fn photos(
        &self,
        sensor: Option<Sensor>,
        rig: &Rig,
        light: impl Fn(usize, usize) -> Plane,
    ) -> Result<Vec<Vec<Photo>>, LabError> {
        let photo = |lamp: usize, (colour, alpha): (usize, &f64)| {
            taken(&light(lamp, colour).map(|light| light * *alpha as f32), sensor)
        };
        let row = |lamp: usize| rig.alpha.iter().enumerate().map(|colour| photo(lamp, colour)).collect();
        (0..LAMPS).map(row).collect()
    }

    /// The pixels that all lamps light and whose light is solved.
    pub fn solved(&self, lights: &[Direct]) -> Mask {
        restricted(&self.lit, |pixel| lights.iter().all(|light| light.marks.data()[pixel] & UNSOLVED == 0))
    }

    /// The pixels that all lamps light and that have a normal by every way.
    pub fn compared<const N: usize>(&self, found: [Option<&Found>; N]) -> Mask {
        found.into_iter().flatten().fold(self.lit.clone(), |compared, found| {
            let solved = self.solved(&found.lights);
            restricted(&compared, |pixel| solved.data()[pixel] && found.normals.at_index(pixel).is_some())
        })
    }

    pub fn degrees(&self, found: &Found, compared: &Mask) -> Result<f64, LabError> {
        let error = found.normals.angular_error(&self.rendering.normals, compared);
        Ok(error.map(|error| error.mean_deg).ok_or(SceneError::NothingToSee)?)
    }

    /// What reaches the camera from the scene under a lamp in a colour.
    fn light(&self, bounced: Bounced, lamp: usize, colour: usize, beta: &[f64]) -> Plane {
        let planes = &self.rendering.lights[lamp];
        match bounced {
            Bounced::AsModelled => polynomial(&planes.bounces, beta[colour]),
            Bounced::WithoutEnd => planes.all[colour].clone(),
        }
    }

    /// Light of every bounce in the reference colour.
    pub fn all_bounces(&self, lamp: usize) -> &Plane {
        &self.rendering.lights[lamp].all[0]
    }

    /// The same in a colour of the other ratios.
    pub fn all_bounces_of_ratio(&self, lamp: usize, index: usize) -> &Plane {
        &self.rendering.lights[lamp].all[self.experiment.albedos.len() + index]
    }

    /// The photos of the reference colour taken for direct light.
    pub fn reference(&self, photos: &[Vec<Photo>], watch: &dyn Watch) -> Result<Found, LabError> {
        let row = |photos: &Vec<Photo>| {
            Ok(Direct::of_separation(self.separate(&photos[..1], &Rig { alpha: vec![1.0], beta: vec![1.0] }, watch)?))
        };
        let lights = photos.iter().map(row).collect::<Result<_, LabError>>()?;
        self.found(lights, Paint::Any, watch)
    }

    /// Bounce 1 by the paper's method: as many bounces as colours.
    pub fn bounce_one(&self, photos: &[Vec<Photo>], rig: &Rig, watch: &dyn Watch) -> Result<Vec<Direct>, LabError> {
        photos.iter().map(|row| Ok(Direct::of_separation(self.separate(row, rig, watch)?))).collect()
    }

    /// By the paper's method.
    pub fn by_bounces(&self, photos: &[Vec<Photo>], rig: &Rig, watch: &dyn Watch) -> Result<Found, LabError> {
        self.found(self.bounce_one(photos, rig, watch)?, Paint::Any, watch)
    }

    /// By colours and shape together.
    pub fn by_colours_and_shape(
        &self,
        photos: &[Vec<Photo>],
        rig: &Rig,
        sensor: Option<Sensor>,
        watch: &dyn Watch,
    ) -> Result<Found, LabError> {
        // Pictures without noise have what single precision leaves them.
        let step = sensor.map_or(f64::from(f32::EPSILON), |sensor| sensor.white_level().recip());
        let noise = vec![rounding(step); rig.beta.len()];
        let photos: Vec<Vec<&Photo>> = photos.iter().map(|row| row.iter().collect()).collect();
        let mask = &self.rendering.mask;
        let lights: Vec<_> = photos
            .iter()
            .map(|photos| LightPhotos { photos, noise: &noise, alpha: &rig.alpha, beta: &rig.beta, mask })
            .collect();
        let separated = self.place().by_colours_and_shape(&lights, watch)?;
        self.found(separated.lights.into_iter().map(Direct::from).collect(), Paint::Auto, watch)
    }

    fn separate(&self, photos: &[Photo], rig: &Rig, watch: &dyn Watch) -> Result<Separation, LabError> {
        let noise = vec![rounding(LEVEL); rig.beta.len()];
        let photos: Vec<&Photo> = photos.iter().collect();
        let mask = &self.rendering.mask;
        let light = LightPhotos { photos: &photos, noise: &noise, alpha: &rig.alpha, beta: &rig.beta, mask };
        Ok(separate(&light, &SeparateOptions { bounces: rig.beta.len() }, watch)?.0)
    }

    fn found(&self, lights: Vec<Direct>, paint: Paint, watch: &dyn Watch) -> Result<Found, LabError> {
        let normals = self.place().normals(&lights, None, paint, watch)?.map;
        Ok(Found { lights, normals })
    }

    fn place(&self) -> Place<'_> {
        Place { lamps: &self.lamps, mask: &self.rendering.mask, camera: &self.camera }
    }

    /// Sums over lamps and pixels of the absolute error of bounce 1, and of the true direct light.
    pub fn direct_error(&self, found: &[Direct], compared: &Mask) -> (f64, f64) {
        let pairs = found.iter().map(|light| &light.light).zip(&self.rendering.lights);
        pairs.fold((0.0, 0.0), |(error, truth), (found, light)| {
            let direct = &light.bounces[0];
            let off = found.data().iter().zip(direct.data()).map(|(found, truth)| (found - truth).abs()).collect();
            let off = Plane::from_vec(direct.width(), direct.height(), off);
            (error + off.map_or(0.0, |off| sum_over(compared, &off)), truth + sum_over(compared, direct))
        })
    }
}

/// Noise of values that are rounded to steps.
fn rounding(step: f64) -> NoiseModel {
    NoiseModel { floor: step * step / 12.0, per_signal: 0.0, source: NoiseSource::Camera }
}

fn taken(light: &Plane, sensor: Option<Sensor>) -> Result<Photo, LabError> {
    match sensor {
        Some(sensor) => sensor.photograph(light, 0),
        None => Ok(Photo::unmarked(light.clone())),
    }
}

/// `sum_k beta^k L_k` of bounces 1, 2, ..
pub(super) fn polynomial(bounces: &[Plane], beta: f64) -> Plane {
    let mut sum = Plane::filled(bounces[0].width(), bounces[0].height(), 0.0);
    for (k, bounce) in (1..).zip(bounces) {
        let factor = beta.powi(k) as f32;
        sum.data_mut().iter_mut().zip(bounce.data()).for_each(|(sum, light)| *sum += factor * light);
    }
    sum
}

fn sum_over(mask: &Mask, plane: &Plane) -> f64 {
    plane.data().iter().zip(mask.data()).filter(|(_, inside)| **inside).map(|(value, _)| f64::from(*value)).sum()
}

fn restricted(mask: &Mask, keep: impl Fn(usize) -> bool) -> Mask {
    Mask::from_fn(mask.width(), mask.height(), |x, y| mask.at(x, y) && keep(y * mask.width() + x))
}

#[cfg(test)]
mod tests {
    use firstbounce_core::Unwatched;

    use super::*;

    #[test]
    fn colours_and_shape_beat_two_bounces_where_light_bounces_without_end() {
        let corner = Experiment { patches: 300, ..Experiment::corner() };
        let rendered = corner.render(64, &Unwatched).unwrap();
        for bits in [16, 8] {
            let sensor = Some(Sensor::noiseless(bits));
            let errors = rendered.errors(Bounced::WithoutEnd, sensor, &Unwatched).unwrap();
            let together = errors.colours_and_shape.unwrap();
            assert!(together.normals_deg < 0.8 * errors.separated_deg, "{bits} bits: {errors:?}");
            assert!(together.direct_error_percent < 0.5 * errors.direct_error_percent, "{bits} bits: {errors:?}");
        }
    }
}
