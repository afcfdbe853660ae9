//! Reads a scan: OBJ, PLY, STL or GLB, told apart by what the file contains.

mod clean;
mod contents;
mod error;
mod glb;
mod obj;
mod own;
mod ply;
mod sniff;
mod stl;

use std::path::Path;

use firstbounce_core::Mesh;
use firstbounce_core::mesh::LengthUnit;
use serde::{Deserialize, Serialize};

pub use error::{MeshError, MeshProblem, MeshWarning};
pub use sniff::MeshFormat;

use crate::guard::{Panicked, guarded};

use own::Header;

/// What one unit of a file's coordinates is. No mesh format but glTF says so itself: the person must, except for a file of
/// this program's own that is in pixels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum LengthScale {
    /// 1 mm.
    #[default]
    Millimetre,
    /// 10 mm.
    Centimetre,
    /// 1000 mm.
    Metre,
    /// 25.4 mm.
    Inch,
}

impl LengthScale {
    /// All, in the order of a choice.
    pub const ALL: [Self; 4] = [Self::Millimetre, Self::Centimetre, Self::Metre, Self::Inch];

    /// What it is called.
    pub fn name(self) -> &'static str {
        match self {
            Self::Millimetre => "mm",
            Self::Centimetre => "cm",
            Self::Metre => "m",
            Self::Inch => "inches",
        }
    }

    /// The length of one unit.
    pub fn millimetres(self) -> f64 {
        match self {
            Self::Millimetre => 1.0,
            Self::Centimetre => 10.0,
            Self::Metre => 1000.0,
            Self::Inch => 25.4,
        }
    }
}

/// A mesh that was read, in mm, welded: one vertex for each position. In pixels only where its file says so, see
/// [`read_mesh`].
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFile {
    /// The surface; with unit normals for all vertices.
    pub mesh: Mesh,
    /// What the file is.
    pub format: MeshFormat,
    /// Whether this program wrote it: it then lies in the frame of the camera that saw it.
    pub is_own: bool,
    /// What was put right, or is odd; each one a line by `Display`.
    pub warnings: Vec<MeshWarning>,
}

/// Reads an OBJ, PLY (text or binary) or STL (text or binary) file whose lengths are in `scale`, or a GLB, whose lengths are
/// in metres.
///
/// Polygons are split into triangles from their first corner, vertices at one position are joined, colours become
/// linear, and normals that the file lacks are computed. A file that this program wrote states its axes, and is turned back
/// from z up; and that it is in pixels, unless it is given a unit other than the default.
///
/// # Errors
/// The file's path with one line that says what is wrong: not readable, none of these formats, cut off, without a
/// surface, with coordinates that are no numbers, or with triangles whose vertices do not exist.
pub fn read_mesh(path: &Path, scale: LengthScale) -> Result<MeshFile, MeshError> {
    let file = read_mesh_or_points(path, scale)?;
    match file.mesh.fault() {
        None => Ok(file),
        Some(fault) => Err(MeshError { path: path.to_owned(), problem: MeshProblem::Fault(fault) }),
    }
}

/// The same, with PLY files that are clouds of points: their mesh has no triangles, and normals only where the file does.
///
/// # Errors
/// As [`read_mesh`].
pub fn read_mesh_or_points(path: &Path, scale: LengthScale) -> Result<MeshFile, MeshError> {
    let at_path = |problem| MeshError { path: path.to_owned(), problem };
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).unwrap_or_default();
    if path.is_dir() {
        return Err(at_path(MeshProblem::Directory));
    }
    let bytes = contents::read(path, &extension).map_err(at_path)?;
    mesh_from_bytes(&bytes, &extension, scale).map_err(at_path)
}

/// Reads a mesh from the contents of a file; `extension` (lower case, no dot) is only compared with what they are.
fn mesh_from_bytes(bytes: &[u8], extension: &str, scale: LengthScale) -> Result<MeshFile, MeshProblem> {
    let start = &bytes[..bytes.len().min(sniff::START_BYTES)];
    let format = sniff::sniff(start, bytes.len() as u64, extension)?;
    let parsed = guarded(|| {
        let raw = match format {
            MeshFormat::Glb => return glb::parse(bytes),
            MeshFormat::Obj if !sniff::has_obj_line(bytes) => {
                return Err(MeshProblem::UnknownFormat { looks_like: "a text without any vertex" });
            }
            MeshFormat::Obj => obj::parse(bytes),
            MeshFormat::Ply => ply::parse(bytes),
            MeshFormat::StlText => stl::parse_text(bytes),
            MeshFormat::StlBinary => stl::parse_binary(bytes),
        };
        Ok((raw?, Header::of(bytes, format)))
    });
    let gave_up = |Panicked| MeshProblem::Malformed { format, reason: "its reader gave up".to_owned() };
    let (raw, header) = parsed.map_err(gave_up)??;
    // glTF has one unit, and that is its own.
    let scale = if format == MeshFormat::Glb { LengthScale::Metre } else { scale };
    let is_believed = format == MeshFormat::Glb || scale == LengthScale::default();
    let is_cloud = format == MeshFormat::Ply && raw.triangles.is_empty() && !raw.positions.is_empty();
    let (mut mesh, mut warnings) = if is_cloud { clean::points(raw, scale)? } else { clean::clean(raw, scale)? };
    if header.in_pixels && is_believed {
        mesh.unit = LengthUnit::Pixel;
        warnings.push(MeshWarning::InPixels);
    }
    if header.z_up {
        mesh = mesh.with_y_up();
        warnings.push(MeshWarning::TurnedBack);
    }
    if !extension.is_empty() && extension != format.extension() {
        warnings.insert(0, MeshWarning::WrongExtension { extension: extension.to_owned(), format });
    }
    Ok(MeshFile { mesh, format, is_own: header.is_own, warnings })
}

/// What a format's own reader hands over: in the file's unit, nothing checked or joined yet.
#[derive(Debug, Default)]
struct RawMesh {
    positions: Vec<[f64; 3]>,
    /// Per vertex, not necessarily of unit length, or empty.
    normals: Vec<[f32; 3]>,
    /// Linear, per vertex, or empty.
    colours: Vec<[f32; 3]>,
    triangles: Vec<[u32; 3]>,
    /// Faces of more than three corners that became several of `triangles`.
    polygons: usize,
}

impl RawMesh {
    /// Adds a face as a fan of triangles from its first corner. Fewer than three corners are no surface.
    fn add_face(&mut self, corners: &[u32]) {
        if let [first, rest @ ..] = corners {
            self.triangles.extend(rest.windows(2).map(|edge| [*first, edge[0], edge[1]]));
        }
        self.polygons += usize::from(corners.len() > 3);
    }
}

#[cfg(test)]
mod tests;
