//! The plan of a rig: the expected error of the normals against the number of frames and the ratio of albedos.
//!
//! The scene is rendered once, small, for every paint in question: form factors do not know the paint. What noise does and what
//! remains without it are then kept apart. The latter is what the method makes of pictures without noise: light of more than `m`
//! bounces by the paper's method, what the shape does not tell by colours and shape together. The noise is what the camera model
//! predicts, carried through the method and photometric stereo.

mod direct;
mod scene;

use serde::Serialize;

use super::{LabError, Sensor};
use firstbounce_capture::set::Method;
use firstbounce_core::denoise::DenoiseOptions;
use firstbounce_core::light::radiosity::FormFactors;
use firstbounce_core::light::scene::{Lamp, SceneError};
use firstbounce_core::options::check_range;
use firstbounce_core::separate::{MIN_BETA_DISTANCE, SeparateError, check_order};
use firstbounce_core::{Camera, Portion, Watch};
use scene::Scene;

/// How direct light will be told from light that bounced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanMethod {
    /// By colours and shape together.
    ColoursAndShape,
    /// By the paper's method.
    Colours {
        /// The order m.
        bounces: usize,
    },
}

impl PlanMethod {
    /// What a set of so many colours is separated by: colours and shape, and one colour not at all.
    pub fn of_colours(colours: usize) -> Self {
        if colours > 1 { Self::ColoursAndShape } else { Self::Colours { bounces: 1 } }
    }

    /// The paper's method as a set of so many colours is separated by it.
    pub fn paper(colours: usize) -> Self {
        Self::Colours { bounces: colours.min(2) }
    }

    /// The method in general.
    pub fn method(self) -> Method {
        match self {
            Self::ColoursAndShape => Method::ColoursAndShape,
            Self::Colours { .. } => Method::Colours,
        }
    }

    /// The order m; 1 where all indirect light is taken together.
    pub fn bounces(self) -> usize {
        match self {
            Self::ColoursAndShape => 1,
            Self::Colours { bounces } => bounces,
        }
    }

    /// What turns normals where there is no noise: "later bounces".
    pub fn remainder(self) -> &'static str {
        match self {
            Self::ColoursAndShape => "the method",
            Self::Colours { .. } => "later bounces",
        }
    }

    /// # Errors
    /// Colours whose light the method cannot tell apart.
    fn check(self, alpha: &[f64], beta: &[f64]) -> Result<(), SeparateError> {
        match self {
            Self::Colours { bounces } => check_order(alpha, beta, bounces),
            // One colour that differs from the reference is enough.
            Self::ColoursAndShape => {
                check_order(alpha, beta, 1)?;
                let differs = |beta: &&f64| (**beta - 1.0).abs() >= MIN_BETA_DISTANCE;
                let other = beta.iter().skip(1).find(differs).or(beta.get(1)).unwrap_or(&1.0);
                check_order(&[1.0; 2], &[1.0, *other], 2)
            }
        }
    }
}

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
    /// The method that will separate.
    pub method: PlanMethod,
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
    /// How the paper's method will average the noise of the indirect light.
    pub denoise: DenoiseOptions,
}

impl Default for PlanOptions {
    fn default() -> Self {
        Self {
            albedos: vec![0.75, 0.38],
            lamps: Vec::new(),
            alpha: Vec::new(),
            method: PlanMethod::ColoursAndShape,
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
        let in_range = (1..=self.albedos.len()).contains(&self.method.bounces());
        check_range("bounces", self.method.bounces() as f64, in_range, "1 to the number of albedos")?;
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
    /// Mean angle without noise: by light of more than m bounces, or by what the shape does not tell of indirect light.
    #[serde(rename = "tail_deg")]
    pub remainder_deg: f64,
    /// Mean angle by both.
    pub error_deg: f64,
}

/// What a rig can be expected to achieve.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The method that will separate.
    pub method: PlanMethod,
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

/// Plans for the surface of `factors` before a camera, which should be small: 48 pixels across are enough for the paper's method, more for colours and shape together.
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
            options.method.check(alpha, &own.beta())?;
        }
    }
    let mut albedos: Vec<f64> = options.albedos.clone();
    for &albedo in paints.iter().flat_map(|paint| &paint.albedos) {
        if !albedos.contains(&albedo) {
            albedos.push(albedo);
        }
    }
    let scene = Scene::new(factors, camera, albedos, options, &Portion { watch, from: 0.0, to: 0.8 })?;

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
    Ok(Plan { method: options.method, raw_deg, by_frames, by_ratio })
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
        options.method.check(&even, &paint.beta()).is_ok()
    };
    let varied = if own.len() > 1 { options.ratios.as_slice() } else { &[] };
    let others = varied.iter().map(of_ratio).filter(physical).filter(separable);
    let ratio = own.last().zip(own.first()).map_or(1.0, |(last, first)| last / first);
    std::iter::once(Paint { albedos: own.clone(), alpha, ratio, white: options.white }).chain(others).collect()
}
