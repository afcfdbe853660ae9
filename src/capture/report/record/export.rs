//! By which conventions the files were written, and what that cost.

use firstbounce_core::mesh::LengthUnit;
use firstbounce_core::mesh::decimate::DecimateReport;
use indexmap::IndexMap;
use serde::Serialize;

use crate::image_file::DepthScale;

/// How the meshes and the depth were written.
#[derive(Clone, Debug, Serialize)]
pub struct ExportRecord {
    /// By extension.
    pub meshes: IndexMap<&'static str, MeshFormatRecord>,
    /// By mesh, where triangles were taken away: "mesh", "mesh-raw".
    pub decimation: IndexMap<String, DecimationRecord>,
    /// By file, how the stored values of a depth PNG become depth.
    pub depth_png: IndexMap<String, DepthScale>,
}

/// The frame of a mesh file.
#[derive(Clone, Debug, Serialize)]
pub struct MeshFormatRecord {
    /// Where its axes point.
    pub axes: &'static str,
    /// Of its coordinates.
    pub unit: &'static str,
}

/// What decimation did to a mesh.
#[derive(Clone, Debug, Serialize)]
pub struct DecimationRecord {
    /// Triangles before.
    pub triangles_before: usize,
    /// Triangles left.
    pub triangles: usize,
    /// Mean distance of the full mesh's vertices from the decimated surface.
    pub mean_distance: f64,
    /// The largest such distance.
    pub largest_distance: f64,
    /// Of the distances: "mm" or "px".
    pub unit: &'static str,
}

impl ExportRecord {
    /// A line for each mesh that was decimated.
    pub fn decimation_lines(&self) -> Vec<String> {
        let line = |(name, words): (&String, &DecimationRecord)| {
            let DecimationRecord { triangles_before, triangles, mean_distance, largest_distance, unit } = words;
            if triangles == triangles_before {
                return format!("{name}: all {triangles} triangles kept, for there are no more than that");
            }
            format!(
                "{name}: {triangles} of {triangles_before} triangles; the full mesh's points lie {mean_distance:.4} \
                 {unit} from it on average, {largest_distance:.4} {unit} at most"
            )
        };
        self.decimation.iter().map(line).collect()
    }
}

impl DecimationRecord {
    /// Of a mesh in `unit`.
    pub(crate) fn of(report: &DecimateReport, unit: LengthUnit) -> Self {
        Self {
            triangles_before: report.triangles_before,
            triangles: report.triangles,
            mean_distance: report.deviation.mean,
            largest_distance: report.deviation.largest,
            unit: unit_word(unit),
        }
    }
}

/// "mm" or "px".
pub(crate) fn unit_word(unit: LengthUnit) -> &'static str {
    match unit {
        LengthUnit::Millimetre => "mm",
        LengthUnit::Pixel => "px",
    }
}
