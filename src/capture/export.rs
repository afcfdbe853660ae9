//! Results to files.

mod earlier;
mod file_names;
mod finished;
mod lights;
mod meshes;
mod names;
mod options;
#[cfg(test)]
mod tests;

use std::path::{Path, PathBuf};

use firstbounce_core::NormalMap;
use indexmap::IndexMap;

use crate::atomic::{OutputFolder, OutputRules, WriteError};
use crate::image_file::{ExrLayer, ImageError, depth_png, normals_png, write_exr};
use crate::pipeline::{Part, PipelineError, PipelineWatch, Solved, Stage, StageCost, Surface, camera_of};
use crate::report::{BatchRecord, ExportRecord, Report, html, overview, unit_word};
use crate::set::CaptureSet;

use earlier::Earlier;
pub use file_names::is_one_of;
use file_names::{SURFACES, filled};
pub use finished::is_finished;
pub use names::is_result_name;
use names::{
    ALBEDO, BOUNCE, BOUNCES, DEPTH, DEPTH_PNG, DIRECT, INDIRECT, NORMAL_NOISE, NORMALS_EXR, NORMALS_PNG, OVERVIEW,
    PAGE, REPORT, SEPARATED,
};
pub use options::OutputOptions;

/// Stages results of `set` for the folder `target`, where a set from elsewhere may have links of any name.
///
/// # Errors
/// As [`OutputFolder::stage_with`].
pub fn stage_results(set: &CaptureSet, target: &Path) -> Result<OutputFolder, WriteError> {
    OutputFolder::stage_with(target, OutputRules { guarded: Some(&set.folder), is_output: is_result_name })
}

/// Writes every result into `folder`, which was staged before the work began so that an unwritable one is known early, and
/// returns the report that lies there too. Until all of it is written, nothing in the folder changes.
///
/// # Errors
/// `WriteError::NotOurs` where a file would take the place of one that no earlier run wrote, or of one of the set.
pub fn write_solved(
    set: &CaptureSet,
    solved: &Solved,
    folder: OutputFolder,
    options: &OutputOptions,
    watch: &dyn PipelineWatch,
) -> Result<Report, PipelineError> {
    write_solved_as(set, solved, folder, options, None, watch)
}

/// The same of a run among many, whose report says what was asked for.
///
/// # Errors
/// As [`write_solved`].
pub fn write_solved_as(
    set: &CaptureSet,
    solved: &Solved,
    folder: OutputFolder,
    options: &OutputOptions,
    batch: Option<BatchRecord>,
    watch: &dyn PipelineWatch,
) -> Result<Report, PipelineError> {
    options.check()?;
    let mut stages = solved.stages.clone();
    let mut files = Files { folder, written: IndexMap::new() };
    let written = StageCost::measure(&mut stages, Stage::Write, || write_results(solved, &mut files, options, watch));
    let export = written?;

    let path = files.add(OVERVIEW, "photo, direct and indirect light of the first light, normals before and after")?;
    write_bytes(&path, &overview(solved).png()?)?;
    files.note(REPORT, "every number of this run");
    files.note(PAGE, "this run on one page, with pictures");
    let report = Report::new(solved, stages, options.green, export, files.written.clone(), batch);
    let json = serde_json::to_string_pretty(&report).map_err(PipelineError::Json)?;
    write_text(&files.folder.file(REPORT)?, &(json + "\n"))?;
    write_text(&files.folder.file(PAGE)?, &html(solved, &report)?)?;
    if watch.cancelled() {
        return Err(PipelineError::Cancelled);
    }
    commit_results(set, files.folder, files.written.keys())?;
    Ok(report)
}

/// Moves the staged files, which have these names, to their folder, and takes away what else an earlier run left there.
fn commit_results<'n>(
    set: &CaptureSet,
    folder: OutputFolder,
    names: impl Iterator<Item = &'n String> + Clone,
) -> Result<(), WriteError> {
    folder.commit_after(|target| {
        let earlier = Earlier::of(target);
        earlier.check(set, target, names.clone())?;
        Ok(earlier.untouched(target))
    })
}

/// The staged files, and what each is.
struct Files {
    folder: OutputFolder,
    written: IndexMap<String, String>,
}

impl Files {
    /// Where to write `name`, which is `what`.
    fn add(&mut self, name: impl Into<String>, what: impl Into<String>) -> Result<PathBuf, WriteError> {
        let name = name.into();
        debug_assert!(is_result_name(&name), "{name} is missing in the table of names");
        let path = self.folder.file(&name)?;
        self.written.insert(name, what.into());
        Ok(path)
    }

    fn note(&mut self, name: &str, what: &str) {
        self.written.insert(name.into(), what.into());
    }
}

fn write_results(
    solved: &Solved,
    files: &mut Files,
    options: &OutputOptions,
    watch: &dyn PipelineWatch,
) -> Result<ExportRecord, PipelineError> {
    let set = &solved.set;
    let count = set.lights.len() + 2;
    for (l, light) in set.lights.iter().enumerate() {
        write_light(solved, l, &light.name, files)?;
        step(watch, l, count)?;
    }
    lights::write_lights(set, &solved.calibrated, options, files)?;
    let [after, before] = SURFACES;
    let surfaces = [
        (solved.after.as_ref().ok(), after, ""),
        (solved.before.as_ref(), before, " from the photos before separation"),
    ];
    let unit = surfaces.iter().find_map(|(surface, ..)| surface.map(|surface| surface.mesh.unit));
    let mut export = options::record(options, unit);
    for (index, (surface, suffix, origin)) in (count - 2..).zip(surfaces) {
        let Some(surface) = surface else { continue };
        write_surface(surface, (suffix, origin), files, options, &mut export)?;
        let part = Part::of(watch, Stage::Write, index, count);
        let camera = camera_of(set, surface.shape.depth.mask.size());
        meshes::write_meshes(surface, (suffix, origin), &camera, options, files, &mut export, &part)?;
        step(watch, index, count)?;
    }
    Ok(export)
}

fn step(watch: &dyn PipelineWatch, index: usize, count: usize) -> Result<(), PipelineError> {
    firstbounce_core::Watch::progress(&Part::of(watch, Stage::Write, index, count), 1.0);
    if watch.cancelled() { Err(PipelineError::Cancelled) } else { Ok(()) }
}

/// One layered file with all of a light's planes, and a file for each kind of light.
fn write_light(solved: &Solved, l: usize, light: &str, files: &mut Files) -> Result<(), PipelineError> {
    let separation = &solved.separated.lights[l];
    let marks = separation.marks.map(f32::from);
    let named = |pattern: &str, k: usize| filled(pattern, &[("k", &k.to_string()), ("light", light)]);
    // By layer: its plane, and the name and the words of its own file.
    let (layered, what, kinds): (_, _, Vec<_>) = match solved.indirect.get(l) {
        Some(indirect) => {
            let direct =
                ("direct".to_owned(), &separation.bounces[0], named(DIRECT, 1), format!("direct light of {light}"));
            let what = "direct and indirect light, the noise of direct light, the marks";
            let indirect =
                ("indirect".to_owned(), indirect, named(INDIRECT, 1), format!("all light of {light} that bounced"));
            (SEPARATED, what, vec![direct, indirect])
        }
        None => {
            let bounce =
                |(k, plane)| (format!("bounce{k}"), plane, named(BOUNCE, k), format!("bounce {k} under light {light}"));
            let what = "a layer for each bounce, the noise of bounce 1, the residual, the marks";
            (BOUNCES, what, (1..).zip(&separation.bounces).map(bounce).collect())
        }
    };
    let others = [
        ("direct-noise", separation.direct_noise.as_ref()),
        ("residual", separation.residual.as_ref()),
        ("marks", Some(&marks)),
    ];
    let layers = kinds.iter().map(|(layer, plane, ..)| (layer.as_str(), Some(*plane))).chain(others);
    let layers = layers.filter_map(|(name, plane)| Some(ExrLayer { name, channels: vec![("Y", plane?)] }));
    let path = files.add(named(layered, 1), format!("light {light}: {what}"))?;
    write_exr(&path, &layers.collect::<Vec<_>>())?;
    for (_, plane, name, what) in kinds {
        write_exr(&files.add(name, what)?, &[ExrLayer { name: "light", channels: vec![("Y", plane)] }])?;
    }
    Ok(())
}

/// Normals, albedo and depth; `suffix` goes into the names, `origin` into what is said of them.
fn write_surface(
    surface: &Surface,
    (suffix, origin): (&str, &str),
    files: &mut Files,
    options: &OutputOptions,
    export: &mut ExportRecord,
) -> Result<(), PipelineError> {
    let Surface { shape, mesh } = surface;
    let map: &NormalMap = &shape.normals.map;
    let named = |pattern: &str| filled(pattern, &[("surface", suffix)]);
    let path = files.add(named(NORMALS_PNG), format!("normals{origin}, 16 bits"))?;
    write_bytes(&path, &normals_png([map.x(), map.y(), map.z()], options.green)?)?;
    let path = files.add(named(NORMALS_EXR), format!("normals{origin}: R G B = x y z, y up"))?;
    write_exr(&path, &[ExrLayer { name: "normals", channels: vec![("R", map.x()), ("G", map.y()), ("B", map.z())] }])?;
    let grey = [
        (ALBEDO, "albedo", &shape.normals.albedo, "albedo"),
        (NORMAL_NOISE, "normal-noise", &shape.normals.noise_deg, "predicted noise of the normals in degrees"),
        (DEPTH, "depth", &shape.depth.depth_mm, "depth toward the camera, in the mesh's unit"),
    ];
    for (pattern, name, plane, what) in grey {
        let path = files.add(named(pattern), format!("{what}{origin}"))?;
        write_exr(&path, &[ExrLayer { name, channels: vec![("Y", plane)] }])?;
    }
    if options.depth_png {
        let name = named(DEPTH_PNG);
        let (png, scale) = depth_png(&shape.depth.depth_mm, &shape.depth.mask, unit_word(mesh.unit))?;
        write_bytes(&files.add(&name, format!("depth{origin}, 16 bits: {}", scale.words()))?, &png)?;
        export.depth_png.insert(name, scale);
    }
    Ok(())
}

fn write_text(path: &Path, text: &str) -> Result<(), PipelineError> {
    write_bytes(path, text.as_bytes())
}

fn write_bytes(path: &Path, bytes: &[u8]) -> Result<(), PipelineError> {
    let unwritable =
        |error: std::io::Error| ImageError::Unwritable { path: path.to_owned(), reason: error.to_string() };
    Ok(std::fs::write(path, bytes).map_err(unwritable)?)
}
