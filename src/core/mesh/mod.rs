//! A triangle mesh: what the depth becomes, what a scan is read into, what every mesh file is written from.

mod coarse;
pub mod compare;
pub mod decimate;
mod from_depth;
mod ray;
mod section;
pub mod topology;

use nalgebra::{Point3, Vector3};

pub use crate::length::LengthUnit;
pub use coarse::Coarse;
pub use from_depth::{MeshError, MeshOptions, MeshReport, from_depth};
pub use ray::Pickable;
pub use section::section;

/// Triangles over shared vertices, in the object frame (x right, y up, z toward the camera).
///
/// Triangles wind counter-clockwise seen from outside, so that `(b - a) x (c - a)` points out of the surface.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh {
    /// Vertex positions in `unit`.
    pub positions: Vec<Point3<f32>>,
    /// A unit normal for each vertex, or empty.
    pub normals: Vec<Vector3<f32>>,
    /// A linear RGB colour in 0..1 for each vertex, or empty.
    pub colours: Vec<[f32; 3]>,
    /// Three vertex indices a triangle.
    pub triangles: Vec<[u32; 3]>,
    /// What the coordinates are measured in.
    pub unit: LengthUnit,
}

impl Mesh {
    /// The smallest and largest corner of the box around all vertices; `None` for a mesh without vertices.
    pub fn bounds(&self) -> Option<(Point3<f32>, Point3<f32>)> {
        let first = *self.positions.first()?;
        Some(self.positions.iter().fold((first, first), |(low, high), p| (low.inf(p), high.sup(p))))
    }
}
