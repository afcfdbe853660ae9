//! The formats that meshes are written in.

use std::fmt;

use firstbounce_core::mesh::LengthUnit;
use serde::{Deserialize, Serialize};

/// Where the axes of a mesh file point.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Axes {
    /// The object frame as it is.
    #[default]
    YUp,
    /// For programs whose z axis points up: a quarter turn about x.
    ZUp,
}

impl Axes {
    /// For the user and for the header of a file.
    pub fn words(self) -> &'static str {
        match self {
            Self::YUp => "x right, y up, z toward the camera",
            Self::ZUp => "x right, z up, y away from the camera",
        }
    }
}

/// The mesh formats that are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum OutputFormat {
    /// Wavefront OBJ.
    Obj,
    /// Stanford PLY, binary.
    Ply,
    /// STL, binary.
    Stl,
    /// glTF 2.0, binary.
    Glb,
}

impl OutputFormat {
    /// Every format.
    pub const ALL: [Self; 4] = [Self::Obj, Self::Ply, Self::Stl, Self::Glb];

    /// How such files end, without the dot.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::Stl => "stl",
            Self::Glb => "glb",
        }
    }

    /// What the format holds, and what it is good for.
    pub fn purpose(self) -> &'static str {
        match self {
            Self::Obj => "Text with normals and the albedo as a texture; every modeller reads it",
            Self::Ply => "Small, with albedo and predicted noise for each vertex; for MeshLab and CloudCompare",
            Self::Stl => "Triangles alone; for printing and CAD",
            Self::Glb => "One file with texture, for the web and for viewers",
        }
    }

    /// The axes that a file of this format has where these are asked for: glTF's standard says y up.
    pub fn axes(self, asked: Axes) -> Axes {
        if self == Self::Glb { Axes::YUp } else { asked }
    }

    /// The unit of a file of this format whose mesh is in `unit`.
    pub fn unit(self, unit: LengthUnit) -> &'static str {
        match (self, unit) {
            (Self::Glb, LengthUnit::Millimetre) => "m",
            (Self::Glb, LengthUnit::Pixel) => "m, a pixel as 0.001 m, for no scale is known",
            (_, LengthUnit::Millimetre) => "mm",
            (_, LengthUnit::Pixel) => "px, for no scale is known",
        }
    }
}

impl fmt::Display for OutputFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Obj => "OBJ",
            Self::Ply => "PLY",
            Self::Stl => "STL",
            Self::Glb => "glTF",
        })
    }
}
