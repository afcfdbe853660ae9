//! Writes STL, here: the format is a header and packed numbers, and the crate that reads it leaves the header empty, the
//! only place for unit and axes.

use std::io::{self, Write};

use firstbounce_core::Mesh;

use super::{Axes, unit, write_all};

/// Bytes of the header.
const HEADER: usize = 80;

/// Writes binary STL: triangles with their normals, in the mesh's unit (STL itself has none), as they lie.
///
/// # Errors
/// What the writer says.
pub(super) fn stl_into(out: &mut impl Write, mesh: &Mesh, axes: Axes) -> io::Result<()> {
    // A text here must not begin with "solid", by which readers know the other kind of STL.
    let mut header = format!("Firstbounce mesh, unit {}, {}", unit(mesh), axes.words()).into_bytes();
    header.resize(HEADER, b' ');
    let too_many = |_| io::Error::new(io::ErrorKind::InvalidInput, "more triangles than STL can count");
    header.extend(u32::try_from(mesh.triangles.len()).map_err(too_many)?.to_le_bytes());
    out.write_all(&header)?;
    write_all(out, &mesh.triangles, |bytes, _, corners| {
        let [a, b, c] = corners.map(|corner| mesh.positions[corner as usize]);
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
        let numbers = [normal, a.coords, b.coords, c.coords];
        bytes.extend(numbers.iter().flat_map(|vector| vector.iter()).flat_map(|x| x.to_le_bytes()));
        // An attribute that is never read.
        bytes.extend([0; 2]);
        Ok(())
    })
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
        stl_into(&mut file, &mesh, Axes::YUp).unwrap();
        assert!(file.starts_with(b"Firstbounce mesh, unit mm, x right, y up, z toward the camera  "));
        let read = stl_io::read_stl(&mut Cursor::new(file)).unwrap();
        read.validate().expect("closed, and every edge once in each direction");
        assert_eq!((read.vertices.len(), read.faces.len()), (4, 4));
        for (face, corners) in read.faces.iter().zip(&mesh.triangles) {
            let expected = corners.map(|corner| <[f32; 3]>::from(mesh.positions[corner as usize]));
            assert_eq!(face.vertices.map(|vertex| read.vertices[vertex].0), expected, "same order, so same winding");
        }
    }
}
