//! From what is to be shown to numbers and colours.

use firstbounce_core::image::photo::DARK;
use firstbounce_core::separate::{OUTSIDE, UNSOLVED};
use thiserror::Error;

use super::preview;
use crate::app::state::document::Document;
use crate::app::state::layout::Shown;
use crate::app::state::results::{
    MarksName, Of, PlaneName, Range, Results, ShotName, StageError, StageState, Step, Stored, SurfaceName,
};
use crate::gpu::{ColourMap, Display, Layer, Source, SourceError, Tint};

/// Bounce 2 is a few percent of bounce 1; the paper shows it amplified.
const FIGURE_ONE_GAIN: f32 = 3.0;

/// Pixels along either side of a picture that are looked at for the range of its values.
const SAMPLES: usize = 32;

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
    /// This set cannot have it.
    #[error("{line}")]
    Impossible {
        /// Why, and what to do.
        line: &'static str,
    },
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
    if let Some(method) = shown.by_method().filter(|method| !document.is_compared(*method)) {
        let in_force = method == document.method();
        return Err(if in_force { StageError::InForce { method } } else { StageError::NotAsked { method } }.into());
    }
    let (source, display) = drawn(shown, document, results)?;
    Ok(Picture { source, display, quantity: shown.quantity(&document.set).words })
}

fn drawn(shown: &Shown, document: &Document, results: &Results) -> Result<(Source, Display), PictureError> {
    let pictures = results.pictures();
    let stored = |name: PlaneName| pictures.plane(&name).ok_or_else(|| not_yet(shown, document, results));
    let masked = |source: Source| with_mask(source, results);
    match shown {
        Shown::Photo(shot) => {
            let photo = stored(PlaneName::Photo(shot.clone()))?;
            let source = Source::plane(photo.plane.clone());
            let source = with_marks(source, results, &MarksName::Photo(shot.clone()));
            let mut display = grey(photo.range);
            if shot.subject.is_shiny_ball() {
                // All but the highlight is dark there.
                display.tints[DARK.trailing_zeros() as usize] = Tint::default();
            }
            Ok((source, display))
        }
        Shown::Bounce { light, k } => {
            let source = Source::value(bounce(document, results, light, *k)?)?;
            let range = pictures.plane(&PlaneName::Bounce(light.clone(), *k)).map(|stored| stored.range);
            let range = range.unwrap_or_else(|| sampled_range(&source));
            let source = with_marks(masked(source), results, &MarksName::Separation(light.clone()));
            Ok((source, grey(range)))
        }
        Shown::Sum { light } => {
            let source = Source::value(sum(document, results, light)?)?;
            let range = reference(document, results, light).map_or([0.0, 1.0], |photo| photo.range);
            Ok((masked(source), grey(range)))
        }
        Shown::FigureOne { light } => {
            let (first, second) = (bounce(document, results, light, 1)?, bounce(document, results, light, 2)?);
            let source = Source::figure_one(first, second, FIGURE_ONE_GAIN)?;
            let range = reference(document, results, light).map_or([0.0, 1.0], |photo| photo.range);
            let stops = -range[1].max(f32::MIN_POSITIVE).log2();
            Ok((masked(source), Display { exposure_stops: stops, ..Display::default() }))
        }
        Shown::Marks { light } => {
            let photo = reference(document, results, light).ok_or_else(|| not_yet(shown, document, results))?;
            let source = Source::plane(photo.plane.clone());
            let source = with_marks(source, results, &MarksName::Separation(light.clone()));
            Ok((source, all_marks(grey(photo.range))))
        }
        Shown::Normals(name) => {
            let axis = |axis: usize| stored(PlaneName::Normal(*name, axis)).map(|stored| stored.plane.clone());
            let source = Source::normals([axis(0)?, axis(1)?, axis(2)?])?;
            let source = with_marks(masked(source), results, &MarksName::Normals(*name));
            Ok((source, Display::default()))
        }
        Shown::Surface | Shown::Pane(_) => Err(PictureError::Surface),
        Shown::Difference(a, b) if are_normals(a, b) => {
            let turned = pictures.plane(&PlaneName::Turned).ok_or_else(|| not_yet(a, document, results))?;
            let display = Display { map: ColourMap::Viridis, range: turned.range, ..Display::default() };
            Ok((masked(Source::plane(turned.plane.clone())), display))
        }
        Shown::Difference(a, b) => {
            let (first, second) = (layer(a, document, results)?, layer(b, document, results)?);
            let source = Source::difference(first, second)?;
            let largest = sampled_largest(&source);
            Ok((masked(source), Display::signed(largest)))
        }
        Shown::Plain(name) if preview::words(name, document, results).is_some() => {
            let source = Source::value(preview::layer(name, document, results)?)?;
            let own = pictures.plane(&name.clone().into()).map(|stored| stored.range);
            let range = own.unwrap_or_else(|| sampled_range(&source));
            Ok((masked(source), grey(range)))
        }
        Shown::Plain(name) => {
            let row = name.plain.row();
            let own = stored(name.clone().into())?;
            let range = match row.range {
                Range::Own => own.range,
                Range::FromZero => from_zero(own.range),
                Range::FromZeroTo(other) => {
                    let other = name.light().and_then(|light| pictures.plane(&other.of(Of::light(light)).into()));
                    from_zero(other.unwrap_or(own).range)
                }
            };
            Ok((masked(Source::plane(own.plane.clone())), Display { map: row.map, range, ..Display::default() }))
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
        Shown::Plain(name) if preview::words(name, document, results).is_some() => {
            preview::layer(name, document, results)
        }
        Shown::Plain(name) => stored(name.clone().into()),
        Shown::Marks { .. }
        | Shown::FigureOne { .. }
        | Shown::Normals(_)
        | Shown::Surface
        | Shown::Pane(_)
        | Shown::Difference(..) => Err(PictureError::SeveralValues { title: shown.title() }),
    }
}

/// The two sides of a difference: what is shown is the first minus the second.
pub fn sides(a: &Shown, b: &Shown, document: &Document, results: &Results) -> Result<[Layer; 2], PictureError> {
    if are_normals(a, b) {
        let turned = results.pictures().plane(&PlaneName::Turned);
        let missing = || not_yet(&Shown::Normals(SurfaceName::After), document, results);
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
    matches!(whens, (SurfaceName::After, SurfaceName::Before) | (SurfaceName::Before, SurfaceName::After))
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

/// From zero to the brightest values but for the outermost half percent, of a few pixels all over: what is drawn from the photos
/// was counted by no stage.
fn sampled_range(source: &Source) -> [f32; 2] {
    [0.0, outermost(sampled(source)).unwrap_or(1.0)]
}

/// The same for differences, whichever way they go.
fn sampled_largest(source: &Source) -> f32 {
    outermost(sampled(source).map(f32::abs)).unwrap_or(1.0)
}

fn sampled(source: &Source) -> impl Iterator<Item = f32> {
    let (width, height) = source.size();
    let place = |k: usize, pixels: usize| (2 * k + 1) * pixels / (2 * SAMPLES);
    let at = move |k: usize| source.values_at(place(k % SAMPLES, width), place(k / SAMPLES, height)).first().copied();
    (0..SAMPLES * SAMPLES).filter_map(at).filter(|value| value.is_finite())
}

fn outermost(values: impl Iterator<Item = f32>) -> Option<f32> {
    let mut values: Vec<f32> = values.collect();
    values.sort_unstable_by(f32::total_cmp);
    let brightest = values.get(values.len().saturating_sub(1) * 199 / 200).copied();
    brightest.filter(|value| *value > 0.0)
}

/// The photos of a light, each with its weight, added up.
pub(super) fn combination(
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
pub(super) fn reference<'a>(document: &Document, results: &'a Results, light: &str) -> Option<&'a Stored> {
    let colour = document.set.colours.first()?;
    let Shown::Photo(name) = Shown::object(light, &colour.name) else { return None };
    results.pictures().plane(&PlaneName::Photo(name))
}

/// Light from black to the brightest value.
fn grey(range: [f32; 2]) -> Display {
    Display { range: from_zero(range), ..Display::default() }
}

fn from_zero(range: [f32; 2]) -> [f32; 2] {
    [0.0, range[1].max(f32::MIN_POSITIVE)]
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

/// What is shown in the place of a picture whose stage is at work.
pub fn previewed(shown: &Shown, document: &Document, results: &Results) -> Option<&'static str> {
    match shown {
        Shown::Plain(name) => preview::words(name, document, results),
        Shown::Difference(a, b) => previewed(a, document, results).or_else(|| previewed(b, document, results)),
        _ => None,
    }
}

/// What keeps a picture that is shown from being that of the document: it is the last that could be made.
pub fn outdated(shown: &Shown, document: &Document, results: &Results) -> Option<String> {
    let step = shown.step();
    match results.state(step, document) {
        StageState::Failed { line } | StageState::Blocked { line } | StageState::Cancelled { line }
            if step > Step::Load =>
        {
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
    if let Shown::Plain(name) = shown
        && let Some(line) = (name.plain.row().impossible)(&document.set)
    {
        return PictureError::Impossible { line };
    }
    let step = shown.step();
    match results.state(step, document) {
        StageState::Failed { line } | StageState::Blocked { line } | StageState::Cancelled { line } => {
            PictureError::Step { line }
        }
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
