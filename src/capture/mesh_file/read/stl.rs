//! STL: triangles without shared vertices.

use std::collections::HashMap;
use std::io::Cursor;

use super::sniff::{STL_HEADER, STL_TRIANGLE, stl_triangles};
use super::{MeshFormat, MeshProblem, RawMesh};

/// A normal of a binary triangle, which the triangle says better.
const STL_NORMAL: usize = 12;

/// Reads text of one or more solids as one mesh, whatever they are called. Only corners count: normals, colours and the
/// capitals of words are passed over, as programs differ in them.
pub(super) fn parse_text(bytes: &[u8]) -> Result<RawMesh, MeshProblem> {
    let text = String::from_utf8_lossy(bytes);
    let mut raw = RawMesh::default();
    let mut known: HashMap<[u32; 3], u32> = HashMap::new();
    let mut corners: Vec<u32> = Vec::new();
    let (mut begun, mut ended) = (0, 0);
    let mut lines = (1..).zip(text.lines()).peekable();
    while let Some((number, line)) = lines.next() {
        let mut words = line.split_whitespace();
        let word = words.next().unwrap_or_default().to_ascii_lowercase();
        match word.as_str() {
            "solid" => begun += 1,
            "endsolid" => ended += 1,
            "end" if words.next().is_some_and(|next| next.eq_ignore_ascii_case("solid")) => ended += 1,
            "outer" => corners.clear(),
            "vertex" => {
                let Some(point) = point_of(words) else {
                    return Err(match lines.peek() {
                        Some(_) => malformed(format!("line {number}: expected vertex x y z")),
                        None => cut_off(),
                    });
                };
                // STL repeats a corner for each of its triangles: equal ones are one vertex.
                let next = raw.positions.len() as u32;
                let vertex = *known.entry(point.map(|x| (x as f32).to_bits())).or_insert(next);
                if vertex == next {
                    raw.positions.push(point);
                }
                corners.push(vertex);
            }
            "endloop" | "endfacet" if !corners.is_empty() => {
                if corners.len() < 3 {
                    return Err(malformed(format!("line {number}: a facet of {} corners", corners.len())));
                }
                raw.add_face(&corners);
                corners.clear();
            }
            // A nameless "solidbox" is a solid too.
            word if word.starts_with("solid") => begun += 1,
            word if word.starts_with("endsolid") => ended += 1,
            _ => {}
        }
    }
    if ended < begun.max(1) || !corners.is_empty() {
        return Err(cut_off());
    }
    Ok(raw)
}

fn point_of<'w>(words: impl Iterator<Item = &'w str>) -> Option<[f64; 3]> {
    let numbers: Vec<f64> = words.map_while(|word| word.parse().ok()).take(3).collect();
    numbers.try_into().ok()
}

fn malformed(reason: String) -> MeshProblem {
    MeshProblem::Malformed { format: MeshFormat::StlText, reason }
}

fn cut_off() -> MeshProblem {
    malformed("it ends without \"endsolid\", so it is cut off; export or copy it again".into())
}

/// Reads numbers, even where the header begins like a text.
pub(super) fn parse_binary(bytes: &[u8]) -> Result<RawMesh, MeshProblem> {
    let promised = stl_triangles(bytes).map_or(STL_HEADER, |count| STL_HEADER + count * STL_TRIANGLE);
    if bytes.len() < promised {
        let (promised, found) = (promised as u64, bytes.len() as u64);
        return Err(MeshProblem::Truncated { what: "bytes".to_owned(), promised, found });
    }
    let mut numbers = [&[0; STL_HEADER - 4], &bytes[STL_HEADER - 4..promised]].concat();
    // Some programs write normals that are no numbers.
    numbers[STL_HEADER..].chunks_mut(STL_TRIANGLE).for_each(|triangle| triangle[..STL_NORMAL].fill(0));
    let malformed =
        |error: std::io::Error| MeshProblem::Malformed { format: MeshFormat::StlBinary, reason: error.to_string() };
    let stl = stl_io::read_stl(&mut Cursor::new(numbers)).map_err(malformed)?;
    // The reader has joined equal corners, and that is STL's nature: no warning is due.
    Ok(RawMesh {
        positions: stl.vertices.iter().map(|vertex| vertex.0.map(f64::from)).collect(),
        triangles: stl.faces.iter().map(|face| face.vertices.map(|vertex| vertex as u32)).collect(),
        ..RawMesh::default()
    })
}
