//! Rigid alignment by iterative closest point.

use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, UnitVector3, Vector3};

use super::motion::MotionEquations;
use super::pairs::{Gate, Pairs, Samples};
use super::surface::Surface;
use super::{AlignOptions, CompareError, FreeMotion, Side, Start, rigid_from_pairs};
use crate::{Mesh, Watch};

/// Vertices of the moving mesh left at each level, as a divisor of the last level's.
const LEVEL_STEP: [usize; 3] = [16, 4, 1];
/// How far a pair may reach at each level, as a fraction of the reference's diagonal.
const LEVEL_REACH: [f64; 3] = [0.2, 0.05, 0.0];
/// The smallest cosine between the normals of a pair at each level.
const LEVEL_COSINE: [f64; 3] = [0.2, 0.5, 0.5];
/// A level ends when a step moves the points by less than this fraction of the diagonal.
const LEVEL_STILL: [f64; 3] = [1e-4, 1e-5, 2e-7];
/// A start whose first level leaves less than this fraction of the diagonal, over half the mesh, is right.
const GOOD_RMS: f64 = 0.002;
const GOOD_OVERLAP: f64 = 0.5;
/// A start that was searched must be better than the given one by this factor: an object of revolution must not turn.
const SEARCH_MUST_GAIN: f64 = 0.5;
const SEARCH_TURNS_DEG: [f64; 4] = [25.0, -25.0, 50.0, -50.0];

/// One step of the alignment.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    let samples = Samples::of_mesh(moving, options.samples)?;
    let given = match &options.start {
        Start::CameraFrame => Isometry3::identity(),
        Start::Pose(pose) => *pose,
        Start::Pairs(pairs) => rigid_from_pairs(pairs)?.motion,
    };
    let given = between_centres(&given, &samples.centre, &surface.centre);
    watch.progress(0.2);

    let job = Job { surface: &surface, samples: &samples, options, watch };
    let coarse = job.first_level(given)?;
    let (mut run, searched) = job.search(coarse)?;
    watch.progress(0.6);
    for level in 1..LEVEL_STEP.len() {
        run = job.level(level, run)?;
        watch.progress(0.6 + 0.2 * level as f32);
    }
    job.finish(run, searched)
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

impl Run {
    /// Smaller is better: the residual, weighed up for the part of the mesh that it does not cover (as in Phillips, Liu
    /// and Tomasi 2007, whose exponent for meshes is 3).
    fn cost(&self) -> f64 {
        if self.overlap > 0.0 { self.rms_mm / self.overlap.powi(3) } else { f64::INFINITY }
    }
}

struct Job<'a> {
    surface: &'a Surface,
    samples: &'a Samples,
    options: &'a AlignOptions,
    watch: &'a dyn Watch,
}

impl Job<'_> {
    fn reach_mm(&self) -> f64 {
        self.options.reach_mm.unwrap_or(0.02 * self.surface.diagonal_mm)
    }

    fn gate(&self, level: usize) -> Gate {
        let reach_mm = self.reach_mm().max(LEVEL_REACH[level] * self.surface.diagonal_mm);
        Gate { reach_mm, least_cosine: LEVEL_COSINE[level] }
    }

    fn first_level(&self, pose: Isometry3<f64>) -> Result<Run, CompareError> {
        self.level(0, Run { pose, iterations: vec![], rms_mm: f64::INFINITY, overlap: 0.0, converged: false })
    }

    /// Iterates at one level until the points rest.
    fn level(&self, level: usize, mut run: Run) -> Result<Run, CompareError> {
        let samples = self.samples.every(LEVEL_STEP[level]);
        run.converged = false;
        for _ in 0..self.options.iterations {
            if self.watch.cancelled() {
                return Err(CompareError::Cancelled);
            }
            let mut pairs = samples.pairs(self.surface, &run.pose, self.gate(level));
            run.overlap = pairs.overlap();
            pairs.trim(self.options.trim);
            run.rms_mm = pairs.rms_mm();
            run.iterations.push(Iteration {
                level,
                samples: pairs.asked,
                pairs: pairs.kept.len(),
                rms_mm: run.rms_mm,
                overlap: run.overlap,
            });
            let Some(equations) = MotionEquations::new(&pairs.kept) else { break };
            let (motion, moved_mm) = equations.solve();
            run.pose = motion * run.pose;
            if moved_mm < LEVEL_STILL[level] * self.surface.diagonal_mm {
                run.converged = true;
                break;
            }
        }
        Ok(run)
    }

    /// Keeps the given start if it fits; else tries turns about the centres. One of those must fit, and clearly better
    /// than the given one: nobody asked for it, and smooth surfaces fit each other somewhere even if they are strangers.
    fn search(&self, given: Run) -> Result<(Run, bool), CompareError> {
        if self.fits(&given) || !self.options.search {
            return Ok((given, false));
        }
        let starts = other_starts();
        let mut best: Option<Run> = None;
        for (tried, pose) in starts.iter().enumerate() {
            let run = self.first_level(*pose)?;
            let cost_to_beat = best.as_ref().map_or(SEARCH_MUST_GAIN * given.cost(), Run::cost);
            if self.fits(&run) && run.cost() < cost_to_beat {
                best = Some(run);
            }
            self.watch.progress(0.2 + 0.4 * (tried + 1) as f32 / starts.len() as f32);
        }
        let searched = best.is_some();
        Ok((best.unwrap_or(given), searched))
    }

    fn fits(&self, run: &Run) -> bool {
        run.rms_mm < GOOD_RMS * self.surface.diagonal_mm && run.overlap > GOOD_OVERLAP
    }

    /// Measures the result at the final pose, and refuses one without overlap.
    fn finish(&self, run: Run, searched: bool) -> Result<Alignment, CompareError> {
        let mut pairs = self.samples.pairs(self.surface, &run.pose, self.gate(LEVEL_STEP.len() - 1));
        let overlap = pairs.overlap();
        self.refuse_no_overlap(&pairs, overlap)?;
        pairs.trim(self.options.trim);
        let equations = MotionEquations::new(&pairs.kept)
            .ok_or(CompareError::NoOverlap { overlap, minimum: self.options.minimum_overlap })?;
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
