//! The synthetic experiments of Liao, Huang and Yang, CVPR 2011, section 4 and Figure 3, done again.
//!
//! The paper leaves open its lamps' directions, the first scene's albedos and the second scene's shape. Here three lamps
//! of one strength stand 20 degrees from the camera's axis, the corner has albedos 0.5 and 0.25 ("half of that"), and
//! the second scene, with the paper's four albedos, is [`Shape::Tray`].

mod plot;
mod report;

use firstbounce_core::image::evaluate::lit_by_three;
use firstbounce_core::image::noise::{NoiseModel, NoiseSource};
use firstbounce_core::light::radiosity::{BounceOptions, FormFactorOptions, Patches, form_factors};
use firstbounce_core::light::scene::{
    Lamp, RenderOptions, Rendering, SceneError, Shape, directions_on_ring, framed, render,
};
use firstbounce_core::options::check_range;
use firstbounce_core::separate::{LightPhotos, SeparateOptions, Separation, UNSOLVED, separate};
use firstbounce_core::stereo::normals::{DirectLight, Lamp as StereoLamp, NormalsOptions, Surface, normals};
use firstbounce_core::{Camera, Mask, NormalMap, Photo, Plane, Portion, Watch};
use nalgebra::{Unit, Vector3};
use serde::Serialize;

use crate::{LabError, Sensor};

pub use report::{PUBLISHED, PaperRecord, PaperRowRecord, PublishedRecord, paper_html};

/// How finely the scenes are rendered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperOptions {
    /// Side of the pictures.
    pub size_px: usize,
    /// Patches of the corner.
    pub corner_patches: usize,
    /// Patches of the tray.
    pub tray_patches: usize,
}

impl Default for PaperOptions {
    fn default() -> Self {
        Self { size_px: 96, corner_patches: 600, tray_patches: 1500 }
    }
}

impl PaperOptions {
    /// Whether every option is in its range; the shapes check their patches.
    pub fn check(&self) -> Result<(), LabError> {
        Ok(check_range("size_px", self.size_px as f64, (16..=4096).contains(&self.size_px), "16 to 4096")?)
    }
}

/// Mean errors over the pixels that all three lamps light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PaperErrors {
    /// Normals from the photos without separation.
    pub raw_deg: f64,
    /// Normals from bounce 1.
    pub separated_deg: f64,
    /// Normals from the true direct light: what photometric stereo itself costs where a pixel holds several surfaces or
    /// the edge of a shadow.
    pub true_direct_deg: f64,
    /// Bounce 1 against the true direct light, in grey levels of 8 bits.
    pub direct_error_levels: f64,
    /// The same relative to the mean of the true direct light.
    pub direct_error_percent: f64,
}

/// One scene under one kind of light.
#[derive(Clone, Debug, PartialEq)]
pub struct TableRow {
    /// "corner" or "tray".
    pub scene: &'static str,
    /// "two bounces", "four bounces" or "all bounces".
    pub light: &'static str,
    /// The order m that was separated.
    pub bounces: usize,
    /// The paint, reference first.
    pub albedos: Vec<f64>,
    /// The mean of the true direct light in grey levels of 8 bits: the paper's.
    pub mean_direct_level: f64,
    /// From pictures without noise or rounding.
    pub noiseless: PaperErrors,
    /// From pictures of 8 bits.
    pub eight_bit: PaperErrors,
}

/// A point of Figure 3.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Figure3Point {
    /// beta: the second albedo over the first.
    pub ratio: f64,
    /// Bits of the pictures.
    pub bits: u32,
    /// Mean error of bounce 1 over the mean true direct light.
    pub error_percent: f64,
}

/// All results.
#[derive(Clone, Debug, PartialEq)]
pub struct Paper {
    /// The synthetic half of Table 1.
    pub table: Vec<TableRow>,
    /// Figure 3, by bits, then ratio.
    pub figure3: Vec<Figure3Point>,
}

/// The ratios of Figure 3.
const RATIOS: [f64; 22] = [
    0.1, 0.15, 0.2, 0.25, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.85, 0.9, 0.94, 0.96, 0.98, 1.02, 1.04, 1.06, 1.1, 1.2, 1.35,
    1.5,
];
const FIGURE3_BITS: [u32; 2] = [8, 14];
/// Angle of the lamps to the camera's axis.
const TILT_DEG: f64 = 20.0;
const LAMPS: usize = 3;
/// A level of 8 bits.
const LEVEL: f64 = 1.0 / 255.0;

/// Does all experiments.
pub fn paper(options: &PaperOptions, watch: &dyn Watch) -> Result<Paper, LabError> {
    options.check()?;
    let corner = Experiment {
        scene: "corner",
        shape: Shape::Corner { wall_mm: 60.0, roll_deg: 0.0 },
        patches: options.corner_patches,
        albedos: vec![0.5, 0.25],
        mean_direct_level: 94.0,
        light: "two bounces",
    };
    let tray = Experiment {
        scene: "tray",
        shape: Shape::Tray { side_mm: 100.0 },
        patches: options.tray_patches,
        albedos: vec![0.78, 0.59, 0.39, 0.2],
        mean_direct_level: 109.0,
        light: "four bounces",
    };
    let corner = corner.render(options.size_px, &Portion { watch, from: 0.0, to: 0.2 })?;
    let figure3 = corner.figure3(&Portion::still(watch, 0.2))?;
    let mut table = corner.rows(&Portion::still(watch, 0.3))?;
    let tray = tray.render(options.size_px, &Portion { watch, from: 0.3, to: 0.9 })?;
    table.extend(tray.rows(&Portion::still(watch, 0.9))?);
    watch.progress(1.0);
    Ok(Paper { table, figure3 })
}

/// A scene and its paint.
struct Experiment {
    scene: &'static str,
    shape: Shape,
    patches: usize,
    albedos: Vec<f64>,
    mean_direct_level: f64,
    /// What light of as many bounces as albedos is called.
    light: &'static str,
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
    fn render(self, size_px: usize, watch: &dyn Watch) -> Result<Rendered, LabError> {
        let (mesh, camera) = framed(self.shape.mesh(self.patches)?, size_px)?;
        let directions = directions_on_ring(LAMPS, TILT_DEG);
        let lamp = |&direction_to_light: &_| Lamp::Directional { direction_to_light, intensity: 1.0 };
        let lamps: Vec<Lamp> = directions.iter().map(lamp).collect();
        let portion = |from, to| Portion { watch, from, to };
        let patches = Patches::from_mesh(&mesh)?;
        let (factors, _) = form_factors(patches, &FormFactorOptions::default(), &portion(0.0, 0.5))?;
        let bounces =
            BounceOptions { albedos: self.albedos.clone(), bounces: self.albedos.len(), ..BounceOptions::default() };
        let options = RenderOptions { bounces, ..RenderOptions::default() };
        let (rendering, _) = render(&factors, &lamps, &camera, &options, &portion(0.5, 1.0))?;
        Rendered::new(self, rendering, camera, directions)
    }
}

/// A rendered scene, scaled so that its true direct light has the paper's mean.
struct Rendered {
    experiment: Experiment,
    rendering: Rendering,
    camera: Camera,
    directions: Vec<Unit<Vector3<f64>>>,
    /// Pixels that all lamps light.
    lit: Mask,
}

impl Rendered {
    fn new(
        experiment: Experiment,
        mut rendering: Rendering,
        camera: Camera,
        directions: Vec<Unit<Vector3<f64>>>,
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
        Ok(Self { experiment, rendering, camera, directions, lit })
    }

    fn beta(&self) -> Vec<f64> {
        let albedos = &self.experiment.albedos;
        albedos.iter().map(|albedo| albedo / albedos[0]).collect()
    }

    fn rows(&self, watch: &dyn Watch) -> Result<Vec<TableRow>, LabError> {
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
        let beta = self.beta();
        let (mut raw, mut separated) = (Vec::new(), Vec::new());
        for lamp in 0..LAMPS {
            let photos = (0..beta.len())
                .map(|colour| taken(&self.light(bounced, lamp, colour, &beta), sensor))
                .collect::<Result<Vec<_>, _>>()?;
            raw.push(self.separate(&photos[..1], &beta[..1], watch)?);
            separated.push(self.separate(&photos, &beta, watch)?);
        }
        let exact = |lamp: usize| {
            let direct = Photo::unmarked(self.rendering.lights[lamp].bounces[0].clone());
            self.separate(&[direct], &beta[..1], watch)
        };
        let exact = (0..LAMPS).map(exact).collect::<Result<Vec<_>, _>>()?;
        let (raw_map, separated_map) = (self.normals(&raw, watch)?, self.normals(&separated, watch)?);
        let exact_map = self.normals(&exact, watch)?;
        let solved = |pixel: usize| {
            [&raw_map, &separated_map, &exact_map].iter().all(|map| map.at_index(pixel).is_some())
                && separated.iter().all(|light| light.marks.data()[pixel] & UNSOLVED == 0)
        };
        let compared = restricted(&self.lit, solved);
        let degrees = |map: &NormalMap| {
            let error = map.angular_error(&self.rendering.normals, &compared);
            error.map(|error| error.mean_deg).ok_or(SceneError::NothingToSee)
        };
        let (error, truth) = self.direct_error(&separated, &compared);
        Ok(PaperErrors {
            raw_deg: degrees(&raw_map)?,
            separated_deg: degrees(&separated_map)?,
            true_direct_deg: degrees(&exact_map)?,
            direct_error_levels: error / (LEVEL * (compared.count() * LAMPS) as f64),
            direct_error_percent: 100.0 * error / truth,
        })
    }

    /// What reaches the camera from the scene under a lamp in a colour.
    fn light(&self, bounced: Bounced, lamp: usize, colour: usize, beta: &[f64]) -> Plane {
        let planes = &self.rendering.lights[lamp];
        match bounced {
            Bounced::AsModelled => polynomial(&planes.bounces, beta[colour]),
            Bounced::WithoutEnd => planes.all[colour].clone(),
        }
    }

    /// As many bounces as photos.
    fn separate(&self, photos: &[Photo], beta: &[f64], watch: &dyn Watch) -> Result<Separation, LabError> {
        let noise =
            vec![NoiseModel { floor: LEVEL * LEVEL / 12.0, per_signal: 0.0, source: NoiseSource::Camera }; beta.len()];
        let photos: Vec<&Photo> = photos.iter().collect();
        let alpha = vec![1.0; beta.len()];
        let mask = &self.rendering.mask;
        let light = LightPhotos { photos: &photos, noise: &noise, alpha: &alpha, beta, mask };
        Ok(separate(&light, &SeparateOptions { bounces: beta.len() }, watch)?.0)
    }

    fn normals(&self, lights: &[Separation], watch: &dyn Watch) -> Result<NormalMap, LabError> {
        let direct = |(light, direction): (_, &Unit<Vector3<f64>>)| {
            let light: &Separation = light;
            DirectLight {
                direct: &light.bounces[0],
                noise: None,
                marks: &light.marks,
                lamp: StereoLamp::Distant(direction.into_inner()),
                intensity: 1.0,
            }
        };
        let lights: Vec<_> = lights.iter().zip(&self.directions).map(direct).collect();
        let surface = Surface { camera: &self.camera, depth_mm: None };
        Ok(normals(&lights, &self.rendering.mask, surface, &NormalsOptions::default(), watch)?.0.map)
    }

    /// Sums over lamps and pixels of the absolute error of bounce 1, and of the true direct light.
    fn direct_error(&self, separated: &[Separation], compared: &Mask) -> (f64, f64) {
        let pairs = separated.iter().map(|light| &light.bounces[0]).zip(&self.rendering.lights);
        pairs.fold((0.0, 0.0), |(error, truth), (found, light)| {
            let direct = &light.bounces[0];
            let off = found.data().iter().zip(direct.data()).map(|(found, truth)| (found - truth).abs()).collect();
            let off = Plane::from_vec(direct.width(), direct.height(), off);
            (error + off.map_or(0.0, |off| sum_over(compared, &off)), truth + sum_over(compared, direct))
        })
    }

    /// Two bounces of the scene's light, for any ratio of albedos.
    fn figure3(&self, watch: &dyn Watch) -> Result<Vec<Figure3Point>, LabError> {
        let all = FIGURE3_BITS.into_iter().flat_map(|bits| RATIOS.into_iter().map(move |ratio| (bits, ratio)));
        let point = |(bits, ratio): (u32, f64)| {
            let beta = [1.0, ratio];
            let sensor = Some(Sensor::noiseless(bits));
            let separated = |lamp: usize| {
                let bounces = &self.rendering.lights[lamp].bounces;
                let photos = beta.iter().map(|&beta| taken(&polynomial(bounces, beta), sensor));
                self.separate(&photos.collect::<Result<Vec<_>, _>>()?, &beta, watch)
            };
            let separated = (0..LAMPS).map(separated).collect::<Result<Vec<_>, LabError>>()?;
            let solved = |pixel: usize| separated.iter().all(|light| light.marks.data()[pixel] & UNSOLVED == 0);
            let (error, truth) = self.direct_error(&separated, &restricted(&self.lit, solved));
            Ok(Figure3Point { ratio, bits, error_percent: 100.0 * error / truth })
        };
        all.map(point).collect()
    }
}

fn taken(light: &Plane, sensor: Option<Sensor>) -> Result<Photo, LabError> {
    match sensor {
        Some(sensor) => sensor.photograph(light, 0),
        None => Ok(Photo::unmarked(light.clone())),
    }
}

/// `sum_k beta^k L_k` of bounces 1, 2, ..
fn polynomial(bounces: &[Plane], beta: f64) -> Plane {
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
    use super::*;
    use firstbounce_core::Unwatched;

    #[test]
    fn the_papers_claims_hold() {
        let options = PaperOptions { size_px: 48, corner_patches: 300, tray_patches: 500 };
        let Paper { table, figure3 } = paper(&options, &Unwatched).unwrap();
        for row in &table {
            println!("{row:.2?}");
        }
        let corner = table[0].noiseless;
        assert!(corner.separated_deg <= 0.3 && corner.true_direct_deg <= 0.3 && corner.raw_deg > 3.0);
        // Where the model holds, separation costs nothing: what is left is photometric stereo's.
        for row in table.iter().filter(|row| row.light != "all bounces") {
            let PaperErrors { separated_deg, true_direct_deg, direct_error_percent, .. } = row.noiseless;
            assert!((separated_deg - true_direct_deg).abs() < 0.01 && direct_error_percent < 0.1, "{row:?}");
        }
        for row in &table {
            for errors in [row.noiseless, row.eight_bit] {
                assert!(errors.separated_deg < errors.raw_deg, "{row:?}");
            }
        }
        // Equation 5 scales the noise of bounce 1 by sqrt(1 + beta^4) / (beta (1 - beta)): the curve follows it where
        // rounding is fine enough to be noise.
        let error = |bits: u32, ratio: f64| {
            figure3.iter().find(|point| (point.bits, point.ratio) == (bits, ratio)).unwrap().error_percent
        };
        let gain = |beta: f64| (1.0 + beta.powi(4)).sqrt() / (beta * (1.0 - beta).abs());
        for ratio in RATIOS {
            let expected = error(14, 0.5) * gain(ratio) / gain(0.5);
            println!("{ratio}: {:.3} % at 8 bits, {:.4} % at 14 for {expected:.4}", error(8, ratio), error(14, ratio));
            assert!((0.5..2.0).contains(&(error(14, ratio) / expected)), "{ratio}");
        }
        for [far, near] in [[0.5, 0.8], [0.8, 0.9], [0.9, 0.98], [1.5, 1.2], [1.2, 1.06], [1.06, 1.02]] {
            assert!(error(8, far) < error(8, near), "{far} {near}");
        }
    }
}
