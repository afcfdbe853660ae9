//! Output options: the flags of `solve` that the Export step of the window has too.

use clap::{Args, ValueEnum};
use firstbounce_capture::export::OutputOptions;
use firstbounce_capture::image_file::{GreenAxis, GreyBits};
use firstbounce_capture::mesh_file::{Axes, OutputFormat};

#[derive(Args, Debug)]
#[command(next_help_heading = "Output")]
pub struct OutputArgs {
    /// Mesh formats, separated by commas
    #[arg(long, value_enum, value_delimiter = ',', default_value = "obj,ply", value_name = "FORMATS")]
    formats: Vec<Format>,
    /// Turn OBJ, PLY and STL for programs whose z axis points up; glTF keeps y up, as its standard says
    #[arg(long)]
    z_up: bool,
    /// Leave at most N triangles in the mesh files; what that costs is reported
    #[arg(long, value_name = "N")]
    triangles: Option<usize>,
    /// The albedo as the texture of OBJ and glTF
    #[arg(long, value_enum, default_value_t = Texture::Eight)]
    texture: Texture,
    /// Write the depth as a 16-bit PNG too; its scale and offset are in the file and in the report
    #[arg(long)]
    depth_png: bool,
    /// Write normals.png with green down, as DirectX reads it, instead of up, as OpenGL does
    #[arg(long)]
    directx: bool,
    /// Write a light file (lights-COLOUR.lp) for each colour, not only lights.lp for the reference colour
    #[arg(long)]
    lights_per_colour: bool,
}

/// The formats by their extensions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Text, with normals and the albedo as a texture; every modeller reads it
    Obj,
    /// Small, with albedo and predicted noise for each vertex; for MeshLab and CloudCompare
    Ply,
    /// Triangles alone; for printing and CAD
    Stl,
    /// glTF in metres, one file with texture; for the web and for viewers
    Glb,
    /// No mesh
    None,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Texture {
    /// Colours at the vertices instead
    None,
    /// 8 bits, which every program reads
    #[value(name = "8")]
    Eight,
    /// 16 bits for OBJ; glTF keeps 8
    #[value(name = "16")]
    Sixteen,
}

impl OutputArgs {
    /// As the pipeline takes them.
    pub fn options(&self) -> OutputOptions {
        let mut formats = Vec::new();
        for format in self.formats.iter().filter_map(|format| format.of_file()) {
            if !formats.contains(&format) {
                formats.push(format);
            }
        }
        OutputOptions {
            green: if self.directx { GreenAxis::Down } else { GreenAxis::Up },
            formats,
            axes: if self.z_up { Axes::ZUp } else { Axes::YUp },
            triangles: self.triangles,
            texture: match self.texture {
                Texture::None => None,
                Texture::Eight => Some(GreyBits::Eight),
                Texture::Sixteen => Some(GreyBits::Sixteen),
            },
            depth_png: self.depth_png,
            lights_per_colour: self.lights_per_colour,
        }
    }
}

impl Format {
    fn of_file(self) -> Option<OutputFormat> {
        match self {
            Self::Obj => Some(OutputFormat::Obj),
            Self::Ply => Some(OutputFormat::Ply),
            Self::Stl => Some(OutputFormat::Stl),
            Self::Glb => Some(OutputFormat::Glb),
            Self::None => None,
        }
    }
}
