//! Coarse versions of a mesh, by one vertex for each cell of a grid.

use std::collections::HashMap;

use nalgebra::Point3;

use crate::Mesh;

/// For each vertex, the first vertex in the same cell of a grid that has about `wanted` cells on the surface.
pub(crate) fn first_in_cell(mesh: &Mesh, wanted: usize) -> Vec<u32> {
    let area = |corners: &[u32; 3]| {
        let [p, q, r] = corners.map(|corner| mesh.positions[corner as usize].cast::<f64>());
        (q - p).cross(&(r - p)).norm() / 2.0
    };
    let area_mm2: f64 = mesh.triangles.iter().map(area).sum();
    let cell_mm = (area_mm2 / wanted as f64).sqrt().max(f64::MIN_POSITIVE);
    let cell = |p: &Point3<f32>| p.cast::<f64>().coords.map(|x| (x / cell_mm).floor() as i64);
    let mut firsts = HashMap::with_capacity(2 * wanted);
    (0..).zip(&mesh.positions).map(|(index, p)| *firsts.entry(cell(p)).or_insert(index)).collect()
}

/// The surface with about `wanted` vertices: all vertices of a cell become its first one (Rossignac and Borrel 1993).
/// Its vertices lie on the surface; it has no normals of its own.
pub(super) fn clustered(mesh: &Mesh, wanted: usize) -> Mesh {
    let first = first_in_cell(mesh, wanted);
    let mut coarse = Mesh { normals: vec![], colours: vec![], ..mesh.clone() };
    coarse.triangles.iter_mut().for_each(|corners| *corners = corners.map(|corner| first[corner as usize]));
    coarse.welded().0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::compare::test_meshes::{bumps, relief};

    #[test]
    fn a_coarse_surface_has_about_as_many_vertices_as_wanted_and_spreads_them() {
        let coarse = clustered(&relief(200, 0.5, bumps), 2000);
        let count = coarse.positions.len();
        assert!((1000..4000).contains(&count), "{count}");
        let left = coarse.positions.iter().filter(|p| p.x < 0.0).count();
        assert!((left as f64 / count as f64 - 0.5).abs() < 0.05);
        let off = |p: &&Point3<f32>| (p.z - bumps(p.x.into(), p.y.into()) as f32).abs() > 1e-5;
        assert_eq!(coarse.positions.iter().filter(off).count(), 0, "all on the surface");
    }
}
