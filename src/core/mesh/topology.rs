//! The topology of a mesh: normals, borders, doubled vertices, faults.

use std::collections::HashMap;

use nalgebra::{Isometry3, Point3, Vector3};
use rayon::prelude::*;

use crate::Mesh;

/// The fourth power of a larger coordinate, as in the square of an area, is no number in single precision.
const MAX_COORDINATE: f32 = 1e9;

/// The fourth power of a shorter length is none either.
const MIN_DIAGONAL: f32 = 1e-6;

/// Why a mesh cannot be used at all.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MeshFault {
    /// There is no surface: no triangle, or none left.
    #[error("has {vertices} vertices and no triangle, so it has no surface")]
    NoTriangle {
        /// Vertices it has all the same; many mean a point cloud.
        vertices: usize,
    },
    /// Normals or colours for some vertices only.
    #[error("has {found} {what} for {vertices} vertices; there must be one for each, or none")]
    Incomplete {
        /// "normals" or "colours".
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A coordinate is NaN or infinite.
    #[error("has {count} vertices with {what} that are not finite numbers, the first is vertex {first}")]
    NotFinite {
        /// "positions" or "normals".
        what: &'static str,
        /// How many vertices are affected.
        count: usize,
        /// Index of the first one.
        first: usize,
    },
    /// A coordinate that single precision cannot compute with.
    #[error(
        "has vertex {vertex} at {coordinate:e}, and at most {MAX_COORDINATE:e} mm can be computed with: check the unit, or \
         move the mesh to the origin"
    )]
    TooFar {
        /// Index of the first such vertex.
        vertex: usize,
        /// Its largest coordinate.
        coordinate: f32,
    },
    /// All of it is closer together than single precision can tell apart.
    #[error("is {diagonal:e} from end to end, and at least {MIN_DIAGONAL:e} mm can be computed with: check the unit")]
    TooSmall {
        /// The diagonal of the box around it.
        diagonal: f32,
    },
    /// A triangle names a vertex that is not there.
    #[error("has a triangle ({triangle}) that uses vertex {index}, but only {vertices} vertices")]
    IndexOutOfRange {
        /// Index of the triangle.
        triangle: usize,
        /// The vertex index it names.
        index: u32,
        /// How many vertices there are.
        vertices: usize,
    },
}

/// The edges that do not lie between exactly two triangles.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OpenEdges {
    /// Edges of one triangle only, as vertex pairs with the smaller index first, sorted.
    pub border: Vec<[u32; 2]>,
    /// How many edges have more than two triangles.
    pub non_manifold: usize,
}

impl OpenEdges {
    /// Whether the edge between two vertices is on the border.
    pub fn is_border(&self, a: u32, b: u32) -> bool {
        self.border.binary_search(&[a.min(b), a.max(b)]).is_ok()
    }
}

/// What welding took away.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Welded {
    /// Vertices at the position of another one.
    pub duplicate_vertices: usize,
    /// Vertices that no triangle uses.
    pub unused_vertices: usize,
    /// Triangles that have two corners at one position, and so no area.
    pub collapsed_triangles: usize,
}

impl Mesh {
    /// The first thing that makes this mesh unusable, if any.
    pub fn fault(&self) -> Option<MeshFault> {
        if self.triangles.is_empty() {
            return Some(MeshFault::NoTriangle { vertices: self.positions.len() });
        }
        self.fault_of_points().or_else(|| self.index_fault())
    }

    /// The same of its vertices alone: a cloud of points may have no triangle.
    pub fn fault_of_points(&self) -> Option<MeshFault> {
        let vertices = self.positions.len();
        if vertices == 0 {
            return Some(MeshFault::NoTriangle { vertices });
        }
        for (what, found) in [("normals", self.normals.len()), ("colours", self.colours.len())] {
            if found != 0 && found != vertices {
                return Some(MeshFault::Incomplete { what, found, vertices });
            }
        }
        let positions = not_finite("positions", self.positions.iter().map(|p| p.coords));
        if let Some(fault) = positions.or_else(|| not_finite("normals", self.normals.iter().copied())) {
            return Some(fault);
        }
        self.extent_fault()
    }

    fn extent_fault(&self) -> Option<MeshFault> {
        let reach = |position: &Point3<f32>| position.coords.amax();
        if let Some(vertex) = self.positions.iter().position(|position| reach(position) > MAX_COORDINATE) {
            return Some(MeshFault::TooFar { vertex, coordinate: reach(&self.positions[vertex]) });
        }
        let (low, high) = self.bounds()?;
        let diagonal = (high.cast::<f64>() - low.cast::<f64>()).norm() as f32;
        // Of no extent at all, it has no triangle left once it is welded.
        (diagonal > 0.0 && diagonal < MIN_DIAGONAL).then_some(MeshFault::TooSmall { diagonal })
    }

    fn index_fault(&self) -> Option<MeshFault> {
        let vertices = self.positions.len();
        self.triangles.iter().enumerate().find_map(|(triangle, corners)| {
            let &index = corners.iter().find(|&&corner| corner as usize >= vertices)?;
            Some(MeshFault::IndexOutOfRange { triangle, index, vertices })
        })
    }

    /// A unit normal for each vertex: the mean of its triangles' normals, weighted by their areas. A vertex without a
    /// triangle of some area gets +z, toward the camera.
    pub fn area_weighted_normals(&self) -> Vec<Vector3<f32>> {
        let mut sums = vec![Vector3::<f64>::zeros(); self.positions.len()];
        for &[a, b, c] in &self.triangles {
            let [p, q, r] = [a, b, c].map(|corner| self.positions[corner as usize].cast::<f64>());
            let twice_area = (q - p).cross(&(r - p));
            for corner in [a, b, c] {
                sums[corner as usize] += twice_area;
            }
        }
        sums.par_iter().map(|sum| sum.try_normalize(0.0).unwrap_or_else(Vector3::z).cast()).collect()
    }

    /// The border of the surface, and the count of edges where more than two triangles meet. Two vertices at one
    /// position count as two: weld first.
    pub fn open_edges(&self) -> OpenEdges {
        let mut edges: Vec<[u32; 2]> = self
            .triangles
            .par_iter()
            .flat_map_iter(|&[a, b, c]| [[a, b], [b, c], [c, a]].map(|[from, to]| [from.min(to), from.max(to)]))
            .collect();
        edges.par_sort_unstable();
        let mut open = OpenEdges::default();
        for same in edges.chunk_by(|one, next| one == next) {
            match same.len() {
                1 => open.border.push(same[0]),
                2 => {}
                _ => open.non_manifold += 1,
            }
        }
        open
    }

    /// The same surface with one vertex for each position, without unused vertices and triangles without area. Normals
    /// of vertices that become one are averaged; the first one's colour stays. Vertices keep their order.
    pub fn welded(&self) -> (Mesh, Welded) {
        let mut used = vec![false; self.positions.len()];
        self.triangles.iter().flatten().for_each(|&corner| used[corner as usize] = true);

        let mut welded =
            Mesh { positions: vec![], normals: vec![], colours: vec![], triangles: vec![], unit: self.unit };
        let mut report = Welded::default();
        let mut index_at = HashMap::with_capacity(self.positions.len());
        let mut new_index = vec![0; self.positions.len()];
        for (old, position) in self.positions.iter().enumerate() {
            if !used[old] {
                report.unused_vertices += 1;
                continue;
            }
            // Adding zero makes one of the two zeros, which differ in their bits.
            let key = [position.x + 0.0, position.y + 0.0, position.z + 0.0].map(f32::to_bits);
            let next = welded.positions.len();
            let index = *index_at.entry(key).or_insert(next);
            new_index[old] = index as u32;
            if index == next {
                welded.positions.push(*position);
                welded.normals.extend(self.normals.get(old));
                welded.colours.extend(self.colours.get(old));
            } else {
                report.duplicate_vertices += 1;
                if let Some(normal) = self.normals.get(old) {
                    welded.normals[index] += normal;
                }
            }
        }
        welded.normals.iter_mut().for_each(|sum| *sum = sum.try_normalize(0.0).unwrap_or_else(Vector3::z));
        welded.triangles = self.triangles.iter().map(|corners| corners.map(|old| new_index[old as usize])).collect();
        welded.triangles.retain(|&[a, b, c]| a != b && b != c && c != a);
        report.collapsed_triangles = self.triangles.len() - welded.triangles.len();
        (welded, report)
    }

    /// The same surface after a rigid motion, whose translation is in the mesh's unit.
    pub fn moved(mut self, motion: &Isometry3<f64>) -> Mesh {
        self.positions.iter_mut().for_each(|p| *p = (motion * p.cast::<f64>()).cast());
        self.normals.iter_mut().for_each(|n| *n = (motion * n.cast::<f64>()).cast());
        self
    }

    /// The same surface for programs whose z axis points up: (x, y, z) becomes (x, -z, y), a quarter turn about x.
    pub fn with_z_up(mut self) -> Mesh {
        self.positions.iter_mut().for_each(|p| *p = Point3::new(p.x, -p.z, p.y));
        self.normals.iter_mut().for_each(|n| *n = Vector3::new(n.x, -n.z, n.y));
        self
    }

    /// A surface with z up as it was before [`Mesh::with_z_up`]: (x, y, z) becomes (x, z, -y).
    pub fn with_y_up(mut self) -> Mesh {
        self.positions.iter_mut().for_each(|p| *p = Point3::new(p.x, p.z, -p.y));
        self.normals.iter_mut().for_each(|n| *n = Vector3::new(n.x, n.z, -n.y));
        self
    }
}

fn not_finite(what: &'static str, vectors: impl Iterator<Item = Vector3<f32>>) -> Option<MeshFault> {
    let mut bad = vectors.enumerate().filter(|(_, v)| !v.iter().all(|x| x.is_finite())).map(|(index, _)| index);
    let first = bad.next()?;
    Some(MeshFault::NotFinite { what, count: 1 + bad.count(), first })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::LengthUnit;

    /// Four vertices of a unit square as two triangles facing +z, the shared corners stored twice.
    fn split_square() -> Mesh {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        Mesh {
            positions: corners.map(|[x, y]| Point3::new(x, y, 0.0)).to_vec(),
            normals: vec![],
            colours: vec![],
            triangles: vec![[0, 1, 2], [3, 4, 5]],
            unit: LengthUnit::Millimetre,
        }
    }

    #[test]
    fn welding_joins_the_halves_of_a_square() {
        let (square, report) = split_square().welded();
        assert_eq!(report, Welded { duplicate_vertices: 2, ..Welded::default() });
        assert_eq!(square.positions.len(), 4);
        assert_eq!(split_square().open_edges().border.len(), 6);
        let open = square.open_edges();
        assert_eq!(open.border.len(), 4, "only the diagonal has two triangles");
        assert!(!open.is_border(0, 2) && open.is_border(1, 0));
    }

    #[test]
    fn welding_drops_what_has_no_surface() {
        let mut mesh = split_square();
        mesh.positions.push(Point3::new(9.0, 9.0, 9.0));
        mesh.triangles.push([0, 1, 3]);
        let (welded, report) = mesh.welded();
        assert_eq!(report, Welded { duplicate_vertices: 2, unused_vertices: 1, collapsed_triangles: 1 });
        assert_eq!((welded.positions.len(), welded.triangles.len()), (4, 2));
    }

    #[test]
    fn a_third_triangle_on_an_edge_is_not_manifold() {
        let mut fan = split_square().welded().0;
        fan.positions.push(Point3::new(0.5, 0.5, 1.0));
        fan.triangles.push([0, 2, 4]);
        assert_eq!(fan.open_edges().non_manifold, 1);
    }

    #[test]
    fn large_triangles_pull_a_normal_more_than_small_ones() {
        // Vertex 0 has a triangle of area 50 facing +z and one of area 0.5 facing +x.
        let mesh = Mesh {
            positions: [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
                .map(Point3::from)
                .to_vec(),
            triangles: vec![[0, 1, 2], [0, 3, 4]],
            ..split_square()
        };
        let expected = Vector3::new(1.0, 0.0, 100.0).normalize();
        assert!((mesh.area_weighted_normals()[0] - expected).norm() < 1e-6);
    }

    #[test]
    fn faults_name_what_is_wrong() {
        let empty = Mesh { triangles: vec![], ..split_square() };
        assert_eq!(empty.fault(), Some(MeshFault::NoTriangle { vertices: 6 }));
        let mut lost = split_square();
        lost.triangles[1] = [3, 4, 6];
        assert_eq!(lost.fault(), Some(MeshFault::IndexOutOfRange { triangle: 1, index: 6, vertices: 6 }));
        let mut holed = split_square();
        holed.positions[2].y = f32::NAN;
        assert_eq!(holed.fault(), Some(MeshFault::NotFinite { what: "positions", count: 1, first: 2 }));
        let half = Mesh { normals: vec![Vector3::z(); 3], ..split_square() };
        assert_eq!(half.fault(), Some(MeshFault::Incomplete { what: "normals", found: 3, vertices: 6 }));
        assert_eq!(split_square().fault(), None);
    }

    #[test]
    fn turning_z_up_keeps_the_surface_facing_outward() {
        let turned = Mesh { normals: vec![Vector3::z(); 6], ..split_square() }.with_z_up();
        assert_eq!(turned.normals[0], Vector3::new(0.0, -1.0, 0.0));
        assert_eq!(turned.area_weighted_normals(), turned.normals, "winding and normals agree");
        let back = turned.with_y_up();
        assert_eq!(back, Mesh { normals: vec![Vector3::z(); 6], ..split_square() });
    }
}
