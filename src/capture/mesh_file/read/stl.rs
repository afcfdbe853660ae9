//! STL: triangles without shared vertices.

use std::io::Cursor;

use super::sniff::{STL_HEADER, STL_TRIANGLE, stl_triangles};
use super::{MeshFormat, MeshProblem, RawMesh};

/// How a solid of a text begins and ends.
const BEGIN: &[u8] = b"solid";
const END: &[u8] = b"endsolid";

/// Reads text of one or more solids as one mesh, whatever they are called.
pub(super) fn parse_text(bytes: &[u8]) -> Result<RawMesh, MeshProblem> {
    // The reader wants a space after "solid", which a nameless solid lacks, and ends with the first solid.
    let mut text = [BEGIN, b" mesh\n"].concat();
    let (mut begun, mut ended) = (0, 0);
    for line in bytes.split_inclusive(|&byte| byte == b'\n') {
        match line.split(u8::is_ascii_whitespace).find(|word| !word.is_empty()) {
            Some(word) if word.starts_with(BEGIN) => begun += 1,
            Some(word) if word.starts_with(END) => ended += 1,
            _ => text.extend(line),
        }
    }
    if ended < begun.max(1) {
        let reason = "it ends without \"endsolid\", so it is cut off; export or copy it again".to_owned();
        return Err(MeshProblem::Malformed { format: MeshFormat::StlText, reason });
    }
    text.extend([b"\n", END, b"\n"].concat());
    read(text, MeshFormat::StlText)
}

/// Reads numbers, even where the header begins like a text.
pub(super) fn parse_binary(bytes: &[u8]) -> Result<RawMesh, MeshProblem> {
    let promised = stl_triangles(bytes).map_or(STL_HEADER, |count| STL_HEADER + count * STL_TRIANGLE);
    if bytes.len() < promised {
        let (promised, found) = (promised as u64, bytes.len() as u64);
        return Err(MeshProblem::Truncated { what: "bytes".to_owned(), promised, found });
    }
    read([&[0; STL_HEADER - 4], &bytes[STL_HEADER - 4..]].concat(), MeshFormat::StlBinary)
}

fn read(bytes: Vec<u8>, format: MeshFormat) -> Result<RawMesh, MeshProblem> {
    let malformed = |error: std::io::Error| MeshProblem::Malformed { format, reason: error.to_string() };
    let mut cursor = Cursor::new(bytes);
    let stl = stl_io::read_stl(&mut cursor).map_err(malformed)?;
    // The reader has joined equal corners, and that is STL's nature: no warning is due.
    Ok(RawMesh {
        positions: stl.vertices.iter().map(|vertex| vertex.0.map(f64::from)).collect(),
        triangles: stl.faces.iter().map(|face| face.vertices.map(|vertex| vertex as u32)).collect(),
        ..RawMesh::default()
    })
}
