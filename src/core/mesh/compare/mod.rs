//! Comparison of a mesh with a reference: rigid alignment, then distances. All lengths in mm.
//!
//! [`align`] finds the rigid motion that lays one mesh onto another (iterative closest point, point to plane);
//! [`distances`] measures every vertex of one mesh against the surface of the other; [`colour_by_distance`] paints what
//! it found. Scans are partial, so a vertex whose closest point lies beyond the border of the other surface has no
//! counterpart there: it counts as not overlapping and enters no figure. The moving side may be a cloud of points without
//! triangles.

mod align;
#[cfg(test)]
mod align_tests;
mod cells;
mod deviation;
mod distances;
mod heat_map;
mod motion;
mod options;
mod pairs;
mod rigid;
mod search;
mod surface;
#[cfg(test)]
pub(crate) mod test_meshes;

pub(crate) use cells::first_in_cell;

pub use align::{Alignment, Iteration, align};
pub use deviation::{Deviation, deviation};
pub use distances::{Comparison, DistanceOptions, distances};
pub use heat_map::colour_by_distance;
pub use motion::FreeMotion;
pub use options::{AlignOptions, Freedom, Start};
pub use rigid::{RigidFit, rigid_from_pairs};

use crate::mesh::topology::MeshFault;
use crate::mesh::{LengthUnit, Mesh};
use crate::options::OptionError;

/// Which of the two meshes of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// The mesh that is measured, and moved.
    Moving,
    /// The reference, which stays where it is.
    Fixed,
}

impl std::fmt::Display for Side {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(match self {
            Self::Moving => "the mesh to compare",
            Self::Fixed => "the reference mesh",
        })
    }
}

/// Why two meshes could not be compared.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CompareError {
    /// The mesh itself is unusable.
    #[error("{side} {fault}")]
    Mesh {
        /// Which mesh.
        side: Side,
        /// What is wrong with it.
        fault: MeshFault,
    },
    /// All points of the mesh are one point.
    #[error("{side} has no extent: all its triangles have zero area")]
    NoExtent {
        /// Which mesh.
        side: Side,
    },
    /// The mesh has no scale.
    #[error("{side} is in pixels; set mm_per_pixel in the capture set, so that distances are in mm")]
    NotInMillimetres {
        /// Which mesh.
        side: Side,
    },
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// Fewer than three picked pairs, or pairs on one line.
    #[error("the {count} picked pairs do not fix a position: pick at least three pairs that do not lie on one line")]
    PairsOnALine {
        /// How many pairs were given.
        count: usize,
    },
    /// A mesh of a few points fixes no position.
    #[error(
        "only {pairs} points of the mesh lie over the reference, too few to align: compare without aligning, or use a finer mesh"
    )]
    TooFewPairs {
        /// How many lie over it.
        pairs: usize,
    },
    /// The surfaces do not lie on each other.
    #[error(
        "the meshes overlap by {:.1} % only (at least {:.0} % needed): check the units of both, or pick three pairs of \
         points that belong together",
        overlap * 100.0,
        minimum * 100.0
    )]
    NoOverlap {
        /// The largest fraction of the moving mesh that was found on the reference, 0 to 1.
        overlap: f64,
        /// The fraction that was asked for.
        minimum: f64,
    },
    /// No vertex has a counterpart to measure against.
    #[error(
        "no point of the mesh lies over the reference within {limit_mm:.2} mm: align the two first, or raise the limit"
    )]
    NothingWithin {
        /// The distance limit.
        limit_mm: f64,
    },
    /// One surface faces inward.
    #[error(
        "the surfaces lie on each other but face opposite ways ({:.0} % of the points): reverse the triangles of one of them",
        facing_away * 100.0
    )]
    InsideOut {
        /// Fraction of the points close to the reference whose normals oppose it, 0 to 1.
        facing_away: f64,
    },
    /// The watch said so.
    #[error("the comparison was cancelled")]
    Cancelled,
}

/// Refuses a mesh without a surface.
fn check_sound(mesh: &Mesh, side: Side) -> Result<(), CompareError> {
    mesh.fault().map_or(Ok(()), |fault| Err(CompareError::Mesh { side, fault }))
}

/// Refuses a mesh that cannot be measured in mm.
fn check_mesh(mesh: &Mesh, side: Side) -> Result<(), CompareError> {
    check_sound(mesh, side)?;
    check_points(mesh, side)
}

/// Refuses points that cannot be measured in mm; the moving side needs no triangles.
fn check_points(mesh: &Mesh, side: Side) -> Result<(), CompareError> {
    if let Some(fault) = mesh.fault_of_points() {
        return Err(CompareError::Mesh { side, fault });
    }
    if mesh.unit != LengthUnit::Millimetre {
        return Err(CompareError::NotInMillimetres { side });
    }
    Ok(())
}
