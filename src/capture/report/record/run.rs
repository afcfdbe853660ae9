//! `report.json`: every number of a run, by the words of the capture file.

use std::time::SystemTime;

use firstbounce_core::separate::SeparateReport;
use indexmap::IndexMap;
use serde::Serialize;

use super::{
    BatchRecord, CalibrationRecord, CaptureWarningRecord, ColoursAndShapeRecord, ExportRecord, InputRecord,
    NayarRecord, OptionsRecord, TrustRecord, input_records, unit_word,
};
use crate::image_file::GreenAxis;
use crate::pipeline::{Solved, StageCost, Surface};

/// The form of [`Report`].
pub const SCHEMA: usize = 1;

/// Everything that a run reports.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// The form of this record: it grows by one when a field changes its meaning or goes.
    pub schema: usize,
    /// The program and its version.
    pub program: String,
    /// When the run ended, as RFC 3339 in UTC.
    pub time: String,
    /// How the set was solved.
    pub options: OptionsRecord,
    /// The files that the run was computed from, by the paths that capture.toml writes.
    pub inputs: IndexMap<String, InputRecord>,
    /// What a run of many sets was asked for; absent for one set by itself.
    pub batch: Option<BatchRecord>,
    /// What was photographed.
    pub set: SetRecord,
    /// The rig, in the words that `calibrate --json` prints.
    pub calibration: CalibrationRecord,
    /// The name of the method: "colours-and-shape", "colours" (Liao et al. 2011) or "shape" (Nayar et al. 1991).
    pub method: &'static str,
    /// The iterations of Nayar's method; absent for others.
    pub nayar: Option<NayarRecord>,
    /// How colours and shape together went; absent for others.
    pub colours_and_shape: Option<ColoursAndShapeRecord>,
    /// The order m.
    pub bounces: usize,
    /// By light.
    pub separation: IndexMap<String, SeparateReport>,
    /// How far the bounces can be trusted, and why.
    pub trust: TrustRecord,
    /// The surface from bounce 1; absent where there is none.
    pub shape: Option<ShapeRecord>,
    /// The surface from the photos before separation.
    pub before: Option<ShapeRecord>,
    /// Why there is no surface.
    pub no_shape: Option<String>,
    /// How to read the files.
    pub conventions: Conventions,
    /// How meshes and depth were written.
    pub export: ExportRecord,
    /// What was written, by path relative to the report.
    pub files: IndexMap<String, String>,
    /// What is wrong with the captures, the worst first; also among the warnings.
    pub capture_warnings: Vec<CaptureWarningRecord>,
    /// What the user should know before trusting the numbers.
    pub warnings: Vec<String>,
    /// What each stage cost.
    pub stages: Vec<StageCost>,
}

/// The program and its version.
pub fn program() -> String {
    format!("Firstbounce {}", env!("CARGO_PKG_VERSION"))
}

/// What was photographed.
#[derive(Clone, Debug, Serialize)]
pub struct SetRecord {
    /// Its name.
    pub name: String,
    /// The folder it was read from.
    pub folder: String,
    /// Width and height of the object's photos in pixels.
    pub size: [usize; 2],
    /// Pixels of the object.
    pub mask_pixels: usize,
    /// Names of the lights.
    pub lights: Vec<String>,
    /// Names of the colours, the reference first.
    pub colours: Vec<String>,
}

/// A surface.
#[derive(Clone, Debug, Serialize)]
pub struct ShapeRecord {
    /// Pixels with a normal.
    pub solved_pixels: usize,
    /// Of those, with shadowed or misfitting lights left out.
    pub shadowed_pixels: usize,
    /// Of those, where a shadowed light had to be used.
    pub shadow_used_pixels: usize,
    /// Pixels of the object without a normal.
    pub unsolved_pixels: usize,
    /// Of the lamps' directions.
    pub condition_number: f64,
    /// Mean albedo, relative to the first lamp's strength.
    pub mean_albedo: f64,
    /// Mean predicted noise of the normals in degrees.
    pub mean_noise_deg: f64,
    /// The integration.
    pub depth: DepthRecord,
    /// The triangles.
    pub mesh: MeshRecord,
}

/// The integration.
#[derive(Clone, Debug, Serialize)]
pub struct DepthRecord {
    /// Pixels with a depth.
    pub pixels: usize,
    /// Unconnected parts; the depth between them is not known.
    pub islands: usize,
    /// Iterations of the solver.
    pub iterations: usize,
    /// Relative residual of the solver.
    pub relative_residual: f64,
    /// Integrability residual: slopes of the depth less those of the normals, root mean square.
    pub rms_slope_residual: f64,
    /// Pixels whose slope was clamped.
    pub clamped_pixels: usize,
    /// For each round after the first, the change of the depth (near lamps only).
    pub changes: Vec<f64>,
}

/// The triangles.
#[derive(Clone, Debug, Serialize)]
pub struct MeshRecord {
    /// Vertices.
    pub vertices: usize,
    /// Triangles.
    pub triangles: usize,
    /// Unit of the coordinates: "mm" or "px".
    pub unit: &'static str,
    /// Smallest and largest corner.
    pub bounds: Option<[[f32; 3]; 2]>,
}

/// How to read the files.
#[derive(Clone, Debug, Serialize)]
pub struct Conventions {
    /// Of everything in space.
    pub frame: &'static str,
    /// Of the normal map's green channel.
    pub normals: &'static str,
    /// Of depth and mesh.
    pub unit: &'static str,
    /// Of the bounce images.
    pub bounces: &'static str,
    /// Of the marks layer.
    pub marks: &'static str,
}

impl Conventions {
    fn of(green: GreenAxis, unit: &'static str) -> Self {
        Self {
            frame: "x right, y up, z from the object toward the camera",
            normals: match green {
                GreenAxis::Up => "OpenGL: red = x, green = y up, blue = z, each (n + 1) / 2; black = no normal",
                GreenAxis::Down => "DirectX: red = x, green = y down, blue = z, each (n + 1) / 2; black = no normal",
            },
            unit,
            bounces: "linear light in the reference colour; 1 is the camera's white level at exposure 1",
            marks: "sum of 1 clipped, 2 dark, 4 unsolved, 8 outside the mask",
        }
    }
}

impl Report {
    /// The report of a run; `files` are what it wrote, by the conventions that `green` and `export` tell.
    pub fn new(
        solved: &Solved,
        stages: Vec<StageCost>,
        green: GreenAxis,
        export: ExportRecord,
        files: IndexMap<String, String>,
        batch: Option<BatchRecord>,
    ) -> Self {
        let (set, method) = (&*solved.set, solved.options.method);
        let bounces = solved.separated.reports.first().map_or(0, |report| report.bounces);
        let size = solved.object.mask.size();
        let shape = solved.after.as_ref().ok().map(ShapeRecord::of);
        let names = set.lights.iter().map(|light| light.name.clone());
        let trust = TrustRecord::of(set, &solved.trust);
        let of_photos = solved.captures.others(solved.object.warnings.iter().chain(&solved.calibrated.warnings));
        let solved_pixels = shape.as_ref().map_or(0, |shape| shape.solved_pixels);
        let of_method = solved.report.warnings(solved_pixels);
        // That one colour cannot tell bounces apart is no reproach to a method that simulates them.
        let of_trust = trust.warnings().filter(|_| method.needs().all_colours);
        // What the method says of itself is said once.
        let of_trust = of_trust.filter(|line| !of_method.iter().any(|told| line.ends_with(told.as_str())));
        let of_trust: Vec<_> = of_trust.collect();
        let of_captures = solved.captures.lines().into_iter();
        let warnings = of_captures.chain(of_photos).chain(of_method).chain(of_trust).collect();
        Self {
            schema: SCHEMA,
            time: humantime::format_rfc3339_seconds(SystemTime::now()).to_string(),
            options: OptionsRecord::of(&solved.options, bounces),
            inputs: input_records(set),
            program: program(),
            batch,
            set: SetRecord {
                name: set.title(),
                folder: set.folder.display().to_string(),
                size: [size.0, size.1],
                mask_pixels: solved.object.mask.count(),
                lights: names.clone().collect(),
                colours: set.colours.iter().map(|colour| colour.name.clone()).collect(),
            },
            calibration: CalibrationRecord::of(set, &solved.calibrated),
            method: method.name(),
            nayar: solved.report.nayar().map(NayarRecord::of),
            colours_and_shape: solved.report.colours_and_shape().map(|solved| ColoursAndShapeRecord::of(set, solved)),
            bounces,
            separation: names.zip(solved.separated.reports.iter().cloned()).collect(),
            trust,
            conventions: Conventions::of(green, shape.as_ref().map_or("none", |shape| shape.mesh.unit)),
            shape,
            before: solved.before.as_ref().map(ShapeRecord::of),
            no_shape: solved.after.as_ref().err().map(ToString::to_string),
            export,
            files,
            capture_warnings: CaptureWarningRecord::all(&solved.captures),
            warnings,
            stages,
        }
    }
}

impl ShapeRecord {
    fn of(surface: &Surface) -> Self {
        let (normals, depth) = (&surface.shape.report.normals, &surface.shape.depth.report);
        let corner = |p: nalgebra::Point3<f32>| [p.x, p.y, p.z];
        Self {
            solved_pixels: normals.solved_pixels,
            shadowed_pixels: normals.shadowed_pixels,
            shadow_used_pixels: normals.shadow_used_pixels,
            unsolved_pixels: normals.unsolved_pixels,
            condition_number: normals.condition_number,
            mean_albedo: normals.mean_albedo,
            mean_noise_deg: normals.mean_noise_deg,
            depth: DepthRecord {
                pixels: depth.pixels,
                islands: depth.islands,
                iterations: depth.iterations,
                relative_residual: depth.relative_residual,
                rms_slope_residual: depth.rms_slope_residual,
                clamped_pixels: depth.clamped_pixels,
                changes: surface.shape.report.depth_changes.clone(),
            },
            mesh: MeshRecord {
                vertices: surface.mesh.positions.len(),
                triangles: surface.mesh.triangles.len(),
                unit: unit_word(surface.mesh.unit),
                bounds: surface.mesh.bounds().map(|(low, high)| [corner(low), corner(high)]),
            },
        }
    }
}
