//! Meshes in ([`read`]), and out as OBJ (text, read by everything), PLY (binary, small), STL and glTF.
//!
//! Vertex colours go out sRGB-encoded: viewers and modellers show or decode them as such.

mod gltf;
mod obj;
mod ply;
pub mod read;
mod stl;

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use firstbounce_core::Mesh;
use firstbounce_core::mesh::LengthUnit;
use firstbounce_core::mesh_topology::MeshFault;
use rayon::prelude::*;

pub use obj::Material;
pub use ply::Quality;

/// How the axes of a mesh lie, for the header of its file.
const AXES: &str = "x right, y up, z toward the camera; triangles wind counter-clockwise seen from outside";

/// How many lines or records a core formats at a time.
const PIECE: usize = 1 << 12;
/// How many pieces are formatted before they are written, which bounds the memory.
const PIECES: usize = 64;

/// Why a mesh could not be written. Every message is one line.
#[derive(Debug, thiserror::Error)]
pub enum MeshFileError {
    /// The mesh does not hold together.
    #[error("{}: not written, for the mesh {fault}", path.display())]
    Fault {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        fault: MeshFault,
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

/// Writes `mesh` as an OBJ file, textured where `material` says so.
///
/// # Errors
/// [`MeshFileError`] for a mesh that does not hold together, or with the system's reason.
pub fn write_obj(path: &Path, mesh: &Mesh, material: Option<Material>) -> Result<(), MeshFileError> {
    write_file(path, mesh, |out| obj::obj_into(out, mesh, material))
}

/// Writes `mesh` as a binary little-endian PLY file, with a number for each vertex where `quality` gives one.
///
/// # Errors
/// As [`write_obj`].
pub fn write_ply(path: &Path, mesh: &Mesh, quality: Option<Quality>) -> Result<(), MeshFileError> {
    write_file(path, mesh, |out| ply::ply_into(out, mesh, quality))
}

/// Writes `mesh` as a binary STL file.
///
/// # Errors
/// As [`write_obj`].
pub fn write_stl(path: &Path, mesh: &Mesh) -> Result<(), MeshFileError> {
    write_file(path, mesh, |out| stl::stl_into(out, mesh))
}

/// Writes `mesh` as a binary glTF 2.0 file, in metres.
///
/// # Errors
/// As [`write_obj`]; the format ends at 4 GiB.
pub fn write_glb(path: &Path, mesh: &Mesh) -> Result<(), MeshFileError> {
    write_file(path, mesh, |out| gltf::glb_into(out, mesh))
}

fn write_file(
    path: &Path,
    mesh: &Mesh,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<(), MeshFileError> {
    if let Some(fault) = mesh.fault() {
        return Err(MeshFileError::Fault { path: path.to_owned(), fault });
    }
    let unwritable = |error: io::Error| MeshFileError::Unwritable { path: path.to_owned(), reason: error.to_string() };
    let mut out = BufWriter::new(File::create(path).map_err(unwritable)?);
    write(&mut out).and_then(|()| out.flush()).map_err(unwritable)
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
