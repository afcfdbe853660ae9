//! The small motion that point-to-plane pairs ask for, and which motions they leave free.

use nalgebra::{
    Isometry3, Matrix6, Point3, SymmetricEigen, Translation3, UnitQuaternion, UnitVector3, Vector3, Vector6,
};
use rayon::prelude::*;

use super::pairs::Pair;
use crate::linear_algebra;

/// A motion by 1 mm that parts the surfaces by less than this many mm is free: its amount is not to be trusted.
const FREE_BELOW: f64 = 0.05;
/// Below this the equations say nothing at all, and the motion is left as it was.
const UNKNOWN_BELOW: f64 = 0.005;

/// A motion that hardly parts the two surfaces, so that the alignment along it is a guess: a plane slides, a sphere
/// turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FreeMotion {
    /// Sliding along a direction in the reference's frame.
    Slide {
        /// The unit direction.
        direction: Vector3<f64>,
        /// How many mm a slide of 1 mm parts the surfaces, root mean square.
        parting: f64,
    },
    /// Turning about an axis in the reference's frame.
    Turn {
        /// The axis' unit direction.
        axis: Vector3<f64>,
        /// A point of the axis.
        through: Point3<f64>,
        /// How many mm a turn that moves the points by 1 mm parts the surfaces, root mean square.
        parting: f64,
    },
}

impl std::fmt::Display for FreeMotion {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Self::Slide { direction, .. } => write!(f, "alignment is free along {}", axis_name(direction)),
            Self::Turn { axis, through: p, .. } => write!(
                f,
                "alignment is free in turning about {} through ({:.1}, {:.1}, {:.1}) mm",
                axis_name(axis),
                p.x,
                p.y,
                p.z
            ),
        }
    }
}

/// `x`, `y` or `z` within 10 degrees of one, else the direction in numbers.
fn axis_name(direction: &Vector3<f64>) -> String {
    match ["x", "y", "z"].into_iter().zip(direction.iter()).find(|(_, along)| along.abs() > 0.985) {
        Some((name, _)) => name.to_owned(),
        None => format!("({:.2}, {:.2}, {:.2})", direction.x, direction.y, direction.z),
    }
}

/// The normal equations of Chen and Medioni 1991 in the six unknowns of a small motion, turns first, about the middle
/// of the pairs and with turns scaled by their mean distance from it, so that all six are in mm.
pub(super) struct MotionEquations {
    middle: Point3<f64>,
    radius_mm: f64,
    left: Matrix6<f64>,
    right: Vector6<f64>,
    eigen: SymmetricEigen<f64, nalgebra::U6>,
}

impl MotionEquations {
    /// Sums the equations of all pairs; `None` for fewer than six pairs, or pairs at one point.
    pub fn new(pairs: &[Pair]) -> Option<Self> {
        if pairs.len() < 6 {
            return None;
        }
        let count = pairs.len() as f64;
        let middle = Point3::from(pairs.iter().map(|pair| pair.from.coords).sum::<Vector3<f64>>() / count);
        let radius_mm = (pairs.iter().map(|pair| (pair.from - middle).norm_squared()).sum::<f64>() / count).sqrt();
        if radius_mm <= 0.0 {
            return None;
        }
        // Blocks of a fixed size, summed in order: the sum must not depend on the number of cores.
        let blocks: Vec<(Matrix6<f64>, Vector6<f64>)> = pairs
            .par_chunks(2048)
            .map(|block| {
                block.iter().fold((Matrix6::zeros(), Vector6::zeros()), |(left, right), pair| {
                    let turn = (pair.from - middle).cross(&pair.normal) / radius_mm;
                    let n = pair.normal;
                    let row = Vector6::new(turn.x, turn.y, turn.z, n.x, n.y, n.z);
                    (left + row * row.transpose(), right + row * pair.residual_mm())
                })
            })
            .collect();
        let left: Matrix6<f64> = blocks.iter().map(|(left, _)| left).sum();
        let right: Vector6<f64> = blocks.iter().map(|(_, right)| right).sum();
        let left = left / count;
        let eigen = linear_algebra::symmetric_eigen(left)?;
        Some(Self { middle, radius_mm, left, right: right / count, eigen })
    }

    /// The motion that best closes the pairs, and how far it moves their points on average, in mm. It does not go where
    /// the pairs say nothing.
    pub fn solve(&self) -> (Isometry3<f64>, f64) {
        let step: Vector6<f64> = (0..6)
            .filter(|&k| self.eigen.eigenvalues[k] > UNKNOWN_BELOW.powi(2))
            .map(|k| {
                let direction = self.eigen.eigenvectors.column(k);
                direction * (direction.dot(&self.right) / self.eigen.eigenvalues[k])
            })
            .sum();
        let turn = Vector3::from(step.fixed_rows::<3>(0)) / self.radius_mm;
        let slide = Vector3::from(step.fixed_rows::<3>(3));
        let about_middle = Isometry3::rotation_wrt_point(UnitQuaternion::from_scaled_axis(turn), self.middle);
        (Translation3::from(slide) * about_middle, step.norm())
    }

    /// The same of shifts along z alone.
    pub fn solve_along_z(&self) -> (Isometry3<f64>, f64) {
        const Z: usize = 5;
        let weight = self.left[(Z, Z)];
        let shift_mm = if weight > UNKNOWN_BELOW.powi(2) { self.right[Z] / weight } else { 0.0 };
        (Isometry3::translation(0.0, 0.0, shift_mm), shift_mm.abs())
    }

    /// Ratio of the largest to the smallest singular value of the equations; 1 is best.
    pub fn condition(&self) -> f64 {
        (self.eigen.eigenvalues.max() / self.eigen.eigenvalues.min().max(f64::MIN_POSITIVE)).sqrt()
    }

    /// The motions that hardly part the surfaces, the freest first; points are shifted by `origin`.
    pub fn free_motions(&self, origin: &Point3<f64>) -> Vec<FreeMotion> {
        let mut free: Vec<(f64, FreeMotion)> = (0..6)
            .map(|k| (self.eigen.eigenvalues[k].max(0.0).sqrt(), k))
            .filter(|(parting, _)| *parting < FREE_BELOW)
            .map(|(parting, k)| (parting, self.free_motion(k, parting, origin)))
            .collect();
        free.sort_by(|(one, _), (other, _)| one.total_cmp(other));
        free.into_iter().map(|(_, motion)| motion).collect()
    }

    fn free_motion(&self, k: usize, parting: f64, origin: &Point3<f64>) -> FreeMotion {
        let column = self.eigen.eigenvectors.column(k);
        let turn = Vector3::from(column.fixed_rows::<3>(0)) / self.radius_mm;
        let slide = Vector3::from(column.fixed_rows::<3>(3));
        match UnitVector3::try_new(turn, 0.1 / self.radius_mm) {
            // A turn about the middle and a slide across the axis are one turn about an axis elsewhere.
            Some(axis) => {
                let through = self.middle + turn.cross(&slide) / turn.norm_squared();
                FreeMotion::Turn { axis: axis.into_inner(), through: origin + through.coords, parting }
            }
            None => FreeMotion::Slide { direction: slide.normalize(), parting },
        }
    }
}
