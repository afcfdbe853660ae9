//! Each bounce by itself, and all of them.

use super::{RadiosityError, form_factors::FormFactors};
use crate::options::check_range;
use crate::{Portion, Watch};

/// About how many passes over the form factors the sum of all bounces takes, to share out progress.
const SOLVER_PASSES: f32 = 10.0;

/// Which bounces, for which paints.
#[derive(Clone, Debug, PartialEq)]
pub struct BounceOptions {
    /// Albedos, the reference first. Bounces are kept apart for the reference; the sum is solved for every one.
    pub albedos: Vec<f64>,
    /// How many bounces to keep apart.
    pub bounces: usize,
    /// The solver stops when `|rho E - (I - rho F) B|` falls below this fraction of `|rho E|` (norms weighted by area).
    pub relative_residual: f64,
    /// The solver gives up after this many iterations, each as costly as a bounce.
    pub max_iterations: usize,
}

impl Default for BounceOptions {
    fn default() -> Self {
        Self { albedos: vec![0.75], bounces: 4, relative_residual: 1e-6, max_iterations: 100 }
    }
}

impl BounceOptions {
    /// Whether every option is in its range.
    pub fn check(&self) -> Result<(), RadiosityError> {
        if let Some(&albedo) = self.albedos.iter().find(|&&albedo| !(albedo > 0.0 && albedo < 1.0)) {
            return Err(RadiosityError::BadAlbedo { albedo });
        }
        check_range("albedos", self.albedos.len() as f64, !self.albedos.is_empty(), "at least one")?;
        check_range("bounces", self.bounces as f64, self.bounces >= 1, "at least 1")?;
        let residual = self.relative_residual;
        let range = "between 0 and 1, such as 1e-6";
        check_range("relative_residual", residual, residual > 0.0 && residual < 1.0, range)?;
        Ok(check_range("max_iterations", self.max_iterations as f64, self.max_iterations >= 1, "at least 1")?)
    }

    /// The albedo of the bounces that are kept apart.
    pub fn reference_albedo(&self) -> f64 {
        self.albedos.first().copied().unwrap_or_default()
    }
}

/// Radiosity of every patch under one lamp.
#[derive(Clone, Debug, PartialEq)]
pub struct Radiosities {
    /// For bounce 1, 2, ..: a value for each patch, at the reference albedo.
    pub bounces: Vec<Vec<f64>>,
    /// For each albedo: the sum of all bounces without end, a value for each patch.
    pub all: Vec<Vec<f64>>,
}

/// How well the sum of all bounces is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BounceReport {
    /// Iterations of the solver.
    pub iterations: usize,
    /// The largest relative residual over lamps and albedos.
    pub residual: f64,
}

/// Bounces for each lamp's irradiance on the patches (one value a patch, see `Patches`). All lamps and albedos share
/// every pass over the form factors.
///
/// Bounce k + 1 is `rho F` times bounce k. The sum solves `(A - rho G) B = rho A E`, symmetric and positive definite
/// since rows of `G` sum to at most `A`, by conjugate gradients preconditioned with `A`.
pub fn bounces(
    factors: &FormFactors,
    irradiances: &[Vec<f64>],
    options: &BounceOptions,
    watch: &dyn Watch,
) -> Result<(Vec<Radiosities>, BounceReport), RadiosityError> {
    options.check()?;
    let count = factors.patches().len();
    if let Some(found) = irradiances.iter().map(Vec::len).find(|&found| found != count) {
        return Err(RadiosityError::WrongLength { found, expected: count });
    }
    let rho = options.reference_albedo();
    let passes = (options.bounces - 1) as f32 + SOLVER_PASSES;
    let first: Vec<Vec<f64>> = irradiances.iter().map(|column| scaled(column, rho)).collect();
    let mut by_bounce = vec![first];
    for done in 1..options.bounces {
        let pass = Portion { watch, from: (done - 1) as f32 / passes, to: done as f32 / passes };
        let arriving = factors.irradiance(&by_bounce[done - 1], &pass)?;
        by_bounce.push(arriving.iter().map(|column| scaled(column, rho)).collect());
    }
    let systems = irradiances.iter().flat_map(|irradiance| options.albedos.iter().map(move |&rho| (rho, irradiance)));
    let mut solver = Solver::new(factors, systems);
    let report = solver.run(options, &Portion { watch, from: 1.0 - SOLVER_PASSES / passes, to: 1.0 })?;
    let mut solved = solver.systems.into_iter().map(|system| system.radiosity);
    let radiosities = (0..irradiances.len()).map(|lamp| Radiosities {
        bounces: by_bounce.iter_mut().map(|bounce| std::mem::take(&mut bounce[lamp])).collect(),
        all: solved.by_ref().take(options.albedos.len()).collect(),
    });
    Ok((radiosities.collect(), report))
}

fn scaled(column: &[f64], factor: f64) -> Vec<f64> {
    column.iter().map(|value| value * factor).collect()
}

/// One albedo and lamp in the conjugate gradients; `residual` is divided by the area, so it is also the preconditioned
/// one, and inner products weigh by area.
struct System {
    rho: f64,
    radiosity: Vec<f64>,
    residual: Vec<f64>,
    direction: Vec<f64>,
    residual_squared: f64,
    source_squared: f64,
}

impl System {
    fn relative_residual(&self) -> f64 {
        if self.source_squared > 0.0 { (self.residual_squared / self.source_squared).sqrt() } else { 0.0 }
    }

    /// One step along the direction, whose irradiance on the patches is `arriving`.
    fn step(&mut self, areas: &[f64], arriving: &[f64]) {
        if self.residual_squared == 0.0 {
            return;
        }
        let image: Vec<f64> = self.direction.iter().zip(arriving).map(|(p, f)| p - self.rho * f).collect();
        let length = self.residual_squared / weighted_product(areas, &self.direction, &image);
        for (radiosity, direction) in self.radiosity.iter_mut().zip(&self.direction) {
            *radiosity += length * direction;
        }
        for (residual, image) in self.residual.iter_mut().zip(&image) {
            *residual -= length * image;
        }
        let before =
            std::mem::replace(&mut self.residual_squared, weighted_product(areas, &self.residual, &self.residual));
        let keep = self.residual_squared / before;
        for (direction, residual) in self.direction.iter_mut().zip(&self.residual) {
            *direction = residual + keep * *direction;
        }
    }
}

/// Conjugate gradients for several systems in lockstep.
struct Solver<'a> {
    factors: &'a FormFactors,
    areas: Vec<f64>,
    systems: Vec<System>,
}

impl<'a> Solver<'a> {
    fn new<'b>(factors: &'a FormFactors, systems: impl Iterator<Item = (f64, &'b Vec<f64>)>) -> Self {
        let areas: Vec<f64> = factors.patches().as_slice().iter().map(|patch| patch.area_mm2).collect();
        let start = |(rho, irradiance): (f64, &Vec<f64>)| {
            let source = scaled(irradiance, rho);
            let source_squared = weighted_product(&areas, &source, &source);
            System {
                rho,
                radiosity: vec![0.0; source.len()],
                residual: source.clone(),
                direction: source,
                residual_squared: source_squared,
                source_squared,
            }
        };
        Self { factors, systems: systems.map(start).collect(), areas }
    }

    fn run(&mut self, options: &BounceOptions, watch: &dyn Watch) -> Result<BounceReport, RadiosityError> {
        let mut reported = 0.0_f32;
        for iterations in 0..=options.max_iterations {
            let residual = self.systems.iter().map(System::relative_residual).fold(0.0, f64::max);
            if residual <= options.relative_residual {
                return Ok(BounceReport { iterations, residual });
            }
            if iterations == options.max_iterations {
                return Err(RadiosityError::NotConverged { residual, iterations });
            }
            // The residual falls about geometrically, so its logarithm is the progress.
            let way = (residual.ln() / options.relative_residual.ln()).clamp(0.0, 1.0) as f32;
            let from = way.max(reported);
            reported = from + (1.0 - from) / SOLVER_PASSES;
            watch.progress(from);
            let directions: Vec<Vec<f64>> = self.systems.iter().map(|system| system.direction.clone()).collect();
            let arriving = self.factors.irradiance(&directions, &Portion { watch, from, to: reported })?;
            for (system, arriving) in self.systems.iter_mut().zip(&arriving) {
                system.step(&self.areas, arriving);
            }
        }
        unreachable!("the last iteration returns")
    }
}

fn weighted_product(weights: &[f64], a: &[f64], b: &[f64]) -> f64 {
    weights.iter().zip(a).zip(b).map(|((weight, a), b)| weight * a * b).sum()
}
