//! Weighted graph Laplacians: (A x)_i = sum over the neighbours j of i of w_ij (x_i - x_j).
//!
//! The pixels form a grid; the coarse levels of the multigrid are graphs of connected groups of pixels, so that neither
//! a hole nor a gap between two islands is ever bridged.

use std::ops::{AddAssign, Mul, Range, Sub};

use rayon::prelude::*;

/// Nodes that a thread takes at once: their vectors fit into its cache.
const NODES_AT_ONCE: usize = 1 << 13;

/// The node of another level to which a pixel outside the mask belongs.
pub const OUTSIDE: u32 = u32::MAX;

/// A number that a Laplacian can be applied to.
pub trait Real: Copy + Send + Sync + From<f32> + Sub<Output = Self> + Mul<Output = Self> + AddAssign {}
impl<T: Copy + Send + Sync + From<f32> + Sub<Output = T> + Mul<Output = T> + AddAssign> Real for T {}

/// A symmetric Laplacian whose nodes lie in the rows and columns of an image.
pub trait Laplacian: Sync {
    /// Where each row of nodes starts, and where the last one ends.
    fn row_starts(&self) -> &[usize];
    /// The column of a node.
    fn column(&self, node: usize) -> u32;
    /// Whether a node is inside the mask.
    fn holds(&self, node: usize) -> bool;
    /// The neighbours of a node that lie in its own row and the row after it, with their weights; each edge once.
    fn forward_edges(&self, node: usize) -> impl Iterator<Item = (usize, f32)>;
    /// The sum of a node's weights.
    fn degree(&self, node: usize) -> f32;
    /// Nodes that `product` wants at once.
    fn piece(&self) -> usize;
    /// `(A x)` for the piece of nodes that starts at `first` and is as long as `out`.
    fn product<T: Real>(&self, first: usize, x: &[T], out: &mut [T]);
}

/// All pixels of a `width` x `height` image, joined to the right and down.
pub struct Grid {
    width: usize,
    row_starts: Vec<usize>,
    inside: Vec<bool>,
    right: Vec<f32>,
    down: Vec<f32>,
}

impl Grid {
    /// `right[i]` and `down[i]` are the weights of the edges from pixel `i`, zero where there is none (in the last
    /// column and row too).
    pub fn new(width: usize, inside: Vec<bool>, right: Vec<f32>, down: Vec<f32>) -> Self {
        let row_starts = (0..=inside.len()).step_by(width.max(1)).collect();
        Self { width, row_starts, inside, right, down }
    }

    pub fn width(&self) -> usize {
        self.width
    }

    pub fn inside(&self) -> &[bool] {
        &self.inside
    }

    pub fn right(&self) -> &[f32] {
        &self.right
    }

    pub fn down(&self) -> &[f32] {
        &self.down
    }
}

impl Laplacian for Grid {
    fn row_starts(&self) -> &[usize] {
        &self.row_starts
    }

    fn column(&self, node: usize) -> u32 {
        (node % self.width) as u32
    }

    fn holds(&self, node: usize) -> bool {
        self.inside[node]
    }

    fn forward_edges(&self, node: usize) -> impl Iterator<Item = (usize, f32)> {
        let edges = [(node + 1, self.right[node]), (node + self.width, self.down[node])];
        edges.into_iter().filter(|&(_, weight)| weight > 0.0)
    }

    fn degree(&self, node: usize) -> f32 {
        let before = |edges: &[f32], step: usize| node.checked_sub(step).map_or(0.0, |node| edges[node]);
        self.right[node] + before(&self.right, 1) + self.down[node] + before(&self.down, self.width)
    }

    fn piece(&self) -> usize {
        NODES_AT_ONCE.div_ceil(self.width) * self.width
    }

    fn product<T: Real>(&self, first: usize, x: &[T], out: &mut [T]) {
        let width = self.width;
        for (start, out) in (first..).step_by(width).zip(out.chunks_mut(width)) {
            let row = start..start + width;
            let here = &x[row.clone()];
            // At the border the row itself stands in for the one that is not there: the difference is zero.
            let above = if start == 0 { row.clone() } else { start - width..start };
            let below = if row.end == x.len() { row.clone() } else { row.end..row.end + width };
            let weights = self.down[above.clone()].iter().zip(&self.down[row.clone()]);
            let values = here.iter().zip(&x[above]).zip(&x[below]);
            for ((out, ((&here, &above), &below)), (&up, &down)) in out.iter_mut().zip(values).zip(weights) {
                let mut sum = T::from(up) * (here - above);
                sum += T::from(down) * (here - below);
                *out = sum;
            }
            let right = &self.right[row];
            for ((out, pair), &weight) in out.iter_mut().zip(here.windows(2)).zip(right) {
                *out += T::from(weight) * (pair[0] - pair[1]);
            }
            for ((out, pair), &weight) in out.iter_mut().skip(1).zip(here.windows(2)).zip(right) {
                *out += T::from(weight) * (pair[1] - pair[0]);
            }
        }
    }
}

/// A graph in compressed rows: the edges of node `i` are `edges[starts[i]..starts[i + 1]]`, each stored from both ends.
pub struct Graph {
    pub row_starts: Vec<usize>,
    pub columns: Vec<u32>,
    pub starts: Vec<usize>,
    pub edges: Vec<(u32, f32)>,
}

impl Graph {
    fn edges_of(&self, node: usize) -> &[(u32, f32)] {
        &self.edges[self.starts[node]..self.starts[node + 1]]
    }
}

impl Laplacian for Graph {
    fn row_starts(&self) -> &[usize] {
        &self.row_starts
    }

    fn column(&self, node: usize) -> u32 {
        self.columns[node]
    }

    fn holds(&self, _node: usize) -> bool {
        true
    }

    fn forward_edges(&self, node: usize) -> impl Iterator<Item = (usize, f32)> {
        self.edges_of(node).iter().map(|&(to, weight)| (to as usize, weight)).filter(move |&(to, _)| to > node)
    }

    fn degree(&self, node: usize) -> f32 {
        self.edges_of(node).iter().map(|&(_, weight)| weight).sum()
    }

    fn piece(&self) -> usize {
        NODES_AT_ONCE
    }

    fn product<T: Real>(&self, first: usize, x: &[T], out: &mut [T]) {
        for (node, out) in (first..).zip(out) {
            let mut sum = T::from(0.0);
            for &(to, weight) in self.edges_of(node) {
                sum += T::from(weight) * (x[node] - x[to as usize]);
            }
            *out = sum;
        }
    }
}

/// Cuts `values` into one slice for each range of `starts`.
pub fn split_rows<'a, T>(mut values: &'a mut [T], starts: &[usize]) -> Vec<&'a mut [T]> {
    starts
        .windows(2)
        .map(|pair| {
            let (row, rest) = std::mem::take(&mut values).split_at_mut(pair[1] - pair[0]);
            values = rest;
            row
        })
        .collect()
}

/// The nodes of a pair of rows, which become one row of the coarser level.
pub fn row_pairs(row_starts: &[usize]) -> Vec<Range<usize>> {
    let last = row_starts.len() - 1;
    (0..last).step_by(2).map(|row| row_starts[row]..row_starts[(row + 2).min(last)]).collect()
}

/// The scalar product, in f64 and in an order that does not depend on the number of threads.
pub fn dot(a: &[f32], b: &[f32]) -> f64 {
    let pieces: Vec<f64> = a
        .par_chunks(NODES_AT_ONCE)
        .zip(b.par_chunks(NODES_AT_ONCE))
        .map(|(a, b)| a.iter().zip(b).map(|(&a, &b)| f64::from(a) * f64::from(b)).sum())
        .collect();
    pieces.iter().sum()
}
