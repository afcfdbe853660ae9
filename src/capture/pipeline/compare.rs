//! A mesh against a reference: reading, registering one onto the other, distances. The command line and the window compare by this.

use std::path::Path;

use firstbounce_core::mesh::compare::{
    AlignOptions, Alignment, CompareError, Comparison, DistanceOptions, align, distances,
};
use firstbounce_core::{Mesh, Watch};
use nalgebra::Isometry3;

use super::truth_mesh;
use crate::mesh_file::read::{LengthScale, MeshError, read_mesh};
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

/// Reads a mesh in mm, and what the user should know of it: a mesh file whose unit is `scale`, or the truth of a capture set
/// (its folder or its capture.toml).
///
/// # Errors
/// `ReferenceError`: no set, a set without truth, or a file that is no mesh.
pub fn read_comparable(path: &Path, scale: LengthScale) -> Result<(Mesh, Vec<String>), ReferenceError> {
    if path.is_dir() || path.extension().is_some_and(|extension| extension == "toml") {
        return Ok((truth_mesh(&CaptureSet::open(path)?)?, vec![]));
    }
    let file = read_mesh(path, scale)?;
    let warnings = file.warnings.iter().map(|warning| format!("{}: {warning}", path.display())).collect();
    Ok((file.mesh, warnings))
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
    warnings
}
