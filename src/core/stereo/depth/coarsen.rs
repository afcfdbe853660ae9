//! The next coarser level: 2 x 2 blocks of nodes, each connected part of a block one node.

use rayon::prelude::*;

use super::laplacian::{Graph, Laplacian, OUTSIDE, row_pairs, split_rows};

/// Summing the edges between two blocks makes the coarse Laplacian twice too stiff for a smooth surface: a block is two
/// nodes long, so the same slope makes twice the difference (over-correction: D. Braess, Towards algebraic multigrid for
/// elliptic problems of second order, Computing 55, 1995).
const OVER_CORRECTION: f32 = 0.5;

/// Groups the nodes of `fine`: returns the coarse node of each (`OUTSIDE` for none) and the coarse Laplacian.
pub fn coarsen(fine: &impl Laplacian) -> (Vec<u32>, Graph) {
    let pairs = row_pairs(fine.row_starts());
    let nodes = *fine.row_starts().last().unwrap_or(&0);
    let mut aggregate = vec![OUTSIDE; nodes];

    // Number the connected parts of each pair of rows from zero, then shift each pair behind the one before it.
    let fine_starts: Vec<usize> = pairs.iter().map(|pair| pair.start).chain([nodes]).collect();
    let columns: Vec<Vec<u32>> = split_rows(&mut aggregate, &fine_starts)
        .into_par_iter()
        .zip(&pairs)
        .map(|(labels, pair)| label_parts(fine, pair.start, labels))
        .collect();
    let mut row_starts = vec![0; columns.len() + 1];
    for (row, columns) in columns.iter().enumerate() {
        row_starts[row + 1] = row_starts[row] + columns.len();
    }
    split_rows(&mut aggregate, &fine_starts).into_par_iter().zip(&row_starts).for_each(|(labels, &base)| {
        labels.iter_mut().filter(|label| **label != OUTSIDE).for_each(|label| *label += base as u32);
    });

    let (starts, edges) = coarse_edges(fine, &aggregate, &pairs, &row_starts);
    (aggregate, Graph { row_starts, columns: columns.concat(), starts, edges })
}

/// Writes the number of each node's connected part within its block, for the nodes of a pair of rows from `first` on.
/// Returns the coarse column of each part.
fn label_parts(fine: &impl Laplacian, first: usize, labels: &mut [u32]) -> Vec<u32> {
    let mut parents: Vec<u32> = (0..labels.len() as u32).collect();
    for node in 0..labels.len() {
        let block = fine.column(first + node) / 2;
        for (to, _) in fine.forward_edges(first + node) {
            if to - first < labels.len() && fine.column(to) / 2 == block {
                let (a, b) = (root(&mut parents, node), root(&mut parents, to - first));
                parents[a.max(b)] = a.min(b) as u32;
            }
        }
    }
    // A root is the first node of its part, so its number is known before the others ask for it.
    let mut columns = Vec::new();
    for node in (0..labels.len()).filter(|&node| fine.holds(first + node)) {
        let root = root(&mut parents, node);
        if root == node {
            labels[node] = columns.len() as u32;
            columns.push(fine.column(first + node) / 2);
        } else {
            labels[node] = labels[root];
        }
    }
    columns
}

/// The first node of a node's part; halves the path to it.
fn root(parents: &mut [u32], mut node: usize) -> usize {
    while parents[node] as usize != node {
        let parent = parents[node] as usize;
        parents[node] = parents[parent];
        node = parents[parent] as usize;
    }
    node
}

/// The edges between coarse nodes in compressed rows.
fn coarse_edges(
    fine: &impl Laplacian,
    aggregate: &[u32],
    pairs: &[std::ops::Range<usize>],
    row_starts: &[usize],
) -> (Vec<usize>, Vec<(u32, f32)>) {
    // Edges forward from each pair of rows, from the lower node to the higher one, parallel ones joined.
    let forward: Vec<Vec<(u32, u32, f32)>> = pairs
        .par_iter()
        .map(|pair| {
            let mut edges = Vec::new();
            for node in pair.clone() {
                let from = aggregate[node];
                edges.extend(fine.forward_edges(node).filter_map(|(to, weight)| {
                    let to = aggregate[to];
                    (to != from).then_some((from.min(to), from.max(to), OVER_CORRECTION * weight))
                }));
            }
            edges.sort_unstable_by_key(|&(from, to, _)| (from, to));
            edges.dedup_by(|next, kept| {
                let same = (next.0, next.1) == (kept.0, kept.1);
                kept.2 += if same { next.2 } else { 0.0 };
                same
            });
            edges
        })
        .collect();

    // Count the edges of each node from both ends, then put them in their places.
    let nodes = row_starts.last().copied().unwrap_or(0);
    let mut starts = vec![0; nodes + 1];
    for &(from, to, _) in forward.iter().flatten() {
        starts[from as usize + 1] += 1;
        starts[to as usize + 1] += 1;
    }
    for node in 0..nodes {
        starts[node + 1] += starts[node];
    }
    let mut edges = vec![(0, 0.0); starts[nodes]];
    let mut next = starts.clone();
    for &(from, to, weight) in forward.iter().flatten() {
        for (from, to) in [(from, to), (to, from)] {
            edges[next[from as usize]] = (to, weight);
            next[from as usize] += 1;
        }
    }
    (starts, edges)
}
