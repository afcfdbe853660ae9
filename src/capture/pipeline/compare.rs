//! A mesh against a reference: reading, registering one onto the other, distances. The command line and the window compare by this.

use std::path::Path;

use firstbounce_core::mesh::compare::{
    AlignOptions, Alignment, CompareError, Comparison, DistanceOptions, Freedom, Start, align, distances,
};
use firstbounce_core::{Mesh, Watch};
use nalgebra::Isometry3;

use super::truth_mesh;
use crate::mesh_file::read::{LengthScale, MeshError, read_mesh_or_points};
use crate::pipeline::PipelineError;
use crate::set::{CaptureSet, SetError};

/// Why there is nothing to compare with.
#[derive(Debug, thiserror::Error)]
pub enum ReferenceError {
    /// The set is none.
    #[error(transparent)]
    Set(#[from] SetError),
    /// The set does not know its own surface.
    #[error(transparent)]
    Truth(#[from] PipelineError),
    /// The file is no mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// A mesh to be compared, in mm.
#[derive(Clone, Debug)]
pub struct Comparable {
    /// The surface.
    pub mesh: Mesh,
    /// In whose frame it lies.
    pub frame: Frame,
    /// What the user should know of it.
    pub warnings: Vec<String>,
}

/// In whose frame a mesh lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// The frame of a capture set's camera, of which this is the truth.
    Truth,
    /// The frame of the camera that this program made the mesh of.
    Camera,
    /// A frame of its own: a scan.
    Unknown,
}

impl Frame {
    /// What an alignment of meshes in two frames may change: the truth of a set lies as the set's own surface does, but for
    /// the height, which no camera shows.
    pub fn freedom(self, other: Self) -> Freedom {
        match (self, other) {
            (Self::Truth, Self::Camera) | (Self::Camera, Self::Truth) => Freedom::AlongZ,
            _ => Freedom::Rigid,
        }
    }
}

/// Reads a mesh, or a cloud of points: a file whose unit is `scale`, or the truth of a capture set (its folder or its capture.toml).
///
/// # Errors
/// `ReferenceError`: no set, a set without truth, or a file that is no mesh.
pub fn read_comparable(path: &Path, scale: LengthScale) -> Result<Comparable, ReferenceError> {
    if path.is_dir() || path.extension().is_some_and(|extension| extension == "toml") {
        let mesh = truth_mesh(&CaptureSet::open(path)?)?;
        return Ok(Comparable { mesh, frame: Frame::Truth, warnings: vec![] });
    }
    let file = read_mesh_or_points(path, scale)?;
    let warnings = file.warnings.iter().map(|warning| format!("{}: {warning}", path.display())).collect();
    let frame = if file.is_own { Frame::Camera } else { Frame::Unknown };
    Ok(Comparable { mesh: file.mesh, frame, warnings })
}

/// How A is brought to B before distances are taken.
#[derive(Clone, Debug, PartialEq)]
pub enum Registration {
    /// Not at all: it stays where it is.
    None,
    /// It is moved by what is known already.
    Known(Isometry3<f64>),
    /// It is aligned.
    Align(AlignOptions),
}

/// How far A is from B, and how A was laid there.
#[derive(Clone, Debug, PartialEq)]
pub struct Compared {
    /// How A was laid onto B; `None` where it was not aligned.
    pub alignment: Option<Alignment>,
    /// The distances.
    pub comparison: Comparison,
    /// What the user should know before trusting them.
    pub warnings: Vec<String>,
}

/// A scan of a part is smaller than the whole, and no more than this.
const STRANGE_SIZE: f64 = 8.0;

/// Lays `a` onto `b` and measures every vertex. `aligning` and `measuring` watch the two parts.
///
/// # Errors
/// `CompareError`, with the overlap that was found where there is too little.
pub fn compare_meshes(
    a: &Mesh,
    b: &Mesh,
    registration: &Registration,
    options: &DistanceOptions,
    (aligning, measuring): (&dyn Watch, &dyn Watch),
) -> Result<Compared, CompareError> {
    // Of two clouds neither has a surface, which `distances` says.
    if b.triangles.is_empty() && !a.triangles.is_empty() {
        return compare_with_points(a, b, registration, options, (aligning, measuring));
    }
    let alignment = match registration {
        Registration::Align(options) => Some(align(a, b, options, aligning)?),
        Registration::None | Registration::Known(_) => None,
    };
    let pose = match (registration, &alignment) {
        (_, Some(alignment)) => alignment.moving_to_fixed,
        (Registration::Known(pose), None) => *pose,
        _ => Isometry3::identity(),
    };
    let comparison = distances(a, b, &pose, options, measuring)?;
    let mut warnings = alignment.as_ref().map_or_else(Vec::new, alignment_warnings);
    warnings.extend(size_warning(a, b));
    Ok(Compared { alignment, comparison, warnings })
}

/// The same with a cloud of points for `b`, which has no surface: the points are measured against `a`. The figures are over
/// the points, with the signs that they have from `b`'s side; vertices of `a` have no distance of their own.
fn compare_with_points(
    a: &Mesh,
    b: &Mesh,
    registration: &Registration,
    options: &DistanceOptions,
    (aligning, measuring): (&dyn Watch, &dyn Watch),
) -> Result<Compared, CompareError> {
    let registration = match registration {
        Registration::None => Registration::None,
        Registration::Known(pose) => Registration::Known(pose.inverse()),
        Registration::Align(options) => {
            Registration::Align(AlignOptions { start: turned_round(&options.start), ..options.clone() })
        }
    };
    let Compared { alignment, comparison, mut warnings } =
        compare_meshes(b, a, &registration, options, (aligning, measuring))?;
    let alignment = alignment.map(|found| Alignment {
        moving_to_fixed: found.moving_to_fixed.inverse(),
        ambiguous: found.ambiguous.map(|other| other.inverse()),
        ..found
    });
    let pose = alignment.as_ref().map_or_else(Isometry3::identity, |found| found.moving_to_fixed);
    let comparison = Comparison {
        signed_mm: vec![None; a.positions.len()],
        bias_mm: -comparison.bias_mm,
        rotation_deg: pose.rotation.angle().to_degrees(),
        translation_mm: pose.translation.vector,
        matrix: pose.to_homogeneous(),
        ..comparison
    };
    warnings
        .push(format!("B is a cloud of {} points: each of them is measured against A's surface", b.positions.len()));
    Ok(Compared { alignment, comparison, warnings })
}

/// The same start for the other direction.
fn turned_round(start: &Start) -> Start {
    match start {
        Start::CameraFrame => Start::CameraFrame,
        Start::Pose(pose) => Start::Pose(pose.inverse()),
        Start::Pairs(pairs) => Start::Pairs(pairs.iter().map(|(from, to)| (*to, *from)).collect()),
    }
}

/// A mesh that is many times as large as the other fits somewhere all the same: a unit was forgotten.
fn size_warning(a: &Mesh, b: &Mesh) -> Option<String> {
    let diagonal = |mesh: &Mesh| mesh.bounds().map(|(low, high)| f64::from((high - low).norm())).filter(|mm| *mm > 0.0);
    let ratio = diagonal(a)? / diagonal(b)?;
    let (times, word) = if ratio > 1.0 { (ratio, "larger") } else { (1.0 / ratio, "smaller") };
    (times > STRANGE_SIZE).then(|| format!("A is {times:.0} times {word} than B: check the unit of each"))
}

/// What the user should know before trusting an alignment.
pub fn alignment_warnings(alignment: &Alignment) -> Vec<String> {
    let mut warnings: Vec<_> = alignment.free.iter().map(|free| format!("the {free}: do not trust it there")).collect();
    if !alignment.converged {
        warnings.push("the alignment did not come to rest; look at the rms of its iterations".into());
    }
    if alignment.searched {
        warnings.push("the meshes lay so far apart that other starts were tried: look at the result".into());
    }
    if alignment.is_poor() {
        warnings.push(format!(
            "a poor fit: {:.3} mm are left of a relief of {:.3} mm, as between surfaces that do not belong together; check \
             both files and their units, or pick three pairs of points that belong together",
            alignment.rms_mm, alignment.relief_mm
        ));
    }
    if let Some(other) = &alignment.ambiguous {
        let turn = (other.rotation * alignment.moving_to_fixed.rotation.inverse()).angle().to_degrees();
        warnings.push(format!(
            "an ambiguous fit: turned by {turn:.0} degrees the meshes fit as well; pick three pairs of points that belong \
             together"
        ));
    }
    warnings
}
