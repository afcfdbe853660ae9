//! Stanford PLY, binary little-endian. Written here: the format is a short header and packed numbers, while the PLY
//! crates build a map of properties for every vertex.

use std::io::{self, Write};

use firstbounce_core::Mesh;

use super::{AXES, unit, write_all};
use crate::set::Encoding;

/// Writes float x, y, z, then nx, ny, nz and uchar red, green, blue where the mesh has them, and triangles of int.
///
/// # Errors
/// Those of `out`.
pub fn ply_into(out: &mut impl Write, mesh: &Mesh) -> io::Result<()> {
    write!(out, "ply\nformat binary_little_endian 1.0\ncomment Firstbounce mesh\ncomment unit: {}\n", unit(mesh))?;
    write!(out, "comment axes: {AXES}\ncomment colours: sRGB\nelement vertex {}\n", mesh.positions.len())?;
    properties(out, "float", &["x", "y", "z"])?;
    if !mesh.normals.is_empty() {
        properties(out, "float", &["nx", "ny", "nz"])?;
    }
    if !mesh.colours.is_empty() {
        properties(out, "uchar", &["red", "green", "blue"])?;
    }
    write!(out, "element face {}\nproperty list uchar int vertex_indices\nend_header\n", mesh.triangles.len())?;

    write_all(out, &mesh.positions, |bytes, index, position| {
        let normal = mesh.normals.get(index).into_iter().flat_map(|normal| normal.iter());
        bytes.extend(position.iter().chain(normal).flat_map(|value| value.to_le_bytes()));
        if let Some(colour) = mesh.colours.get(index) {
            bytes.extend(colour.map(|light| (Encoding::Srgb.encode(light.clamp(0.0, 1.0)) * 255.0).round() as u8));
        }
        Ok(())
    })?;
    write_all(out, &mesh.triangles, |bytes, _, triangle| {
        bytes.push(3);
        bytes.extend_from_slice(triangle.map(u32::to_le_bytes).as_flattened());
        Ok(())
    })
}

fn properties(out: &mut impl Write, kind: &str, names: &[&str]) -> io::Result<()> {
    names.iter().try_for_each(|name| writeln!(out, "property {kind} {name}"))
}
