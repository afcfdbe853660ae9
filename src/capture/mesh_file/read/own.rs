//! The headers of this program's own mesh files: unit and axes, which other programs do not state.

use super::MeshFormat;

/// The header's length in bytes is below this; quality's meaning, after what is looked for here, may make it longer.
const LONGEST: usize = 1024;
/// Length of a binary STL's words.
const STL_WORDS: usize = 80;

/// The unit and the axes that this program wrote a mesh in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Header {
    /// This program wrote the file.
    pub is_own: bool,
    /// Lengths are in pixels, for the camera had no scale.
    pub in_pixels: bool,
    /// z points up.
    pub z_up: bool,
}

impl Header {
    /// What a file's first lines say; that of another program says nothing.
    pub(super) fn of(bytes: &[u8], format: MeshFormat) -> Self {
        let length = if format == MeshFormat::StlBinary { STL_WORDS } else { LONGEST };
        let start = String::from_utf8_lossy(&bytes[..bytes.len().min(length)]).into_owned();
        let is_own = match format {
            MeshFormat::Obj => start.starts_with("# Firstbounce mesh\n"),
            MeshFormat::Ply => start.lines().nth(2) == Some("comment Firstbounce mesh"),
            MeshFormat::StlBinary => start.starts_with("Firstbounce mesh, "),
            // Its reader says it.
            MeshFormat::StlText | MeshFormat::Glb => false,
        };
        let says = |words: &str| is_own && start.contains(words);
        Self { is_own, in_pixels: says("unit: pixels") || says("unit pixels"), z_up: says(" x right, z up, ") }
    }
}
