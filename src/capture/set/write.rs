//! Writes a capture set, into a new text or into the one it came from.

use std::path::{Path, PathBuf};

use indexmap::IndexMap;
use toml_edit::{DocumentMut, Table, Value};

use crate::atomic::{FILE_NAME, WriteError, write_kept_file};
use crate::open::read_text;

use super::edit::{edit_subtable, edit_table, edit_tables, inline, list, put, put_or_remove, put_unless_default};
use super::method::Method;
use super::model::*;
use super::problem::SetError;
use super::read::{ORTHOGRAPHIC, PERSPECTIVE, Reading, SCHEMA};
use super::word::Word;

/// Keys that every new file has even at their defaults, so that its reader need not know these.
const NEW_FILE: &str = "schema = 1\n\n[camera]\nprojection = \"orthographic\"\n";

/// Digits of a measured value: more than any measurement holds, few enough to read.
const MEASURED_DIGITS: usize = 6;

impl CaptureSet {
    /// The text of a new file that says what this set says.
    pub fn to_toml(&self) -> String {
        let document = NEW_FILE.parse().unwrap_or_default();
        updated(document, &Reading::of(NEW_FILE, &self.file_path()), self)
    }

    /// Where the set's file lies in its folder.
    pub fn file_path(&self) -> PathBuf {
        self.folder.join(FILE_NAME)
    }

    /// Saves the set in its folder, in place of the file there whose comments and layout it keeps.
    pub fn save(&self) -> Result<(), WriteError> {
        let path = self.file_path();
        let text = match read_text(&path) {
            Ok(old_text) => update_text(&old_text, self),
            Err(reason) if reason.is_not_found() => self.to_toml(),
            Err(reason) => return Err(WriteError::Refused { path, reason: reason.into() }),
        };
        write_kept_file(&path, text.as_bytes())
    }
}

/// `old_text` changed so that it says what `set` says, with its comments and layout where what they belong to survives.
///
/// A text that cannot be changed so (it is not TOML, or holds keys that no capture set has) is replaced as a whole.
pub fn update_text(old_text: &str, set: &CaptureSet) -> String {
    let (mark, body) = match old_text.strip_prefix('\u{feff}') {
        Some(body) => ("\u{feff}", body),
        None => ("", old_text),
    };
    let old = Reading::of(body, &set.file_path());
    if says(&old, set) {
        return old_text.to_owned();
    }
    let Ok(document) = body.parse::<DocumentMut>() else { return set.to_toml() };
    let text = updated(document, &old, set);
    let text = if body.contains("\r\n") { text.replace("\r\n", "\n").replace('\n', "\r\n") } else { text };
    if says(&Reading::of(&text, &set.file_path()), set) { format!("{mark}{text}") } else { set.to_toml() }
}

fn says(reading: &Reading, set: &CaptureSet) -> bool {
    reading.complete && reading.set == *set
}

/// `text` with measured values under `[calibration]`, and the circles they were measured in, rounded to six digits.
/// Everything else stays as it is; lights that `measured` leaves out keep their values. An error if `text` is no right
/// capture set, or would be none with these values in it.
pub fn write_calibration(text: &str, measured: &Calibration, circles: &[Sphere]) -> Result<String, SetError> {
    let path = Path::new(FILE_NAME);
    let mut set = CaptureSet::parse(text, path)?;
    merge_calibration(&mut set.calibration, measured);
    for sphere in circles {
        let old = set.circle(sphere.subject, sphere.kind).unwrap_or_default();
        let centre = rounded_array(old.centre, sphere.circle.centre);
        let radius = rounded(Some(&old.radius), sphere.circle.radius);
        set.put_sphere(Sphere { circle: Circle { centre, radius }, ..*sphere });
    }
    let problems = set.check();
    if problems.is_empty() {
        Ok(update_text(text, &set))
    } else {
        Err(SetError::Invalid { path: path.to_owned(), problems })
    }
}

/// `text` with the positions of these lights put in, but for those whose direction is typed at the light. Directions that were
/// measured under `[calibration]` give way to them.
///
/// # Errors
/// As [`write_calibration`].
pub fn write_positions<'a>(
    text: &str,
    positions_mm: impl IntoIterator<Item = (&'a str, [f64; 3])>,
) -> Result<String, SetError> {
    let path = Path::new(FILE_NAME);
    let mut set = CaptureSet::parse(text, path)?;
    for (name, position) in positions_mm {
        let light = set.lights.iter_mut().find(|light| light.name == name && light.direction.is_none());
        let Some(light) = light else { continue };
        light.position_mm = Some(rounded_array(light.position_mm.unwrap_or_default(), position));
        set.calibration.direction.shift_remove(name);
    }
    let problems = set.check();
    if problems.is_empty() {
        Ok(update_text(text, &set))
    } else {
        Err(SetError::Invalid { path: path.to_owned(), problems })
    }
}

/// `text` with the projection and the distortion of a camera that was calibrated elsewhere.
///
/// # Errors
/// As [`write_calibration`].
pub fn write_lens(text: &str, camera: &Camera) -> Result<String, SetError> {
    let path = Path::new(FILE_NAME);
    let mut set = CaptureSet::parse(text, path)?;
    (set.camera.projection, set.camera.distortion) = (camera.projection, camera.distortion);
    let problems = set.check();
    if problems.is_empty() {
        Ok(update_text(text, &set))
    } else {
        Err(SetError::Invalid { path: path.to_owned(), problems })
    }
}

/// `text` with a measured crosstalk matrix under `[camera]`, rounded as [`write_calibration`] does.
///
/// # Errors
/// As [`write_calibration`].
pub fn write_crosstalk(text: &str, rows: &[Vec<f64>]) -> Result<String, SetError> {
    let path = Path::new(FILE_NAME);
    let mut set = CaptureSet::parse(text, path)?;
    let old = set.camera.crosstalk.take().unwrap_or_default();
    let row = |(index, row): (usize, &Vec<f64>)| rounded_list(old.get(index).map(Vec::as_slice), row);
    set.camera.crosstalk = Some(rows.iter().enumerate().map(row).collect());
    let problems = set.check();
    if problems.is_empty() {
        Ok(update_text(text, &set))
    } else {
        Err(SetError::Invalid { path: path.to_owned(), problems })
    }
}

fn merge_calibration(old: &mut Calibration, measured: &Calibration) {
    if let Some(beta) = &measured.beta {
        old.beta = Some(rounded_list(old.beta.as_deref(), beta));
    }
    for (light, alpha) in &measured.alpha {
        let alpha = rounded_list(old.alpha.get(light).map(Vec::as_slice), alpha);
        old.alpha.insert(light.clone(), alpha);
    }
    for (light, direction) in &measured.direction {
        let typed = old.direction.get(light).copied().unwrap_or_default();
        old.direction.insert(light.clone(), rounded_array(typed, *direction));
    }
    for (light, intensity) in &measured.intensity {
        let intensity = rounded(old.intensity.get(light), *intensity);
        old.intensity.insert(light.clone(), intensity);
    }
    old.grey_albedo = measured.grey_albedo.or(old.grey_albedo);
    old.white_light = measured.white_light.or(old.white_light);
}

/// `new` to six digits; `old` as it is if it says the same to those digits: a typed value is not reworded.
fn rounded(old: Option<&f64>, new: f64) -> f64 {
    let round = |x: f64| format!("{x:.*e}", MEASURED_DIGITS - 1).parse().unwrap_or(x);
    let new: f64 = round(new);
    old.copied().filter(|old| round(*old) == new).unwrap_or(new)
}

fn rounded_list(old: Option<&[f64]>, new: &[f64]) -> Vec<f64> {
    new.iter().enumerate().map(|(index, new)| rounded(old.and_then(|old| old.get(index)), *new)).collect()
}

fn rounded_array<const N: usize>(old: [f64; N], new: [f64; N]) -> [f64; N] {
    let mut pairs = old.iter().zip(new);
    new.map(|x| pairs.next().map_or(x, |(old, new)| rounded(Some(old), new)))
}

/// The text of `document` after it was changed from saying `old` to saying `set`.
fn updated(mut document: DocumentMut, old: &Reading, set: &CaptureSet) -> String {
    put(document.as_table_mut(), "schema", SCHEMA as i64);
    put_unless_default(document.as_table_mut(), "name", set.name.as_str(), "");
    put_or_remove(document.as_table_mut(), "mask", set.mask.as_deref());
    edit_table(&mut document, "camera", |table| write_camera(table, &set.camera));
    if !(old.complete && old.set.colours == set.colours) {
        edit_tables(&mut document, "colour", &["name"], &set.colours, write_colour);
    }
    if !(old.complete && old.set.lights == set.lights) {
        edit_tables(&mut document, "light", &["name"], &set.lights, write_light);
    }
    if !(old.complete && old.set.shots == set.shots) {
        edit_tables(&mut document, "shot", &["subject", "light", "colour"], &set.shots, write_shot);
    }
    if !(old.complete && old.set.spheres == set.spheres) {
        edit_tables(&mut document, "sphere", &["subject", "kind"], &set.spheres, write_sphere);
    }
    edit_table(&mut document, "calibration", |table| write_calibration_table(table, &set.calibration));
    edit_table(&mut document, "separation", |table| {
        put_or_remove(table, "method", set.separation.method.map(Method::name));
        put_or_remove(table, "bounces", set.separation.bounces.map(|bounces| bounces as i64));
    });
    edit_table(&mut document, "shape", |table| write_shape(table, &set.shape));
    edit_table(&mut document, "truth", |table| write_truth(table, &set.truth));
    document.to_string()
}

fn write_camera(table: &mut Table, camera: &Camera) {
    match camera.projection {
        Projection::Orthographic { mm_per_pixel } => {
            put_unless_default(table, "projection", ORTHOGRAPHIC, ORTHOGRAPHIC);
            put_or_remove(table, "mm_per_pixel", mm_per_pixel);
            for key in ["focal_length_px", "principal_point", "working_distance_mm", "distortion"] {
                table.remove(key);
            }
        }
        Projection::Perspective { focal_length_px, principal_point, working_distance_mm } => {
            put(table, "projection", PERSPECTIVE);
            table.remove("mm_per_pixel");
            put(table, "focal_length_px", focal_length_px);
            put_or_remove(table, "principal_point", principal_point.map(list));
            put(table, "working_distance_mm", working_distance_mm);
            put_or_remove(table, "distortion", camera.distortion.map(list));
        }
    }
    let default = Camera::default();
    put_or_remove(table, "encoding", camera.encoding.map(encoding_value));
    put_or_remove(table, "layer", camera.layer.as_deref());
    if camera.black_level != default.black_level || table.contains_key("black_level") {
        put(table, "black_level", level_value(camera.black_level));
    }
    put_or_remove(table, "white_level", camera.white_level.map(level_value));
    put_or_remove(table, "full_well_electrons", camera.full_well_electrons.map(level_value));
    put_or_remove(table, "read_noise_electrons", camera.read_noise_electrons);
    let rows = camera.crosstalk.as_ref().map(|rows| list(rows.iter().map(|row| list(row.iter().copied()))));
    put_or_remove(table, "crosstalk", rows);
}

/// Stored levels are whole numbers in most files, and read better as such.
fn level_value(level: f64) -> Value {
    let whole = level as i64;
    if whole as f64 == level { whole.into() } else { level.into() }
}

fn encoding_value(encoding: Encoding) -> Value {
    match encoding {
        Encoding::Linear => "linear".into(),
        Encoding::Srgb => "srgb".into(),
        Encoding::Gamma(gamma) => inline("gamma", gamma),
    }
}

fn write_colour(table: &mut Table, colour: &Colour) {
    put(table, "name", colour.name.as_str());
    put(table, "channel", colour.channel.word());
}

fn write_light(table: &mut Table, light: &Light) {
    put(table, "name", light.name.as_str());
    put_or_remove(table, "direction", light.direction.map(list));
    put_or_remove(table, "position_mm", light.position_mm.map(list));
}

fn write_shot(table: &mut Table, shot: &Shot) {
    put(table, "subject", shot.subject.word());
    put_or_remove(table, "light", shot.light.as_deref());
    put_or_remove(table, "colour", shot.colour.as_deref());
    put(table, "files", list(shot.files.iter().map(String::as_str)));
    put_or_remove(table, "exposure", shot.exposure);
    let exposures = (!shot.exposures.is_empty()).then(|| list(shot.exposures.iter().copied()));
    put_or_remove(table, "exposures", exposures);
    put_or_remove(table, "encoding", shot.encoding.map(encoding_value));
    put_or_remove(table, "layer", shot.layer.as_deref());
}

fn write_sphere(table: &mut Table, sphere: &Sphere) {
    put(table, "subject", sphere.subject.word());
    let default = sphere.subject.sphere_kind().map_or("", Word::word);
    put_unless_default(table, "kind", sphere.kind.word(), default);
    put(table, "centre", list(sphere.circle.centre));
    put(table, "radius", sphere.circle.radius);
    put_or_remove(table, "diameter_mm", sphere.diameter_mm);
}

fn write_calibration_table(table: &mut Table, calibration: &Calibration) {
    put_or_remove(table, "beta", calibration.beta.as_ref().map(|beta| list(beta.iter().copied())));
    put_or_remove(table, "grey_albedo", calibration.grey_albedo);
    put_or_remove(table, "white_light", calibration.white_light);
    edit_subtable(table, "alpha", by_light(&calibration.alpha, |alpha| list(alpha.iter().copied())));
    edit_subtable(table, "direction", by_light(&calibration.direction, |direction| list(*direction)));
    edit_subtable(table, "intensity", by_light(&calibration.intensity, |intensity| Value::from(*intensity)));
}

fn by_light<'c, T>(
    table: &'c IndexMap<String, T>,
    value: impl Fn(&T) -> Value + 'c,
) -> impl Iterator<Item = (&'c str, Value)> {
    table.iter().map(move |(light, of_light)| (light.as_str(), value(of_light)))
}

fn write_shape(table: &mut Table, shape: &ShapeSettings) {
    let default = ShapeSettings::default();
    if !shape.leave_out.is_empty() || table.contains_key("leave_out") {
        put(table, "leave_out", list(shape.leave_out.iter().map(String::as_str)));
    }
    put_unless_default(table, "shadow_share", shape.shadow_share, default.shadow_share);
    put_unless_default(table, "misfit_share", shape.misfit_share, default.misfit_share);
    put_unless_default(table, "rounds", shape.rounds as i64, default.rounds as i64);
    put_unless_default(table, "indirect_window_px", shape.indirect_window_px as i64, default.indirect_window_px as i64);
    put_unless_default(table, "paint", shape.paint.word(), default.paint.word());
}

fn write_truth(table: &mut Table, truth: &Truth) {
    let default = Truth::default();
    put_unless_default(table, "normals", truth.normals.as_str(), &default.normals);
    put_unless_default(table, "depth", truth.depth.as_str(), &default.depth);
    put_unless_default(table, "bounce", truth.bounce.as_str(), &default.bounce);
}
