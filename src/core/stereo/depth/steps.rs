//! From normals to the steps in height between neighbouring pixels.

use rayon::prelude::*;

use super::laplacian::Grid;
use crate::{Camera, Mask, NormalMap, Plane, Projection};

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Region {
    pub left: usize,
    pub top: usize,
    pub width: usize,
    pub height: usize,
}

impl Region {
    /// The smallest rectangle that holds the mask; `None` for an empty one.
    pub fn around(mask: &Mask) -> Option<Self> {
        let rows = mask.data().chunks(mask.width().max(1));
        let spans: Vec<(usize, usize, usize)> = rows
            .enumerate()
            .filter_map(|(y, row)| {
                let left = row.iter().position(|&inside| inside)?;
                Some((y, left, row.iter().rposition(|&inside| inside)?))
            })
            .collect();
        let (top, bottom) = (spans.first()?.0, spans.last()?.0);
        let left = spans.iter().map(|span| span.1).min()?;
        let right = spans.iter().map(|span| span.2).max()?;
        Some(Self { left, top, width: right - left + 1, height: bottom - top + 1 })
    }

    /// Copies the region's values into their place in an image.
    pub fn place<T: Copy>(&self, values: &[T], image_width: usize, image: &mut [T]) {
        let rows = image.chunks_mut(image_width).skip(self.top);
        for (row, values) in rows.zip(values.chunks(self.width)) {
            row[self.left..self.left + self.width].copy_from_slice(values);
        }
    }
}

/// The slope of the surface at a pixel.
#[derive(Clone, Copy, Default)]
struct Slope {
    /// Height gained per pixel to the right.
    right: f32,
    /// Height gained per pixel down.
    down: f32,
    /// From the pixel's own normal, not from its neighbours.
    measured: bool,
    /// How much the slope can be trusted; zero where there is none.
    confidence: f32,
    clamped: bool,
}

/// For each pixel of a region the step in height to its right and its lower neighbour, in pixels.
pub struct Steps {
    right: Vec<f32>,
    down: Vec<f32>,
    pub clamped_pixels: usize,
    pub pixels_without_normal: usize,
}

impl Steps {
    /// Takes the steps from the normals inside the mask, and how much each counts as the weights of a grid.
    ///
    /// With perspective the height is -f ln(distance) instead of z (Queau, Durou, Aujol, Normal integration: a survey,
    /// JMIV 60, 2018, section 2): for a point d (u, v, -1), with u and v the pixel's position over the focal length f,
    /// n . dX/du = 0 gives d(ln d)/du = n_x / (n_z - u n_x - v n_y). Orthographic is the case u = v = 0.
    pub fn new(
        normals: &NormalMap,
        mask: &Mask,
        confidence: Option<&Plane>,
        camera: &Camera,
        region: Region,
        max_slope: f64,
    ) -> (Self, Grid) {
        let width = region.width;
        let most = confidence
            .map_or(1.0, |plane| plane.data().par_iter().copied().filter(|c| c.is_finite()).reduce(|| 0.0, f32::max));
        let pixel = |index: usize| (region.left + index % width, region.top + index / width);
        let mut slopes: Vec<Slope> = (0..width * region.height)
            .into_par_iter()
            .map(|index| {
                let (x, y) = pixel(index);
                let confidence =
                    if mask.at(x, y) { confidence.map_or(1.0, |plane| plane.at(x, y) / most) } else { 0.0 };
                slope(normals, (x, y), tilt_of_ray(camera, x, y), confidence, max_slope)
            })
            .collect();
        let clamped_pixels = slopes.par_iter().filter(|slope| slope.clamped).count();
        let missing = |index: &usize| {
            let (x, y) = pixel(*index);
            mask.at(x, y) && slopes[*index].confidence == 0.0
        };
        let missing: Vec<usize> = (0..slopes.len()).into_par_iter().filter(missing).collect();
        bridge(&mut slopes, width, &missing);

        let pixels = (0..slopes.len()).into_par_iter();
        let (right, right_weight) = pixels
            .clone()
            .map(|i| {
                if (i + 1).is_multiple_of(width) {
                    NO_STEP
                } else {
                    step(&slopes[i], &slopes[i + 1], |slope| slope.right)
                }
            })
            .unzip();
        let (down, down_weight) = pixels
            .map(|i| slopes.get(i + width).map_or(NO_STEP, |below| step(&slopes[i], below, |slope| slope.down)))
            .unzip();
        let inside = slopes.par_iter().map(|slope| slope.confidence > 0.0).collect();
        let steps = Self { right, down, clamped_pixels, pixels_without_normal: missing.len() };
        (steps, Grid::new(width, inside, right_weight, down_weight))
    }

    /// The weight of each step at a pixel, and by how much the heights miss it (counted away from the pixel).
    pub fn misfits<'a>(&'a self, grid: &'a Grid, height: &'a [f64], here: usize) -> impl Iterator<Item = (f64, f64)> {
        let directions = [(&self.right, grid.right(), 1), (&self.down, grid.down(), grid.width())];
        directions.into_iter().flat_map(move |(steps, weights, stride)| {
            let before = here.checked_sub(stride);
            let forward = (here, 1.0);
            let backward = before.map(|before| (before, -1.0));
            [Some(forward), backward].into_iter().flatten().filter(|&(from, _)| weights[from] > 0.0).map(
                move |(from, sign)| {
                    let misfit = height[from + stride] - height[from] - f64::from(steps[from]);
                    (f64::from(weights[from]), sign * misfit)
                },
            )
        })
    }

    /// The weighted root mean square misfit of the steps at each pixel, and over all of them.
    pub fn slope_residual(&self, grid: &Grid, height: &[f64]) -> (Vec<f32>, f64) {
        let add = |sum: (f64, f64), (weight, square): (f64, f64)| (sum.0 + weight, sum.1 + square);
        let rms = |(weight, square): (f64, f64)| if weight > 0.0 { (square / weight).sqrt() } else { 0.0 };
        let sums: Vec<(f64, f64)> = (0..height.len())
            .into_par_iter()
            .map(|here| {
                let squares =
                    self.misfits(grid, height, here).map(|(weight, misfit)| (weight, weight * misfit * misfit));
                squares.fold((0.0, 0.0), add)
            })
            .collect();
        let rows: Vec<(f64, f64)> =
            sums.par_chunks(grid.width()).map(|row| row.iter().copied().fold((0.0, 0.0), add)).collect();
        let total = rows.into_iter().fold((0.0, 0.0), add);
        (sums.into_par_iter().map(|sum| rms(sum) as f32).collect(), rms(total))
    }
}

const NO_STEP: (f32, f32) = (0.0, 0.0);

/// Slopes that count less than this beside the best are as good as missing, and would only slow the solver down.
const MIN_CONFIDENCE: f32 = 1e-6;

/// How much a slope that is guessed from its neighbours counts beside theirs.
const BRIDGE_CONFIDENCE: f32 = 0.1;

/// How far the ray through the centre of pixel `(x, y)` leans to the right and upward.
fn tilt_of_ray(camera: &Camera, x: usize, y: usize) -> (f32, f32) {
    match camera.projection {
        Projection::Orthographic { .. } => (0.0, 0.0),
        Projection::Perspective { focal_length_px, principal_point_px: (x0, y0), .. } => {
            (((x as f64 + 0.5 - x0) / focal_length_px) as f32, ((y0 - y as f64 - 0.5) / focal_length_px) as f32)
        }
    }
}

fn slope(normals: &NormalMap, (x, y): (usize, usize), (u, v): (f32, f32), confidence: f32, max_slope: f64) -> Slope {
    let Some(normal) = normals.at(x, y) else { return Slope::default() };
    let sideways = normal.x.hypot(normal.y);
    let toward_camera = normal.z - u * normal.x - v * normal.y;
    let least = sideways / max_slope as f32;
    let facing = toward_camera.max(least);
    if facing <= 0.0 || !(MIN_CONFIDENCE..=1.0).contains(&confidence) {
        return Slope::default();
    }
    let clamped = toward_camera < least;
    Slope { right: -normal.x / facing, down: normal.y / facing, measured: true, confidence, clamped }
}

/// Gives the pixels of the mask without a slope the mean of their neighbours', layer by layer from the rim inward, so
/// that a line of bad pixels does not cut the surface.
fn bridge(slopes: &mut [Slope], width: usize, missing: &[usize]) {
    let mut is_missing = vec![false; slopes.len()];
    missing.iter().for_each(|&index| is_missing[index] = true);
    let mut rim = missing.to_vec();
    while !rim.is_empty() {
        let layer: Vec<(usize, Slope)> = rim
            .par_iter()
            .filter_map(|&index| {
                let known = || neighbours(index, width, slopes.len()).map(|i| slopes[i]).filter(|s| s.confidence > 0.0);
                let count = known().count() as f32;
                let mean = |component: fn(&Slope) -> f32| known().map(|slope| component(&slope)).sum::<f32>() / count;
                let trust = |slope: Slope| if slope.measured { BRIDGE_CONFIDENCE } else { 1.0 } * slope.confidence;
                let confidence = known().map(trust).fold(0.0, f32::max);
                let slope = Slope { right: mean(|s| s.right), down: mean(|s| s.down), confidence, ..Slope::default() };
                (count > 0.0).then_some((index, slope))
            })
            .collect();
        rim.clear();
        for &(index, slope) in &layer {
            (slopes[index], is_missing[index]) = (slope, false);
        }
        for &(index, _) in &layer {
            for next in neighbours(index, width, slopes.len()) {
                if std::mem::take(&mut is_missing[next]) {
                    rim.push(next);
                }
            }
        }
    }
}

/// The pixels left, right, above and below.
fn neighbours(index: usize, width: usize, pixels: usize) -> impl Iterator<Item = usize> {
    let left = (!index.is_multiple_of(width)).then(|| index - 1);
    let right = (!(index + 1).is_multiple_of(width)).then_some(index + 1);
    let below = (index + width < pixels).then_some(index + width);
    [left, right, index.checked_sub(width), below].into_iter().flatten()
}

/// The step between two neighbours and its weight: the mean of their slopes, which is exact on a quadratic surface and
/// right on average where a crease passes between them; but a guess has no say beside a measurement.
fn step(a: &Slope, b: &Slope, component: fn(&Slope) -> f32) -> (f32, f32) {
    if a.confidence == 0.0 || b.confidence == 0.0 {
        return NO_STEP;
    }
    let step = match (a.measured, b.measured) {
        (true, false) => component(a),
        (false, true) => component(b),
        _ => 0.5 * (component(a) + component(b)),
    };
    // The variance of a mean of two: a harmonic mean of confidences.
    (step, 2.0 / (a.confidence.recip() + b.confidence.recip()))
}
