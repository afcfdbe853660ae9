//! One symmetric multigrid cycle over connected groups of pixels, the preconditioner of the integration.

use std::mem::swap;

use rayon::prelude::*;

use super::coarsen::coarsen;
use super::laplacian::{Graph, Grid, Laplacian, OUTSIDE, Real, row_pairs, split_rows};

/// Damping of the Jacobi sweeps before and after the coarse correction: the inverse roots of the Chebyshev polynomial
/// on 0.5..2, the upper part of the spectrum of D^-1 A, which for a Laplacian lies in 0..2.
const DAMPING: [f32; 2] = [0.561_8, 1.388_9];

/// A Laplacian, and the way to the next coarser one.
struct Level<L> {
    laplacian: L,
    /// One over the sum of each node's weights; zero for a node without a neighbour.
    inverse_degree: Vec<f32>,
    /// The node of the next coarser level, `OUTSIDE` for none.
    aggregate: Vec<u32>,
    coarse_row_starts: Vec<usize>,
}

/// The vectors of a coarse level.
pub struct Scratch {
    right_hand_side: Vec<f32>,
    solution: Vec<f32>,
    spare: Vec<f32>,
}

/// The grid of pixels and all coarser levels, down to one node for each island.
pub struct Hierarchy {
    grid: Level<Grid>,
    graphs: Vec<Level<Graph>>,
    islands: usize,
}

impl Hierarchy {
    /// Coarsens `grid` until no edge is left.
    pub fn new(grid: Grid) -> Self {
        let (grid, mut next) = Level::new(grid);
        let mut graphs = Vec::new();
        while !next.edges.is_empty() {
            let (level, coarser) = Level::new(next);
            graphs.push(level);
            next = coarser;
        }
        Self { grid, graphs, islands: next.columns.len() }
    }

    /// The Laplacian of the pixels.
    pub fn grid(&self) -> &Grid {
        &self.grid.laplacian
    }

    /// How many parts of the mask are not connected.
    pub fn islands(&self) -> usize {
        self.islands
    }

    /// Vectors for `cycle`.
    pub fn scratch(&self) -> Vec<Scratch> {
        let zeros = |level: &Level<Graph>| vec![0.0; level.aggregate.len()];
        self.graphs
            .iter()
            .map(|level| Scratch { right_hand_side: zeros(level), solution: zeros(level), spare: zeros(level) })
            .collect()
    }

    /// Overwrites `solution` with an approximate solution of A x = b; linear and symmetric in b.
    pub fn cycle(&self, b: &[f32], solution: &mut Vec<f32>, spare: &mut Vec<f32>, scratch: &mut [Scratch]) {
        cycle(&self.grid, &self.graphs, b, solution, spare, scratch);
    }

    /// Subtracts from each island its mean.
    pub fn centre_islands(&self, values: &mut [f64]) {
        let ones: Vec<f64> = self.grid.aggregate.par_iter().map(|&to| f64::from(u8::from(to != OUTSIDE))).collect();
        let mut means: Vec<f64> = self.island_sums(values);
        means.iter_mut().zip(self.island_sums(&ones)).for_each(|(sum, count)| *sum /= count);
        for level in self.graphs.iter().rev() {
            means = level.aggregate.par_iter().map(|&to| means[to as usize]).collect();
        }
        values.par_iter_mut().zip(&self.grid.aggregate).filter(|(_, to)| **to != OUTSIDE).for_each(|(value, &to)| {
            *value -= means[to as usize];
        });
    }

    fn island_sums(&self, values: &[f64]) -> Vec<f64> {
        let mut sums = self.grid.restrict(values);
        for level in &self.graphs {
            sums = level.restrict(&sums);
        }
        sums
    }
}

impl<L: Laplacian> Level<L> {
    fn new(laplacian: L) -> (Self, Graph) {
        let (aggregate, coarse) = coarsen(&laplacian);
        let inverse = |degree: f32| if degree > 0.0 { degree.recip() } else { 0.0 };
        let inverse_degree = (0..aggregate.len()).into_par_iter().map(|node| inverse(laplacian.degree(node))).collect();
        (Self { laplacian, inverse_degree, aggregate, coarse_row_starts: coarse.row_starts.clone() }, coarse)
    }

    /// `out = x + damping D^-1 (b - A x)`
    fn relax(&self, x: &[f32], b: &[f32], damping: f32, out: &mut [f32]) {
        let piece = self.laplacian.piece();
        out.par_chunks_mut(piece).enumerate().for_each(|(index, out)| {
            let first = index * piece;
            self.laplacian.product(first, x, out);
            let given = x[first..].iter().zip(&b[first..]).zip(&self.inverse_degree[first..]);
            for (out, ((x, b), inverse_degree)) in out.iter_mut().zip(given) {
                *out = x + damping * inverse_degree * (b - *out);
            }
        });
    }

    /// `out = b - A x`
    fn residual(&self, x: &[f32], b: &[f32], out: &mut [f32]) {
        let piece = self.laplacian.piece();
        out.par_chunks_mut(piece).enumerate().for_each(|(index, out)| {
            let first = index * piece;
            self.laplacian.product(first, x, out);
            out.iter_mut().zip(&b[first..]).for_each(|(out, b)| *out = b - *out);
        });
    }

    /// The sum over each coarse node's members.
    fn restrict<T: Real>(&self, fine: &[T]) -> Vec<T> {
        let mut coarse = vec![T::from(0.0); self.coarse_row_starts.last().copied().unwrap_or(0)];
        self.restrict_into(fine, &mut coarse);
        coarse
    }

    fn restrict_into<T: Real>(&self, fine: &[T], coarse: &mut [T]) {
        let pairs = row_pairs(self.laplacian.row_starts());
        let rows = split_rows(coarse, &self.coarse_row_starts);
        rows.into_par_iter().zip(&pairs).zip(&self.coarse_row_starts).for_each(|((row, pair), &base)| {
            row.fill(T::from(0.0));
            for (&value, &to) in fine[pair.clone()].iter().zip(&self.aggregate[pair.clone()]) {
                if to != OUTSIDE {
                    row[to as usize - base] += value;
                }
            }
        });
    }

    /// Adds to each node the value of its coarse node.
    fn prolong(&self, coarse: &[f32], fine: &mut [f32]) {
        let piece = self.laplacian.piece();
        fine.par_chunks_mut(piece).zip(self.aggregate.par_chunks(piece)).for_each(|(fine, aggregate)| {
            for (value, &to) in fine.iter_mut().zip(aggregate) {
                if to != OUTSIDE {
                    *value += coarse[to as usize];
                }
            }
        });
    }
}

/// A V-cycle. The order of the sweeps after the correction mirrors that before it, which keeps the cycle symmetric.
fn cycle<L: Laplacian>(
    level: &Level<L>,
    coarser: &[Level<Graph>],
    b: &[f32],
    x: &mut Vec<f32>,
    spare: &mut Vec<f32>,
    scratch: &mut [Scratch],
) {
    // The first sweep starts from zero and needs no product.
    x.par_iter_mut().zip(b).zip(&level.inverse_degree).with_min_len(1 << 12).for_each(|((x, b), inverse_degree)| {
        *x = DAMPING[0] * inverse_degree * b;
    });
    for damping in &DAMPING[1..] {
        level.relax(x, b, *damping, spare);
        swap(x, spare);
    }
    if let (Some((next, coarser)), Some((own, scratch))) = (coarser.split_first(), scratch.split_first_mut()) {
        level.residual(x, b, spare);
        level.restrict_into(spare, &mut own.right_hand_side);
        cycle(next, coarser, &own.right_hand_side, &mut own.solution, &mut own.spare, scratch);
        level.prolong(&own.solution, x);
    }
    for damping in DAMPING.iter().rev() {
        level.relax(x, b, *damping, spare);
        swap(x, spare);
    }
}
