//! The picture of the surface, bounce by bounce.

use std::ops::Range;

use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

use super::{
    SceneError,
    anchor::Anchors,
    gather::{Gatherer, smooth_receiver},
    lamp::{Lamp, Receiver, Sources, irradiances},
};
use crate::light::radiosity::{BounceOptions, BounceReport, FormFactors, Hit, Patches, bounces};
use crate::options::check_range;
use crate::{Camera, Mask, NormalMap, Plane, Portion, Projection, Watch};

/// How a scene is rendered.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderOptions {
    /// The paint, and how many bounces to keep apart.
    pub bounces: BounceOptions,
    /// Samples along each side of a pixel: direct light, shadows, normals and depth are means over their square.
    pub samples_per_pixel_side: usize,
    /// Indirect light is gathered at every pixel of this step along rows and columns, and at those between only where the
    /// ones around lie on different surfaces or differ by more than `gather_tolerance`; 1 gathers in every pixel.
    pub gather_spacing_px: usize,
    /// How much the light gathered around a pixel may differ, as a fraction of it or of the picture's mean, for the pixel
    /// to take its bilinear mean. That errs by about an eighth of its square where the light is smooth, and by half of it
    /// at worst, on a shadow's edge.
    pub gather_tolerance: f64,
    /// Points along each side of a patch at which lamps and shadows are sampled for its irradiance.
    pub points_per_patch_side: usize,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            bounces: BounceOptions::default(),
            samples_per_pixel_side: 3,
            gather_spacing_px: 4,
            gather_tolerance: 0.1,
            points_per_patch_side: 3,
        }
    }
}

impl RenderOptions {
    /// Whether every option is in its range.
    pub fn check(&self) -> Result<(), SceneError> {
        self.bounces.check()?;
        for (option, value) in [
            ("samples_per_pixel_side", self.samples_per_pixel_side),
            ("gather_spacing_px", self.gather_spacing_px),
            ("points_per_patch_side", self.points_per_patch_side),
        ] {
            check_range(option, value as f64, (1..=16).contains(&value), "1 to 16")?;
        }
        let tolerance = self.gather_tolerance;
        Ok(check_range("gather_tolerance", tolerance, (0.0..1.0).contains(&tolerance), "from 0 to below 1")?)
    }
}

/// Linear light under one lamp.
#[derive(Clone, Debug, PartialEq)]
pub struct LitPlanes {
    /// Bounce 1, 2, .. at the reference albedo.
    pub bounces: Vec<Plane>,
    /// For each albedo, the sum of all bounces without end.
    pub all: Vec<Plane>,
}

/// A rendered scene. A white facet that faces a lamp of intensity 1 is 1; radiance is the same from every side.
#[derive(Clone, Debug, PartialEq)]
pub struct Rendering {
    /// For each lamp.
    pub lights: Vec<LitPlanes>,
    /// Pixels that the surface fills wholly. In the others the values are what falls into them.
    pub mask: Mask,
    /// Smooth normals inside the mask.
    pub normals: NormalMap,
    /// Depth (z toward the camera) inside the mask, zero outside.
    pub depth_mm: Plane,
}

/// What the rendering took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RenderReport {
    /// Pixels the surface fills wholly.
    pub mask_pixels: usize,
    /// Points at which indirect light was gathered; the other pixels interpolate.
    pub gathers: usize,
    /// The solver's report on the sum of all bounces.
    pub all_bounces: BounceReport,
}

/// Renders the surface of `factors`: direct light exactly at every sample, bounce k + 1 as `rho` times the light gathered
/// from bounce k of all patches with visibility, once for each surface in a pixel.
pub fn render(
    factors: &FormFactors,
    lamps: &[Lamp],
    camera: &Camera,
    options: &RenderOptions,
    watch: &dyn Watch,
) -> Result<(Rendering, RenderReport), SceneError> {
    options.check()?;
    if lamps.is_empty() {
        return Err(SceneError::NoLamp);
    }
    if !camera.is_valid() || camera.size.0 == 0 || camera.size.1 == 0 {
        return Err(SceneError::BadCamera { camera: *camera });
    }
    let patches = factors.patches();
    let direct = irradiances(patches, lamps, options.points_per_patch_side)?;
    // Form factors that are computed again for every bounce take the longest.
    let seen = if factors.is_stored() { 0.1 } else { 0.8 };
    let (radiosities, all_bounces) =
        bounces(factors, &direct, &options.bounces, &Portion { watch, from: 0.0, to: seen })?;
    let watch = &Portion { watch, from: seen, to: 1.0 };
    let told_apart = options.bounces.bounces - 1;
    let channels: Vec<&[f64]> = radiosities
        .iter()
        .flat_map(|lamp| lamp.bounces.iter().take(told_apart).chain(&lamp.all))
        .map(Vec::as_slice)
        .collect();
    let view = View {
        camera,
        samples: options.samples_per_pixel_side,
        albedos: &options.bounces.albedos,
        patches,
        lamps: lamps.iter().map(Lamp::sources).collect::<Result<_, _>>()?,
        gatherer: Gatherer::new(patches, &channels),
        told_apart,
    };
    let hit = |x_px, y_px| Some(view.hit(x_px, y_px)?.0);
    let (spacing_px, tolerance) = (options.gather_spacing_px, options.gather_tolerance);
    let anchors = Anchors::new(camera.size, spacing_px, tolerance, &view.gatherer, hit, watch)?;
    let pixels = view.all_pixels(&anchors, watch)?;
    let (rendering, mask_pixels, gathers_between) = assemble(camera.size, lamps.len(), &options.bounces, &pixels);
    let gathers = anchors.gathers() + gathers_between;
    Ok((rendering, RenderReport { mask_pixels, gathers, all_bounces }))
}

/// What falls into one pixel.
struct Pixel {
    /// For each lamp: bounces, then all bounces for each albedo.
    light: Vec<f32>,
    /// Means over the samples that hit.
    normal: Vector3<f64>,
    depth_mm: f64,
    filled: bool,
    gathers: usize,
}

struct View<'a> {
    camera: &'a Camera,
    samples: usize,
    albedos: &'a [f64],
    patches: &'a Patches,
    lamps: Vec<Sources>,
    gatherer: Gatherer<'a>,
    told_apart: usize,
}

impl View<'_> {
    fn all_pixels(&self, anchors: &Anchors, watch: &dyn Watch) -> Result<Vec<Pixel>, SceneError> {
        let (width, height) = self.camera.size;
        let rows_at_once = height.div_ceil(100);
        let mut pixels = Vec::with_capacity(width * height);
        for first in (0..height).step_by(rows_at_once) {
            if watch.cancelled() {
                return Err(SceneError::Cancelled);
            }
            watch.progress(first as f32 / height as f32);
            let block: Range<usize> = first * width..(first + rows_at_once).min(height) * width;
            pixels.par_extend(block.into_par_iter().map(|index| self.pixel(index % width, index / width, anchors)));
        }
        watch.progress(1.0);
        Ok(pixels)
    }

    fn pixel(&self, column: usize, row: usize, anchors: &Anchors) -> Pixel {
        let side = self.samples as f64;
        let sample = |k: usize| {
            let (i, j) = ((k % self.samples) as f64, (k / self.samples) as f64);
            self.hit(column as f64 + (i + 0.5) / side, row as f64 + (j + 0.5) / side)
        };
        let count = self.samples * self.samples;
        let (hits, heights_mm): (Vec<Receiver>, Vec<f64>) = (0..count).filter_map(sample).unzip();
        let mut pixel = Pixel {
            light: vec![0.0; self.lamps.len() * (self.told_apart + 1 + self.albedos.len())],
            normal: hits.iter().map(|hit| hit.normal.into_inner()).sum(),
            depth_mm: heights_mm.iter().sum::<f64>() / hits.len().max(1) as f64,
            filled: hits.len() == count,
            gathers: 0,
        };
        let light_of = 1.0 / count as f64;
        for surface in surfaces(&hits) {
            let middle = middle(&surface);
            let gathered = anchors.irradiance(column, row, middle).unwrap_or_else(|| {
                pixel.gathers += 1;
                self.gatherer.irradiance(middle)
            });
            self.add_surface(&surface, &gathered, light_of, &mut pixel.light);
        }
        pixel
    }

    /// The first point of the surface on the ray of an image position, and its height z.
    fn hit(&self, x_px: f64, y_px: f64) -> Option<(Receiver, f64)> {
        let (hit, height_mm) = seen_at(self.patches, self.camera, x_px, y_px)?;
        Some((smooth_receiver(self.patches, hit.patch, hit.weights), height_mm))
    }

    /// Adds the light of samples that share a surface and the irradiance `gathered`, each with the weight `light_of`.
    fn add_surface(&self, samples: &[&Receiver], gathered: &[f64], light_of: f64, light: &mut [f32]) {
        let share = light_of * samples.len() as f64;
        let rho = self.albedos[0];
        let planes = self.told_apart + self.albedos.len();
        for (lamp, (light, gathered)) in
            self.lamps.iter().zip(light.chunks_exact_mut(planes + 1).zip(gathered.chunks_exact(planes)))
        {
            let direct =
                |sample: &&Receiver| lamp.irradiance(sample, self.patches.occluders(), self.patches.diagonal_mm());
            let direct = samples.iter().map(direct).sum::<f64>() * light_of;
            light[0] += (rho * direct) as f32;
            let (apart, all) = gathered.split_at(self.told_apart);
            let (light_apart, light_all) = light[1..].split_at_mut(self.told_apart);
            for (light, irradiance) in light_apart.iter_mut().zip(apart) {
                *light += (rho * share * irradiance) as f32;
            }
            for ((light, irradiance), rho) in light_all.iter_mut().zip(all).zip(self.albedos) {
                *light += (rho * (direct + share * irradiance)) as f32;
            }
        }
    }
}

/// What the camera sees of the surface at an image position, from either side, and the height z of the point.
pub fn seen_at(patches: &Patches, camera: &Camera, x_px: f64, y_px: f64) -> Option<(Hit, f64)> {
    let direction = camera.view_ray(x_px, y_px);
    let origin = match camera.projection {
        Projection::Perspective { working_distance_mm, .. } => Point3::new(0.0, 0.0, working_distance_mm),
        Projection::Orthographic { .. } => {
            // A height above the whole surface.
            let top_mm = patches.as_slice().first()?.centre.z + 2.0 * patches.diagonal_mm();
            camera.point_mm(x_px, y_px, top_mm)
        }
    };
    let hit = patches.occluders().first_hit(&origin, &direction, None)?;
    Some((hit, origin.z + direction.z * hit.distance))
}

/// Samples of a pixel sorted by the smooth surface they lie on.
fn surfaces(hits: &[Receiver]) -> Vec<Vec<&Receiver>> {
    let mut surfaces: Vec<Vec<&Receiver>> = Vec::new();
    for hit in hits {
        match surfaces.iter_mut().find(|surface| surface[0].continues(hit)) {
            Some(surface) => surface.push(hit),
            None => surfaces.push(vec![hit]),
        }
    }
    surfaces
}

/// The sample nearest to the mean of samples that share a surface.
fn middle<'a>(samples: &[&'a Receiver]) -> &'a Receiver {
    let mean = samples.iter().map(|sample| sample.point.coords).sum::<Vector3<f64>>() / samples.len() as f64;
    let from_mean = |sample: &Receiver| (sample.point.coords - mean).norm_squared();
    samples[1..].iter().fold(samples[0], |best, sample| if from_mean(sample) < from_mean(best) { sample } else { best })
}

fn assemble(
    (width, height): (usize, usize),
    lamps: usize,
    options: &BounceOptions,
    pixels: &[Pixel],
) -> (Rendering, usize, usize) {
    let plane =
        |value: &(dyn Fn(&Pixel) -> f32 + Sync)| Plane::from_fn(width, height, |x, y| value(&pixels[y * width + x]));
    let planes = options.bounces + options.albedos.len();
    let lit = |lamp: usize| {
        let mut all = (0..planes).map(|k| plane(&|pixel| pixel.light[lamp * planes + k]));
        LitPlanes { bounces: all.by_ref().take(options.bounces).collect(), all: all.collect() }
    };
    let mask = Mask::from_fn(width, height, |x, y| pixels[y * width + x].filled);
    let inside = |pixel: &Pixel, value: f64| if pixel.filled { value as f32 } else { 0.0 };
    let normal =
        |k: usize| plane(&|pixel| inside(pixel, pixel.normal.try_normalize(0.0).map_or(0.0, |normal| normal[k])));
    let normals = NormalMap::from_planes(normal(0), normal(1), normal(2)).expect("three planes of one size");
    let depth_mm = plane(&|pixel| inside(pixel, pixel.depth_mm));
    let mask_pixels = mask.count();
    let gathers = pixels.iter().map(|pixel| pixel.gathers).sum();
    let lights = (0..lamps).map(lit).collect();
    (Rendering { lights, mask, normals, depth_mm }, mask_pixels, gathers)
}
