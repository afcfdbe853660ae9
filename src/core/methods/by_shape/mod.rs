//! Shape from interreflections in one colour: the method of Nayar, Ikeuchi and Kanade, "Shape from interreflections",
//! International Journal of Computer Vision 6(3), 1991, beside the paper's own.
//!
//! Photometric stereo on the light as it is gives a pseudo shape, shallower than the true one, and a pseudo albedo. The
//! light that would bounce about on that shape is simulated and taken away, photometric stereo on what is left gives a
//! better shape, and so on. With the light L of every patch, the albedo matrix `P = diag(rho / pi)` and the kernel
//! `K = pi F` (F the form factors), light is direct light plus what bounces, `L = L_s + P K L`; so the direct light is
//! `L_s = (I - P K) L` without any matrix to invert (their equations 13 and 18).

mod facets;
#[cfg(test)]
mod tests;

use nalgebra::{Point3, Unit};
use rayon::prelude::*;
use thiserror::Error;

use crate::light::radiosity::{FormFactorOptions, FormFactors, RadiosityError, form_factors};
use crate::light::scene::{self, SceneError};
use crate::options::{OptionError, check_range};
use crate::stereo::normals::{DirectLight, Lamp};
use crate::stereo::shape::{Shape, ShapeError, ShapeOptions, recover_shape};
use crate::{Camera, Mask, Plane, Portion, Watch};
use facets::Facets;

/// No paint reflects all of the light: a larger pseudo albedo is taken as this.
const MAX_ALBEDO: f32 = 0.99;
/// The change of the normals grows when it is this many times the one before.
const GROWTH: f64 = 1.2;
/// Of one iteration's work, the part that photometric stereo and integration take; form factors take the rest.
const SHAPE_SHARE: f32 = 0.3;
/// Points along each side of a patch at which its direct light is simulated.
const POINTS_PER_PATCH_SIDE: usize = 2;

/// How to iterate.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ByShapeOptions {
    /// About how many patches the surface is cut into. Time and memory grow with its square.
    pub patches: usize,
    /// Iterations after which to stop.
    pub max_iterations: usize,
    /// Stop when an iteration turns the normals by less than this on the mean, in degrees.
    pub smallest_change_deg: f64,
    /// The light between patches.
    pub form_factors: FormFactorOptions,
}

impl Default for ByShapeOptions {
    fn default() -> Self {
        Self { patches: 1000, max_iterations: 10, smallest_change_deg: 0.1, form_factors: FormFactorOptions::default() }
    }
}

impl ByShapeOptions {
    /// Whether every option is in its range.
    pub fn check(&self) -> Result<(), ByShapeError> {
        let (patches, change_deg) = (self.patches, self.smallest_change_deg);
        check_range("patches", patches as f64, (16..=20_000).contains(&patches), "from 16 to 20000")?;
        let in_range = (1..=1000).contains(&self.max_iterations);
        check_range("max_iterations", self.max_iterations as f64, in_range, "from 1 to 1000")?;
        let in_range = change_deg > 0.0 && change_deg < 90.0;
        check_range("smallest_change_deg", change_deg, in_range, "above 0 and below 90")?;
        self.form_factors.check().map_err(ByShapeError::from)
    }
}

/// Why the light could not be taken apart.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ByShapeError {
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// No scale for the albedo.
    #[error("the light of a white facet is {value}; it must be a positive number")]
    WhiteLight {
        /// What was given.
        value: f64,
    },
    /// A shape too small to bounce light.
    #[error("the {pixels} pixels with a depth make no surface; check the mask and the lights")]
    NoSurface {
        /// Pixels with a depth.
        pixels: usize,
    },
    /// Photometric stereo or integration failed.
    #[error(transparent)]
    Shape(ShapeError),
    /// The light could not be bounced.
    #[error(transparent)]
    Radiosity(RadiosityError),
    /// A lamp that cannot be simulated.
    #[error(transparent)]
    Scene(SceneError),
    /// The watch cancelled.
    #[error("cancelled")]
    Cancelled,
}

impl From<ShapeError> for ByShapeError {
    fn from(error: ShapeError) -> Self {
        if error.is_cancelled() { Self::Cancelled } else { Self::Shape(error) }
    }
}

impl From<RadiosityError> for ByShapeError {
    fn from(error: RadiosityError) -> Self {
        if error == RadiosityError::Cancelled { Self::Cancelled } else { Self::Radiosity(error) }
    }
}

impl From<SceneError> for ByShapeError {
    fn from(error: SceneError) -> Self {
        if error == SceneError::Cancelled { Self::Cancelled } else { Self::Scene(error) }
    }
}

/// What was photographed in one colour.
#[derive(Clone, Copy, Debug)]
pub struct Photographed<'a> {
    /// The light as it is, bounced and not, of three or more lamps.
    pub lights: &'a [DirectLight<'a>],
    /// The object.
    pub mask: &'a Mask,
    /// What sees it.
    pub camera: &'a Camera,
    /// Linear light of a white facet (albedo 1) that faces a lamp of intensity 1: makes albedos absolute.
    pub white_light: f64,
}

/// The surface, and the light that it was found from.
#[derive(Clone, Debug, PartialEq)]
pub struct ByShape {
    /// The surface. Its albedo is in linear light, as photometric stereo gives it; over `white_light` it is absolute.
    pub shape: Shape,
    /// For each lamp, the direct light; zero where there is no surface.
    pub direct: Vec<Plane>,
    /// How it went.
    pub report: ByShapeReport,
}

/// One shape on the way: the pseudo shape is number 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct ByShapeStep {
    /// Iterations done.
    pub iteration: usize,
    /// Mean angle between the normals of this shape and of the one before, in degrees; zero for the pseudo shape.
    pub change_deg: f64,
    /// Mean albedo, absolute.
    pub mean_albedo: f64,
    /// Pixels whose albedo came out above what a paint can have and was lowered to 0.99.
    pub clamped_pixels: usize,
    /// Of the light photographed, the part that was found to have bounced more than once; zero for the pseudo shape.
    pub indirect_fraction: f64,
    /// What this shape does not explain of the photos: the light of every patch less the direct light that the lamps throw
    /// on it, shadows included, and less what arrives from the other patches; root mean square relative to the light.
    pub residual: f64,
}

/// How the iterations ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The normals came to rest.
    Converged,
    /// They still moved when the iterations ran out.
    OutOfIterations,
    /// They moved more and more.
    Diverged,
}

impl Ending {
    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Converged => "converged",
            Self::OutOfIterations => "out of iterations",
            Self::Diverged => "diverged",
        }
    }
}

/// How the method went.
#[derive(Clone, Debug, PartialEq)]
pub struct ByShapeReport {
    /// The pseudo shape, then a shape for each iteration.
    pub steps: Vec<ByShapeStep>,
    /// The iteration whose shape is the result: the one that leaves the least of the photos unexplained. Where patches are
    /// too coarse or the surface too steep for them, later iterations take away too much light.
    pub chosen: usize,
    /// How the iterations ended.
    pub ending: Ending,
    /// Patches of the last surface.
    pub patches: usize,
    /// Pixels along a patch.
    pub patch_px: usize,
    /// Unconnected parts of the surface. The depth between them is not known: they are lit as if at one mean depth.
    pub islands: usize,
}

/// Iterates from the pseudo shape that `recover_shape` finds in the light as it is. `on_step` is shown every shape once it
/// is known, the pseudo shape first.
///
/// # Errors
/// `ByShapeError`: options or scale out of range, no surface, no normals or depth, or cancelled.
pub fn separate_by_shape(
    photographed: &Photographed,
    pseudo_shape: &Shape,
    options: &ByShapeOptions,
    shape_options: &ShapeOptions,
    watch: &dyn Watch,
    on_step: &mut dyn FnMut(&ByShapeStep, &Shape),
) -> Result<ByShape, ByShapeError> {
    options.check()?;
    if !(photographed.white_light > 0.0 && photographed.white_light.is_finite()) {
        return Err(ByShapeError::WhiteLight { value: photographed.white_light });
    }
    let part = |from: f32, to: f32| {
        let whole = (options.max_iterations + 1) as f32;
        Portion { watch, from: from / whole, to: to / whole }
    };
    let mut now = Simulated::new(photographed, pseudo_shape.clone(), options, &part(0.0, 1.0))?;
    let mut steps = vec![now.step(0, 0.0, 0.0)];
    on_step(&steps[0], &now.shape);
    // The result is one of the iterations: the pseudo shape itself is what photometric stereo gives without the method.
    let mut best: Option<(Shape, Vec<Plane>, usize)> = None;
    let mut ending = Ending::OutOfIterations;
    for iteration in 1..=options.max_iterations {
        let begin = iteration as f32;
        let (corrected, indirect_fraction) = now.corrected(photographed, watch)?;
        let shape = shape_of(photographed, &corrected, shape_options, &part(begin, begin + SHAPE_SHARE))?;
        let change_deg = shape.normals.map.angular_error(&now.shape.normals.map, photographed.mask);
        let change_deg = change_deg.map_or(0.0, |change| change.mean_deg);
        now = Simulated::new(photographed, shape, options, &part(begin + SHAPE_SHARE, begin + 1.0))?;
        steps.push(now.step(iteration, change_deg, indirect_fraction));
        on_step(&steps[iteration], &now.shape);
        if best.as_ref().is_none_or(|(_, _, best)| now.residual < steps[*best].residual) {
            best = Some((now.shape.clone(), corrected, iteration));
        }
        if change_deg < options.smallest_change_deg {
            ending = Ending::Converged;
        } else if grows_twice(&steps) {
            ending = Ending::Diverged;
        }
        if ending != Ending::OutOfIterations {
            break;
        }
    }
    let (patches, patch_px) = (now.factors.patches().len(), now.facets.step_px());
    let Some((shape, direct, chosen)) = best else {
        return Err(ByShapeError::NoSurface { pixels: now.shape.depth.report.pixels });
    };
    watch.progress(1.0);
    let islands = shape.depth.report.islands;
    Ok(ByShape { shape, direct, report: ByShapeReport { steps, chosen, ending, patches, patch_px, islands } })
}

/// Whether the last two iterations each turned the normals clearly further than the one before.
fn grows_twice(steps: &[ByShapeStep]) -> bool {
    match steps {
        [.., a, b, c] => {
            a.iteration > 0 && b.change_deg > GROWTH * a.change_deg && c.change_deg > GROWTH * b.change_deg
        }
        _ => false,
    }
}

fn shape_of(
    photographed: &Photographed,
    direct: &[Plane],
    options: &ShapeOptions,
    watch: &dyn Watch,
) -> Result<Shape, ByShapeError> {
    let lights: Vec<_> =
        photographed.lights.iter().zip(direct).map(|(light, direct)| DirectLight { direct, ..*light }).collect();
    Ok(recover_shape(&lights, photographed.mask, photographed.camera, options, watch)?)
}

/// A shape, and the light that bounces on it when its patches shine as photographed.
struct Simulated {
    shape: Shape,
    facets: Facets,
    factors: FormFactors,
    /// For each lamp and patch, the light that arrives from the other patches: `F L`.
    arriving: Vec<Vec<f64>>,
    /// Absolute albedo of every pixel.
    albedo: Plane,
    clamped_pixels: usize,
    residual: f64,
}

impl Simulated {
    fn new(
        photographed: &Photographed,
        shape: Shape,
        options: &ByShapeOptions,
        watch: &dyn Watch,
    ) -> Result<Self, ByShapeError> {
        let facets = Facets::new(&shape, photographed.camera, options.patches)
            .ok_or(ByShapeError::NoSurface { pixels: shape.depth.report.pixels })?;
        let patches = facets.patches()?;
        // Form factors that are not kept are computed again for the light.
        let made = if options.form_factors.stores(patches.len()) { 1.0 } else { 0.5 };
        let (factors, _) = form_factors(patches, &options.form_factors, &Portion { watch, from: 0.0, to: made })?;
        let light: Vec<_> = photographed.lights.iter().map(|light| facets.means(light.direct)).collect();
        let arriving = factors.irradiance(&light, &Portion { watch, from: made, to: 1.0 })?;
        let (albedo, clamped_pixels) = absolute_albedo(&shape, photographed.white_light);
        let residual = residual(photographed, &factors, &facets.means(&albedo), &light, &arriving)?;
        Ok(Self { shape, facets, factors, arriving, albedo, clamped_pixels, residual })
    }

    fn step(&self, iteration: usize, change_deg: f64, indirect_fraction: f64) -> ByShapeStep {
        let solved = self.shape.report.normals.solved_pixels.max(1) as f64;
        let albedo: f64 = self.albedo.data().par_iter().map(|&albedo| f64::from(albedo)).sum();
        ByShapeStep {
            iteration,
            change_deg,
            mean_albedo: albedo / solved,
            clamped_pixels: self.clamped_pixels,
            indirect_fraction,
            residual: self.residual,
        }
    }

    /// For each lamp, the photographed light less what arrives from the other patches and is reflected: `L - rho F L`.
    /// And the part of the light that this takes away.
    fn corrected(&self, photographed: &Photographed, watch: &dyn Watch) -> Result<(Vec<Plane>, f64), ByShapeError> {
        let fields = self.facets.fields(self.factors.patches(), &self.arriving);
        let (width, height) = self.albedo.size();
        let (mut taken, mut whole) = (0.0, 0.0);
        let mut all = Vec::with_capacity(photographed.lights.len());
        for (l, light) in photographed.lights.iter().enumerate() {
            if watch.cancelled() {
                return Err(ByShapeError::Cancelled);
            }
            let mut direct = Plane::filled(width, height, 0.0);
            let row = |(y, row): (usize, &mut [f32])| {
                let (mut taken, mut whole) = (0.0, 0.0);
                for (x, value) in row.iter_mut().enumerate().filter(|(x, _)| self.shape.depth.mask.at(*x, y)) {
                    let arriving = self.facets.field_at(&fields, l, x, y).unwrap_or(0.0);
                    let (light, indirect) = (light.direct.at(x, y), self.albedo.at(x, y) * arriving);
                    *value = light - indirect;
                    taken += f64::from(indirect);
                    whole += f64::from(light);
                }
                (taken, whole)
            };
            let sums = direct.data_mut().par_chunks_mut(width.max(1)).enumerate().map(row);
            let (taken_here, whole_here) = sums.reduce(|| (0.0, 0.0), |a, b| (a.0 + b.0, a.1 + b.1));
            taken += taken_here;
            whole += whole_here;
            all.push(direct);
        }
        Ok((all, if whole > 0.0 { taken / whole } else { 0.0 }))
    }
}

/// Albedo over that of white, and how many pixels had more than a paint can have.
fn absolute_albedo(shape: &Shape, white_light: f64) -> (Plane, usize) {
    let mut albedo = shape.normals.albedo.clone();
    let scale = (1.0 / white_light) as f32;
    let clamp = |value: &mut f32| {
        *value *= scale;
        let too_bright = *value > MAX_ALBEDO;
        *value = value.min(MAX_ALBEDO);
        usize::from(too_bright)
    };
    let clamped = albedo.data_mut().par_iter_mut().map(clamp).sum();
    (albedo, clamped)
}

/// What the shape does not explain of the photographed light, relative to it.
fn residual(
    photographed: &Photographed,
    factors: &FormFactors,
    albedo: &[f64],
    light: &[Vec<f64>],
    arriving: &[Vec<f64>],
) -> Result<f64, ByShapeError> {
    let lamps: Vec<_> = photographed.lights.iter().map(as_simulated).collect();
    let direct = scene::irradiances(factors.patches(), &lamps, POINTS_PER_PATCH_SIDE)?;
    let (mut squares, mut whole) = (0.0, 0.0);
    for ((light, arriving), direct) in light.iter().zip(arriving).zip(&direct) {
        for (i, patch) in factors.patches().as_slice().iter().enumerate() {
            let explained = albedo[i] * (photographed.white_light * direct[i] + arriving[i]);
            squares += patch.area_mm2 * (light[i] - explained).powi(2);
            whole += patch.area_mm2 * light[i].powi(2);
        }
    }
    Ok(if whole > 0.0 { (squares / whole).sqrt() } else { 0.0 })
}

/// The lamp as the virtual lab takes it.
fn as_simulated(light: &DirectLight) -> scene::Lamp {
    let intensity = light.intensity;
    match light.lamp {
        Lamp::Distant(direction) => {
            scene::Lamp::Directional { direction_to_light: Unit::new_normalize(direction), intensity }
        }
        Lamp::Near(position) => scene::Lamp::Point { position_mm: Point3::from(position.coords), intensity },
    }
}
