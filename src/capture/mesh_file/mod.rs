//! Meshes in ([`read`]), and out as OBJ (text, read by everything), PLY (binary, small), STL and glTF.
//!
//! Vertex colours go out sRGB-encoded: viewers and modellers show or decode them as such.

mod format;
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
use firstbounce_core::mesh::topology::MeshFault;
use rayon::prelude::*;

pub use format::{Axes, OutputFormat};
pub use gltf::Embedded;
pub use obj::Material;
pub use ply::Quality;

/// How triangles lie, for the header of a file.
const WINDING: &str = "triangles wind counter-clockwise seen from outside";

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

/// A mesh and what goes into its file with it.
#[derive(Clone, Copy, Debug)]
pub struct MeshContents<'a> {
    /// The mesh in the object frame: x right, y up, z toward the camera.
    pub mesh: &'a Mesh,
    /// The axes of the file; glTF keeps its own, y up.
    pub axes: Axes,
    /// The texture of an OBJ, whose files lie beside it.
    pub material: Option<Material<'a>>,
    /// The texture of a glTF, within it.
    pub embedded: Option<Embedded<'a>>,
    /// A number for each vertex of a PLY.
    pub quality: Option<Quality<'a>>,
}

impl<'a> MeshContents<'a> {
    /// The mesh alone.
    pub fn of(mesh: &'a Mesh) -> Self {
        Self { mesh, axes: Axes::default(), material: None, embedded: None, quality: None }
    }
}

/// Writes a mesh as a file of this format; what the format has no place for is left out.
///
/// # Errors
/// [`MeshFileError`] for a mesh that does not hold together, or with the system's reason; .glb ends at 4 GiB.
pub fn write_mesh(path: &Path, format: OutputFormat, contents: &MeshContents) -> Result<(), MeshFileError> {
    let MeshContents { mesh, axes, material, embedded, quality } = *contents;
    if let Some(fault) = mesh.fault() {
        return Err(MeshFileError::Fault { path: path.to_owned(), fault });
    }
    let unwritable = |error: io::Error| MeshFileError::Unwritable { path: path.to_owned(), reason: error.to_string() };
    let mut out = BufWriter::new(File::create(path).map_err(unwritable)?);
    let axes = format.axes(axes);
    let turned = (axes == Axes::ZUp).then(|| mesh.clone().with_z_up());
    let mesh = turned.as_ref().unwrap_or(mesh);
    let written = match format {
        OutputFormat::Obj => obj::obj_into(&mut out, mesh, axes, material),
        OutputFormat::Ply => ply::ply_into(&mut out, mesh, axes, quality),
        OutputFormat::Stl => stl::stl_into(&mut out, mesh, axes),
        OutputFormat::Glb => gltf::glb_into(&mut out, mesh, embedded),
    };
    written.and_then(|()| out.flush()).map_err(unwritable)
}

/// Writes `mesh` as an OBJ file, textured where `material` says so.
///
/// # Errors
/// As [`write_mesh`].
pub fn write_obj(path: &Path, mesh: &Mesh, material: Option<Material>) -> Result<(), MeshFileError> {
    write_mesh(path, OutputFormat::Obj, &MeshContents { material, ..MeshContents::of(mesh) })
}

/// Writes `mesh` as a binary little-endian PLY file, with a number for each vertex where `quality` gives one.
///
/// # Errors
/// As [`write_mesh`].
pub fn write_ply(path: &Path, mesh: &Mesh, quality: Option<Quality>) -> Result<(), MeshFileError> {
    write_mesh(path, OutputFormat::Ply, &MeshContents { quality, ..MeshContents::of(mesh) })
}

/// Writes `mesh` as a binary STL file.
///
/// # Errors
/// As [`write_mesh`].
pub fn write_stl(path: &Path, mesh: &Mesh) -> Result<(), MeshFileError> {
    write_mesh(path, OutputFormat::Stl, &MeshContents::of(mesh))
}

/// Writes `mesh` as a binary glTF 2.0 file, in metres.
///
/// # Errors
/// As [`write_mesh`].
pub fn write_glb(path: &Path, mesh: &Mesh) -> Result<(), MeshFileError> {
    write_mesh(path, OutputFormat::Glb, &MeshContents::of(mesh))
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
