//! Fewer triangles for a mesh that is too large to be drawn: a level of detail, not a result.

use super::Mesh;
use crate::mesh::compare::first_in_cell;

/// A grid cell on the surface gives about two triangles.
const TRIANGLES_PER_CELL: usize = 2;
/// How much coarser the grid becomes while the mesh still has too many triangles.
const COARSER: f64 = 0.7;

/// Which vertices of a mesh stand for all, and the triangles between them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Coarse {
    /// For each vertex of the coarse mesh its number in the full one: values of the full mesh are looked up here.
    pub kept: Vec<u32>,
    /// Three indices into `kept` a triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Coarse {
    /// At most `most_triangles` triangles over some of the mesh's own vertices: all vertices in a cell of a grid become one
    /// (Rossignac and Borrel 1993). The winding stays; details below a cell go.
    pub fn of(mesh: &Mesh, most_triangles: usize) -> Self {
        let mut wanted = (most_triangles / TRIANGLES_PER_CELL).max(1);
        loop {
            let coarse = Self::with_cells(mesh, wanted);
            if coarse.triangles.len() <= most_triangles || wanted == 1 {
                return coarse;
            }
            wanted = ((wanted as f64 * COARSER) as usize).max(1);
        }
    }

    fn with_cells(mesh: &Mesh, wanted: usize) -> Self {
        let first = first_in_cell(mesh, wanted);
        let mut number = vec![u32::MAX; mesh.positions.len()];
        let (mut kept, mut triangles) = (Vec::new(), Vec::new());
        for corners in &mesh.triangles {
            let [a, b, c] = corners.map(|corner| first[corner as usize]);
            if a == b || b == c || c == a {
                continue;
            }
            triangles.push([a, b, c].map(|vertex| {
                let number = &mut number[vertex as usize];
                if *number == u32::MAX {
                    *number = kept.len() as u32;
                    kept.push(vertex);
                }
                *number
            }));
        }
        Self { kept, triangles }
    }

    /// The coarse mesh with positions, normals and colours of the vertices that were kept.
    pub fn mesh(&self, full: &Mesh) -> Mesh {
        let kept = || self.kept.iter().map(|&vertex| vertex as usize);
        Mesh {
            positions: kept().filter_map(|vertex| full.positions.get(vertex).copied()).collect(),
            normals: kept().filter_map(|vertex| full.normals.get(vertex).copied()).collect(),
            colours: kept().filter_map(|vertex| full.colours.get(vertex).copied()).collect(),
            triangles: self.triangles.clone(),
            unit: full.unit,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::compare::test_meshes::{bumps, relief};

    #[test]
    fn a_coarse_mesh_has_no_more_triangles_than_asked_for_and_lies_on_the_full_one() {
        let full = relief(200, 0.5, bumps);
        let coarse = Coarse::of(&full, 9000);
        let mesh = coarse.mesh(&full);
        assert!((3000..=9000).contains(&mesh.triangles.len()), "{}", mesh.triangles.len());
        assert!(mesh.fault().is_none());
        for p in &mesh.positions {
            assert!((p.z - bumps(p.x.into(), p.y.into()) as f32).abs() < 1e-5);
        }
        // It still faces +z and covers the same square.
        let area: f32 = mesh
            .triangles
            .iter()
            .map(|corners| {
                let [a, b, c] = corners.map(|corner| mesh.positions[corner as usize]);
                (b - a).cross(&(c - a)).z / 2.0
            })
            .sum();
        assert!((area / 1e4 - 1.0).abs() < 0.05, "{area}");
    }
}
