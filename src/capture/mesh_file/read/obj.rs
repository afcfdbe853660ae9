//! Wavefront OBJ.

use std::borrow::Cow;

use firstbounce_core::image::colour::linear_from_srgb;
use tobj::LoadOptions;

use super::sniff::without_mark;
use super::{MeshFormat, MeshProblem, RawMesh};

/// Reads all objects of a file as one mesh. Colours behind the positions count as sRGB, as other programs write them.
pub(super) fn parse(bytes: &[u8]) -> Result<RawMesh, MeshProblem> {
    let text = String::from_utf8_lossy(without_mark(bytes));
    let lines = check_lines(&text)?;
    let options = LoadOptions { triangulate: true, ignore_points: true, ignore_lines: true, ..LoadOptions::default() };
    let no_materials = |_: &std::path::Path| Err(tobj::LoadError::OpenFileFailed);
    let (models, _) = tobj::load_obj_buf(&mut lines.kept.as_bytes(), &options, no_materials)
        .map_err(|error| malformed(format!("{error}")))?;

    let mut raw = RawMesh { polygons: lines.polygons, ..RawMesh::default() };
    let all_coloured = models.iter().all(|model| model.mesh.vertex_color.len() == model.mesh.positions.len());
    for mesh in models.iter().map(|model| &model.mesh) {
        let first = raw.positions.len() as u32;
        raw.positions.extend(mesh.positions.as_chunks::<3>().0.iter().map(|p| p.map(f64::from)));
        raw.triangles.extend(mesh.indices.as_chunks::<3>().0.iter().map(|corners| corners.map(|index| first + index)));
        if all_coloured {
            raw.colours.extend(mesh.vertex_color.as_chunks::<3>().0.iter().map(|rgb| rgb.map(linear_from_srgb)));
        }
        if lines.all_have_normals {
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

/// What was found in the lines that are read.
struct Lines {
    /// The lines with vertices, normals, objects and faces, as every reader takes them.
    kept: String,
    polygons: usize,
    all_have_normals: bool,
}

/// A vertex with a colour: x y z r g b.
const COLOURED_WORDS: usize = 6;

/// Keeps the lines that are read, and checks every index of every face against what stands above or below it: tobj
/// computes with indices before it checks them, also with those of lines and points, names no line, and makes up
/// normals that are missing. Texture places are left out, and so are colours that only some vertices have.
fn check_lines(text: &str) -> Result<Lines, MeshProblem> {
    let lines = joined_lines(text);
    let lines = || lines.iter().map(|(number, line)| (*number, line.as_ref()));
    let mut totals = [0u64; 3];
    lines().filter_map(|(_, line)| kind_of(line)).for_each(|kind| totals[kind] += 1);
    let vertices = lines().filter(|(_, line)| kind_of(line) == Some(0));
    let all_coloured =
        vertices.map(|(_, line)| line.split_whitespace().count() - 1).all(|count| count == COLOURED_WORDS);
    let kept_words = 1 + if all_coloured { COLOURED_WORDS } else { 3 };

    let mut so_far = [0u64; 3];
    let mut found = Lines { kept: String::with_capacity(text.len()), polygons: 0, all_have_normals: totals[2] > 0 };
    for (number, line) in lines() {
        let mut words = line.split_whitespace();
        let kept: Vec<&str> = match words.next() {
            Some("v") => {
                so_far[0] += 1;
                line.split_whitespace().take(kept_words).collect()
            }
            Some("vt") => {
                so_far[1] += 1;
                continue;
            }
            Some("vn") => {
                so_far[2] += 1;
                line.split_whitespace().collect()
            }
            Some("o" | "g") => line.split_whitespace().collect(),
            Some("f") => {
                let mut corners = 0;
                for corner in words {
                    corners += 1;
                    found.all_have_normals &= normal_of(corner).is_some();
                    check_corner(corner, &so_far, &totals)
                        .map_err(|reason| malformed(format!("line {number}: {reason}")))?;
                }
                found.polygons += usize::from(corners > 3);
                line.split_whitespace().collect()
            }
            _ => continue,
        };
        let is_face = kept.first() == Some(&"f");
        for (index, word) in kept.iter().enumerate() {
            if index > 0 {
                found.kept.push(' ');
            }
            match normal_of(word).filter(|_| is_face) {
                Some(normal) => found.kept.extend([word.split('/').next().unwrap_or_default(), "//", normal]),
                None if is_face => found.kept.push_str(word.split('/').next().unwrap_or_default()),
                None => found.kept.push_str(word),
            }
        }
        found.kept.push('\n');
    }
    Ok(found)
}

/// The lines by their numbers, without comments; one that ends with a backslash goes on in the next.
fn joined_lines(text: &str) -> Vec<(usize, Cow<'_, str>)> {
    let mut joined: Vec<(usize, Cow<'_, str>)> = Vec::new();
    let mut goes_on = false;
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.split('#').next().unwrap_or_default().trim();
        let (line, continues) = line.strip_suffix('\\').map_or((line, false), |line| (line, true));
        match joined.last_mut().filter(|_| goes_on) {
            Some((_, last)) => {
                last.to_mut().push(' ');
                last.to_mut().push_str(line);
            }
            None => joined.push((number, Cow::Borrowed(line))),
        }
        goes_on = continues;
    }
    joined
}

/// The normal's index in a corner.
fn normal_of(corner: &str) -> Option<&str> {
    corner.split('/').nth(2).filter(|normal| !normal.is_empty())
}

/// Which of vertices, texture coordinates and normals the line adds to.
fn kind_of(line: &str) -> Option<usize> {
    ["v", "vt", "vn"].iter().position(|&keyword| line.split_whitespace().next() == Some(keyword))
}

/// Whether the indices of a corner name what is there: those below 0 count back from the line, the others from the
/// beginning of the file. An error says why not.
fn check_corner(corner: &str, so_far: &[u64; 3], totals: &[u64; 3]) -> Result<(), String> {
    let parts: Vec<&str> = corner.split('/').collect();
    let indices = parts.iter().enumerate().filter(|(kind, index)| *kind == 0 || !index.is_empty());
    for (kind, index) in indices {
        let (Some(name), Ok(index)) = (KINDS.get(kind), index.parse::<i64>()) else {
            return Err(format!("\"{corner}\" is not a corner of a face"));
        };
        let most = if index < 0 { so_far[kind] } else { totals[kind] };
        if !(1..=most).contains(&index.unsigned_abs()) {
            return Err(format!("a face names {name} {index}, and there are {}", totals[kind]));
        }
    }
    Ok(())
}

const KINDS: [&str; 3] = ["vertex", "texture coordinate", "normal"];
