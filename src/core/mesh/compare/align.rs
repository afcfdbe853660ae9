//! Rigid alignment by iterative closest point.

use nalgebra::{Isometry3, Point3, Translation3};

use super::motion::MotionEquations;
use super::pairs::{Gate, Pairs, Samples};
use super::search::{is_free, is_same, other_starts};
use super::surface::Surface;
use super::{AlignOptions, CompareError, FreeMotion, Freedom, Side, Start, rigid_from_pairs};
use crate::{Mesh, Watch};

/// One pass from coarse to fine.
pub(super) struct Level {
    /// Its number in the report; 0 is the coarsest.
    pub number: usize,
    /// Every how many-th sample takes part.
    pub step: usize,
    /// How far a pair may reach at least, as a fraction of the reference's diagonal.
    pub reach: f64,
    /// The smallest cosine between the normals of a pair.
    pub least_cosine: f64,
    /// The level ends when a step moves the points by less than this fraction of the diagonal,
    pub still: f64,
    /// or after this many iterations, if the options do not say fewer.
    pub iterations: usize,
}

pub(super) const FIRST: Level =
    Level { number: 0, step: 16, reach: 0.2, least_cosine: 0.2, still: 1e-4, iterations: usize::MAX };
const SECOND: Level = Level { number: 1, step: 4, reach: 0.05, least_cosine: 0.5, still: 1e-5, iterations: usize::MAX };
const LAST: Level = Level { number: 2, step: 1, reach: 0.0, least_cosine: 0.5, still: 2e-7, iterations: usize::MAX };

/// Vertices of the reference at the first level.
const COARSE_VERTICES: usize = 10_000;
/// A start whose first level leaves less than this fraction of the diagonal, over half the mesh, is right.
const GOOD_RMS: f64 = 0.002;
const GOOD_OVERLAP: f64 = 0.5;
/// A start that was searched must be better than the given one by this factor: an object of revolution must not turn.
const SEARCH_MUST_GAIN: f64 = 0.9;
/// How many searched starts are compared at the second level: what has three or four equal sides fits as often.
const COMPARED: usize = 4;
/// Coverages that differ by fewer standard errors of the points that were looked at are one.
const SAME_COVERAGE_ERRORS: f64 = 3.0;
/// Poses whose costs differ by less than this factor cannot be told apart.
const AS_GOOD: f64 = 1.2;
/// Costs below this fraction of the diagonal are as good as none.
const NO_COST: f64 = 1e-5;
/// Of surfaces that lie on each other inside out, at least so many points face away.
const INSIDE_OUT_SHARE: f64 = 0.8;
/// A fit that leaves this part of the reference's relief, where all of the mesh lies on it, is poor.
const POOR_SHARE: f64 = 0.3;

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
    /// How far the reference's points lie from their best plane, root mean square, in mm.
    pub relief_mm: f64,
    /// Another motion under which the surfaces fit as well: which of the two is right, they do not show.
    pub ambiguous: Option<Isometry3<f64>>,
}

impl Alignment {
    /// Whether the fit leaves as much as surfaces leave that do not belong together.
    pub fn is_poor(&self) -> bool {
        // What slides or turns is reported as such: a plane has no relief.
        self.free.is_empty() && is_poor(self.rms_mm, self.overlap, self.relief_mm)
    }
}

/// Whether surfaces that do not belong together lie as well on each other: they fit where they happen to be near.
fn is_poor(rms_mm: f64, overlap: f64, relief_mm: f64) -> bool {
    rms_mm > POOR_SHARE * relief_mm * overlap
}

/// Lays `moving` onto `fixed`: iterative closest point with point-to-plane residuals (Chen and Medioni 1991), pairs to
/// the closest point of a triangle, without those at the border and the worst part of the rest (trimmed: Chetverikov
/// et al. 2002), in three levels from coarse to fine.
///
/// Where the given start does not fit it tries all rotations about the centres; the lowest cost wins. Fits that are poor,
/// or as good under another motion, are reported.
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
    let mut given = between_centres(&given, &samples.centre, &surface.centre);
    if options.freedom == Freedom::AlongZ {
        // However far apart the heights are: the middles of both meshes at one.
        given.translation.vector.z = 0.0;
    }
    watch.progress(0.2);

    let job = Job { surface: &surface, coarse_surface: &coarse_surface, samples: &samples, options, watch };
    let found = job.search(job.level(&FIRST, Run::from(given))?)?;
    watch.progress(0.8);
    job.finish(found)
}

/// A pose between two frames, as the pose between the same frames with their origins at the given centres.
fn between_centres(pose: &Isometry3<f64>, from: &Point3<f64>, to: &Point3<f64>) -> Isometry3<f64> {
    Translation3::from(-to.coords) * pose * Translation3::from(from.coords)
}

/// How far one start has come.
#[derive(Clone)]
pub(super) struct Run {
    pub pose: Isometry3<f64>,
    iterations: Vec<Iteration>,
    rms_mm: f64,
    overlap: f64,
    converged: bool,
}

/// The start that won, at the second level.
struct Found {
    run: Run,
    searched: bool,
    /// The next best, where it differs.
    other: Option<Run>,
}

impl From<Isometry3<f64>> for Run {
    fn from(pose: Isometry3<f64>) -> Self {
        Self { pose, iterations: vec![], rms_mm: f64::INFINITY, overlap: 0.0, converged: false }
    }
}

impl Run {
    /// Smaller is better: the residual, weighed up for the part of the mesh that it does not cover (as in Phillips, Liu
    /// and Tomasi 2007, whose exponent for meshes is 3).
    pub fn cost(&self) -> f64 {
        if self.overlap > 0.0 { self.rms_mm / self.overlap.powi(3) } else { f64::INFINITY }
    }
}

pub(super) struct Job<'a> {
    pub surface: &'a Surface,
    coarse_surface: &'a Surface,
    pub samples: &'a Samples,
    options: &'a AlignOptions,
    pub watch: &'a dyn Watch,
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
    pub fn level(&self, level: &Level, mut run: Run) -> Result<Run, CompareError> {
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
            let (motion, moved_mm) = match self.options.freedom {
                Freedom::Rigid => equations.solve(),
                Freedom::AlongZ => equations.solve_along_z(),
            };
            run.pose = motion * run.pose;
            if moved_mm < level.still * self.surface.diagonal_mm {
                run.converged = true;
                break;
            }
        }
        Ok(run)
    }

    /// Tries other starts than the given one; the lowest cost wins at the second level. One that was searched was not asked
    /// for: it must be clearly better, and where the given one lies nowhere on the reference it must fit well, for smooth
    /// surfaces fit each other somewhere even if they are unrelated.
    fn search(&self, given: Run) -> Result<Found, CompareError> {
        let is_fixed = !self.options.search || self.options.freedom == Freedom::AlongZ;
        if is_fixed || self.lies_inside_out(&given) {
            return Ok(Found { run: self.level(&SECOND, given)?, searched: false, other: None });
        }
        let others = other_starts(self, &given, !self.fits(&given))?;
        let others = others.into_iter().filter(|other| !is_same(self, &other.pose, &given.pose)).take(COMPARED);
        let others = others.map(|other| self.level(&SECOND, other)).collect::<Result<Vec<_>, _>>()?;
        let given = self.level(&SECOND, given)?;
        // One that comes to where the given start comes is no other, but may have come there sooner.
        let (same, mut others): (Vec<_>, Vec<_>) =
            others.into_iter().partition(|other| is_same(self, &other.pose, &given.pose));
        let given = same.into_iter().fold(given, |best, run| if run.cost() < best.cost() { run } else { best });
        others.sort_by(|one, other| one.cost().total_cmp(&other.cost()));
        let Some(best) = self.best_of_ties(&others, &given) else {
            return Ok(Found { run: given, searched: false, other: None });
        };
        let best = others.remove(best);
        let mut others = others.into_iter();
        let relief_mm = self.surface.relief_mm();
        let may_win = given.overlap >= self.options.minimum_overlap || !is_poor(best.rms_mm, best.overlap, relief_mm);
        if may_win && best.cost() < SEARCH_MUST_GAIN * given.cost() {
            let next = others.next().filter(|next| next.cost() < given.cost()).unwrap_or(given);
            return Ok(Found { run: best, searched: true, other: Some(next) });
        }
        Ok(Found { run: given, searched: false, other: Some(best) })
    }

    /// Of runs, the cheapest first, the one to go on with: among those that are as cheap as noise allows the one that covers most of
    /// the mesh, and of equal coverage the one that turns it least from where the user put it. Only those count that beat the given
    /// start, if any does.
    fn best_of_ties(&self, runs: &[Run], given: &Run) -> Option<usize> {
        let limit = AS_GOOD * runs.first()?.cost() + NO_COST * self.surface.diagonal_mm;
        let must_beat = SEARCH_MUST_GAIN * given.cost();
        let is_tied = |run: &Run| run.cost() <= limit && (run.cost() < must_beat || runs[0].cost() >= must_beat);
        let samples = self.samples.every(SECOND.step);
        let coverage = |run: &Run| {
            let pairs = samples.pairs(self.surface, &run.pose, self.gate(&LAST));
            let share = pairs.overlap();
            (share, (share * (1.0 - share) / pairs.asked.max(1) as f64).sqrt())
        };
        let tied = runs.iter().enumerate().filter(|(_, run)| is_tied(run));
        let tied: Vec<_> = tied.map(|(index, run)| (index, coverage(run))).collect();
        let most = tied.iter().map(|(_, coverage)| *coverage).max_by(|one, other| one.0.total_cmp(&other.0))?;
        let covers_most = |(share, error): (f64, f64)| most.0 - share <= SAME_COVERAGE_ERRORS * most.1.hypot(error);
        let turn = |index: usize| runs[index].pose.rotation.angle_to(&given.pose.rotation);
        let best = tied.iter().filter(|(_, coverage)| covers_most(*coverage));
        best.map(|(index, _)| *index).min_by(|one, other| turn(*one).total_cmp(&turn(*other)))
    }

    /// Whether the surfaces lie on each other and face opposite ways: turned over they may fit somehow, which is not meant.
    fn lies_inside_out(&self, run: &Run) -> bool {
        let pairs = self.samples.every(FIRST.step).pairs(self.coarse_surface, &run.pose, self.gate(&LAST));
        pairs.facing_away as f64 > INSIDE_OUT_SHARE * pairs.asked as f64
    }

    fn fits(&self, run: &Run) -> bool {
        run.rms_mm < GOOD_RMS * self.surface.diagonal_mm && run.overlap > GOOD_OVERLAP
    }

    /// Measures the result at the final pose, and refuses one without overlap.
    fn finish(&self, Found { run, searched, other }: Found) -> Result<Alignment, CompareError> {
        let no_cost = NO_COST * self.surface.diagonal_mm;
        let as_good = other.filter(|other| other.cost() <= AS_GOOD * run.cost() + no_cost);
        let run = self.level(&LAST, run)?;
        let mut pairs = self.samples.pairs(self.surface, &run.pose, self.gate(&LAST));
        let overlap = pairs.overlap();
        self.refuse_no_overlap(&pairs, overlap)?;
        pairs.trim(self.options.trim);
        let equations =
            MotionEquations::new(&pairs.kept).ok_or(CompareError::TooFewPairs { pairs: pairs.kept.len() })?;
        let free = match self.options.freedom {
            Freedom::Rigid => equations.free_motions(&self.surface.centre),
            Freedom::AlongZ => vec![],
        };
        let as_good =
            as_good.filter(|other| !is_same(self, &other.pose, &run.pose) && !is_free(&run.pose, &other.pose, &free));
        let between = |pose: &Isometry3<f64>| {
            let (moving, fixed) = (-self.samples.centre.coords, -self.surface.centre.coords);
            between_centres(pose, &moving.into(), &fixed.into())
        };
        self.watch.progress(1.0);
        Ok(Alignment {
            moving_to_fixed: between(&run.pose),
            rms_mm: pairs.rms_mm(),
            overlap,
            reach_mm: self.reach_mm(),
            converged: run.converged,
            searched,
            condition: equations.condition(),
            free,
            relief_mm: self.surface.relief_mm(),
            ambiguous: as_good.map(|other| between(&other.pose)),
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
