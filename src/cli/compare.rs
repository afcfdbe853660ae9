//! `firstbounce compare A B`

use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::Args;
use firstbounce_capture::OutputFolder;
use firstbounce_capture::mesh_file::{Quality, write_ply};
use firstbounce_capture::pipeline::{Comparable, Compared, Registration, compare_meshes, read_comparable};
use firstbounce_core::Mesh;
use firstbounce_core::mesh::compare::{
    AlignOptions, Alignment, Comparison, DistanceOptions, Iteration, colour_by_distance,
};
use nalgebra::Isometry3;
use serde::Serialize;

use super::progress::Terminal;
use super::table::{row, table};
use super::unit::Unit;
use super::{PrintArgs, print, print_json, print_warnings};

#[derive(Args, Debug)]
pub struct CompareArgs {
    /// The mesh that is measured: OBJ, PLY, STL or GLB, or a capture set with true depth
    #[arg(value_name = "A")]
    a: PathBuf,
    /// The reference: a mesh, or a capture set with true depth
    #[arg(value_name = "B")]
    b: PathBuf,
    /// Lay A onto B first: iterative closest point, without any change of scale; a mesh of this program onto the truth of a
    /// set by its height alone
    #[arg(long)]
    align: bool,
    /// What one unit of the files is; sets know it themselves
    #[arg(long, value_enum, default_value_t = Unit::Mm)]
    unit: Unit,
    /// The same for B alone [default: that of --unit]
    #[arg(long, value_enum)]
    unit_b: Option<Unit>,
    /// Farther than this from B, a point of A has no counterpart there [default: a tenth of B's diagonal]
    #[arg(long, value_name = "MM")]
    limit: Option<f64>,
    /// Write A, where it was laid, as PLY: red outside B, blue inside, and the signed distance in mm as quality
    #[arg(long, value_name = "OUT.PLY", value_parser = ply_path)]
    heat_map: Option<PathBuf>,
    #[command(flatten)]
    print: PrintArgs,
}

fn ply_path(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    let is_ply = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("ply"));
    if is_ply { Ok(path) } else { Err("a heat map is a PLY file: name it .ply".into()) }
}

/// The numbers of a comparison: A onto B.
#[derive(Debug, Serialize)]
struct CompareRecord {
    mean_mm: f64,
    bias_mm: f64,
    rms_mm: f64,
    p95_mm: f64,
    max_mm: f64,
    overlap: f64,
    orientation_error_deg: f64,
    rotation_deg: f64,
    translation_mm: [f64; 3],
    /// Row by row, for column vectors.
    matrix: [[f64; 4]; 4],
    alignment: Option<AlignmentRecord>,
    warnings: Vec<String>,
}

/// How A was laid onto B.
#[derive(Debug, Serialize)]
struct AlignmentRecord {
    rms_mm: f64,
    overlap: f64,
    reach_mm: f64,
    converged: bool,
    searched: bool,
    poor: bool,
    ambiguous: bool,
    condition: f64,
    free_motions: Vec<String>,
    iterations: Vec<Iteration>,
}

/// Runs the command.
pub fn run(args: &CompareArgs) -> anyhow::Result<()> {
    let terminal = Terminal::attend();
    if let Some(path) = &args.heat_map {
        refuse_to_replace(path, [&args.a, &args.b])?;
    }
    let a = read_comparable(&args.a, args.unit.into())?;
    let b = read_comparable(&args.b, args.unit_b.unwrap_or(args.unit).into())?;
    if args.heat_map.is_some() && b.mesh.triangles.is_empty() {
        bail!(
            "{}: a cloud of points has no surface to colour A's distances by; leave out --heat-map",
            args.b.display()
        );
    }
    let mut warnings = [a.warnings.as_slice(), b.warnings.as_slice()].concat();
    // A place that cannot be written to is found before the work, and what happens to it later costs no number.
    let heat_map = args.heat_map.as_deref().map(HeatMap::stage).transpose()?;
    let measured = measure(args, &a, &b, &terminal);
    terminal.finish();
    let Compared { alignment, comparison, warnings: of_alignment } = measured?;
    let written = heat_map.map_or(Ok(()), |heat_map| heat_map.write(&a.mesh, alignment.as_ref(), &comparison));
    warnings.extend(of_alignment);
    print_warnings(&warnings);
    let record = CompareRecord::of(&comparison, alignment.as_ref(), warnings);
    if args.print.json {
        print_json(&record)?
    } else {
        print(&text(args, &record))?
    }
    written
}

/// A heat map in the place of what was compared would be the end of it.
fn refuse_to_replace(heat_map: &Path, inputs: [&PathBuf; 2]) -> anyhow::Result<()> {
    let Ok(place) = heat_map.canonicalize() else { return Ok(()) };
    if inputs.into_iter().any(|input| input.canonicalize().is_ok_and(|input| input == place)) {
        bail!("{}: the heat map would replace a mesh that is compared; give it another name", heat_map.display());
    }
    Ok(())
}

fn measure(args: &CompareArgs, a: &Comparable, b: &Comparable, terminal: &Terminal) -> anyhow::Result<Compared> {
    let align = AlignOptions { freedom: a.frame.freedom(b.frame), ..AlignOptions::default() };
    let registration = if args.align { Registration::Align(align) } else { Registration::None };
    let options = DistanceOptions { limit_mm: args.limit };
    Ok(compare_meshes(&a.mesh, &b.mesh, &registration, &options, (&terminal.job("align"), &terminal.job("measure")))?)
}

/// Where A lies: as it came, unless it was laid onto B.
fn pose(alignment: Option<&Alignment>) -> Isometry3<f64> {
    alignment.map_or_else(Isometry3::identity, |alignment| alignment.moving_to_fixed)
}

/// A heat map that has a place on the disk, and no contents yet.
struct HeatMap {
    output: OutputFolder,
    staged: PathBuf,
}

impl HeatMap {
    fn stage(path: &Path) -> anyhow::Result<Self> {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
        let output = OutputFolder::stage(folder)?;
        let staged = output.file(path.file_name().unwrap_or_default())?;
        Ok(Self { output, staged })
    }

    /// Writes A where it was laid, coloured up to the distance that 95 % stay below.
    fn write(self, a: &Mesh, alignment: Option<&Alignment>, comparison: &Comparison) -> anyhow::Result<()> {
        let range_mm = comparison.p95_mm as f32;
        let mut mesh = a.clone().moved(&pose(alignment));
        mesh.colours = colour_by_distance(&comparison.signed_mm, range_mm);
        let values: Vec<_> = comparison.signed_mm.iter().map(|signed| signed.unwrap_or(f32::NAN)).collect();
        let meaning = format!(
            "signed distance to the reference in mm, positive outside, NaN without a counterpart; \
             red is +{range_mm} mm and more, white 0, blue -{range_mm} mm and less"
        );
        write_ply(&self.staged, &mesh, Some(Quality { values: &values, meaning: &meaning }))?;
        Ok(self.output.commit()?)
    }
}

impl CompareRecord {
    fn of(comparison: &Comparison, alignment: Option<&Alignment>, warnings: Vec<String>) -> Self {
        let matrix = &comparison.matrix;
        Self {
            mean_mm: comparison.mean_mm,
            bias_mm: comparison.bias_mm,
            rms_mm: comparison.rms_mm,
            p95_mm: comparison.p95_mm,
            max_mm: comparison.max_mm,
            overlap: comparison.overlap,
            orientation_error_deg: comparison.orientation_error_deg,
            rotation_deg: comparison.rotation_deg,
            translation_mm: comparison.translation_mm.into(),
            matrix: std::array::from_fn(|row| std::array::from_fn(|column| matrix[(row, column)])),
            alignment: alignment.map(AlignmentRecord::of),
            warnings,
        }
    }
}

impl AlignmentRecord {
    fn of(alignment: &Alignment) -> Self {
        Self {
            rms_mm: alignment.rms_mm,
            overlap: alignment.overlap,
            reach_mm: alignment.reach_mm,
            converged: alignment.converged,
            searched: alignment.searched,
            poor: alignment.is_poor(),
            ambiguous: alignment.ambiguous.is_some(),
            condition: alignment.condition,
            free_motions: alignment.free.iter().map(ToString::to_string).collect(),
            iterations: alignment.iterations.clone(),
        }
    }
}

fn orientation(error_deg: f64) -> String {
    if error_deg.is_nan() { "not known: points without normals".into() } else { format!("{error_deg:.2} degrees") }
}

fn text(args: &CompareArgs, record: &CompareRecord) -> String {
    let mm = |name: &str, value: f64| row([name, &format!("{value:.4} mm")]);
    let [x, y, z] = record.translation_mm;
    let mut rows = vec![
        row([&args.a.display().to_string(), &format!("onto {}", args.b.display())]),
        mm("mean distance", record.mean_mm),
        mm("mean signed distance", record.bias_mm),
        mm("rms distance", record.rms_mm),
        mm("95 % are closer than", record.p95_mm),
        mm("largest distance", record.max_mm),
        row(["overlap", &format!("{:.1} %", 100.0 * record.overlap)]),
        row(["mean orientation error", &orientation(record.orientation_error_deg)]),
        row(["rotation", &format!("{:.3} degrees", record.rotation_deg)]),
        row(["translation", &format!("{x:.4}, {y:.4}, {z:.4} mm")]),
    ];
    if let Some(alignment) = &record.alignment {
        let rms: Vec<_> = alignment.iterations.iter().map(|step| format!("{:.3}", step.rms_mm)).collect();
        rows.push(row(["rms of each iteration", &format!("{} mm", rms.join(" "))]));
    }
    table(&rows)
}
