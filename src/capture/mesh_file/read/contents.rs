//! The bytes of a mesh file: no more of them than a mesh may have, and none beyond those that show that it is no mesh.

use std::io::{self, Read};
use std::path::Path;

use super::sniff::{START_BYTES, STL_HEADER, STL_TRIANGLE, sniff, stl_triangles};
use super::{MeshFormat, MeshProblem};
use crate::open::{OpenError, open_file};

/// The longest mesh file that is read: about 60 million triangles as text.
const MAX_MESH_BYTES: u64 = 8 << 30;

/// What is read of a text at a time.
const CHUNK_BYTES: u64 = 16 << 20;

/// Reads the file at `path`; `extension` (lower case, no dot) is only compared with what it is.
pub(super) fn read(path: &Path, extension: &str) -> Result<Vec<u8>, MeshProblem> {
    let (file, length) = open_file(path, MAX_MESH_BYTES).map_err(|error| match error {
        OpenError::TooLong { max_bytes } => MeshProblem::TooLong { max_bytes },
        error => MeshProblem::Unreadable { reason: error.to_string() },
    })?;
    // The stated length is no promise: some files of the system state none and never end.
    let mut rest = file.take(MAX_MESH_BYTES + 1);
    let mut bytes = Vec::new();
    append(&mut bytes, &mut rest, START_BYTES as u64)?;
    match sniff(&bytes, length, extension)? {
        format @ (MeshFormat::Obj | MeshFormat::StlText) => append_text(&mut bytes, &mut rest, format)?,
        // What follows the last triangle says nothing.
        MeshFormat::StlBinary => {
            let promised = stl_triangles(&bytes).map_or(0, |count| STL_HEADER + count * STL_TRIANGLE);
            let missing = promised.saturating_sub(bytes.len());
            append(&mut bytes, &mut rest, missing as u64)?;
        }
        MeshFormat::Ply | MeshFormat::Glb => append(&mut bytes, &mut rest, u64::MAX)?,
    }
    if bytes.len() as u64 > MAX_MESH_BYTES {
        return Err(MeshProblem::TooLong { max_bytes: MAX_MESH_BYTES });
    }
    Ok(bytes)
}

fn append(bytes: &mut Vec<u8>, rest: &mut impl Read, at_most: u64) -> Result<(), MeshProblem> {
    let unreadable = |error: io::Error| MeshProblem::Unreadable { reason: error.to_string() };
    rest.take(at_most).read_to_end(bytes).map(drop).map_err(unreadable)
}

/// The same up to the first zero byte, which no text holds.
fn append_text(bytes: &mut Vec<u8>, rest: &mut impl Read, format: MeshFormat) -> Result<(), MeshProblem> {
    loop {
        let from = bytes.len();
        append(bytes, rest, CHUNK_BYTES)?;
        if bytes.len() == from {
            return Ok(());
        }
        if let Some(offset) = bytes[from..].iter().position(|&byte| byte == 0) {
            let reason = format!("byte {} is zero, which no text holds", from + offset);
            return Err(MeshProblem::Malformed { format, reason });
        }
    }
}
