//! A simulated set on disk.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use firstbounce_core::Plane;
use indexmap::IndexMap;
use serde::Serialize;

use super::photos::file_name;
use super::{SimulateError, SimulateOptions, Simulated};
use firstbounce_capture::atomic::{OutputFolder, OutputRules, WriteError};
use firstbounce_capture::export::is_one_of;
use firstbounce_capture::image_file::{ExrLayer, grey8_png, grey16_png, mask_png, rgb8_png, rgb16_png, write_exr};
use firstbounce_capture::set::{CaptureSet, Channel};

/// `truth/rig.json`: the values that the simulation used.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RigRecord {
    /// By light, per colour: intensity over the reference colour's.
    pub alpha: IndexMap<String, Vec<f64>>,
    /// Per colour: albedo over the reference colour's.
    pub beta: Vec<f64>,
    /// Per colour.
    pub albedo: Vec<f64>,
    /// By light: unit vector from the origin to the light.
    pub direction: IndexMap<String, [f64; 3]>,
    /// By light, where it is near.
    pub position_mm: IndexMap<String, [f64; 3]>,
    /// By light: strength in the reference colour over the first light's.
    pub intensity: IndexMap<String, f64>,
    /// Linear light of a white facet that faces the first lamp in the reference colour.
    pub radiance_to_linear: f64,
}

impl RigRecord {
    pub(super) fn of(options: &SimulateOptions, alpha: &[Vec<f64>], scale: f64) -> Self {
        let names = || options.lamps.iter().map(|lamp| lamp.name.clone());
        let lamps: Vec<_> = options.lamps.iter().map(|lamp| lamp.lamp()).collect();
        let first = options.lamps[0].intensity;
        let direction = lamps.iter().map(|lamp| lamp.direction_to_light()).map(|d| [d.x, d.y, d.z]);
        let position = lamps.iter().map(|lamp| lamp.position_mm());
        Self {
            alpha: names().zip(alpha.iter().cloned()).collect(),
            beta: options.albedos.iter().map(|albedo| albedo / options.albedos[0]).collect(),
            albedo: options.albedos.clone(),
            direction: names().zip(direction).collect(),
            position_mm: names().zip(position).filter_map(|(name, p)| Some((name, p?.into()))).collect(),
            intensity: names().zip(options.lamps.iter().map(|lamp| lamp.intensity / first)).collect(),
            radiance_to_linear: scale * first,
        }
    }
}

/// Where the rig's values lie in the set's folder. No photographed set has them.
const RIG: &str = "truth/rig.json";
/// What the files of a simulated set are called.
const NAMES: [&str; 14] = [
    firstbounce_capture::set::FILE_NAME,
    "mask.png",
    RIG,
    "truth/normals.exr",
    "truth/depth.exr",
    "truth/bounce{k}-{light}.exr",
    "object/{light}-{colour}.png",
    "grey-sphere/{light}-{colour}.png",
    "material-sphere/{light}-{colour}.png",
    "mirror-sphere/{light}.png",
    "object/{light}.png",
    "grey-sphere/{light}.png",
    "material-sphere/{light}.png",
    "crosstalk/{light}-{colour}.png",
];
/// What lies closer together was written by one run.
const SAME_TIME: Duration = Duration::from_secs(2);

fn stage(folder: &Path) -> Result<OutputFolder, WriteError> {
    OutputFolder::stage_with(folder, OutputRules { guarded: None, is_output: |name| is_one_of(&NAMES, name) })
}

/// Whether a simulated set could be written into `folder`: to know before the work.
///
/// # Errors
/// As [`write_simulated`].
pub fn check_folder(folder: &Path) -> Result<(), SimulateError> {
    let staged = stage(folder)?;
    let folder = staged.target();
    if folder.join(RIG).is_file() {
        return refuse_edited(folder);
    }
    let Ok(entries) = fs::read_dir(folder) else { return Ok(()) };
    let mut names = entries.flatten().map(|entry| entry.file_name().to_string_lossy().into_owned());
    match names.find(|name| !is_programs_own(name)) {
        Some(found) => Err(SimulateError::ForeignFiles { folder: folder.to_owned(), found }),
        None => Ok(()),
    }
}

/// The user may have written into the capture file what only they know, or `calibrate --write` what it measured.
fn refuse_edited(folder: &Path) -> Result<(), SimulateError> {
    let written = |name: &str| folder.join(name).metadata().ok()?.modified().ok();
    // Both are written within a moment.
    let edited = written(RIG).map(|rig| rig + SAME_TIME) < written(firstbounce_capture::set::FILE_NAME);
    if !edited {
        return Ok(());
    }
    let found = format!("a {} that was changed since", firstbounce_capture::set::FILE_NAME);
    Err(SimulateError::ForeignFiles { folder: folder.to_owned(), found })
}

/// A view that the window keeps beside a set, or what is being staged.
fn is_programs_own(name: &str) -> bool {
    name.starts_with("firstbounce-") || name.starts_with(".firstbounce-")
}

/// Writes a simulated set into `folder`, all of it or nothing. A simulated set of the same files there is replaced.
///
/// # Errors
/// `ForeignFiles` for a folder that holds anything else, and what the system says.
pub fn write_simulated(simulated: &Simulated, folder: &Path) -> Result<(), SimulateError> {
    let set = &simulated.set;
    let output = stage(folder)?;
    let file = |name: &str| {
        debug_assert!(is_one_of(&NAMES, name), "{name} is missing in the table of names");
        output.file(name)
    };
    let put = |name: &str, bytes: &[u8]| -> Result<(), SimulateError> {
        let path = file(name)?;
        fs::write(&path, bytes).map_err(|reason| WriteError::Refused { path, reason }.into())
    };
    // Eight bits hold what an eight-bit sensor stores in one frame.
    let eight_bits = set.camera.white_level.is_some_and(|white| white <= 255.0);
    let mut files: IndexMap<String, Vec<&Plane>> = IndexMap::new();
    for photo in &simulated.photos {
        files.entry(file_name(set, photo)).or_default().push(&photo.stored);
    }
    for (name, channels) in &files {
        let png = match (channels.as_slice(), eight_bits) {
            ([grey], true) => grey8_png(grey, 255.0)?,
            ([grey], false) => grey16_png(grey, 65535.0)?,
            (channels, true) => rgb8_png(rgb(set, channels, &dark(set, channels)), 255.0)?,
            (channels, false) => rgb16_png(rgb(set, channels, &dark(set, channels)), 65535.0)?,
        };
        put(name, &png)?;
    }
    let truth = &simulated.truth;
    put("mask.png", &mask_png(&truth.mask)?)?;
    let exr = |name: &str, channels: Vec<(&str, &Plane)>| -> Result<(), SimulateError> {
        Ok(write_exr(&file(name)?, &[ExrLayer { name: "truth", channels }])?)
    };
    let normals = &truth.normals;
    exr(&set.truth.normals, vec![("R", normals.x()), ("G", normals.y()), ("B", normals.z())])?;
    exr(&set.truth.depth, vec![("Y", &truth.depth_mm)])?;
    for (light, bounces) in set.lights.iter().zip(&truth.bounces) {
        for (k, bounce) in (1..).zip(bounces) {
            let name = set.truth.bounce.replace("{k}", &k.to_string()).replace("{light}", &light.name);
            exr(&name, vec![("Y", bounce)])?;
        }
    }
    // Names and numbers always are JSON.
    let rig = serde_json::to_string_pretty(&truth.rig).unwrap_or_default();
    put(RIG, (rig + "\n").as_bytes())?;
    let report = &simulated.report;
    let comment = format!(
        "# Simulated: {}, {} patches, light without end. The values it was made with are in {RIG}.\n",
        report.scene.replace(['\n', '\r'], " "),
        report.factors.patches
    );
    put(firstbounce_capture::set::FILE_NAME, (comment + &set.to_toml()).as_bytes())?;
    let staged = output.path();
    output.commit_after(|folder| {
        refuse_foreign_files(folder, &staged)?;
        refuse_edited(folder)?;
        Ok(Vec::new())
    })
}

/// What a channel stores that sees no lamp.
fn dark(set: &CaptureSet, channels: &[&Plane]) -> Plane {
    let (width, height) = channels.first().map_or((0, 0), |plane| plane.size());
    Plane::filled(width, height, set.camera.black_level as f32)
}

/// The channels of a photo, where each colour has one.
fn rgb<'a>(set: &CaptureSet, planes: &[&'a Plane], dark: &'a Plane) -> [&'a Plane; 3] {
    [Channel::R, Channel::G, Channel::B].map(|channel| {
        let colour = set.colours.iter().position(|colour| colour.channel == channel);
        colour.and_then(|c| planes.get(c).copied()).unwrap_or(dark)
    })
}

/// Fails if `folder` holds anything that the staged files would not replace.
fn refuse_foreign_files(folder: &Path, staged: &Path) -> Result<(), SimulateError> {
    let foreign = |found: PathBuf| SimulateError::ForeignFiles {
        folder: folder.to_owned(),
        found: found.to_string_lossy().into_owned(),
    };
    let ours = |file: &Path| {
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        staged.join(file).exists() || is_programs_own(&name)
    };
    let mut files = Vec::new();
    let mut pending = vec![PathBuf::new()];
    while let Some(inner) = pending.pop() {
        let Ok(entries) = fs::read_dir(folder.join(&inner)) else { continue };
        for entry in entries.flatten() {
            let path = inner.join(entry.file_name());
            if !ours(&path) {
                return Err(foreign(path));
            }
            if entry.file_type().is_ok_and(|kind| kind.is_dir()) {
                // What is being staged lies in the folder too.
                if !entry.file_name().to_string_lossy().starts_with('.') {
                    pending.push(path);
                }
            } else {
                files.push(path);
            }
        }
    }
    // Photos of the same names may be the user's own: only a simulated set names its rig.
    match files.iter().find(|file| staged.join(file).exists()) {
        Some(file) if !folder.join(RIG).is_file() => Err(foreign(file.clone())),
        _ => Ok(()),
    }
}
