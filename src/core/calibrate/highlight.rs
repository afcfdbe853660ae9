//! The direction to a lamp from its highlight on a mirror ball.

use super::{
    CalibrateError, DirectionEstimate,
    direction::{check_circle_sd, check_lamp_distance},
};
use crate::image::photo::CLIPPED;
use crate::interval::quantile;
use crate::options::check_range;
use crate::sphere::{Ball, seen_from_centre};
use crate::{Photo, Plane};
use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

/// How to look for highlights.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HighlightOptions {
    /// Spots at least this bright, as a fraction of the brightest, are candidates.
    pub min_peak: f64,
    /// Highlights farther out are not looked for, in ball radii.
    pub max_radii: f64,
    /// The most candidates to report.
    pub max_candidates: usize,
    /// Standard deviation of the circle's centre (each axis) and radius in pixels;
    /// [`crate::sphere::CircleReport::sd_px`].
    pub circle_sd_px: f64,
    /// Distance from the ball's centre to the lamp in ball radii, for a near lamp; absent for a distant one.
    pub lamp_distance_radii: Option<f64>,
}

impl Default for HighlightOptions {
    fn default() -> Self {
        Self { min_peak: 0.5, max_radii: 0.95, max_candidates: 12, circle_sd_px: 0.1, lamp_distance_radii: None }
    }
}

impl HighlightOptions {
    /// Whether every option is in its range.
    pub fn check(&self) -> Result<(), CalibrateError> {
        check_range("min_peak", self.min_peak, (0.05..=0.95).contains(&self.min_peak), "between 0.05 and 0.95")?;
        check_range("max_radii", self.max_radii, (0.2..=1.0).contains(&self.max_radii), "between 0.2 and 1")?;
        check_range("max_candidates", self.max_candidates as f64, self.max_candidates >= 1, "1 or more")?;
        check_circle_sd(self.circle_sd_px)?;
        check_lamp_distance(self.lamp_distance_radii)
    }
}

/// A bright spot on a mirror ball.
#[derive(Clone, Debug, PartialEq)]
pub struct Highlight {
    /// Its centre in pixels.
    pub position_px: (f64, f64),
    /// Standard deviation of the centre, each axis, in pixels.
    pub position_sd_px: f64,
    /// Pixels of its core, at least 0.9 of its peak.
    pub area_px: usize,
    /// Linear light of its brightest pixel.
    pub peak: f64,
    /// Whether the peak is clipped, so that only the shape of the core gives the centre.
    pub clipped: bool,
    /// How many of the other lamps' photos show the same spot nearly as bright: a reflection of the room, not of the
    /// lamp.
    pub seen_under_other_lamps: usize,
    /// Rank of the candidate; the sum of all candidates' scores is 1.
    pub score: f64,
    /// The direction to the light if this is its highlight.
    pub direction: DirectionEstimate,
}

/// All bright spots, the likeliest first.
#[derive(Clone, Debug, PartialEq)]
pub struct HighlightReport {
    /// Candidates; never empty. The first is the lamp unless the user chooses another.
    pub candidates: Vec<Highlight>,
}

impl HighlightReport {
    /// The likeliest candidate.
    pub fn chosen(&self) -> Option<&Highlight> {
        self.candidates.first()
    }

    /// Whether another candidate is nearly as likely, so that the user should look.
    pub fn is_ambiguous(&self) -> bool {
        matches!(self.candidates.as_slice(), [first, second, ..] if second.score > 0.5 * first.score)
    }
}

/// Finds the highlights on a mirror ball and the directions d = 2 (n.v) n - v they stand for.
///
/// `other_lamps` are photos of the same ball in the same place under the other lamps, or none: spots that stay are
/// ranked last. A lamp's highlight is ranked by the light of its core: reflections of lit things are dimmer, their
/// highlights smaller. A large core is centred on its smoothed top, so that streaks of light on the ball's surface do
/// not draw it away.
pub fn find_highlights(
    photo: &Photo,
    other_lamps: &[&Photo],
    ball: &Ball,
    options: &HighlightOptions,
) -> Result<HighlightReport, CalibrateError> {
    options.check()?;
    let size = photo.linear.size();
    if let Some(other) = other_lamps.iter().map(|p| p.linear.size()).find(|&other| other != size) {
        return Err(CalibrateError::SizesDiffer { first: size, other });
    }
    if !ball.circle().lies_in(size) {
        return Err(CalibrateError::LeavesImage { circle: ball.circle(), size });
    }
    let view = BallView::new(&photo.linear, ball, options.max_radii);
    let mut values: Vec<f64> = view.light.data().iter().map(|&v| f64::from(v)).collect();
    let (background, brightest) = (quantile(&mut values, 0.5), quantile(&mut values, 1.0));
    if brightest <= 3.0 * background.max(1e-3) {
        return Err(CalibrateError::NoHighlight { peak: brightest });
    }
    let spots = components(&view.light, options.min_peak * brightest);
    let mut candidates: Vec<Highlight> =
        spots.iter().filter_map(|spot| describe(spot, &view, photo, other_lamps, ball, options)).collect();
    let total: f64 = candidates.iter().map(|c| c.score).sum();
    candidates.iter_mut().for_each(|candidate| candidate.score /= total);
    candidates.sort_by(|a, b| b.score.total_cmp(&a.score));
    candidates.truncate(options.max_candidates);
    if candidates.is_empty() {
        return Err(CalibrateError::NoHighlight { peak: brightest });
    }
    Ok(HighlightReport { candidates })
}

/// The square around the ball with everything off the ball black.
struct BallView {
    origin: (usize, usize),
    light: Plane,
}

impl BallView {
    fn new(linear: &Plane, ball: &Ball, max_radii: f64) -> Self {
        let circle = ball.circle();
        let ((cx, cy), r) = (circle.centre_px, circle.radius_px);
        let origin = ((cx - r).max(0.0) as usize, (cy - r).max(0.0) as usize);
        let end = |centre: f64, side: usize| ((centre + r).ceil() as usize).min(side);
        let (width, height) = (end(cx, linear.width()) - origin.0, end(cy, linear.height()) - origin.1);
        let light = Plane::from_fn(width, height, |x, y| {
            let (x, y) = (x + origin.0, y + origin.1);
            let on_ball = circle.radii_from_centre(x as f64 + 0.5, y as f64 + 0.5) <= max_radii;
            let value = linear.at(x, y);
            if on_ball && value.is_finite() { value } else { 0.0 }
        });
        Self { origin, light }
    }
}

/// Connected pixels (eight neighbours) at or above a level.
fn components(light: &Plane, level: f64) -> Vec<Vec<(usize, usize)>> {
    let (width, height) = light.size();
    let bright = |x: usize, y: usize| f64::from(light.at(x, y)) >= level;
    let mut visited = vec![false; width * height];
    let mut found = Vec::new();
    for start in (0..width * height).filter(|&i| bright(i % width, i / width)) {
        if std::mem::replace(&mut visited[start], true) {
            continue;
        }
        let mut component = vec![(start % width, start / width)];
        let mut next = 0;
        while let Some(&(x, y)) = component.get(next) {
            next += 1;
            for ny in y.saturating_sub(1)..(y + 2).min(height) {
                for nx in x.saturating_sub(1)..(x + 2).min(width) {
                    if bright(nx, ny) && !std::mem::replace(&mut visited[ny * width + nx], true) {
                        component.push((nx, ny));
                    }
                }
            }
        }
        found.push(component);
    }
    found
}

fn describe(
    spot: &[(usize, usize)],
    view: &BallView,
    photo: &Photo,
    other_lamps: &[&Photo],
    ball: &Ball,
    options: &HighlightOptions,
) -> Option<Highlight> {
    let value = |&(x, y): &(usize, usize)| f64::from(view.light.at(x, y));
    let peak = spot.iter().map(value).fold(0.0, f64::max);
    let core: Vec<(usize, usize)> = spot.iter().copied().filter(|pixel| value(pixel) >= 0.9 * peak).collect();
    let (centre, sd) = if core.len() < LARGE_CORE_PX {
        light_centre(spot, &view.light)
    } else {
        top_centre(spot, &view.light, core.len())
    };
    let position_px = (centre.0 + view.origin.0 as f64, centre.1 + view.origin.1 as f64);

    let column = |x: usize| x + view.origin.0;
    let row = |y: usize| y + view.origin.1;
    let clipped = core.iter().any(|&(x, y)| photo.marks.at(column(x), row(y)) & CLIPPED != 0);
    let seen_under_other_lamps = other_lamps
        .iter()
        .filter(|other| {
            let light: f64 = core.iter().map(|&(x, y)| f64::from(other.linear.at(column(x), row(y)))).sum();
            light > 0.7 * core.iter().map(value).sum::<f64>()
        })
        .count();
    let stays = if seen_under_other_lamps == 0 { 1.0 } else { 0.1 };
    let direction = direction_of(position_px, sd, ball, options)?;
    let score = stays * core.iter().map(value).sum::<f64>();
    Some(Highlight {
        position_px,
        position_sd_px: sd,
        area_px: core.len(),
        peak,
        clipped,
        seen_under_other_lamps,
        score,
        direction,
    })
}

/// Cores of fewer pixels are centred on all their light; larger ones are saturated or streaked and are centred on their
/// top.
const LARGE_CORE_PX: usize = 30;

/// Centre of all light of a small spot and its surroundings, down to a tenth of its peak. Where in its pixel a lamp
/// smaller than a pixel lies is not known: a uniform error of half a pixel either way.
fn light_centre(spot: &[(usize, usize)], light: &Plane) -> ((f64, f64), f64) {
    const PIXEL_SD: f64 = 0.289;
    let peak = spot.iter().map(|&(x, y)| light.at(x, y)).fold(0.0, f32::max);
    let xs = || spot.iter().map(|&(x, _)| x);
    let ys = || spot.iter().map(|&(_, y)| y);
    let columns = xs().min().unwrap_or(0).saturating_sub(2)..(xs().max().unwrap_or(0) + 3).min(light.width());
    let rows = ys().min().unwrap_or(0).saturating_sub(2)..(ys().max().unwrap_or(0) + 3).min(light.height());
    let around = rows.flat_map(|y| columns.clone().map(move |x| (x, y)));
    let bright = around.filter(|&(x, y)| light.at(x, y) >= 0.1 * peak);
    let centre = centroid(bright.map(|(x, y)| (x, y, f64::from(light.at(x, y)))));
    (centre, PIXEL_SD + 0.05 * (spot.len() as f64).sqrt())
}

/// Centre of the top of a large spot, smoothed by a third of its core's radius. What the choice of the level changes,
/// and a twentieth of the core's radius, are its error.
fn top_centre(spot: &[(usize, usize)], light: &Plane, core_px: usize) -> ((f64, f64), f64) {
    let radius = (core_px as f64 / std::f64::consts::PI).sqrt();
    let sigma = radius / 3.0;
    let smooth: Vec<(usize, usize, f64)> =
        spot.par_iter().map(|&(x, y)| (x, y, smoothed(light, x, y, sigma))).collect();
    let peak = smooth.iter().map(|&(.., v)| v).fold(0.0, f64::max);
    let at_level =
        |level: f64| centroid(smooth.iter().filter(|&&(.., v)| v >= level * peak).map(|&(x, y, _)| (x, y, 1.0)));
    let centre = at_level(0.92);
    let shifts = [0.8, 0.97].map(|level| (at_level(level).0 - centre.0).hypot(at_level(level).1 - centre.1));
    let spread = shifts.iter().sum::<f64>() / 2.0;
    (centre, spread.hypot(0.05 * radius).hypot(0.1))
}

fn centroid(pixels: impl Iterator<Item = (usize, usize, f64)>) -> (f64, f64) {
    let (x, y, weight) = pixels.fold((0.0, 0.0, 0.0), |(sx, sy, sw), (x, y, w)| {
        (sx + w * (x as f64 + 0.5), sy + w * (y as f64 + 0.5), sw + w)
    });
    (x / weight, y / weight)
}

fn smoothed(light: &Plane, x: usize, y: usize, sigma: f64) -> f64 {
    let reach = (3.0 * sigma).ceil() as usize;
    let (mut sum, mut weight) = (0.0, 0.0);
    for ny in y.saturating_sub(reach)..(y + reach + 1).min(light.height()) {
        for nx in x.saturating_sub(reach)..(x + reach + 1).min(light.width()) {
            let squared = nx.abs_diff(x).pow(2) + ny.abs_diff(y).pow(2);
            let w = (-0.5 * squared as f64 / (sigma * sigma)).exp();
            sum += w * f64::from(light.at(nx, ny));
            weight += w;
        }
    }
    sum / weight
}

/// The direction to a lamp whose highlight lies at a position, with the errors of the position and the circle.
fn direction_of(
    (x, y): (f64, f64),
    position_sd_px: f64,
    ball: &Ball,
    options: &HighlightOptions,
) -> Option<DirectionEstimate> {
    let direction = |ball: &Ball, x: f64, y: f64| {
        let point = ball.surface_at(x, y)?;
        let seen = point.direction_mirrored();
        Some(options.lamp_distance_radii.map_or(seen, |distance| seen_from_centre(point.normal, seen, distance)))
    };
    let found = direction(ball, x, y)?;
    let centre_sd = position_sd_px.hypot(options.circle_sd_px);
    let shifted = [
        direction(ball, x + centre_sd, y).or_else(|| direction(ball, x - centre_sd, y)),
        direction(ball, x, y + centre_sd).or_else(|| direction(ball, x, y - centre_sd)),
        direction(&ball.perturbed((0.0, 0.0), options.circle_sd_px), x, y),
    ];
    let shifts = shifted.into_iter().flatten().map(|moved: Vector3<f64>| moved - found);
    let covariance: Matrix3<f64> = shifts.map(|shift| shift * shift.transpose()).sum();
    Some(DirectionEstimate::new(found, &covariance, usize::MAX))
}
