//! Reads the text of a capture set file.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use firstbounce_core::stereo::normals::Paint;
use toml_edit::{Document, Item, TableLike};

use super::fields::{ENCODING, Fields, Reader, count, encoding, number, numbers, rows, text, texts, tuple, word};
use super::method::Method;
use super::model::*;
use super::number::{Number, vector_words};
use super::problem::{Location, Problem, SetError};
use super::rule::{POINT, one_of};
use super::word::Word;
use crate::atomic::FILE_NAME;
use crate::open::{MAX_TEXT_BYTES, OpenError, read_file};

/// What a `layer` is.
const LAYER: &str = "a layer's name";

/// The one version of the format.
pub(super) const SCHEMA: usize = 1;

/// A set as far as it could be read, and everything that is wrong with it.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// The set; where a value could not be read, it has its default.
    pub set: CaptureSet,
    /// In the order of the file; empty if the set is right.
    pub problems: Vec<Problem>,
    /// Whether `set` says all that the text says: every problem is about what the values mean.
    pub complete: bool,
}

impl CaptureSet {
    /// Opens the capture set at `path`: its folder or its capture.toml.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, SetError> {
        let (path, text) = read_text(path.as_ref())?;
        Self::parse(&text, &path)
    }

    /// Reads a set from the text of the file at `path`, whose folder relative paths start from.
    pub fn parse(text: &str, path: &Path) -> Result<Self, SetError> {
        let reading = Reading::of(text, path);
        if reading.problems.is_empty() {
            Ok(reading.set)
        } else {
            Err(SetError::Invalid { path: path.to_owned(), problems: reading.problems })
        }
    }
}

/// The path of the set file that `path` means and its text.
pub(super) fn read_text(path: &Path) -> Result<(PathBuf, String), SetError> {
    let path = if path.is_dir() { path.join(FILE_NAME) } else { path.to_owned() };
    let bytes = read_file(&path, MAX_TEXT_BYTES).map_err(|reason| match (&reason, path.parent()) {
        (OpenError::TooLong { max_bytes }, _) => SetError::TooLarge { path: path.clone(), limit_bytes: *max_bytes },
        (_, Some(folder)) if reason.is_not_found() && folder.is_dir() && path.ends_with(FILE_NAME) => {
            SetError::NoSetFile { folder: folder.to_owned() }
        }
        _ => SetError::Read { path: path.clone(), reason },
    })?;
    match String::from_utf8(bytes) {
        Ok(text) => Ok((path, text)),
        Err(error) => {
            let offset = error.utf8_error().valid_up_to();
            let valid = String::from_utf8_lossy(&error.as_bytes()[..offset]).into_owned();
            let position = Some(Reader::new(&valid).position(offset));
            let problem =
                Problem { position, ..Problem::of_part(Location::Set, "expected UTF-8 text, found other bytes") };
            Err(SetError::Invalid { path, problems: vec![problem] })
        }
    }
}

impl Reading {
    /// Reads what the file at `path` says, as far as it can be read. For a window, which shows errors where they are.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, SetError> {
        let (path, text) = read_text(path.as_ref())?;
        Ok(Self::of(&text, &path))
    }

    /// Reads `text` as the file at `path`, as far as it can be read.
    pub fn of(text: &str, path: &Path) -> Self {
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let mut reader = Reader::new(text);
        let document = match Document::parse(text) {
            Ok(document) => document,
            Err(error) => {
                let position = error.span().map(|span| reader.position(span.start));
                let message = error.message().lines().collect::<Vec<_>>().join("; ");
                let problem = Problem { position, ..Problem::of_part(Location::Set, message) };
                let set = CaptureSet { folder, ..CaptureSet::default() };
                return Self { set, problems: vec![problem], complete: false };
            }
        };
        let set = CaptureSet { folder, ..read_set(&mut reader, document.as_table()) };

        // What lies between parts is judged only when every part could be read: one misspelt light is one problem.
        let complete = reader.problems.is_empty();
        let unread: HashSet<Location> = reader.problems.iter().map(|problem| problem.location).collect();
        let meaning = if complete { set.check() } else { set.check_parts() };
        for problem in meaning.into_iter().filter(|problem| !unread.contains(&problem.location)) {
            reader.report(problem);
        }
        reader.problems.sort_by_key(|problem| problem.position);
        Self { set, problems: reader.problems, complete }
    }
}

pub(super) fn read_set(reader: &mut Reader<'_>, root: &dyn TableLike) -> CaptureSet {
    reader.remember(Location::Set, None, Some(0..0));
    let mut fields = Fields::new(reader, root, Location::Set);
    let schema = fields.require("schema", &format!("schema = {SCHEMA}"), count).unwrap_or(SCHEMA);
    if schema != SCHEMA {
        fields.problem(
            "schema",
            format!("expected {SCHEMA}, found {schema}; another version of the program wrote this file"),
        );
    }
    let name = fields.get("name", "a text", text).unwrap_or_default();
    let mask = fields.get("mask", "a file path", text);
    let camera = part(&mut fields, "camera", Location::Camera, read_camera);
    let colours = parts(&mut fields, "colour", Location::Colour, read_colour);
    let lights = parts(&mut fields, "light", Location::Light, read_light);
    let shots = parts(&mut fields, "shot", Location::Shot, read_shot);
    let spheres = parts(&mut fields, "sphere", Location::Sphere, read_sphere);
    let calibration = part(&mut fields, "calibration", Location::Calibration, read_calibration);
    let separation = part(&mut fields, "separation", Location::Separation, |fields| Separation {
        method: fields.get("method", &words::<Method>(), word),
        bounces: fields.get("bounces", &Number::Bounces.words(), count),
    });
    let shape = part(&mut fields, "shape", Location::Shape, read_shape);
    let truth = part(&mut fields, "truth", Location::Truth, read_truth);
    fields.finish();
    let folder = PathBuf::new();
    CaptureSet { folder, name, mask, camera, colours, lights, shots, spheres, calibration, separation, shape, truth }
}

/// A `[table]`; its default where the file has none.
fn part<T: Default>(
    root: &mut Fields<'_, '_>,
    key: &'static str,
    location: Location,
    read: impl Fn(&mut Fields<'_, '_>) -> T,
) -> T {
    let Some(item) = root.item(key) else { return T::default() };
    let Some(table) = item.as_table_like() else {
        root.problem(key, format!("expected [{key}], a table, found {}", item.type_name()));
        return T::default();
    };
    let span = item.span().or_else(|| root.key_span(key));
    read_part(root.reader, table, location, span, read)
}

/// Every `[[table]]` of one name.
fn parts<T>(
    root: &mut Fields<'_, '_>,
    key: &'static str,
    location: impl Fn(usize) -> Location,
    read: impl Fn(&mut Fields<'_, '_>) -> T,
) -> Vec<T> {
    let Some(item) = root.item(key) else { return Vec::new() };
    let Some(tables) = tables(item) else {
        root.problem(key, format!("expected [[{key}]], a list of tables, found {}", item.type_name()));
        return Vec::new();
    };
    let read_one = |(index, (table, span))| read_part(root.reader, table, location(index), span, &read);
    tables.into_iter().enumerate().map(read_one).collect()
}

type Spanned<'t> = (&'t dyn TableLike, Option<std::ops::Range<usize>>);

/// The tables of `[[name]]`, or of `name = [{ .. }, { .. }]`, which TOML holds to be the same.
fn tables(item: &Item) -> Option<Vec<Spanned<'_>>> {
    if let Some(tables) = item.as_array_of_tables() {
        return Some(tables.iter().map(|table| (table as &dyn TableLike, table.span())).collect());
    }
    item.as_array()?
        .iter()
        .map(|value| value.as_inline_table().map(|table| (table as &dyn TableLike, table.span())))
        .collect()
}

fn read_part<T>(
    reader: &mut Reader<'_>,
    table: &dyn TableLike,
    location: Location,
    span: Option<std::ops::Range<usize>>,
    read: impl Fn(&mut Fields<'_, '_>) -> T,
) -> T {
    reader.remember(location, None, span);
    let mut fields = Fields::new(reader, table, location);
    let part = read(&mut fields);
    fields.finish();
    part
}

fn read_camera(fields: &mut Fields<'_, '_>) -> Camera {
    let expected = one_of([ORTHOGRAPHIC, PERSPECTIVE]);
    let known =
        |item: &Item| item.as_str().filter(|word| [ORTHOGRAPHIC, PERSPECTIVE].contains(word)).map(str::to_owned);
    let perspective = match fields.item("projection") {
        None => false,
        // Of a misspelt projection the keys show which one was meant.
        Some(_) => match fields.get("projection", &expected, known) {
            Some(word) => word == PERSPECTIVE,
            None => fields.item("focal_length_px").is_some(),
        },
    };
    let distortion = if perspective { fields.get("distortion", "four numbers [k1, k2, p1, p2]", tuple) } else { None };
    Camera {
        distortion,
        projection: if perspective { read_perspective(fields) } else { read_orthographic(fields) },
        encoding: fields.get("encoding", ENCODING, encoding),
        layer: fields.get("layer", LAYER, text),
        black_level: fields.get("black_level", &Number::BlackLevel.words(), number).unwrap_or_default(),
        white_level: fields.get("white_level", &Number::WhiteLevel.words(), number),
        full_well_electrons: fields.get("full_well_electrons", &Number::FullWellElectrons.words(), number),
        read_noise_electrons: fields.get("read_noise_electrons", &Number::ReadNoiseElectrons.words(), number),
        crosstalk: fields.get("crosstalk", "a list of rows of numbers, one row per colour", rows),
    }
}

pub(super) const ORTHOGRAPHIC: &str = "orthographic";
pub(super) const PERSPECTIVE: &str = "perspective";

fn read_orthographic(fields: &mut Fields<'_, '_>) -> Projection {
    for key in ["focal_length_px", "principal_point", "working_distance_mm", "distortion"] {
        if fields.item(key).is_some() {
            fields.problem(key, format!("belongs to projection = \"{PERSPECTIVE}\"; this camera is {ORTHOGRAPHIC}"));
        }
    }
    Projection::Orthographic { mm_per_pixel: fields.get("mm_per_pixel", &Number::MmPerPixel.words(), number) }
}

fn read_perspective(fields: &mut Fields<'_, '_>) -> Projection {
    if fields.item("mm_per_pixel").is_some() {
        let message = format!("belongs to projection = \"{ORTHOGRAPHIC}\"; this camera is {PERSPECTIVE}");
        fields.problem("mm_per_pixel", message);
    }
    Projection::Perspective {
        focal_length_px: fields.require("focal_length_px", &Number::FocalLengthPx.words(), number).unwrap_or(1.0),
        principal_point: fields.get("principal_point", POINT, tuple),
        working_distance_mm: fields
            .require("working_distance_mm", &Number::WorkingDistanceMm.words(), number)
            .unwrap_or(1.0),
    }
}

fn read_colour(fields: &mut Fields<'_, '_>) -> Colour {
    Colour {
        name: fields.require("name", "a name", text).unwrap_or_default(),
        channel: fields.get("channel", &words::<Channel>(), word).unwrap_or_default(),
    }
}

fn read_light(fields: &mut Fields<'_, '_>) -> Light {
    Light {
        name: fields.require("name", "a name", text).unwrap_or_default(),
        direction: fields.get("direction", &vector_words(Number::Direction), tuple),
        position_mm: fields.get("position_mm", &vector_words(Number::PositionMm), tuple),
    }
}

fn read_shot(fields: &mut Fields<'_, '_>) -> Shot {
    Shot {
        subject: fields.require("subject", &words::<Subject>(), word).unwrap_or_default(),
        light: fields.get("light", "a light's name", text),
        colour: fields.get("colour", "a colour's name", text),
        files: fields.require("files", "a list of file paths", texts).unwrap_or_default(),
        exposure: fields.get("exposure", &Number::Exposure.words(), number),
        exposures: fields.get("exposures", "a list of numbers, one per file", numbers).unwrap_or_default(),
        encoding: fields.get("encoding", ENCODING, encoding),
        layer: fields.get("layer", LAYER, text),
    }
}

fn read_sphere(fields: &mut Fields<'_, '_>) -> Sphere {
    let subject = fields.require("subject", &words::<Subject>(), word);
    let kind = match subject {
        Some(Subject::Object) => fields.require("kind", &words::<SphereKind>(), word),
        _ => fields.get("kind", &words::<SphereKind>(), word).or(subject.and_then(Subject::sphere_kind)),
    };
    let subject = subject.unwrap_or_default();
    let centre = fields.require("centre", POINT, tuple).unwrap_or_default();
    let radius = fields.require("radius", &Number::Radius.words(), number).unwrap_or_default();
    let diameter_mm = fields.get("diameter_mm", &Number::DiameterMm.words(), number);
    Sphere { subject, kind: kind.unwrap_or_default(), circle: Circle { centre, radius }, diameter_mm }
}

fn read_calibration(fields: &mut Fields<'_, '_>) -> Calibration {
    Calibration {
        beta: fields.get("beta", "a list of numbers, one per colour", numbers),
        alpha: fields.by_light("alpha", "a list of numbers, one per colour", numbers).into_iter().collect(),
        direction: fields.by_light("direction", &vector_words(Number::Direction), tuple).into_iter().collect(),
        intensity: fields.by_light("intensity", &Number::Intensity.words(), number).into_iter().collect(),
        grey_albedo: fields.get("grey_albedo", &Number::GreyAlbedo.words(), number),
        white_light: fields.get("white_light", &Number::WhiteLight.words(), number),
    }
}

fn read_shape(fields: &mut Fields<'_, '_>) -> ShapeSettings {
    let defaults = ShapeSettings::default();
    ShapeSettings {
        leave_out: fields.get("leave_out", "a list of lights' names", texts).unwrap_or_default(),
        shadow_share: fields.get("shadow_share", &Number::ShadowShare.words(), number).unwrap_or(defaults.shadow_share),
        misfit_share: fields.get("misfit_share", &Number::MisfitShare.words(), number).unwrap_or(defaults.misfit_share),
        rounds: fields.get("rounds", &Number::Rounds.words(), count).unwrap_or(defaults.rounds),
        indirect_window_px: fields
            .get("indirect_window_px", &Number::IndirectWindowPx.words(), count)
            .unwrap_or(defaults.indirect_window_px),
        paint: fields.get("paint", &words::<Paint>(), word).unwrap_or(defaults.paint),
    }
}

fn read_truth(fields: &mut Fields<'_, '_>) -> Truth {
    let defaults = Truth::default();
    Truth {
        normals: fields.get("normals", "a file path", text).unwrap_or(defaults.normals),
        depth: fields.get("depth", "a file path", text).unwrap_or(defaults.depth),
        bounce: fields.get("bounce", "a file path with {k} and {light}", text).unwrap_or(defaults.bounce),
    }
}

fn words<W: Word>() -> String {
    one_of(W::ALL.iter().map(|choice| choice.word()))
}
