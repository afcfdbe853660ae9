//! Wavefront OBJ, with the colours behind the positions as MeshLab, Blender and tobj read them.

use std::io::{self, Write};

use firstbounce_core::Mesh;

use super::{AXES, unit, write_all};
use crate::set::Encoding;

/// Writes `v x y z r g b`, `vn` and `f a//a b//b c//c` lines; normals and colours only where the mesh has them.
///
/// # Errors
/// Those of `out`.
pub fn obj_into(out: &mut impl Write, mesh: &Mesh) -> io::Result<()> {
    writeln!(out, "# Firstbounce mesh\n# unit: {}\n# axes: {AXES}\n# colours: sRGB", unit(mesh))?;
    write_all(out, &mesh.positions, |text, index, p| {
        write!(text, "v {} {} {}", p.x, p.y, p.z)?;
        if let Some(colour) = mesh.colours.get(index) {
            let [r, g, b] = colour.map(|light| Encoding::Srgb.encode(light.clamp(0.0, 1.0)));
            write!(text, " {r:.5} {g:.5} {b:.5}")?;
        }
        writeln!(text)
    })?;
    write_all(out, &mesh.normals, |text, _, n| writeln!(text, "vn {:.6} {:.6} {:.6}", n.x, n.y, n.z))?;
    write_all(out, &mesh.triangles, |text, _, triangle| {
        // OBJ counts from 1.
        let [a, b, c] = triangle.map(|index| u64::from(index) + 1);
        if mesh.normals.is_empty() {
            writeln!(text, "f {a} {b} {c}")
        } else {
            writeln!(text, "f {a}//{a} {b}//{b} {c}//{c}")
        }
    })
}
