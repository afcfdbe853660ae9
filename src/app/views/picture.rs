//! From what is to be shown to numbers and colours.

use firstbounce_capture::CaptureSet;
use firstbounce_capture::set::Subject;
use firstbounce_core::image::photo::DARK;
use firstbounce_core::separate::{OUTSIDE, UNSOLVED};
use thiserror::Error;

use crate::app::state::document::Document;
use crate::app::state::layout::Shown;
use crate::app::state::results::{
    MarksName, PlaneName, Results, ShotName, StageError, StageState, Step, Stored, SurfaceName,
};
use crate::gpu::{ColourMap, Display, Layer, Source, SourceError, Tint};

/// Bounce 2 is a few percent of bounce 1; the paper shows it amplified.
const FIGURE_ONE_GAIN: f32 = 3.0;
const LIGHT: &str = "Linear light, 1 = white level";

/// Numbers, and how they are best shown.
#[derive(Clone, Debug)]
pub struct Picture {
    /// The numbers.
    pub source: Source,
    /// A proposal.
    pub display: Display,
    /// What the numbers are, with their unit.
    pub quantity: &'static str,
}

/// Why there is no picture, in one line that says what to do.
#[derive(Clone, Debug, Error)]
pub enum PictureError {
    /// What it is computed from is missing, or failed.
    #[error(transparent)]
    Stage(#[from] StageError),
    /// The step that it comes from is not ready.
    #[error("{line}")]
    Step {
        /// Why, and what to do.
        line: String,
    },
    /// The step that it comes from is being computed.
    #[error("{step} is running")]
    Running {
        /// Which one.
        step: Step,
    },
    /// The set does not have it.
    #[error("there is no such picture in this set: choose another")]
    NotInSet,
    /// The set does not have this shot.
    #[error("this shot is not in the set: choose another picture, or add its file in Captures")]
    NoShot,
    /// Its photo is not there yet.
    #[error("the photo is being read")]
    Reading,
    /// A bounce beyond the order.
    #[error("bounce {k} is not separated: choose an order of at least {k} in Separate")]
    NotSeparated {
        /// From 1.
        k: usize,
    },
    /// The fit is exact.
    #[error("with as many bounces as colours there is no residual: choose a lower order in Separate")]
    NoResidual,
    /// A surface in the place of a picture.
    #[error(
        "Numbers are read off pictures: choose one in a view. Points, distances and sections of a surface are in its own bar."
    )]
    Surface,
    /// A picture of vectors or colours where single values are asked for.
    #[error("{title} has more than one value a pixel: choose another picture")]
    SeveralValues {
        /// The picture.
        title: String,
    },
    /// The planes do not fit together.
    #[error(transparent)]
    Source(#[from] SourceError),
}

/// The picture, or why there is none yet.
pub fn picture(shown: &Shown, document: &Document, results: &Results) -> Result<Picture, PictureError> {
    if shown.by_method().is_some_and(|method| !document.settings.is_compared(method)) {
        return Err(not_yet(shown, document, results));
    }
    let pictures = results.pictures();
    let stored = |name: PlaneName| pictures.plane(&name).ok_or_else(|| not_yet(shown, document, results));
    let masked = |source: Source| with_mask(source, results);
    match shown {
        Shown::Photo(shot) => {
            let photo = stored(PlaneName::Photo(shot.clone()))?;
            let source = Source::plane(photo.plane.clone());
            let source = with_marks(source, results, &MarksName::Photo(shot.clone()));
            let mut display = grey(photo.range);
            if shot.subject == Subject::MirrorSphere {
                // All but the highlight is dark there.
                display.tints[DARK.trailing_zeros() as usize] = Tint::default();
            }
            Ok(Picture { source, display, quantity: LIGHT })
        }
        Shown::Bounce { light, k } => {
            let source = Source::value(bounce(document, results, light, *k)?)?;
            let range = pictures.plane(&PlaneName::Bounce(light.clone(), *k)).map(|stored| stored.range);
            let range = range.or_else(|| reference(document, results, light).map(|photo| photo.range));
            let source = with_marks(masked(source), results, &MarksName::Separation(light.clone()));
            Ok(Picture { source, display: grey(range.unwrap_or([0.0, 1.0])), quantity: LIGHT })
        }
        Shown::Sum { light } => {
            let source = Source::value(sum(document, results, light)?)?;
            let range = reference(document, results, light).map_or([0.0, 1.0], |photo| photo.range);
            Ok(Picture { source: masked(source), display: grey(range), quantity: LIGHT })
        }
        Shown::FigureOne { light } => {
            let (first, second) = (bounce(document, results, light, 1)?, bounce(document, results, light, 2)?);
            let source = Source::figure_one(first, second, FIGURE_ONE_GAIN)?;
            let range = reference(document, results, light).map_or([0.0, 1.0], |photo| photo.range);
            let stops = -range[1].max(f32::MIN_POSITIVE).log2();
            let display = Display { exposure_stops: stops, ..Display::default() };
            Ok(Picture { source: masked(source), display, quantity: "Bounce 1 red, bounce 2 times 3 cyan" })
        }
        Shown::Residual { light } => {
            let plane = stored(PlaneName::Residual(light.clone()))?;
            Ok(value(plane, ColourMap::Viridis, "Root mean square residual, linear light", &masked))
        }
        Shown::Noise { light } => {
            let plane = stored(PlaneName::Noise(light.clone()))?;
            Ok(value(plane, ColourMap::Viridis, "Predicted noise, linear light", &masked))
        }
        Shown::Direct { light } => {
            let plane = stored(PlaneName::Direct(light.clone()))?;
            Ok(Picture {
                source: masked(Source::plane(plane.plane.clone())),
                display: grey(plane.range),
                quantity: LIGHT,
            })
        }
        Shown::DirectBy { method, light } => {
            let plane = stored(PlaneName::DirectBy(*method, light.clone()))?;
            let range = pictures.plane(&PlaneName::Direct(light.clone())).map_or(plane.range, |stored| stored.range);
            Ok(Picture { source: masked(Source::plane(plane.plane.clone())), display: grey(range), quantity: LIGHT })
        }
        Shown::Marks { light } => {
            let photo = reference(document, results, light).ok_or_else(|| not_yet(shown, document, results))?;
            let source = Source::plane(photo.plane.clone());
            let source = with_marks(source, results, &MarksName::Separation(light.clone()));
            Ok(Picture { source, display: all_marks(grey(photo.range)), quantity: LIGHT })
        }
        Shown::Normals(when) => {
            let axis = |axis: usize| stored(PlaneName::Normal(*when, axis)).map(|stored| stored.plane.clone());
            let source = Source::normals([axis(0)?, axis(1)?, axis(2)?])?;
            let source = with_marks(masked(source), results, &MarksName::Normals(*when));
            Ok(Picture { source, display: Display::default(), quantity: "Normal x, y, z as red, green, blue" })
        }
        Shown::Albedo(when) => {
            let plane = stored(PlaneName::Albedo(*when))?;
            Ok(Picture {
                source: masked(Source::plane(plane.plane.clone())),
                display: grey([0.0, plane.range[1]]),
                quantity: "Albedo, relative to the first lamp",
            })
        }
        Shown::NormalNoise(when) => {
            Ok(value(stored(PlaneName::NormalNoise(*when))?, ColourMap::Viridis, "Predicted noise, degrees", &masked))
        }
        Shown::Depth(when) => {
            let quantity = if has_scale(&document.set) { "Depth toward the camera, mm" } else { "Depth, pixels" };
            Ok(value(stored(PlaneName::Depth(*when))?, ColourMap::Viridis, quantity, &masked))
        }
        Shown::Difference(a, b) if are_normals(a, b) => {
            let turned = pictures.plane(&PlaneName::Turned).ok_or_else(|| not_yet(a, document, results))?;
            Ok(value(turned, ColourMap::Viridis, "Angle between normals, degrees", &masked))
        }
        Shown::Surface => Err(PictureError::Surface),
        Shown::Difference(a, b) => {
            let (first, second) = (layer(a, document, results)?, layer(b, document, results)?);
            let source = Source::difference(first, second)?;
            let largest = picture(a, document, results)?.display.range[1].abs() / 4.0;
            Ok(Picture {
                source: masked(source),
                display: Display::signed(largest),
                quantity: difference_of(a, document),
            })
        }
    }
}

/// A picture of single values as a layer, to compare it with another.
pub fn layer(shown: &Shown, document: &Document, results: &Results) -> Result<Layer, PictureError> {
    let stored = |name: PlaneName| {
        let stored = results.pictures().plane(&name).ok_or_else(|| not_yet(shown, document, results))?;
        Ok(Layer::from(stored.plane.clone()))
    };
    match shown {
        Shown::Photo(shot) => stored(PlaneName::Photo(shot.clone())),
        Shown::Bounce { light, k } => bounce(document, results, light, *k),
        Shown::Sum { light } => sum(document, results, light),
        Shown::Residual { light } => stored(PlaneName::Residual(light.clone())),
        Shown::Noise { light } => stored(PlaneName::Noise(light.clone())),
        Shown::Direct { light } => stored(PlaneName::Direct(light.clone())),
        Shown::DirectBy { method, light } => stored(PlaneName::DirectBy(*method, light.clone())),
        Shown::Albedo(when) => stored(PlaneName::Albedo(*when)),
        Shown::NormalNoise(when) => stored(PlaneName::NormalNoise(*when)),
        Shown::Depth(when) => stored(PlaneName::Depth(*when)),
        Shown::Marks { .. } | Shown::FigureOne { .. } | Shown::Normals(_) | Shown::Surface | Shown::Difference(..) => {
            Err(PictureError::SeveralValues { title: shown.title() })
        }
    }
}

/// What a difference is of, with its unit.
fn difference_of(a: &Shown, document: &Document) -> &'static str {
    match (a, has_scale(&document.set)) {
        (Shown::Depth(_), true) => "Difference of depth, mm",
        (Shown::Depth(_), false) => "Difference of depth, pixels",
        (Shown::NormalNoise(_), _) => "Difference of noise, degrees",
        (Shown::Albedo(_), _) => "Difference of albedo",
        _ => "Difference of linear light",
    }
}

/// The unit of a picture's numbers, after a space; empty where they have none.
pub fn unit_of(shown: &Shown, document: &Document) -> &'static str {
    match (shown, has_scale(&document.set)) {
        (Shown::Depth(_), true) => " mm",
        (Shown::Depth(_), false) => " pixels",
        (Shown::NormalNoise(_), _) => " degrees",
        (Shown::Difference(a, b), _) if are_normals(a, b) => " degrees",
        (Shown::Difference(a, _), _) => unit_of(a, document),
        _ => "",
    }
}

/// The two sides of a difference: what is shown is the first minus the second.
pub fn sides(a: &Shown, b: &Shown, document: &Document, results: &Results) -> Result<[Layer; 2], PictureError> {
    if are_normals(a, b) {
        let turned = results.pictures().plane(&PlaneName::Turned);
        let missing = || not_yet(&Shown::Normals(SurfaceName::AFTER), document, results);
        let turned = Layer::from(turned.ok_or_else(missing)?.plane.clone());
        return Ok([turned.clone(), turned.amplified(0.0)]);
    }
    Ok([layer(a, document, results)?, layer(b, document, results)?])
}

/// Directions differ by an angle, which is computed of the normals before and after.
fn are_normals(a: &Shown, b: &Shown) -> bool {
    let whens = match (a, b) {
        (Shown::Normals(a), Shown::Normals(b)) => (*a, *b),
        _ => return false,
    };
    matches!(whens, (SurfaceName::AFTER, SurfaceName::Before) | (SurfaceName::Before, SurfaceName::AFTER))
}

/// Bounce k of a light as weights on its photos.
fn bounce(document: &Document, results: &Results, light: &str, k: usize) -> Result<Layer, PictureError> {
    let system = results.rig(document).system(light)?;
    if k == 0 || k > system.operator.nrows() {
        return Err(PictureError::NotSeparated { k });
    }
    combination(document, results, light, |c| system.operator[(k - 1, c)])
}

fn sum(document: &Document, results: &Results, light: &str) -> Result<Layer, PictureError> {
    let system = results.rig(document).system(light)?;
    combination(document, results, light, |c| system.operator.column(c).sum())
}

fn combination(
    document: &Document,
    results: &Results,
    light: &str,
    weight: impl Fn(usize) -> f64,
) -> Result<Layer, PictureError> {
    let mut planes = Vec::new();
    let mut weights = Vec::new();
    for (c, colour) in document.set.colours.iter().enumerate() {
        let shown = Shown::object(light, &colour.name);
        let Shown::Photo(name) = &shown else { continue };
        let missing = || not_yet(&shown, document, results);
        let stored = results.pictures().plane(&PlaneName::Photo(name.clone())).ok_or_else(missing)?;
        planes.push(stored.plane.clone());
        weights.push(weight(c) as f32);
    }
    Ok(Layer::combination(&planes, &weights)?)
}

/// The reference colour's photo of a light.
fn reference<'a>(document: &Document, results: &'a Results, light: &str) -> Option<&'a Stored> {
    let colour = document.set.colours.first()?;
    let Shown::Photo(name) = Shown::object(light, &colour.name) else { return None };
    results.pictures().plane(&PlaneName::Photo(name))
}

fn value(stored: &Stored, map: ColourMap, quantity: &'static str, masked: &dyn Fn(Source) -> Source) -> Picture {
    let display = Display { map, range: stored.range, ..Display::default() };
    Picture { source: masked(Source::plane(stored.plane.clone())), display, quantity }
}

/// Light from black to the brightest value.
fn grey(range: [f32; 2]) -> Display {
    Display { range: [0.0, range[1].max(f32::MIN_POSITIVE)], ..Display::default() }
}

fn all_marks(display: Display) -> Display {
    let mut display = display;
    display.tints[UNSOLVED.trailing_zeros() as usize] = Tint { colour: [224, 168, 32], strength: 0.8 };
    display.tints[OUTSIDE.trailing_zeros() as usize] = Tint { colour: [90, 90, 90], strength: 0.5 };
    display
}

fn with_mask(source: Source, results: &Results) -> Source {
    match results.pictures().marks(&MarksName::Mask) {
        Some(mask) => source.clone().with_mask(mask.clone()).unwrap_or(source),
        None => source,
    }
}

fn with_marks(source: Source, results: &Results, name: &MarksName) -> Source {
    match results.pictures().marks(name) {
        Some(marks) => source.clone().with_marks(marks.clone()).unwrap_or(source),
        None => source,
    }
}

fn has_scale(set: &CaptureSet) -> bool {
    use firstbounce_capture::set::Projection;
    !matches!(set.camera.projection, Projection::Orthographic { mm_per_pixel: None })
}

/// The stage that a picture comes from. Bounces are computed of the photos while they are drawn.
fn step_of(shown: &Shown) -> Step {
    if let Some(method) = shown.by_method() {
        return Step::ByMethod(method);
    }
    match shown {
        Shown::Photo(_) | Shown::Bounce { .. } | Shown::Sum { .. } | Shown::FigureOne { .. } => Step::Load,
        Shown::Difference(a, b) => step_of(a).max(step_of(b)),
        Shown::Residual { .. } | Shown::Noise { .. } | Shown::Marks { .. } => Step::Separate,
        Shown::Direct { .. }
        | Shown::DirectBy { .. }
        | Shown::Normals(_)
        | Shown::Albedo(_)
        | Shown::NormalNoise(_)
        | Shown::Depth(_) => Step::Shape,
        Shown::Surface => Step::Mesh,
    }
}

/// What keeps a picture that is shown from being that of the document: it is the last that could be made.
pub fn outdated(shown: &Shown, document: &Document, results: &Results) -> Option<String> {
    let step = step_of(shown);
    match results.state(step, document) {
        StageState::Failed { line } | StageState::Blocked { line } if step > Step::Load => {
            Some(format!("Of earlier values: {line}"))
        }
        _ => None,
    }
}

/// Why a picture is not there, and what to do.
fn not_yet(shown: &Shown, document: &Document, results: &Results) -> PictureError {
    if let Shown::Photo(name) = shown {
        return no_photo(name, document, results);
    }
    if matches!(shown, Shown::Residual { .. }) && results.rig(document).bounces >= document.set.colours.len() {
        return PictureError::NoResidual;
    }
    let step = step_of(shown);
    match results.state(step, document) {
        StageState::Failed { line } | StageState::Blocked { line } => PictureError::Step { line },
        StageState::Stale | StageState::Running { .. } => PictureError::Running { step },
        StageState::Ready => PictureError::NotInSet,
    }
}

fn no_photo(name: &ShotName, document: &Document, results: &Results) -> PictureError {
    if !document.set.shots.iter().any(|shot| ShotName::of(shot) == *name) {
        return PictureError::NoShot;
    }
    match results.loaded().as_ref().and_then(|loaded| loaded.shot(name)).map(|shot| &shot.photo) {
        Some(Err(error)) => PictureError::Stage(error.clone()),
        _ => PictureError::Reading,
    }
}
