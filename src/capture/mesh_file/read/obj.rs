//! Wavefront OBJ.

use firstbounce_core::image::colour::linear_from_srgb;
use tobj::LoadOptions;

use super::{MeshFormat, MeshProblem, RawMesh};

/// Reads all objects of a file as one mesh. Colours behind the positions count as sRGB, as other programs write them.
pub(super) fn parse(bytes: &[u8]) -> Result<RawMesh, MeshProblem> {
    let text = String::from_utf8_lossy(bytes);
    let faces = check_faces(&text)?;
    let options = LoadOptions { triangulate: true, ignore_points: true, ignore_lines: true, ..LoadOptions::default() };
    let no_materials = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
    let (models, _) = tobj::load_obj_buf(&mut text.as_bytes(), &options, no_materials)
        .map_err(|error| malformed(format!("{error}")))?;

    let mut raw = RawMesh { polygons: faces.polygons, ..RawMesh::default() };
    let all_coloured = models.iter().all(|model| model.mesh.vertex_color.len() == model.mesh.positions.len());
    for mesh in models.iter().map(|model| &model.mesh) {
        let first = raw.positions.len() as u32;
        raw.positions.extend(mesh.positions.as_chunks::<3>().0.iter().map(|p| p.map(f64::from)));
        raw.triangles.extend(mesh.indices.as_chunks::<3>().0.iter().map(|corners| corners.map(|index| first + index)));
        if all_coloured {
            raw.colours.extend(mesh.vertex_color.as_chunks::<3>().0.iter().map(|rgb| rgb.map(linear_from_srgb)));
        }
        if faces.all_have_normals {
            raw.normals.resize(raw.positions.len(), [0.0; 3]);
            for (&vertex, &normal) in mesh.indices.iter().zip(&mesh.normal_indices) {
                let sum = raw.normals.get_mut((first + vertex) as usize);
                let normal = mesh.normals.as_chunks::<3>().0.get(normal as usize);
                if let (Some(sum), Some(normal)) = (sum, normal) {
                    (0..3).for_each(|axis| sum[axis] += normal[axis]);
                }
            }
        }
    }
    Ok(raw)
}

fn malformed(reason: String) -> MeshProblem {
    MeshProblem::Malformed { format: MeshFormat::Obj, reason }
}

struct Faces {
    polygons: usize,
    all_have_normals: bool,
}

/// Checks every index of every face against the vertices above or below it: tobj computes with them before it checks,
/// names no line, and makes up normals that are missing.
fn check_faces(text: &str) -> Result<Faces, MeshProblem> {
    let mut totals = [0i64; 3];
    let kind =
        |line: &str| ["v", "vt", "vn"].iter().position(|&keyword| line.split_whitespace().next() == Some(keyword));
    text.lines().filter_map(kind).for_each(|kind| totals[kind] += 1);

    let mut so_far = [0i64; 3];
    let mut faces = Faces { polygons: 0, all_have_normals: totals[2] > 0 };
    for (number, line) in text.lines().enumerate() {
        if let Some(kind) = kind(line) {
            so_far[kind] += 1;
        }
        let Some(corners) = line.trim_start().strip_prefix("f ") else { continue };
        let mut count = 0;
        for corner in corners.split('#').next().unwrap_or_default().split_whitespace() {
            count += 1;
            faces.all_have_normals &= corner.split('/').nth(2).is_some_and(|normal| !normal.is_empty());
            for (kind, index) in corner.split('/').take(3).enumerate().filter(|(_, index)| !index.is_empty()) {
                let Ok(index) = index.parse::<i64>() else {
                    return Err(malformed(format!("line {}: \"{corner}\" is not a corner of a face", number + 1)));
                };
                let names = ["vertex", "texture coordinate", "normal"][kind];
                let exists = if index < 0 { -index <= so_far[kind] } else { (1..=totals[kind]).contains(&index) };
                if !exists {
                    let (line, total) = (number + 1, totals[kind]);
                    return Err(malformed(format!("line {line}: a face names {names} {index}, and there are {total}")));
                }
            }
        }
        faces.polygons += usize::from(count > 3);
    }
    Ok(faces)
}
