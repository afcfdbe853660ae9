//! The reference as a surface that answers: what is your closest point, and is it on your border?

use nalgebra::{Matrix3, Point3, Vector3};
use parry3d::math::Vector;
use parry3d::query::PointQueryWithLocation;
use parry3d::shape::{TriMesh, TrianglePointLocation};

use super::cells::clustered;
use super::{CompareError, Side, check_mesh, check_sound};
use crate::mesh::topology::OpenEdges;
use crate::{Mesh, linear_algebra};

/// Sideways distance from the border, as a fraction of the diagonal, up to which a point still lies on the surface: it
/// keeps the border of a mesh on the border of its own copy.
const BORDER_TOLERANCE: f64 = 1e-5;

/// Normals of vertices that turn farther from the face than 20 degrees are those of a crease, not of a curve.
const CREASE_COSINE: f64 = 0.939_692_620_785_908_4;

/// A mesh with a bounding volume hierarchy, centred on `centre` so that f32 is enough wherever the mesh lies.
pub(super) struct Surface {
    triangles: TriMesh,
    normals: Vec<Vector3<f32>>,
    open: OpenEdges,
    on_border: Vec<bool>,
    /// The middle of the bounding box, in the mesh's frame; all points below are relative to it.
    pub centre: Point3<f64>,
    /// Length of the bounding box's diagonal.
    pub diagonal_mm: f64,
}

/// The closest point of a surface.
pub(super) struct Foot {
    /// Where it is, relative to the surface's centre.
    pub point: Point3<f64>,
    /// The surface's unit normal there, interpolated between the vertices; beside a crease that of the face.
    pub normal: Vector3<f64>,
    /// Whether the surface ends there and the asking point lies beyond its end.
    pub beyond_border: bool,
    /// Distance to the asking point, negative where that lies behind the surface.
    pub signed_mm: f64,
}

impl Surface {
    /// Welds, finds borders and normals, builds the hierarchy.
    pub fn new(mesh: &Mesh, side: Side) -> Result<Self, CompareError> {
        check_mesh(mesh, side)?;
        Self::in_own_unit(mesh, side)
    }

    /// The same for a mesh in mm or in pixels; all lengths are then in its unit.
    pub fn in_own_unit(mesh: &Mesh, side: Side) -> Result<Self, CompareError> {
        check_sound(mesh, side)?;
        let (mesh, _) = mesh.welded();
        let (centre, diagonal_mm) = centre_and_diagonal(&mesh, side)?;
        Self::around(&mesh, side, centre, diagonal_mm)
    }

    /// The same for a coarse version of the mesh with about `wanted` vertices, around the same centre: closest points
    /// far from the surface are found many times faster.
    pub fn coarse(&self, mesh: &Mesh, side: Side, wanted: usize) -> Result<Self, CompareError> {
        Self::around(&clustered(mesh, wanted), side, self.centre, self.diagonal_mm)
    }

    fn around(mesh: &Mesh, side: Side, centre: Point3<f64>, diagonal_mm: f64) -> Result<Self, CompareError> {
        let normals = if mesh.normals.is_empty() { mesh.area_weighted_normals() } else { mesh.normals.clone() };
        let open = mesh.open_edges();
        let mut on_border = vec![false; mesh.positions.len()];
        open.border.iter().flatten().for_each(|&vertex| on_border[vertex as usize] = true);
        let centred = mesh.positions.iter().map(|p| single((p.cast::<f64>() - centre).into())).collect();
        let triangles = TriMesh::new(centred, mesh.triangles.clone()).map_err(|_| CompareError::NoExtent { side })?;
        Ok(Self { triangles, normals, open, on_border, centre, diagonal_mm })
    }

    /// The vertices, relative to the centre.
    pub fn points(&self) -> impl Iterator<Item = Vector3<f64>> {
        self.triangles.vertices().iter().map(|vertex| Vector3::from(vertex.to_array()).cast())
    }

    /// How far the vertices lie from their best plane, root mean square.
    pub fn relief_mm(&self) -> f64 {
        let count = self.triangles.vertices().len().max(1) as f64;
        let middle = self.points().sum::<Vector3<f64>>() / count;
        let spread: Matrix3<f64> = self.points().map(|point| (point - middle) * (point - middle).transpose()).sum();
        let eigen = linear_algebra::symmetric_eigen(spread / count);
        eigen.map_or(0.0, |eigen| eigen.eigenvalues.min().max(0.0).sqrt())
    }

    /// The closest point to `point` (relative to the centre) within `reach_mm`, if any.
    pub fn closest(&self, point: &Point3<f64>, reach_mm: f64) -> Option<Foot> {
        let asking = single(*point);
        let (projection, (triangle, location)) =
            self.triangles.project_local_point_and_get_location_with_max_dist(asking, false, reach_mm as f32)?;
        let corners = *self.triangles.indices().get(triangle as usize)?;
        let weights = location.barycentric_coordinates()?;
        let foot = Point3::from(projection.point.to_array()).cast::<f64>();
        let offset = point - foot;

        let smooth: Vector3<f32> = (0..3).map(|k| self.normals[corners[k] as usize] * weights[k]).sum();
        let flat = Vector3::from(self.triangles.triangle(triangle).scaled_normal().to_array());
        let flat = flat.cast::<f64>().try_normalize(0.0);
        let smooth = smooth.cast::<f64>().try_normalize(0.0);
        let is_creased = smooth.zip(flat).is_some_and(|(smooth, flat)| smooth.dot(&flat) < CREASE_COSINE);
        // A vertex on a crease has the mean of its two sides, which holds for neither: within a face its own normal does.
        let on_face = matches!(location, TrianglePointLocation::OnFace(..));
        let normal = if on_face && is_creased { flat } else { smooth.or(flat) }?;
        // Inside a triangle the offset is along its own normal; on an edge or corner only the mean of the neighbours
        // tells the sides apart.
        let facing = if on_face { flat.unwrap_or(normal) } else { normal };
        let sideways = (offset - normal * normal.dot(&offset)).norm();
        let beyond_border = self.is_border(corners, location) && sideways > BORDER_TOLERANCE * self.diagonal_mm;
        let signed_mm = if offset.dot(&facing) < 0.0 { -offset.norm() } else { offset.norm() };
        Some(Foot { point: foot, normal, beyond_border, signed_mm })
    }

    fn is_border(&self, corners: [u32; 3], location: TrianglePointLocation) -> bool {
        match location {
            TrianglePointLocation::OnVertex(corner) => self.on_border[corners[corner as usize % 3] as usize],
            // Edges are AB, BC, AC.
            TrianglePointLocation::OnEdge(0, _) => self.open.is_border(corners[0], corners[1]),
            TrianglePointLocation::OnEdge(1, _) => self.open.is_border(corners[1], corners[2]),
            TrianglePointLocation::OnEdge(..) => self.open.is_border(corners[0], corners[2]),
            TrianglePointLocation::OnFace(..) | TrianglePointLocation::OnSolid => false,
        }
    }
}

/// The middle of the box around a mesh with a surface, and the length of its diagonal.
pub(super) fn centre_and_diagonal(mesh: &Mesh, side: Side) -> Result<(Point3<f64>, f64), CompareError> {
    box_of(mesh).filter(|_| !mesh.triangles.is_empty()).ok_or(CompareError::NoExtent { side })
}

/// The same of any points; `None` where all are one.
pub(super) fn box_of(mesh: &Mesh) -> Option<(Point3<f64>, f64)> {
    let (low, high) = mesh.bounds()?;
    let diagonal_mm = (high.cast::<f64>() - low.cast::<f64>()).norm();
    (diagonal_mm > 0.0).then(|| (nalgebra::center(&low.cast(), &high.cast()), diagonal_mm))
}

fn single(point: Point3<f64>) -> Vector {
    Vector::from_array(point.cast::<f32>().into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::compare::test_meshes::relief;

    #[test]
    fn the_sign_says_which_side_and_the_border_ends_the_surface() {
        let plane = Surface::new(&relief(20, 1.0, |_, _| 0.0), Side::Fixed).unwrap();
        let above = plane.closest(&Point3::new(0.3, -2.2, 1.5), f64::MAX).unwrap();
        assert!((above.signed_mm - 1.5).abs() < 1e-5 && !above.beyond_border);
        let below = plane.closest(&Point3::new(0.3, -2.2, -1.5), f64::MAX).unwrap();
        assert!((below.signed_mm + 1.5).abs() < 1e-5);
        let beyond = plane.closest(&Point3::new(13.0, 0.0, 0.0), f64::MAX).unwrap();
        assert!(beyond.beyond_border);
        assert!(plane.closest(&Point3::new(0.0, 0.0, 5.0), 4.0).is_none());
    }
}
