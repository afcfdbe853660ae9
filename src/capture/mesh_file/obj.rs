//! Wavefront OBJ, with the colours behind the positions as MeshLab, Blender and tobj read them.

use std::io::{self, Write};

use firstbounce_core::Mesh;

use super::{Axes, WINDING, unit, write_all};
use crate::set::Encoding;

/// A texture for an OBJ file.
#[derive(Clone, Copy, Debug)]
pub struct Material<'a> {
    /// The name of the material library's file, beside the OBJ.
    pub library: &'a str,
    /// The material's name in there.
    pub name: &'a str,
    /// For each vertex its place in the texture: right from the left edge, up from the lower edge, both 0 to 1.
    pub uv: &'a [[f32; 2]],
}

impl Material<'_> {
    /// The text of the library: one matte material whose colour is the picture `texture`, a file beside it.
    pub fn library_text(&self, texture: &str) -> String {
        format!("# Firstbounce material\nnewmtl {}\nKd 1 1 1\nillum 1\nmap_Kd {texture}\n", self.name)
    }
}

/// Writes `v x y z r g b`, `vt`, `vn` and `f a/a/a b/b/b c/c/c` lines; normals, colours and texture only where there are
/// some, and of colours and texture the texture: programs that read both multiply them.
///
/// # Errors
/// Those of `out`, or `InvalidInput` for a texture place that a vertex lacks.
pub(super) fn obj_into(out: &mut impl Write, mesh: &Mesh, axes: Axes, material: Option<Material>) -> io::Result<()> {
    let uv = material.map_or(&[][..], |material| material.uv);
    if material.is_some() && uv.len() != mesh.positions.len() {
        let reason = format!("{} texture places for {} vertices", uv.len(), mesh.positions.len());
        return Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
    }
    writeln!(out, "# Firstbounce mesh\n# unit: {}\n# axes: {}; {WINDING}\n# colours: sRGB", unit(mesh), axes.words())?;
    let colours = if material.is_some() { &[][..] } else { &mesh.colours };
    if let Some(Material { library, name, .. }) = material {
        writeln!(out, "mtllib {library}\nusemtl {name}")?;
    }
    write_all(out, &mesh.positions, |text, index, p| {
        write!(text, "v {} {} {}", p.x, p.y, p.z)?;
        if let Some(colour) = colours.get(index) {
            let [r, g, b] = colour.map(|light| Encoding::Srgb.encode(light.clamp(0.0, 1.0)));
            write!(text, " {r:.5} {g:.5} {b:.5}")?;
        }
        writeln!(text)
    })?;
    write_all(out, uv, |text, _, [u, v]| writeln!(text, "vt {u} {v}"))?;
    write_all(out, &mesh.normals, |text, _, n| writeln!(text, "vn {:.6} {:.6} {:.6}", n.x, n.y, n.z))?;
    write_all(out, &mesh.triangles, |text, _, triangle| {
        // OBJ counts from 1.
        let [a, b, c] = triangle.map(|index| u64::from(index) + 1);
        match (uv.is_empty(), mesh.normals.is_empty()) {
            (true, true) => writeln!(text, "f {a} {b} {c}"),
            (true, false) => writeln!(text, "f {a}//{a} {b}//{b} {c}//{c}"),
            (false, true) => writeln!(text, "f {a}/{a} {b}/{b} {c}/{c}"),
            (false, false) => writeln!(text, "f {a}/{a}/{a} {b}/{b}/{b} {c}/{c}/{c}"),
        }
    })
}
