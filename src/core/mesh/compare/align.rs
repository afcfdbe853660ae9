//! Rigid alignment by iterative closest point.

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, UnitVector3, Vector3};

use super::motion::MotionEquations;
use super::pairs::{Gate, Pairs, Samples};
use super::surface::Surface;
use super::{AlignOptions, CompareError, FreeMotion, Side, Start, rigid_from_pairs};
use crate::{Mesh, Watch};

/// One pass from coarse to fine.
struct Level {
    /// Its number in the report; 0 is the coarsest.
    number: usize,
    /// Every how many-th sample takes part.
    step: usize,
    /// How far a pair may reach at least, as a fraction of the reference's diagonal.
    reach: f64,
    /// The smallest cosine between the normals of a pair.
    least_cosine: f64,
    /// The level ends when a step moves the points by less than this fraction of the diagonal,
    still: f64,
    /// or after this many iterations, if the options do not say fewer.
    iterations: usize,
}

const SCOUT: Level = Level { number: 0, step: 64, reach: 0.2, least_cosine: 0.2, still: 1e-3, iterations: 20 };
const FIRST: Level = Level { number: 0, step: 16, reach: 0.2, least_cosine: 0.2, still: 1e-4, iterations: usize::MAX };
const SECOND: Level = Level { number: 1, step: 4, reach: 0.05, least_cosine: 0.5, still: 1e-5, iterations: usize::MAX };
const LAST: Level = Level { number: 2, step: 1, reach: 0.0, least_cosine: 0.5, still: 2e-7, iterations: usize::MAX };

/// Vertices of the reference at the first level.
const COARSE_VERTICES: usize = 10_000;
/// How many of the searched starts go on from scouting to the first level.
const SCOUTS_KEPT: usize = 3;
/// A start whose first level leaves less than this fraction of the diagonal, over half the mesh, is right.
const GOOD_RMS: f64 = 0.002;
const GOOD_OVERLAP: f64 = 0.5;
/// A start that was searched must be better than the given one by this factor: an object of revolution must not turn.
const SEARCH_MUST_GAIN: f64 = 0.5;
const SEARCH_TURNS_DEG: [f64; 4] = [25.0, -25.0, 50.0, -50.0];

/// One step of the alignment.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Iteration {
    /// 0 is the coarsest level.
    pub level: usize,
    /// Points of the moving mesh that took part.
    pub samples: usize,
    /// Pairs that were used, after trimming.
    pub pairs: usize,
    /// Distance of the used pairs to the reference's tangent planes before the step, root mean square.
    pub rms_mm: f64,
    /// Fraction of the points that had a counterpart within the level's reach, 0 to 1.
    pub overlap: f64,
}

/// Where the moving mesh belongs, and how sure that is.
#[derive(Clone, Debug, PartialEq)]
pub struct Alignment {
    /// Takes the moving mesh onto the fixed one; translation in mm.
    pub moving_to_fixed: Isometry3<f64>,
    /// Every step, coarse to fine, of the start that won.
    pub iterations: Vec<Iteration>,
    /// Point-to-plane distance of the trimmed pairs at the end, root mean square.
    pub rms_mm: f64,
    /// Fraction of the moving mesh that lies on the fixed one within the reach, 0 to 1.
    pub overlap: f64,
    /// The reach that counted as overlapping.
    pub reach_mm: f64,
    /// Whether the last level came to rest before its last iteration.
    pub converged: bool,
    /// Whether another than the given start had to be found.
    pub searched: bool,
    /// Ratio of the largest to the smallest singular value of the last equations; 1 is best.
    pub condition: f64,
    /// Motions that the surfaces leave free; along these the result is a guess, and each one says so by `Display`.
    pub free: Vec<FreeMotion>,
}

/// Lays `moving` onto `fixed`: iterative closest point with point-to-plane residuals (Chen and Medioni 1991), pairs to
/// the closest point of a triangle, without those at the border and the worst part of the rest (trimmed: Chetverikov
/// et al. 2002), in three levels from coarse to fine.
///
/// From the camera's frame it finds back from 10 degrees and 5 % of the diagonal; beyond that it tries other starts.
///
/// # Errors
/// Meshes that are empty, not finite, or in pixels; an option outside its range; picked pairs on a line; no overlap, with
/// the overlap found; surfaces that face opposite ways; cancelled.
pub fn align(
    moving: &Mesh,
    fixed: &Mesh,
    options: &AlignOptions,
    watch: &dyn Watch,
) -> Result<Alignment, CompareError> {
    options.check()?;
    let surface = Surface::new(fixed, Side::Fixed)?;
    let coarse_surface = surface.coarse(fixed, Side::Fixed, COARSE_VERTICES)?;
    let samples = Samples::of_mesh(moving, options.samples)?;
    let given = match &options.start {
        Start::CameraFrame => Isometry3::identity(),
        Start::Pose(pose) => *pose,
        Start::Pairs(pairs) => rigid_from_pairs(pairs)?.motion,
    };
    let given = between_centres(&given, &samples.centre, &surface.centre);
    watch.progress(0.2);

    let job = Job { surface: &surface, coarse_surface: &coarse_surface, samples: &samples, options, watch };
    let (run, searched) = job.search(job.level(&FIRST, Run::from(given))?)?;
    watch.progress(0.6);
    let run = job.level(&SECOND, run)?;
    watch.progress(0.8);
    job.finish(job.level(&LAST, run)?, searched)
}

/// A pose between two frames, as the pose between the same frames with their origins at the given centres.
fn between_centres(pose: &Isometry3<f64>, from: &Point3<f64>, to: &Point3<f64>) -> Isometry3<f64> {
    Translation3::from(-to.coords) * pose * Translation3::from(from.coords)
}

/// How far one start has come.
#[derive(Clone)]
struct Run {
    pose: Isometry3<f64>,
    iterations: Vec<Iteration>,
    rms_mm: f64,
    overlap: f64,
    converged: bool,
}

impl From<Isometry3<f64>> for Run {
    fn from(pose: Isometry3<f64>) -> Self {
        Self { pose, iterations: vec![], rms_mm: f64::INFINITY, overlap: 0.0, converged: false }
    }
}

impl Run {
    /// Smaller is better: the residual, weighed up for the part of the mesh that it does not cover (as in Phillips, Liu
    /// and Tomasi 2007, whose exponent for meshes is 3).
    fn cost(&self) -> f64 {
        if self.overlap > 0.0 { self.rms_mm / self.overlap.powi(3) } else { f64::INFINITY }
    }
}

struct Job<'a> {
    surface: &'a Surface,
    coarse_surface: &'a Surface,
    samples: &'a Samples,
    options: &'a AlignOptions,
    watch: &'a dyn Watch,
}

impl Job<'_> {
    fn reach_mm(&self) -> f64 {
        self.options.reach_mm.unwrap_or(0.02 * self.surface.diagonal_mm)
    }

    fn gate(&self, level: &Level) -> Gate {
        let reach_mm = self.reach_mm().max(level.reach * self.surface.diagonal_mm);
        Gate { reach_mm, least_cosine: level.least_cosine }
    }

    /// Iterates at one level until the points rest.
    fn level(&self, level: &Level, mut run: Run) -> Result<Run, CompareError> {
        let samples = self.samples.every(level.step);
        let surface = if level.number == 0 { self.coarse_surface } else { self.surface };
        run.converged = false;
        for _ in 0..self.options.iterations.min(level.iterations) {
            if self.watch.cancelled() {
                return Err(CompareError::Cancelled);
            }
            let mut pairs = samples.pairs(surface, &run.pose, self.gate(level));
            run.overlap = pairs.overlap();
            pairs.trim(self.options.trim);
            run.rms_mm = pairs.rms_mm();
            run.iterations.push(Iteration {
                level: level.number,
                samples: pairs.asked,
                pairs: pairs.kept.len(),
                rms_mm: run.rms_mm,
                overlap: run.overlap,
            });
            let Some(equations) = MotionEquations::new(&pairs.kept) else { break };
            let (motion, moved_mm) = equations.solve();
            run.pose = motion * run.pose;
            if moved_mm < level.still * self.surface.diagonal_mm {
                run.converged = true;
                break;
            }
        }
        Ok(run)
    }

    /// Keeps the given start if it fits; else tries turns about the centres. One of those must fit, and clearly better
    /// than the given one: it was not asked for, and smooth surfaces fit each other somewhere even if they are unrelated.
    fn search(&self, given: Run) -> Result<(Run, bool), CompareError> {
        if self.fits(&given) || !self.options.search {
            return Ok((given, false));
        }
        let starts = other_starts();
        let mut scouts = Vec::with_capacity(starts.len());
        for (tried, pose) in starts.iter().enumerate() {
            scouts.push(self.level(&SCOUT, Run::from(*pose))?);
            self.watch.progress(0.2 + 0.4 * tried as f32 / starts.len() as f32);
        }
        scouts.sort_by(|one, other| one.cost().total_cmp(&other.cost()));
        for scout in scouts.into_iter().take(SCOUTS_KEPT) {
            let run = self.level(&FIRST, Run::from(scout.pose))?;
            if self.fits(&run) && run.cost() < SEARCH_MUST_GAIN * given.cost() {
                return Ok((run, true));
            }
        }
        Ok((given, false))
    }

    fn fits(&self, run: &Run) -> bool {
        run.rms_mm < GOOD_RMS * self.surface.diagonal_mm && run.overlap > GOOD_OVERLAP
    }

    /// Measures the result at the final pose, and refuses one without overlap.
    fn finish(&self, run: Run, searched: bool) -> Result<Alignment, CompareError> {
        let mut pairs = self.samples.pairs(self.surface, &run.pose, self.gate(&LAST));
        let overlap = pairs.overlap();
        self.refuse_no_overlap(&pairs, overlap)?;
        pairs.trim(self.options.trim);
        let equations =
            MotionEquations::new(&pairs.kept).ok_or(CompareError::TooFewPairs { pairs: pairs.kept.len() })?;
        let (moving, fixed) = (-self.samples.centre.coords, -self.surface.centre.coords);
        self.watch.progress(1.0);
        Ok(Alignment {
            moving_to_fixed: between_centres(&run.pose, &moving.into(), &fixed.into()),
            rms_mm: pairs.rms_mm(),
            overlap,
            reach_mm: self.reach_mm(),
            converged: run.converged,
            searched,
            condition: equations.condition(),
            free: equations.free_motions(&self.surface.centre),
            iterations: run.iterations,
        })
    }

    fn refuse_no_overlap(&self, pairs: &Pairs, overlap: f64) -> Result<(), CompareError> {
        let minimum = self.options.minimum_overlap;
        if overlap >= minimum {
            return Ok(());
        }
        let facing_away = pairs.facing_away as f64 / pairs.asked.max(1) as f64;
        match facing_away > overlap.max(minimum) {
            true => Err(CompareError::InsideOut { facing_away }),
            false => Err(CompareError::NoOverlap { overlap, minimum }),
        }
    }
}

/// The centres on each other, unturned and turned both ways about 7 axes: those of a cube through its faces and corners.
fn other_starts() -> Vec<Isometry3<f64>> {
    let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
    let axes = [x, y, z, x + y + z, x + y - z, x - y + z, y + z - x].map(UnitVector3::new_normalize);
    let turned = axes.into_iter().flat_map(|axis| {
        SEARCH_TURNS_DEG.map(|degrees: f64| {
            let turn = UnitQuaternion::from_axis_angle(&axis, degrees.to_radians());
            Isometry3::from_parts(Translation3::identity(), turn)
        })
    });
    std::iter::once(Isometry3::identity()).chain(turned).collect()
}
