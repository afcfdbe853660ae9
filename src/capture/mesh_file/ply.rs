//! Stanford PLY, binary little-endian. Written here: the format is a short header and packed numbers, while the PLY
//! crates build a map of properties for every vertex.

use std::io::{self, Write};

use firstbounce_core::Mesh;

use super::{Axes, WINDING, unit, write_all};
use crate::set::Encoding;

/// A number for each vertex, under the name that MeshLab and CloudCompare show as a scalar.
#[derive(Clone, Copy, Debug)]
pub struct Quality<'a> {
    /// As many as the mesh has vertices.
    pub values: &'a [f32],
    /// One line, for the header.
    pub meaning: &'a str,
}

/// Writes float x, y, z, then nx, ny, nz and uchar red, green, blue where the mesh has them, float quality where it is
/// given, and triangles of int.
///
/// # Errors
/// Those of `out`, or `InvalidInput` for a quality of another length than the mesh.
pub(super) fn ply_into(out: &mut impl Write, mesh: &Mesh, axes: Axes, quality: Option<Quality>) -> io::Result<()> {
    let values = quality.map_or(&[][..], |quality| quality.values);
    if quality.is_some() && values.len() != mesh.positions.len() {
        let reason = format!("{} quality values for {} vertices", values.len(), mesh.positions.len());
        return Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
    }
    write!(out, "ply\nformat binary_little_endian 1.0\ncomment Firstbounce mesh\ncomment unit: {}\n", unit(mesh))?;
    write!(out, "comment axes: {}; {WINDING}\ncomment colours: sRGB\n", axes.words())?;
    if let Some(quality) = quality {
        writeln!(out, "comment quality: {}", quality.meaning)?;
    }
    writeln!(out, "element vertex {}", mesh.positions.len())?;
    properties(out, "float", &["x", "y", "z"])?;
    if !mesh.normals.is_empty() {
        properties(out, "float", &["nx", "ny", "nz"])?;
    }
    if !mesh.colours.is_empty() {
        properties(out, "uchar", &["red", "green", "blue"])?;
    }
    if quality.is_some() {
        properties(out, "float", &["quality"])?;
    }
    write!(out, "element face {}\nproperty list uchar int vertex_indices\nend_header\n", mesh.triangles.len())?;

    write_all(out, &mesh.positions, |bytes, index, position| {
        let normal = mesh.normals.get(index).into_iter().flat_map(|normal| normal.iter());
        bytes.extend(position.iter().chain(normal).flat_map(|value| value.to_le_bytes()));
        if let Some(colour) = mesh.colours.get(index) {
            bytes.extend(colour.map(|light| (Encoding::Srgb.encode(light.clamp(0.0, 1.0)) * 255.0).round() as u8));
        }
        bytes.extend(values.get(index).into_iter().flat_map(|value| value.to_le_bytes()));
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
