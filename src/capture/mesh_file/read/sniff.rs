//! Recognition of mesh files by their content.

use super::MeshProblem;

/// Length of a binary STL without its triangles, and of one triangle.
pub(super) const STL_HEADER: usize = 84;
pub(super) const STL_TRIANGLE: usize = 50;

/// The first bytes, which tell a mesh from other files.
pub(super) const START_BYTES: usize = 4096;

/// A format that can be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MeshFormat {
    /// Wavefront OBJ.
    Obj,
    /// Stanford PLY, text or binary.
    Ply,
    /// STL in words.
    StlText,
    /// STL in numbers.
    StlBinary,
    /// glTF in one binary file.
    Glb,
}

impl MeshFormat {
    /// The extensions of all.
    pub const EXTENSIONS: [&'static str; 4] = ["obj", "ply", "stl", "glb"];

    /// The extension that such a file should have.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::StlText | Self::StlBinary => "stl",
            Self::Glb => "glb",
        }
    }
}

impl std::fmt::Display for MeshFormat {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(match self {
            Self::Obj => "OBJ",
            Self::Ply => "PLY",
            Self::StlText => "STL (text)",
            Self::StlBinary => "STL (binary)",
            Self::Glb => "glTF (binary)",
        })
    }
}

/// Files that people pick by mistake.
const STRANGERS: [(&[u8], &str); 8] = [
    (b"{", "a glTF file in text, whose numbers lie elsewhere (export it as .glb)"),
    (b"\x89PNG", "a PNG picture"),
    (b"\xff\xd8\xff", "a JPEG picture"),
    (b"II*\0", "a TIFF picture"),
    (b"MM\0*", "a TIFF picture"),
    (b"\x76\x2f\x31\x01", "an EXR picture"),
    (b"PK\x03\x04", "an archive (3MF, or zip: unpack it first)"),
    (b"Kaydara FBX", "an FBX file"),
];

/// What a file of `length` bytes is that begins with `start`, of at most [`START_BYTES`]; the extension decides only where a
/// cut-off binary STL could be anything.
pub(super) fn sniff(start: &[u8], length: u64, extension: &str) -> Result<MeshFormat, MeshProblem> {
    if start.is_empty() {
        return Err(MeshProblem::EmptyFile);
    }
    if start.starts_with(b"glTF") {
        return Ok(MeshFormat::Glb);
    }
    if start.starts_with(b"ply\n") || start.starts_with(b"ply\r") {
        return Ok(MeshFormat::Ply);
    }
    // Many binary STL files begin with "solid" too, so their length is asked first.
    if stl_triangles(start).is_some_and(|count| length == (STL_HEADER + count * STL_TRIANGLE) as u64) {
        return Ok(MeshFormat::StlBinary);
    }
    // Comments may be in any encoding, but no text holds a zero byte.
    let is_text = !start.contains(&0);
    let text = without_mark(start).trim_ascii_start();
    if is_text && text.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid")) {
        return Ok(MeshFormat::StlText);
    }
    if let Some((_, looks_like)) = STRANGERS.iter().find(|(magic, _)| start.starts_with(magic)) {
        return Err(MeshProblem::UnknownFormat { looks_like });
    }
    if is_text {
        return Ok(MeshFormat::Obj);
    }
    match extension {
        "stl" => Ok(MeshFormat::StlBinary),
        _ => Err(MeshProblem::UnknownFormat { looks_like: "none of the mesh formats that can be read" }),
    }
}

/// A text without its byte order mark.
pub(super) fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// Whether any line of a text is one of an OBJ's.
pub(super) fn has_obj_line(bytes: &[u8]) -> bool {
    let is_obj_line = |line: &[u8]| line.starts_with(b"v ") || line.starts_with(b"v\t") || line.starts_with(b"f ");
    without_mark(bytes).split(|&byte| byte == b'\n').any(|line| is_obj_line(line.trim_ascii_start()))
}

/// The number of triangles that a binary STL of these bytes would have.
pub(super) fn stl_triangles(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(STL_HEADER - 4..STL_HEADER)?.first_chunk()?;
    usize::try_from(u32::from_le_bytes(*count)).ok()
}
