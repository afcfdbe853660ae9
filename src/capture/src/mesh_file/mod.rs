//! Meshes in ([`read`]), and out as OBJ (text, read by everything), PLY (binary, small), STL and glTF.
//!
//! Vertex colours go out sRGB-encoded: viewers and modellers show or decode them as such.

pub mod gltf;
mod obj;
mod ply;
pub mod read;
pub mod stl;

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use firstbounce_core::Mesh;
use firstbounce_core::mesh::LengthUnit;
use rayon::prelude::*;

pub use obj::obj_into;
pub use ply::ply_into;

/// How the axes of a mesh lie, for the header of its file.
const AXES: &str = "x right, y up, z toward the camera; triangles wind counter-clockwise seen from outside";

/// How many lines or records a core formats at a time.
const PIECE: usize = 1 << 12;
/// How many pieces are formatted before they are written, which bounds the memory.
const PIECES: usize = 64;

/// Why a mesh could not be written. Every message is one line.
#[derive(Debug, thiserror::Error)]
pub enum MeshFileError {
    /// Normals or colours for some vertices only.
    #[error("{what}: {found} for {vertices} vertices; a mesh has one for each vertex, or none")]
    Incomplete {
        /// "normals" or "colours".
        what: &'static str,
        /// How many there are.
        found: usize,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} names a vertex beyond the {vertices} that the mesh has")]
    NoSuchVertex {
        /// The first such triangle.
        triangle: usize,
        /// How many vertices there are.
        vertices: usize,
    },
    /// A vertex lies nowhere.
    #[error("vertex {vertex} of the mesh has no finite position; leave such pixels out of the mask")]
    NotFinite {
        /// The first such vertex.
        vertex: usize,
    },
    /// The file could not be written whole.
    #[error("{}: cannot be written: {reason}; check the space on the disk and the permissions", path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
}

/// Writes `mesh` as an OBJ file.
///
/// # Errors
/// [`MeshFileError`] for a mesh that does not hold together, or with the system's reason.
pub fn write_obj(path: &Path, mesh: &Mesh) -> Result<(), MeshFileError> {
    write_file(path, mesh, |out| obj_into(out, mesh))
}

/// Writes `mesh` as a binary little-endian PLY file.
///
/// # Errors
/// As [`write_obj`].
pub fn write_ply(path: &Path, mesh: &Mesh) -> Result<(), MeshFileError> {
    write_file(path, mesh, |out| ply_into(out, mesh))
}

fn write_file(
    path: &Path,
    mesh: &Mesh,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), MeshFileError> {
    check(mesh)?;
    let unwritable =
        |error: io::Error| MeshFileError::Unwritable { path: path.to_path_buf(), reason: error.to_string() };
    let mut out = BufWriter::new(File::create(path).map_err(unwritable)?);
    write(&mut out).and_then(|()| out.flush()).map_err(unwritable)
}

fn check(mesh: &Mesh) -> Result<(), MeshFileError> {
    let vertices = mesh.positions.len();
    for (what, found) in [("normals", mesh.normals.len()), ("colours", mesh.colours.len())] {
        if found != 0 && found != vertices {
            return Err(MeshFileError::Incomplete { what, found, vertices });
        }
    }
    let beyond = |triangle: &[u32; 3]| triangle.iter().any(|&index| index as usize >= vertices);
    if let Some(triangle) = mesh.triangles.par_iter().position_first(beyond) {
        return Err(MeshFileError::NoSuchVertex { triangle, vertices });
    }
    let nowhere = mesh.positions.par_iter().position_first(|p| !p.iter().all(|value| value.is_finite()));
    nowhere.map_or(Ok(()), |vertex| Err(MeshFileError::NotFinite { vertex }))
}

fn unit(mesh: &Mesh) -> &'static str {
    match mesh.unit {
        LengthUnit::Millimetre => "mm",
        LengthUnit::Pixel => "pixels (no scale is known)",
    }
}

/// Lets all cores format numbered `items`, and writes them in order.
fn write_all<T: Sync>(
    out: &mut impl Write,
    items: &[T],
    format: impl Fn(&mut Vec<u8>, usize, &T) -> io::Result<()> + Sync,
) -> io::Result<()> {
    for (batch, items) in items.chunks(PIECE * PIECES).enumerate() {
        let pieces = items.par_chunks(PIECE).enumerate().map(|(piece, items)| {
            let first = (batch * PIECES + piece) * PIECE;
            let mut text = Vec::new();
            items.iter().zip(first..).try_for_each(|(item, index)| format(&mut text, index, item)).map(|()| text)
        });
        for piece in pieces.collect::<Vec<_>>() {
            out.write_all(&piece?)?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod test_mesh;
