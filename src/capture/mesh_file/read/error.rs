//! Errors and warnings of mesh files.

use std::path::PathBuf;

use firstbounce_core::mesh::topology::MeshFault;

use super::MeshFormat;

/// A mesh file that cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}: {problem}", path.display())]
pub struct MeshError {
    /// The file.
    pub path: PathBuf,
    /// Why.
    pub problem: MeshProblem,
}

/// Why a mesh file cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshProblem {
    /// The path is a folder.
    #[error("is a folder; choose a mesh file in it")]
    Directory,
    /// The system does not hand it out.
    #[error("cannot be read: {reason}")]
    Unreadable {
        /// What the system says.
        reason: String,
    },
    /// More bytes than are read of a mesh.
    #[error("is longer than {} MiB; export the mesh with fewer triangles", max_bytes >> 20)]
    TooLong {
        /// The most that is read.
        max_bytes: u64,
    },
    /// No bytes.
    #[error("is empty")]
    EmptyFile,
    /// None of the formats.
    #[error("is {looks_like}; export the mesh as OBJ, PLY or STL")]
    UnknownFormat {
        /// What it seems to be instead.
        looks_like: &'static str,
    },
    /// It ends before its own header says so.
    #[error("is cut off: it promises {promised} {what}, and {found} are there; export or copy it again")]
    Truncated {
        /// "bytes", "vertex lines" and the like.
        what: String,
        /// How many there should be.
        promised: u64,
        /// How many there are at most.
        found: u64,
    },
    /// The file breaks its format's rules.
    #[error("is not valid {format}: {reason}")]
    Malformed {
        /// What the file claims to be.
        format: MeshFormat,
        /// What is wrong, with the line where that is known.
        reason: String,
    },
    /// The file is well-formed, and its mesh unusable.
    #[error("{0}")]
    Fault(MeshFault),
    /// More vertices or triangles than an index can count.
    #[error("has {count} {what}; at most 4294967295 can be used")]
    TooLarge {
        /// "vertices" or "triangles".
        what: &'static str,
        /// How many.
        count: usize,
    },
}

/// What was put right on reading, or is odd.
#[derive(Clone, Debug, PartialEq)]
pub enum MeshWarning {
    /// The name says otherwise.
    WrongExtension {
        /// The extension, lower case.
        extension: String,
        /// What the file is.
        format: MeshFormat,
    },
    /// Faces of more than three corners.
    PolygonsSplit {
        /// How many.
        count: usize,
    },
    /// Vertices at the position of another one, now one.
    DuplicatesJoined {
        /// How many are gone.
        count: usize,
    },
    /// Vertices without a triangle.
    UnusedDropped {
        /// How many are gone.
        count: usize,
    },
    /// Triangles without an area.
    CollapsedDropped {
        /// How many are gone.
        count: usize,
    },
    /// Normals that oppose their triangles, computed from these instead.
    NormalsComputed {
        /// How many opposed.
        opposing: usize,
    },
    /// Edges of more than two triangles.
    NonManifold {
        /// How many.
        edges: usize,
    },
    /// So far from the origin that f32 coordinates are coarse.
    CoarseCoordinates {
        /// The largest coordinate in mm.
        largest_mm: f64,
        /// Distance between neighbouring f32 numbers there.
        step_mm: f64,
    },
    /// The file's own header says that no scale was known.
    InPixels,
    /// The file's own header says that z points up.
    TurnedBack,
}

impl std::fmt::Display for MeshWarning {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        match self {
            Self::WrongExtension { extension, format } => write!(f, "named .{extension}, but it is {format}"),
            Self::PolygonsSplit { count } => write!(f, "{count} faces of more than three corners split into triangles"),
            Self::DuplicatesJoined { count } => write!(f, "{count} vertices joined with another one at their position"),
            Self::UnusedDropped { count } => write!(f, "{count} vertices without a triangle left out"),
            Self::CollapsedDropped { count } => write!(f, "{count} triangles without an area left out"),
            Self::NormalsComputed { opposing } => {
                write!(f, "{opposing} normals oppose their triangles: all are computed from the triangles instead")
            }
            Self::NonManifold { edges } => write!(f, "{edges} edges have more than two triangles"),
            Self::CoarseCoordinates { largest_mm, step_mm } => write!(
                f,
                "coordinates reach {largest_mm:.0} mm, where they are exact to {step_mm:.2} mm only: check the unit, or \
                 move the mesh to the origin"
            ),
            Self::InPixels => {
                write!(f, "written in pixels, for the camera's scale was not known: its size says nothing")
            }
            Self::TurnedBack => write!(f, "written with z up, turned back so that z points toward the camera"),
        }
    }
}
