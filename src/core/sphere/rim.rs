//! Edge points on the rim, to a fraction of a pixel.
//!
//! Just inside the rim of a ball the light does not stay level: the normal turns by the square root of the distance to
//! the rim, and with it the shading of a painted ball and the reflection in a mirror. A plain search for the steepest
//! place is drawn inward by that. So each profile across the rim is fitted by an edge model: one level outside, inside
//! a step and a square root, blurred alike. The edge is where the model fits best.
//!
//! On the side away from a lamp the light ends before the rim does, and that looks like a faint edge. So each part of
//! the rim is taken from the lamp that shows it most strongly, and parts that no lamp shows strongly are left out.

use super::{Circle, edges::white_of};
use crate::Plane;
use crate::interval::quantile;
use rayon::prelude::*;
use std::sync::LazyLock;

/// Samples along a profile, and places where its edge is tried.
const SAMPLES: usize = 41;
const PLACES: usize = 61;
/// Edges are looked for in this inner part of a profile.
const SEARCHED: f64 = 0.8;
/// Blurs of the lens that are tried, standard deviation in samples of the profile.
const BLURS: [f64; 5] = [1.5, 3.0, 5.0, 8.0, 12.0];
/// How many times better than a level the model must fit to be an edge, an F statistic.
const SIGNIFICANT: f64 = 15.0;
/// Rim points that are weaker than this fraction of the strong ones may be the end of the light.
const WEAKEST: f64 = 0.5;

static MODELS: LazyLock<Vec<EdgeModel>> =
    LazyLock::new(|| BLURS.par_iter().map(|&blur| EdgeModel::new(blur)).collect());

/// A place where the rim was seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct RimPoint {
    /// Around the circle, 0 to 1 turn.
    pub turn: f64,
    /// Position in pixels.
    pub x: f64,
    pub y: f64,
    /// Standard deviation across the rim, pixels.
    pub sd_px: f64,
    /// How much brighter it is just inside than outside.
    pub height: f64,
}

/// Looks for the rim within `half_width_px` of a circle, at `count` places around it. Keeps the polarity that most of
/// it has.
pub(super) fn rim_points(images: &[&Plane], circle: &Circle, half_width_px: f64, count: usize) -> Vec<RimPoint> {
    let whites: Vec<f64> = images.iter().map(|image| white_of(image)).collect();
    let profiles_at = |index: usize| {
        let turn = (index as f64 + 0.5) / count as f64;
        let profiles = images.iter().zip(&whites);
        profiles.filter_map(move |(image, &white)| profile(image, white, circle, half_width_px, turn)).collect()
    };
    let profiles: Vec<Vec<[f64; SAMPLES]>> = (0..count).into_par_iter().map(profiles_at).collect();
    let model = sharpest_model(profiles.iter().step_by(8).flatten());

    let mut points: Vec<RimPoint> = profiles
        .par_iter()
        .enumerate()
        .filter_map(|(index, of_lamps)| {
            let fits = of_lamps.iter().filter_map(|values| model.fit(values));
            let fit = fits.max_by(|a, b| a.height.abs().total_cmp(&b.height.abs()))?;
            let turn = (index as f64 + 0.5) / count as f64;
            let (sin, cos) = (turn * std::f64::consts::TAU).sin_cos();
            let distance = circle.radius_px + fit.place * half_width_px;
            let (x, y) = (circle.centre_px.0 + distance * cos, circle.centre_px.1 + distance * sin);
            Some(RimPoint { turn, x, y, sd_px: fit.sd * half_width_px, height: fit.height })
        })
        .collect();
    let brighter_inside = points.iter().map(|p| p.height).sum::<f64>() >= 0.0;
    points.retain(|p| (p.height > 0.0) == brighter_inside);
    let strong = quantile(&mut points.iter().map(|p| p.height.abs()).collect::<Vec<_>>(), 0.9);
    points.retain(|p| p.height.abs() > WEAKEST * strong && p.sd_px < 0.3 * half_width_px);
    points
}

/// Light across the rim from inside to outside; `None` where it leaves the photo.
fn profile(image: &Plane, white: f64, circle: &Circle, half_width_px: f64, turn: f64) -> Option<[f64; SAMPLES]> {
    let (sin, cos) = (turn * std::f64::consts::TAU).sin_cos();
    let at = |along: f64| {
        let distance = circle.radius_px + half_width_px * along;
        (circle.centre_px.0 + distance * cos, circle.centre_px.1 + distance * sin)
    };
    let (x, y) = at(1.0);
    let inside = x > 0.5 && y > 0.5 && x < image.width() as f64 - 0.5 && y < image.height() as f64 - 0.5;
    inside.then(|| {
        std::array::from_fn(|sample| {
            let (x, y) = at(position(sample));
            (image.sample(x, y) / white).min(1.0)
        })
    })
}

/// The model whose blur fits these profiles best.
fn sharpest_model<'a>(profiles: impl Iterator<Item = &'a [f64; SAMPLES]>) -> &'static EdgeModel {
    let sample: Vec<_> = profiles.collect();
    let misfit = |model: &EdgeModel| -> f64 {
        sample.par_iter().map(|values| model.fit(values).map_or(spread(values), |fit| fit.misfit)).sum()
    };
    let best = MODELS.iter().map(|model| (misfit(model), model)).min_by(|a, b| a.0.total_cmp(&b.0));
    best.map_or(&MODELS[0], |(_, model)| model)
}

fn spread(values: &[f64; SAMPLES]) -> f64 {
    let mean = values.iter().sum::<f64>() / SAMPLES as f64;
    values.iter().map(|v| (v - mean).powi(2)).sum()
}

/// Position of a sample on its profile, -1 inside to 1 outside.
fn position(sample: usize) -> f64 {
    2.0 * sample as f64 / (SAMPLES - 1) as f64 - 1.0
}

/// The shapes a profile can have, for every place of the edge.
struct EdgeModel {
    places: Vec<Shapes>,
}

/// Level, square root and step at one place, orthonormal in this order, and how to read heights from their shares.
struct Shapes {
    columns: [[f64; SAMPLES]; 3],
    /// Height of the model a quarter of the profile's half width inside its edge, for each column's share.
    height: [f64; 3],
}

struct EdgeFit {
    /// Along the profile, -1 to 1, and its standard deviation.
    place: f64,
    sd: f64,
    height: f64,
    misfit: f64,
}

impl EdgeModel {
    fn new(blur_samples: f64) -> Self {
        let blur = blur_samples * 2.0 / (SAMPLES - 1) as f64;
        let places = (0..PLACES).map(|place| Shapes::new(place_of(place as f64), blur)).collect();
        Self { places }
    }

    /// The best place of the edge; `None` where a level explains the profile nearly as well, or the place is at the
    /// end.
    fn fit(&self, values: &[f64; SAMPLES]) -> Option<EdgeFit> {
        let energy: f64 = values.iter().map(|v| v * v).sum();
        let misfits: [f64; PLACES] = std::array::from_fn(|place| {
            energy - self.places[place].columns.iter().map(|column| dot(column, values).powi(2)).sum::<f64>()
        });
        let best = (1..PLACES - 1).min_by(|&a, &b| misfits[a].total_cmp(&misfits[b]))?;
        let (before, here, after) = (misfits[best - 1], misfits[best], misfits[best + 1]);
        if here > before || here > after {
            return None;
        }
        let shapes = &self.places[best];
        let variance = (here / (SAMPLES - 4) as f64).max(1e-9);
        let level = dot(&shapes.columns[0], values).powi(2);
        if (energy - level - here) / 3.0 < SIGNIFICANT * variance {
            return None;
        }
        let curvature = (before - 2.0 * here + after).max(1e-12);
        let offset = 0.5 * (before - after) / curvature;
        let step = place_of(1.0) - place_of(0.0);
        let height = shapes.columns.iter().zip(&shapes.height).map(|(c, h)| dot(c, values) * h).sum();
        Some(EdgeFit {
            place: place_of(best as f64 + offset),
            sd: (2.0 * variance / curvature).sqrt() * step,
            height,
            misfit: here,
        })
    }
}

impl Shapes {
    fn new(edge: f64, blur: f64) -> Self {
        let shape = |f: fn(f64) -> f64| std::array::from_fn(|s| blurred(f, edge - position(s), blur));
        let root = |depth: f64| depth.max(0.0).sqrt();
        let mut columns = [[1.0; SAMPLES], shape(root), shape(|depth| if depth > 0.0 { 1.0 } else { 0.0 })];
        // What each column is worth inside the edge less outside, carried through the orthonormalisation.
        let mut height = [0.0, root(0.25), 1.0];
        for current in 0..3 {
            for earlier in 0..current {
                let share = dot(&columns[earlier], &columns[current]);
                let done = columns[earlier];
                columns[current].iter_mut().zip(done).for_each(|(c, e)| *c -= share * e);
                height[current] -= share * height[earlier];
            }
            let scale = 1.0 / dot(&columns[current], &columns[current]).sqrt().max(1e-9);
            columns[current].iter_mut().for_each(|c| *c *= scale);
            height[current] *= scale;
        }
        Self { columns, height }
    }
}

fn place_of(index: f64) -> f64 {
    SEARCHED * (2.0 * index / (PLACES - 1) as f64 - 1.0)
}

/// `f` smoothed by a Gaussian of standard deviation `blur`, at `depth` inside the edge.
fn blurred(f: fn(f64) -> f64, depth: f64, blur: f64) -> f64 {
    let (mut sum, mut weight) = (0.0, 0.0);
    for node in -30..=30 {
        let z = f64::from(node) / 10.0;
        let w = (-0.5 * z * z).exp();
        sum += w * f(depth + z * blur);
        weight += w;
    }
    sum / weight
}

fn dot(a: &[f64; SAMPLES], b: &[f64; SAMPLES]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
