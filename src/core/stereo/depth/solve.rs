//! Conjugate gradients under the multigrid preconditioner.

use rayon::prelude::*;

use super::laplacian::{Grid, Laplacian, dot};
use super::multigrid::Hierarchy;
use super::steps::Steps;
use super::{DepthError, DepthOptions};
use crate::Watch;

/// How far one round of f32 iterations may claim to reduce the error before it is checked in f64.
const ROUND: f64 = 1e-4;

/// How the solver ended.
pub struct Solution {
    /// Height of each pixel, in pixels, up to a constant for each island.
    pub height: Vec<f64>,
    pub iterations: usize,
    pub relative_residual: f64,
}

/// Heights whose steps come closest to `steps` in the least squares sense.
///
/// Heights are f64 because their second differences are what is solved for: in f32 a large smooth surface would round
/// them away. The search directions may be f32: only their direction matters.
pub fn solve(
    hierarchy: &Hierarchy,
    steps: &Steps,
    options: &DepthOptions,
    watch: &dyn Watch,
) -> Result<Solution, DepthError> {
    let pixels = hierarchy.grid().inside().len();
    let mut height = vec![0.0_f64; pixels];
    let mut residual = vec![0.0_f32; pixels];
    write_residual(hierarchy.grid(), steps, &height, &mut residual);
    let first_norm = dot(&residual, &residual).sqrt();
    if first_norm == 0.0 {
        return Ok(Solution { height, iterations: 0, relative_residual: 0.0 });
    }

    let mut scratch = hierarchy.scratch();
    let mut preconditioned = vec![0.0_f32; pixels];
    let mut spare = vec![0.0_f32; pixels];
    let mut direction = vec![0.0_f32; pixels];
    let mut iterations = 0;
    let mut first_energy = None;
    loop {
        // What the last round claims is checked on the heights themselves, and the next starts from there.
        write_residual(hierarchy.grid(), steps, &height, &mut residual);
        let mut relative_residual = dot(&residual, &residual).sqrt() / first_norm;
        hierarchy.cycle(&residual, &mut preconditioned, &mut spare, &mut scratch);
        let mut energy = dot(&residual, &preconditioned);
        let first_energy = *first_energy.get_or_insert(energy);
        // The residual weighs fine detail most; its product with the correction is the squared error in slope, so both
        // have to be small.
        let error = |energy: f64, relative_residual: f64| relative_residual.max((energy / first_energy).abs().sqrt());
        let start = error(energy, relative_residual);
        if start <= options.tolerance {
            return Ok(Solution { height, iterations, relative_residual });
        }
        // Aim a little lower than asked, so that rounding does not cost another round.
        let goal = (0.9 * options.tolerance).max(ROUND * start);
        direction.copy_from_slice(&preconditioned);
        loop {
            if iterations == options.max_iterations {
                return Err(DepthError::NotConverged { iterations, relative_residual, tolerance: options.tolerance });
            }
            if watch.cancelled() {
                return Err(DepthError::Cancelled);
            }
            iterations += 1;

            write_product(hierarchy.grid(), &direction, &mut spare);
            let length = energy / dot(&direction, &spare);
            let vectors = height.par_iter_mut().zip(&mut residual).zip(&direction).zip(&spare);
            vectors.with_min_len(1 << 12).for_each(|(((height, residual), direction), product)| {
                *height += length * f64::from(*direction);
                *residual -= length as f32 * product;
            });
            relative_residual = dot(&residual, &residual).sqrt() / first_norm;

            hierarchy.cycle(&residual, &mut preconditioned, &mut spare, &mut scratch);
            let last = std::mem::replace(&mut energy, dot(&residual, &preconditioned));
            let error = error(energy, relative_residual);
            watch.progress((error.ln() / options.tolerance.ln()).clamp(0.0, 1.0) as f32);
            if error <= goal {
                break;
            }
            let kept = (energy / last) as f32;
            direction.par_iter_mut().zip(&preconditioned).with_min_len(1 << 12).for_each(|(direction, new)| {
                *direction = new + kept * *direction;
            });
        }
    }
}

fn write_product(grid: &Grid, x: &[f32], out: &mut [f32]) {
    let piece = grid.piece();
    out.par_chunks_mut(piece).enumerate().for_each(|(index, out)| grid.product(index * piece, x, out));
}

/// By how much the heights miss each step, summed over the steps at each pixel: b - A x of the normal equations.
fn write_residual(grid: &Grid, steps: &Steps, height: &[f64], out: &mut [f32]) {
    out.par_iter_mut().enumerate().with_min_len(1 << 12).for_each(|(here, out)| {
        *out = steps.misfits(grid, height, here).map(|(weight, misfit)| weight * misfit).sum::<f64>() as f32;
    });
}
