//! Settings of the reference: which scan, in which unit, where it lies.

use std::path::PathBuf;

use firstbounce_capture::mesh_file::read::LengthScale;
use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use serde::{Deserialize, Serialize};

/// Which scan the surface is compared with, and how the two lie.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ReferenceSettings {
    /// Where it comes from.
    pub source: ReferenceSource,
    /// What one unit of its file is.
    #[serde(default)]
    pub unit: LengthScale,
    /// Where the surfaces lie on it; `None` while they are not aligned.
    #[serde(default)]
    pub poses: Option<Poses>,
}

/// Where a reference comes from.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ReferenceSource {
    /// The true depth of a rendered set.
    Truth,
    /// A mesh file, or another set with a truth.
    File(PathBuf),
}

/// Motions that lay the surfaces onto the reference.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Poses {
    /// That of the direct light.
    pub after: Pose,
    /// The surface before; as that of the direct light where it could not be aligned by itself.
    pub before: Pose,
}

impl Poses {
    /// Whether both stay where single precision can draw the surfaces: a file may say anything.
    pub fn is_usable(&self) -> bool {
        let moves = self.after.translation_mm.iter().chain(&self.before.translation_mm);
        moves.into_iter().all(|x| x.abs() <= MAX_MOVE_MM)
    }
}

const MAX_MOVE_MM: f64 = 1e9;

/// A rigid motion.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// A unit quaternion: i, j, k, w.
    pub rotation: [f64; 4],
    /// Applied after the rotation.
    pub translation_mm: [f64; 3],
}

impl From<Isometry3<f64>> for Pose {
    fn from(motion: Isometry3<f64>) -> Self {
        Self { rotation: motion.rotation.coords.into(), translation_mm: motion.translation.vector.into() }
    }
}

impl From<Pose> for Isometry3<f64> {
    fn from(pose: Pose) -> Self {
        let rotation = UnitQuaternion::new_unchecked(Quaternion::from(pose.rotation));
        let is_one = (rotation.norm() - 1.0).abs() < 1e-6;
        // A file that was edited by hand may hold anything.
        let rotation = if is_one { rotation } else { UnitQuaternion::identity() };
        Self::from_parts(Translation3::from(pose.translation_mm), rotation)
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;

    #[test]
    fn a_pose_comes_back_from_its_text() {
        let motion = Isometry3::new(Vector3::new(1.25, -300.1, 1e-3), Vector3::new(0.3, 2.0, -0.1));
        let text = serde_json::to_string(&Pose::from(motion)).unwrap();
        let back: Isometry3<f64> = serde_json::from_str::<Pose>(&text).unwrap().into();
        assert!((back.translation.vector - motion.translation.vector).norm() < 1e-12);
        assert!(back.rotation.angle_to(&motion.rotation) < 1e-7);
    }
}
