//! What to write, and how.

use firstbounce_core::mesh::LengthUnit;
use firstbounce_core::mesh::decimate::DecimateOptions;
use indexmap::IndexMap;
use serde::{Deserialize, Serialize};

use crate::image_file::{GreenAxis, GreyBits};
use crate::mesh_file::{Axes, OutputFormat};
use crate::pipeline::PipelineError;
use crate::report::{ExportRecord, MeshFormatRecord};

/// What to write beside bounces, normals and report, and by which conventions. The same for `solve` and for the window.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct OutputOptions {
    /// The direction of green in normals.png.
    pub green: GreenAxis,
    /// The mesh formats; none for no mesh.
    pub formats: Vec<OutputFormat>,
    /// The axes of OBJ, PLY and STL.
    pub axes: Axes,
    /// The most triangles of a mesh file; `None` for all there are.
    pub triangles: Option<usize>,
    /// The albedo as the texture of OBJ (glTF always has 8 bits), or `None` for vertex colours instead.
    pub texture: Option<GreyBits>,
    /// Whether to write the depth as a 16-bit PNG too.
    pub depth_png: bool,
    /// Whether to write a light file for each colour beside that of the reference colour.
    pub lights_per_colour: bool,
}

impl Default for OutputOptions {
    fn default() -> Self {
        Self {
            green: GreenAxis::default(),
            formats: vec![OutputFormat::Obj, OutputFormat::Ply],
            axes: Axes::default(),
            triangles: None,
            texture: Some(GreyBits::default()),
            depth_png: false,
            lights_per_colour: false,
        }
    }
}

impl OutputOptions {
    /// Whether every option is in its range.
    ///
    /// # Errors
    /// `PipelineError::Decimate` for fewer triangles than make a shape.
    pub fn check(&self) -> Result<(), PipelineError> {
        match self.triangles {
            Some(triangles) => Ok(DecimateOptions { triangles }.check()?),
            None => Ok(()),
        }
    }

    /// Whether meshes of this format are written.
    pub fn writes(&self, format: OutputFormat) -> bool {
        self.formats.contains(&format)
    }
}

/// What the options say, for the report; what they cost comes as it is written. `unit` is the meshes', if there are any.
pub(super) fn record(options: &OutputOptions, unit: Option<LengthUnit>) -> ExportRecord {
    let of_unit = |unit| {
        options.formats.iter().map(move |format| {
            let record = MeshFormatRecord { axes: format.axes(options.axes).words(), unit: format.unit(unit) };
            (format.extension(), record)
        })
    };
    ExportRecord {
        meshes: unit.into_iter().flat_map(of_unit).collect(),
        decimation: IndexMap::new(),
        depth_png: IndexMap::new(),
    }
}
