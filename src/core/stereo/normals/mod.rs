//! Photometric stereo: the direct light under three or more lamps gives each pixel's normal and albedo.
//!
//! R. J. Woodham, "Photometric method for determining surface orientation from multiple images", Optical Engineering
//! 19(1), 1980; equation 1 of Liao, Huang and Yang, CVPR 2011. With lamps near the object, each pixel is lit from its own
//! direction and with its own inverse-square distance.

mod block;
mod one_paint;
mod pixel;

use nalgebra::{DMatrix, Point3, Vector3};
use rayon::prelude::*;
use thiserror::Error;

use crate::block::JOB;
use crate::image::photo::{CLIPPED, DARK};
use crate::linear_algebra;
use crate::options::{OptionError, check_range};
use crate::separate::{OUTSIDE, UNSOLVED};
use crate::{Camera, Marks, Mask, NormalMap, Plane, Watch};

/// Mark of a pixel whose normal comes from some of the lights: others were in shadow, or did not fit.
pub const SHADOWED: u8 = 16;
/// Mark of a pixel in the shadow of a light that was used all the same, since fewer than three would have remained.
pub const SHADOW_USED: u8 = 32;

/// Lamps whose directions span less than this (smallest over largest singular value) lie in a plane.
const MIN_SPREAD: f64 = 0.01;

/// How to find normals.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct NormalsOptions {
    /// A light is in shadow at a pixel where its strength-corrected light is below this share of the brightest light's.
    pub shadow_fraction: f64,
    /// With five or more lights, one that misses the fit by more than this share of the brightest light is left out
    /// (a cast shadow that indirect light fills, a highlight).
    pub outlier_fraction: f64,
    /// Whether the whole object has one albedo.
    pub paint: Paint,
}

/// What is known of the object's albedo.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub enum Paint {
    /// One where the albedos of photometric stereo agree within their noise.
    #[default]
    Auto,
    /// One everywhere: fewer unknowns, less noise.
    One,
    /// Each pixel has its own.
    Any,
}

impl Default for NormalsOptions {
    fn default() -> Self {
        Self { shadow_fraction: 0.08, outlier_fraction: 0.15, paint: Paint::Any }
    }
}

impl NormalsOptions {
    /// Whether the fractions are fractions.
    pub fn check(&self) -> Result<(), NormalsError> {
        for (option, value) in [("shadow_fraction", self.shadow_fraction), ("outlier_fraction", self.outlier_fraction)]
        {
            check_range(option, value, (0.0..1.0).contains(&value), "from 0 to below 1")?;
        }
        Ok(())
    }
}

/// Why there are no normals.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum NormalsError {
    /// Three unknowns need three lights.
    #[error("{lights} lights: normals need at least three, in different directions")]
    TooFewLights {
        /// How many there are.
        lights: usize,
    },
    /// The lamps' directions do not span space.
    #[error(
        "the {lights} lights lie in a plane (spread {spread:.4}, at least {MIN_SPREAD} is needed): move one lamp out of it"
    )]
    LightsInPlane {
        /// How many there are.
        lights: usize,
        /// Smallest over largest singular value of their directions.
        spread: f64,
    },
    /// A lamp's direction, position or intensity is no number, or its intensity not positive.
    #[error("light {}: direction, position and a positive intensity must be finite numbers", light + 1)]
    BadLamp {
        /// Which light, from 0.
        light: usize,
    },
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// Planes of different sizes.
    #[error("a plane is {found:?} pixels, the mask {expected:?}: all must have one size")]
    Size {
        /// Width and height of the plane.
        found: (usize, usize),
        /// Those of the mask.
        expected: (usize, usize),
    },
    /// Near lamps without a scale.
    #[error("lamps with position_mm need the camera's scale: give mm_per_pixel or a perspective camera")]
    NoScale,
    /// The watch cancelled.
    #[error("cancelled")]
    Cancelled,
}

/// Where a lamp is, in the object frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lamp {
    /// So far that all pixels see it in one direction, from the object to the light (any length but zero).
    Distant(Vector3<f64>),
    /// Near: a position in mm.
    Near(Point3<f64>),
}

impl Lamp {
    /// The light that reaches a facet at `point_mm`, as a vector to the lamp whose length is the strength relative to
    /// the frame's origin (inverse square of the distance; 1 for a distant lamp).
    pub fn irradiance_vector(&self, point_mm: Point3<f64>) -> Vector3<f64> {
        match self {
            Lamp::Distant(direction_to_light) => direction_to_light.normalize(),
            Lamp::Near(position_mm) => {
                let to_light = position_mm - point_mm;
                to_light * (position_mm.coords.norm_squared() / to_light.norm().powi(3))
            }
        }
    }
}

/// The direct light of one lamp, as separation leaves it.
#[derive(Clone, Copy, Debug)]
pub struct DirectLight<'a> {
    /// L_1 in linear light.
    pub direct: &'a Plane,
    /// Standard deviation of L_1, where known.
    pub noise: Option<&'a Plane>,
    /// Marks of the separation; pixels with `UNSOLVED` are left out.
    pub marks: &'a Marks,
    /// Where the lamp is.
    pub lamp: Lamp,
    /// Strength at the frame's origin relative to the first light.
    pub intensity: f64,
}

/// What sees the surface, and what is known of its depth; near lamps need both.
#[derive(Clone, Copy, Debug)]
pub struct Surface<'a> {
    /// The camera.
    pub camera: &'a Camera,
    /// Depth toward the camera in mm; `None` for the plane z = 0.
    pub depth_mm: Option<&'a Plane>,
}

/// Normals, albedo and how far to trust them.
#[derive(Clone, Debug, PartialEq)]
pub struct Normals {
    /// Unit normals; zero where there is none.
    pub map: NormalMap,
    /// The linear light of the surface facing a lamp of intensity 1; zero where there is no normal.
    pub albedo: Plane,
    /// Predicted noise of the normal (root mean square angle) in degrees; zero where unknown.
    pub noise_deg: Plane,
    /// `UNSOLVED`, `OUTSIDE`, `SHADOWED`, `SHADOW_USED`, and why lights are missing (`CLIPPED`, `DARK`).
    pub marks: Marks,
}

impl Normals {
    /// Room for the normals of a picture of this size.
    pub fn empty(width: usize, height: usize) -> Self {
        let zero = Plane::filled(width, height, 0.0);
        let map = NormalMap::empty(width, height);
        Self { map, albedo: zero.clone(), noise_deg: zero, marks: Marks::filled(width, height, OUTSIDE) }
    }

    /// The pixels that have a normal.
    pub fn solved(&self) -> Mask {
        self.marks.map(|mark| mark & (UNSOLVED | OUTSIDE) == 0)
    }
}

/// What photometric stereo found of the object's paint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaintReport {
    /// Whether the normals are those of one albedo.
    pub one: bool,
    /// That albedo, in linear light: of the pixels that every light reaches, the median.
    pub albedo: f64,
    /// The share of these pixels whose own albedo differs by more than 10 % and three times its noise.
    pub stray_share: f64,
}

/// Above this share of pixels with another albedo an object has several paints.
pub const MAX_STRAY_SHARE: f64 = 0.05;

/// What photometric stereo reports. Means run over the solved pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NormalsReport {
    /// Lights given.
    pub lights: usize,
    /// Largest over smallest singular value of the lamps' directions, seen from the frame's origin.
    pub condition_number: f64,
    /// Pixels with a normal.
    pub solved_pixels: usize,
    /// Of those, pixels whose shadowed or misfitting lights were left out.
    pub shadowed_pixels: usize,
    /// Of those, pixels in some light's shadow where that light had to be used.
    pub shadow_used_pixels: usize,
    /// Pixels of the mask without a normal: too few usable lights.
    pub unsolved_pixels: usize,
    /// Mean albedo.
    pub mean_albedo: f64,
    /// Mean of the predicted noise in degrees.
    pub mean_noise_deg: f64,
    /// Of the object's paint, where it was looked at.
    pub paint: Option<PaintReport>,
}

/// Normals and albedo from the direct light of three or more lamps.
pub fn normals(
    lights: &[DirectLight],
    mask: &Mask,
    surface: Surface,
    options: &NormalsOptions,
    watch: &dyn Watch,
) -> Result<(Normals, NormalsReport), NormalsError> {
    let mut normals = Normals::empty(mask.width(), mask.height());
    let report = normals_into(&mut normals, lights, mask, surface, options, watch)?;
    Ok((normals, report))
}

/// Like `normals`, writing into planes that are already there when they have the right size.
pub fn normals_into(
    normals: &mut Normals,
    lights: &[DirectLight],
    mask: &Mask,
    surface: Surface,
    options: &NormalsOptions,
    watch: &dyn Watch,
) -> Result<NormalsReport, NormalsError> {
    options.check()?;
    check_lights(lights, mask, &surface)?;
    let condition_number = spread(lights)?.recip();
    if normals.map.size() != mask.size() {
        *normals = Normals::empty(mask.width(), mask.height());
    }

    let stage = pixel::Stage::new(lights, mask, surface, options);
    let kernel = block::Kernel::new(&stage);
    let jobs = mask.data().len().div_ceil(JOB).max(1);
    let done = std::sync::atomic::AtomicUsize::new(0);
    let Normals { map, albedo, noise_deg, marks } = normals;
    let [x, y, z] = map.planes_mut().map(|plane| plane.data_mut().par_chunks_mut(JOB));
    let albedo = albedo.data_mut().par_chunks_mut(JOB);
    let noise_deg = noise_deg.data_mut().par_chunks_mut(JOB);
    let tally = (x, y, z, albedo, noise_deg, marks.data_mut().par_chunks_mut(JOB))
        .into_par_iter()
        .enumerate()
        .map(|(job, (x, y, z, albedo, noise_deg, marks))| {
            let target = block::Target { first_pixel: job * JOB, x, y, z, albedo, noise_deg, marks };
            let tally =
                if watch.cancelled() { Tally::default() } else { block::run_job(target, &stage, kernel.as_ref()) };
            let finished = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
            watch.progress(finished as f32 / jobs as f32);
            tally
        })
        .reduce(Tally::default, Tally::join);
    let mut report = tally.report(lights.len(), condition_number);
    if options.paint != Paint::Any {
        report.paint = one_paint::judge(&stage, normals);
    }
    if let Some(paint) = &mut report.paint {
        paint.one = options.paint == Paint::One || paint.stray_share <= MAX_STRAY_SHARE;
        if paint.one {
            one_paint::refine_all(&stage, normals, paint.albedo, watch);
            report = refined(report, normals);
        }
    }
    if watch.cancelled() {
        return Err(NormalsError::Cancelled);
    }
    Ok(report)
}

/// What normals report that were refined to one albedo.
fn refined(report: NormalsReport, normals: &Normals) -> NormalsReport {
    let Normals { albedo, noise_deg, marks, .. } = normals;
    let pixels = (marks.data().par_iter(), albedo.data(), noise_deg.data()).into_par_iter();
    let solved = pixels.filter(|(marks, ..)| **marks & (UNSOLVED | OUTSIDE) == 0);
    let of_pixel = |(marks, albedo, noise_deg): (&u8, &f32, &f32)| Tally {
        solved: 1,
        shadowed: usize::from(marks & SHADOWED != 0),
        shadow_used: usize::from(marks & SHADOW_USED != 0),
        albedo: f64::from(*albedo),
        noise_deg: f64::from(*noise_deg),
        ..Tally::default()
    };
    let tally = solved.map(of_pixel).reduce(Tally::default, Tally::join);
    let of_refined = tally.report(report.lights, report.condition_number);
    NormalsReport { unsolved_pixels: report.unsolved_pixels, paint: report.paint, ..of_refined }
}

/// Sums over pixels.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    solved: usize,
    shadowed: usize,
    shadow_used: usize,
    unsolved: usize,
    albedo: f64,
    noise_deg: f64,
}

impl Tally {
    fn join(self, other: Self) -> Self {
        Self {
            solved: self.solved + other.solved,
            shadowed: self.shadowed + other.shadowed,
            shadow_used: self.shadow_used + other.shadow_used,
            unsolved: self.unsolved + other.unsolved,
            albedo: self.albedo + other.albedo,
            noise_deg: self.noise_deg + other.noise_deg,
        }
    }

    fn report(self, lights: usize, condition_number: f64) -> NormalsReport {
        let solved = self.solved.max(1) as f64;
        NormalsReport {
            lights,
            condition_number,
            solved_pixels: self.solved,
            shadowed_pixels: self.shadowed,
            shadow_used_pixels: self.shadow_used,
            unsolved_pixels: self.unsolved,
            mean_albedo: self.albedo / solved,
            mean_noise_deg: self.noise_deg / solved,
            paint: None,
        }
    }
}

fn check_lights(lights: &[DirectLight], mask: &Mask, surface: &Surface) -> Result<(), NormalsError> {
    if lights.len() < 3 {
        return Err(NormalsError::TooFewLights { lights: lights.len() });
    }
    let good = |light: &DirectLight| {
        let vector = light.lamp.irradiance_vector(Point3::origin());
        light.intensity > 0.0 && light.intensity.is_finite() && vector.iter().all(|value| value.is_finite())
    };
    if let Some(light) = lights.iter().position(|light| !good(light)) {
        return Err(NormalsError::BadLamp { light });
    }
    if lights.iter().any(|light| matches!(light.lamp, Lamp::Near(_)))
        && surface.camera.unit() == crate::mesh::LengthUnit::Pixel
    {
        return Err(NormalsError::NoScale);
    }
    let planes = lights.iter().flat_map(|light| [Some(light.direct), light.noise]).chain([surface.depth_mm]);
    let sizes = planes.flatten().map(Plane::size).chain(lights.iter().map(|light| light.marks.size()));
    match sizes.into_iter().find(|&found| found != mask.size()) {
        Some(found) => Err(NormalsError::Size { found, expected: mask.size() }),
        None => Ok(()),
    }
}

/// Smallest over largest singular value of the lamps' directions from the frame's origin.
fn spread(lights: &[DirectLight]) -> Result<f64, NormalsError> {
    let directions: Vec<_> =
        lights.iter().map(|light| light.lamp.irradiance_vector(Point3::origin()).normalize()).collect();
    let matrix = DMatrix::from_fn(lights.len(), 3, |l, axis| directions[l][axis]);
    let spread = linear_algebra::singular_values(&matrix).map_or(0.0, |singular| singular.min() / singular.max());
    if spread > MIN_SPREAD { Ok(spread) } else { Err(NormalsError::LightsInPlane { lights: lights.len(), spread }) }
}

/// Why a light is missing, of all its marks.
const REASONS: u8 = CLIPPED | DARK;

#[cfg(test)]
mod tests;
