//! Writes STL.

use std::io::{self, Write};

use firstbounce_core::Mesh;

/// Writes binary STL: triangles with their normals, in the mesh's unit (STL itself has none), as they lie.
///
/// # Errors
/// What the writer says.
pub(super) fn stl_into(out: &mut impl Write, mesh: &Mesh) -> io::Result<()> {
    let facets = mesh.triangles.iter().map(|corners| {
        let [a, b, c] = corners.map(|corner| mesh.positions[corner as usize]);
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
        stl_io::Triangle {
            normal: stl_io::Normal::new(normal.into()),
            vertices: [a, b, c].map(|corner| stl_io::Vertex::new(corner.into())),
        }
    });
    stl_io::write_stl(out, facets)
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use super::*;
    use crate::mesh_file::test_mesh::tetrahedron;

    #[test]
    fn another_reader_sees_the_same_solid() {
        let mesh = tetrahedron();
        let mut file = Vec::new();
        stl_into(&mut file, &mesh).unwrap();
        let read = stl_io::read_stl(&mut Cursor::new(file)).unwrap();
        read.validate().expect("closed, and every edge once in each direction");
        assert_eq!((read.vertices.len(), read.faces.len()), (4, 4));
        for (face, corners) in read.faces.iter().zip(&mesh.triangles) {
            let expected = corners.map(|corner| <[f32; 3]>::from(mesh.positions[corner as usize]));
            assert_eq!(face.vertices.map(|vertex| read.vertices[vertex].0), expected, "same order, so same winding");
        }
    }
}
