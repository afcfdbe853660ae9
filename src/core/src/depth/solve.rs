//! Conjugate gradients under the multigrid preconditioner.

use rayon::prelude::*;

use super::laplacian::{Grid, Laplacian, dot};
use super::multigrid::Hierarchy;
use super::steps::Steps;
use super::{DepthError, DepthOptions};
use crate::Watch;

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
    let mut last_energy: Option<f64> = None;
    let mut first_energy = 0.0;
    let mut relative_residual: f64 = 1.0;
    for iterations in 0..=options.max_iterations {
        hierarchy.cycle(&residual, &mut preconditioned, &mut spare, &mut scratch);
        let energy = dot(&residual, &preconditioned);
        if iterations == 0 {
            first_energy = energy;
        }
        // The residual weighs fine detail most; its product with the correction is the squared error in slope, so both
        // have to be small. What the recursion claims is then checked on the heights themselves.
        let claimed = relative_residual.max((energy / first_energy).abs().sqrt());
        if claimed <= options.tolerance {
            write_residual(hierarchy.grid(), steps, &height, &mut residual);
            relative_residual = dot(&residual, &residual).sqrt() / first_norm;
            if relative_residual <= options.tolerance {
                return Ok(Solution { height, iterations, relative_residual });
            }
            hierarchy.cycle(&residual, &mut preconditioned, &mut spare, &mut scratch);
            last_energy = None;
        }
        if watch.cancelled() {
            return Err(DepthError::Cancelled);
        }
        watch.progress((claimed.ln() / options.tolerance.ln()).clamp(0.0, 1.0) as f32);

        let energy = dot(&residual, &preconditioned);
        let keep = last_energy.map_or(0.0, |last| energy / last) as f32;
        last_energy = Some(energy);
        direction.par_iter_mut().zip(&preconditioned).with_min_len(1 << 12).for_each(|(direction, new)| {
            *direction = new + keep * *direction;
        });
        write_product(hierarchy.grid(), &direction, &mut spare);
        let length = energy / dot(&direction, &spare);
        if !length.is_finite() {
            break;
        }
        height.par_iter_mut().zip(&mut residual).zip(&direction).zip(&spare).with_min_len(1 << 12).for_each(
            |(((height, residual), direction), product)| {
                *height += length * f64::from(*direction);
                *residual -= length as f32 * product;
            },
        );
        relative_residual = dot(&residual, &residual).sqrt() / first_norm;
    }
    Err(DepthError::NotConverged {
        iterations: options.max_iterations,
        relative_residual,
        tolerance: options.tolerance,
    })
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
