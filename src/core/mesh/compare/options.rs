//! The options of an alignment.

use nalgebra::{Isometry3, Point3};

use super::CompareError;
use crate::options::check_range;

/// Where the alignment begins.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Start {
    /// Both meshes are in the camera's frame already, up to a small motion.
    #[default]
    CameraFrame,
    /// A known pose, moving to fixed, translation in mm.
    Pose(Isometry3<f64>),
    /// Points that the user picked: each on the moving mesh, and where it belongs on the fixed one, in mm.
    Pairs(Vec<(Point3<f64>, Point3<f64>)>),
}

/// What an alignment may change.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Freedom {
    /// Any turn and shift.
    #[default]
    Rigid,
    /// The height alone: both meshes are in one camera's frame, which does not show it.
    AlongZ,
}

/// How to align.
#[derive(Clone, Debug, PartialEq)]
pub struct AlignOptions {
    /// Where to begin.
    pub start: Start,
    /// What may change.
    pub freedom: Freedom,
    /// Whether to try all rotations about the centres where `start` does not fit, and those of a symmetric object where it
    /// does.
    pub search: bool,
    /// The fraction of pairs with the largest residuals that each step leaves out, 0 to 0.9.
    pub trim: f64,
    /// How far a point may be from the reference to count as overlapping, in mm; by default 2 % of the diagonal of the
    /// reference.
    pub reach_mm: Option<f64>,
    /// The smallest overlap that is a result, 0 to 1.
    pub minimum_overlap: f64,
    /// Vertices of the moving mesh that take part in the last level; the two before take a fourth and a sixteenth.
    pub samples: usize,
    /// Iterations a level, at most.
    pub iterations: usize,
}

impl Default for AlignOptions {
    fn default() -> Self {
        Self {
            start: Start::default(),
            freedom: Freedom::default(),
            search: true,
            trim: 0.2,
            reach_mm: None,
            minimum_overlap: 0.2,
            samples: 50_000,
            iterations: 60,
        }
    }
}

impl AlignOptions {
    /// Refuses values outside their range, with the range.
    pub fn check(&self) -> Result<(), CompareError> {
        if let Start::Pose(pose) = &self.start {
            let largest = pose.to_homogeneous().amax();
            check_range("start pose", largest, pose.to_homogeneous().iter().all(|x| x.is_finite()), "finite")?;
        }
        check_range("trim", self.trim, (0.0..=0.9).contains(&self.trim), "0 to 0.9")?;
        let overlap = self.minimum_overlap;
        check_range("minimum_overlap", overlap, (0.0..=1.0).contains(&overlap), "0 to 1")?;
        let reach = self.reach_mm.unwrap_or(1.0);
        check_range("reach_mm", reach, (1e-6..=1e9).contains(&reach), "from 1e-6 to 1e9 mm")?;
        check_range("samples", self.samples as f64, self.samples >= 100, "at least 100")?;
        Ok(check_range("iterations", self.iterations as f64, self.iterations >= 1, "at least 1")?)
    }
}
