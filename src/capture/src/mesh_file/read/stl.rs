//! STL: triangles without shared vertices.

use std::io::Cursor;

use super::sniff::{STL_HEADER, STL_TRIANGLE, stl_triangles};
use super::{MeshFormat, MeshProblem, RawMesh};

/// How a text ends.
const END: &[u8] = b"endsolid";

/// Reads text, whatever its first line is after "solid".
pub(super) fn parse_text(bytes: &[u8]) -> Result<RawMesh, MeshProblem> {
    if !bytes.windows(END.len()).any(|window| window == END) {
        let reason = "it ends without \"endsolid\", so it is cut off; export or copy it again".to_owned();
        return Err(MeshProblem::Malformed { format: MeshFormat::StlText, reason });
    }
    let after_first_line = bytes.iter().position(|&byte| byte == b'\n').map_or(&[][..], |end| &bytes[end..]);
    // The reader takes a file for text only if a space follows "solid", which a nameless solid lacks.
    read([b"solid mesh".as_slice(), after_first_line].concat(), MeshFormat::StlText)
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
