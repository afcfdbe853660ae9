//! The direct and indirect light of every pixel, from what the cells around it know of the indirect light.

use rayon::prelude::*;

use super::SeparatedLight;
use super::grid::Grid;
use super::indirect::Indirect;
use super::split::Split;
use crate::image::noise::NoiseModel;
use crate::separate::{LightPhotos, OUTSIDE, UNSOLVED};
use crate::{Marks, Mask, Plane, Watch};

/// Rows of one job of a core.
const ROWS: usize = 16;
/// A pixel as bright as a cell within this share belongs to the same wall.
const ALIKE: f64 = 0.05;

/// Cells around a pixel, with weights that sum to 1; those of no weight at the end.
type Around = [(usize, f32); 4];

/// The part of one light's planes that one job writes.
struct Target<'a> {
    direct: &'a mut [f32],
    indirect: &'a mut [f32],
    noise: &'a mut [f32],
    marks: &'a mut [u8],
}

/// `None` when cancelled.
pub(super) fn apply(
    lights: &[LightPhotos],
    mask: &Mask,
    grid: &Grid,
    indirect: &[Indirect],
    watch: &dyn Watch,
) -> Option<Vec<SeparatedLight>> {
    let (width, height) = mask.size();
    let empty = || Plane::filled(width, height, 0.0);
    let mut separated: Vec<_> = (0..lights.len())
        .map(|_| SeparatedLight {
            direct: empty(),
            indirect: empty(),
            noise: empty(),
            marks: Marks::filled(width, height, OUTSIDE),
        })
        .collect();
    let jobs = jobs_of(&mut separated, width * ROWS);
    let count = jobs.len().max(1);
    let done = std::sync::atomic::AtomicUsize::new(0);
    jobs.into_par_iter().enumerate().for_each(|(job, mut targets)| {
        if !watch.cancelled() {
            for at in 0..targets.first().map_or(0, |target| target.marks.len()) {
                let pixel = job * width * ROWS + at;
                if mask.data()[pixel] {
                    let around = around(grid, lights, pixel % width, pixel / width);
                    for ((target, light), indirect) in targets.iter_mut().zip(lights).zip(indirect) {
                        solve(target, at, pixel, light, indirect, &around);
                    }
                }
            }
        }
        let finished = done.fetch_add(1, std::sync::atomic::Ordering::Relaxed) + 1;
        watch.progress(finished as f32 / count as f32);
    });
    (!watch.cancelled()).then_some(separated)
}

fn jobs_of(lights: &mut [SeparatedLight], pixels: usize) -> Vec<Vec<Target<'_>>> {
    let mut jobs: Vec<Vec<Target>> = Vec::new();
    for light in lights {
        let direct = light.direct.data_mut().chunks_mut(pixels.max(1));
        let indirect = light.indirect.data_mut().chunks_mut(pixels.max(1));
        let noise = light.noise.data_mut().chunks_mut(pixels.max(1));
        let marks = light.marks.data_mut().chunks_mut(pixels.max(1));
        for (job, (((direct, indirect), noise), marks)) in direct.zip(indirect).zip(noise).zip(marks).enumerate() {
            if job == jobs.len() {
                jobs.push(Vec::new());
            }
            jobs[job].push(Target { direct, indirect, noise, marks });
        }
    }
    jobs
}

fn solve(target: &mut Target, at: usize, pixel: usize, light: &LightPhotos, indirect: &Indirect, around: &Around) {
    let mean = |value: &dyn Fn(usize) -> f32| around.iter().map(|&(cell, weight)| weight * value(cell)).sum::<f32>();
    let (mut split, mut marks) = (Split::default(), 0);
    for (c, photo) in light.photos.iter().enumerate().take(indirect.colours_at(nearest(around))) {
        let mark = photo.marks.data()[pixel];
        marks |= mark;
        if mark == 0 {
            let (value, precision) = normalised(photo.linear.data()[pixel], &light.noise[c], light.alpha[c]);
            let ratio = mean(&|cell| indirect.ratio[c].at(cell));
            split.add(value, precision, light.beta[c], f64::from(ratio));
        }
    }
    let known = match &indirect.amount {
        Some(amount) if split.has_light() && around.iter().any(|(_, weight)| *weight > 0.0) => {
            let (light, variance) =
                (mean(&|cell| amount.light.data()[cell]), mean(&|cell| amount.variance.data()[cell]));
            Some((f64::from(light), split.direct_given(f64::from(light), f64::from(variance))))
        }
        Some(_) => None,
        None => {
            let (precision, weighted) = split.indirect();
            split.direct().map(|direct| (weighted / precision, direct))
        }
    };
    let Some((indirect, (direct, variance))) = known else {
        target.marks[at] = marks | UNSOLVED;
        return;
    };
    target.direct[at] = direct as f32;
    target.indirect[at] = indirect as f32;
    target.noise[at] = variance.sqrt() as f32;
    target.marks[at] = marks;
}

/// The cell of the largest weight.
fn nearest(around: &Around) -> usize {
    around.iter().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(cell, _)| *cell)
}

/// `N_c / alpha_c` and one over its variance.
fn normalised(value: f32, noise: &NoiseModel, alpha: f64) -> (f64, f64) {
    let light = f64::from(value);
    (light / alpha, alpha * alpha / noise.variance(light).max(f64::MIN_POSITIVE))
}

/// The cell of a pixel; of larger cells, those around it that lie in the object, weighted by distance and by how alike they are
/// under every light, so that the walls of a crease keep apart (J. Kopf, M. Cohen, D. Lischinski, M. Uyttendaele, "Joint bilateral
/// upsampling", SIGGRAPH 2007).
fn around(grid: &Grid, lights: &[LightPhotos], x: usize, y: usize) -> Around {
    let (width, height) = grid.size();
    if grid.step_px == 1 {
        return [(y * width + x, 1.0), (0, 0.0), (0, 0.0), (0, 0.0)];
    }
    let place = |pixel: usize, cells: usize| {
        let position = ((pixel as f64 + 0.5) / grid.step_px as f64 - 0.5).clamp(0.0, cells as f64 - 1.0);
        let first = (position as usize).min(cells.saturating_sub(2));
        (first, position - first as f64)
    };
    let ((column, u), (row, v)) = (place(x, width), place(y, height));
    let corner = |k: usize| {
        let (i, j) = (k % 2, k / 2);
        let cell = (row + j).min(height - 1) * width + (column + i).min(width - 1);
        let weight = [1.0 - u, u][i] * [1.0 - v, v][j];
        let weight = if grid.mask.data()[cell] { weight * alike(grid, lights, y, x, cell) + 1e-9 } else { 0.0 };
        (cell, weight as f32)
    };
    let mut around: Around = std::array::from_fn(corner);
    let sum: f32 = around.iter().map(|(_, weight)| weight).sum();
    if sum > 0.0 {
        around.iter_mut().for_each(|(_, weight)| *weight /= sum);
    }
    around
}

/// 1 for a pixel that is as bright as the cell under every light, less where it is not.
fn alike(grid: &Grid, lights: &[LightPhotos], y: usize, x: usize, cell: usize) -> f64 {
    let difference = |(light, of_grid): (&LightPhotos, &super::grid::GridLight)| {
        let (pixel, cell) =
            (f64::from(light.photos[0].linear.at(x, y)), f64::from(of_grid.colours[0].light.data()[cell]));
        (pixel - cell).powi(2) / (light.noise[0].variance(cell) + (ALIKE * cell).powi(2)).max(f64::MIN_POSITIVE)
    };
    let squares: f64 = lights.iter().zip(&grid.lights).map(difference).sum();
    (-0.5 * squares / lights.len().max(1) as f64).exp()
}
