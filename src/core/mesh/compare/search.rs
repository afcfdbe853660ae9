//! Starts of an alignment from which the given one may be far: a coarse search over all rotations.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};
use rayon::prelude::*;

use super::CompareError;
use super::align::{FIRST, Job, Level, Run};
use super::motion::FreeMotion;
use super::pairs::Samples;
use super::surface::Surface;
use crate::linear_algebra;

/// Rotations of the coarse search; they lie about 30 degrees apart.
const ROTATIONS: usize = 512;
/// How many starts go on after a look by few points, and how many of those after one by more.
const PROBES_KEPT: usize = 24;
const SCOUTS_KEPT: usize = 5;
/// Points of a level: what separates a start that fits from one that does not.
const PROBE_POINTS: usize = 200;
const SCOUT_POINTS: usize = 800;

/// Poses are one and the same below this turn, and this shift as a fraction of the diagonal.
const SAME_TURN_DEG: f64 = 15.0;
const SAME_SHIFT: f64 = 0.05;
/// A turn lies along free ones if so much of its axis' squared length does.
const ALONG_FREE: f64 = 0.9;

/// Other starts than the given one, iterated at the first level, the best first and none twice. `all_rotations` is for a
/// given start that does not fit; else only those are tried under which an object looks the same by symmetry.
pub(super) fn other_starts(job: &Job<'_>, given: &Run, all_rotations: bool) -> Result<Vec<Run>, CompareError> {
    let mut starts = symmetric_starts(job.samples, job.surface, &given.pose);
    if all_rotations {
        starts.extend((0..ROTATIONS).map(|index| about_centres(super_fibonacci(index, ROTATIONS))));
    }
    let step = |points: usize| (job.samples.len() / points).max(1);
    let probe = Level { step: step(PROBE_POINTS), still: 1e-3, iterations: 4, ..FIRST };
    let scout = Level { step: step(SCOUT_POINTS), still: 1e-3, iterations: 20, ..FIRST };
    let runs = starts.into_iter().map(Run::from).collect();
    let runs = best_of(job, &probe, runs, PROBES_KEPT)?;
    job.watch.progress(0.3);
    let runs = best_of(job, &scout, runs, SCOUTS_KEPT)?;
    job.watch.progress(0.4);
    best_of(job, &FIRST, runs, SCOUTS_KEPT)
}

/// Iterates every run at one level; the best that differ from each other.
fn best_of(job: &Job<'_>, level: &Level, runs: Vec<Run>, kept: usize) -> Result<Vec<Run>, CompareError> {
    let mut runs = runs.into_par_iter().map(|run| job.level(level, run)).collect::<Result<Vec<_>, _>>()?;
    runs.sort_by(|one, other| one.cost().total_cmp(&other.cost()));
    let mut best: Vec<Run> = Vec::with_capacity(kept);
    for run in runs {
        if best.len() < kept && best.iter().all(|better| !is_same(job, &run.pose, &better.pose)) {
            best.push(run);
        }
    }
    Ok(best)
}

/// Whether two poses are the same but for what iterations close.
pub(super) fn is_same(job: &Job<'_>, one: &Isometry3<f64>, other: &Isometry3<f64>) -> bool {
    one.rotation.angle_to(&other.rotation).to_degrees() < SAME_TURN_DEG
        && (one.translation.vector - other.translation.vector).norm() < SAME_SHIFT * job.surface.diagonal_mm
}

/// Whether the turn from one pose to another is one that the surfaces leave free anyway.
pub(super) fn is_free(one: &Isometry3<f64>, other: &Isometry3<f64>, free: &[FreeMotion]) -> bool {
    let Some(turn) = (other.rotation * one.rotation.inverse()).axis() else { return true };
    let along = |motion: &FreeMotion| match motion {
        FreeMotion::Turn { axis, .. } => axis.dot(&turn).powi(2),
        FreeMotion::Slide { .. } => 0.0,
    };
    free.iter().map(along).sum::<f64>() > ALONG_FREE
}

/// The centres on each other: as the meshes are turned, by quarter and half turns of the given pose about the axes, and
/// with the principal axes on each other.
fn symmetric_starts(samples: &Samples, surface: &Surface, given: &Isometry3<f64>) -> Vec<Isometry3<f64>> {
    let turns = [Vector3::x(), Vector3::y(), Vector3::z()]
        .into_iter()
        .flat_map(|axis| [FRAC_PI_2, PI, -FRAC_PI_2].map(|angle| UnitQuaternion::new(axis * angle)));
    let half_turns = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| UnitQuaternion::new(axis * PI));
    let axes = principal_axes(samples.points()).zip(principal_axes(surface.points()));
    let onto = axes.into_iter().flat_map(|(from, to)| {
        std::iter::once(UnitQuaternion::identity())
            .chain(half_turns)
            .map(move |turn| to * turn * from.inverse())
            // About the reference's own axes the given pose may be off by a half turn.
            .chain(half_turns.map(move |turn| to * turn * to.inverse() * given.rotation))
    });
    let rotations =
        std::iter::once(UnitQuaternion::identity()).chain(turns.map(|turn| turn * given.rotation)).chain(onto);
    rotations.map(about_centres).collect()
}

fn about_centres(rotation: UnitQuaternion<f64>) -> Isometry3<f64> {
    Isometry3::from_parts(Translation3::identity(), rotation)
}

/// The axes of the points' spread, as the rotation that takes x, y and z there.
fn principal_axes(points: impl Iterator<Item = Vector3<f64>>) -> Option<UnitQuaternion<f64>> {
    let points: Vec<_> = points.collect();
    let middle = points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64;
    let spread: Matrix3<f64> = points.iter().map(|point| (point - middle) * (point - middle).transpose()).sum();
    let eigen = linear_algebra::symmetric_eigen(spread)?;
    let mut order = [0, 1, 2];
    order.sort_by(|&one, &other| eigen.eigenvalues[other].total_cmp(&eigen.eigenvalues[one]));
    let [first, second] = [order[0], order[1]].map(|axis| Vector3::from(eigen.eigenvectors.column(axis)));
    let axes = Matrix3::from_columns(&[first, second, first.cross(&second)]);
    axes.iter().all(|x| x.is_finite()).then(|| UnitQuaternion::from_matrix(&axes))
}

/// Rotation `index` of `count` that lie evenly in the space of rotations (M. Alexa, "Super-Fibonacci spirals: fast,
/// low-discrepancy sampling of SO(3)", CVPR 2022).
fn super_fibonacci(index: usize, count: usize) -> UnitQuaternion<f64> {
    const PHI: f64 = std::f64::consts::SQRT_2;
    const PSI: f64 = 1.533_751_168_755_204_3;
    let step = index as f64 + 0.5;
    let share = step / count as f64;
    let (inner, outer) = (share.sqrt(), (1.0 - share).sqrt());
    let (alpha, beta) = (TAU * step / PHI, TAU * step / PSI);
    let [x, y, z, w] = [inner * alpha.sin(), inner * alpha.cos(), outer * beta.sin(), outer * beta.cos()];
    UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, x, y, z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_rotation_is_far_from_one_that_is_tried() {
        let tried: Vec<_> = (0..ROTATIONS).map(|index| super_fibonacci(index, ROTATIONS)).collect();
        for index in 0..1000 {
            let asked = super_fibonacci(index, 1000);
            let nearest = tried.iter().map(|tried| tried.angle_to(&asked)).fold(f64::MAX, f64::min);
            assert!(nearest.to_degrees() < 30.0, "{} degrees", nearest.to_degrees());
        }
    }
}
