//! A small solid for tests.

use firstbounce_core::Mesh;
use firstbounce_core::mesh::LengthUnit;
use nalgebra::Point3;

/// Four triangles facing outward, sides of 10, 20 and 30 mm, with colours and normals.
pub fn tetrahedron() -> Mesh {
    let positions = [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 20.0, 0.0], [0.0, 0.0, 30.0]];
    let mut mesh = Mesh {
        positions: positions.map(Point3::from).to_vec(),
        normals: vec![],
        colours: vec![[0.0, 0.5, 1.0], [1.0, 0.0, 0.0], [0.25, 0.25, 0.25], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]],
        unit: LengthUnit::Millimetre,
    };
    mesh.normals = mesh.area_weighted_normals();
    mesh
}
