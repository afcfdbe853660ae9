//! Form factors: how much of the light that leaves one patch reaches another.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use super::{
    RadiosityError,
    pair::{reciprocity_residual, unoccluded_exchange_mm2, visible_fraction},
    patches::Patches,
};
use crate::Watch;
use crate::options::check_range;

/// What form factors may cost.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct FormFactorOptions {
    /// Above this the factors are not kept but computed again for every bounce. N patches need 2 N^2 bytes.
    pub memory_limit_bytes: u64,
    /// Rays between two patches that face each other and are near, to find which part of one the other sees; patches
    /// farther apart than ten times their radii get one. None are used where nothing can stand between two patches.
    pub rays_per_pair: usize,
}

impl Default for FormFactorOptions {
    fn default() -> Self {
        Self { memory_limit_bytes: 2 << 30, rays_per_pair: 4 }
    }
}

impl FormFactorOptions {
    /// Whether every option is in its range.
    pub fn check(&self) -> Result<(), RadiosityError> {
        Ok(check_range("rays_per_pair", self.rays_per_pair as f64, self.rays_per_pair >= 1, "at least 1")?)
    }

    /// Whether the factors of so many patches are kept.
    pub fn stores(&self, patches: usize) -> bool {
        let count = patches as u64;
        2 * count * count.saturating_sub(1) <= self.memory_limit_bytes
    }
}

/// How good the form factors are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FormFactorReport {
    /// Patches of the surface.
    pub patches: usize,
    /// The smallest sum of form factors from one patch: 0 where a patch sees no other.
    pub row_sum_min: f64,
    /// The mean of these sums over the surface's area.
    pub row_sum_mean: f64,
    /// The largest; at most 1 but for rounding and the error of the rules.
    pub row_sum_max: f64,
    /// The largest relative difference between the exchange of two near patches found from either side, over a sample
    /// of pairs. What is used of each pair is one number, so `A_i F_ij = A_j F_ji` holds to rounding.
    pub reciprocity_residual: f64,
    /// Of the exchange between patches that face each other, the fraction that nothing blocks.
    pub visible_fraction: f64,
    /// Whether the shape made rays unnecessary.
    pub unoccluded: bool,
    /// Whether the factors are kept; else every bounce computes them again.
    pub stored: bool,
    /// Memory the factors take.
    pub bytes: u64,
}

/// Form factors of a surface with visibility, as the symmetric exchange `G_ij = A_i F_ij`.
#[derive(Clone, Debug)]
pub struct FormFactors {
    patches: Patches,
    rays_per_pair: usize,
    /// Row i holds `G_ij` for j > i, or nothing if all are zero. `None` where the memory limit forbids.
    rows: Option<Vec<Vec<f32>>>,
}

/// Form factors between all patches. O(N^2) time; 2 N^2 bytes, or O(N) beyond the memory limit.
pub fn form_factors(
    patches: Patches,
    options: &FormFactorOptions,
    watch: &dyn Watch,
) -> Result<(FormFactors, FormFactorReport), RadiosityError> {
    options.check()?;
    let stored = options.stores(patches.len());
    let mut factors = FormFactors { patches, rays_per_pair: options.rays_per_pair, rows: None };
    let mut tally = Tally::default();
    if stored {
        let (rows, rows_tally) = factors.all_rows(watch)?;
        factors.rows = Some(rows);
        tally = rows_tally;
    }
    let ones = vec![1.0; factors.patches.len()];
    let (sums, pass_tally) = factors.exchange_columns(&[ones], watch)?;
    let report = factors.report(&sums[0], tally.plus(pass_tally));
    Ok((factors, report))
}

impl FormFactors {
    /// The surface.
    pub fn patches(&self) -> &Patches {
        &self.patches
    }

    /// The form factor from patch `from` to patch `to`: the part of the light leaving `from` that reaches `to`.
    pub fn form_factor(&self, from: usize, to: usize) -> f64 {
        let (low, high) = (from.min(to), from.max(to));
        let exchange_mm2 = match &self.rows {
            _ if low == high => 0.0,
            Some(rows) => f64::from(rows[low].get(high - low - 1).copied().unwrap_or(0.0)),
            None => self.exchange_mm2(low, high, &mut Tally::default()),
        };
        let area_mm2 = self.patches.as_slice()[from].area_mm2;
        if area_mm2 > 0.0 { exchange_mm2 / area_mm2 } else { 0.0 }
    }

    /// `F` times each column: the irradiance that radiosities (one value a patch) cause on each patch.
    pub fn irradiance(&self, radiosities: &[Vec<f64>], watch: &dyn Watch) -> Result<Vec<Vec<f64>>, RadiosityError> {
        let (mut columns, _) = self.exchange_columns(radiosities, watch)?;
        for column in &mut columns {
            for (value, patch) in column.iter_mut().zip(self.patches.as_slice()) {
                *value = if patch.area_mm2 > 0.0 { *value / patch.area_mm2 } else { 0.0 };
            }
        }
        Ok(columns)
    }

    /// Whether the factors are kept; else every pass computes them again.
    pub fn is_stored(&self) -> bool {
        self.rows.is_some()
    }

    /// `G` times each column, streaming once through the factors. Reports progress where they are computed again.
    fn exchange_columns(
        &self,
        columns: &[Vec<f64>],
        watch: &dyn Watch,
    ) -> Result<(Vec<Vec<f64>>, Tally), RadiosityError> {
        let count = self.patches.len();
        if let Some(column) = columns.iter().find(|column| column.len() != count) {
            return Err(RadiosityError::WrongLength { found: column.len(), expected: count });
        }
        let finished = AtomicUsize::new(0);
        let partial = |rows: Range<usize>| {
            let mut sums = vec![vec![0.0; count]; columns.len()];
            let mut tally = Tally::default();
            for (done, i) in rows.enumerate() {
                if done % ROWS_BETWEEN_CANCEL_CHECKS == 0 && watch.cancelled() {
                    return Err(RadiosityError::Cancelled);
                }
                let computed;
                let row = match &self.rows {
                    Some(rows) => &rows[i],
                    None => {
                        computed = self.row(i, &mut tally);
                        &computed
                    }
                };
                for (column, sum) in columns.iter().zip(&mut sums) {
                    let (sum_i, sums_after) = sum[i..].split_first_mut().expect("row i is one of the patches");
                    *sum_i += exchange_row(row, column[i], &column[i + 1..], sums_after);
                }
                if self.rows.is_none() {
                    report_row(count, i, &finished, watch);
                }
            }
            Ok((sums, tally))
        };
        let parts: Vec<_> = equal_shares(count, 16).into_par_iter().map(partial).collect::<Result<_, _>>()?;
        let mut parts = parts.into_iter();
        let (mut sums, mut tally) = parts.next().unwrap_or_default();
        for (part, part_tally) in parts {
            tally = tally.plus(part_tally);
            for (sum, part) in sums.iter_mut().flatten().zip(part.iter().flatten()) {
                *sum += part;
            }
        }
        Ok((sums, tally))
    }

    fn all_rows(&self, watch: &dyn Watch) -> Result<(Vec<Vec<f32>>, Tally), RadiosityError> {
        let count = self.patches.len();
        let mut rows = Vec::with_capacity(count);
        let mut tally = Tally::default();
        let shares = equal_shares(count, 100);
        for (done, share) in shares.iter().enumerate() {
            if watch.cancelled() {
                return Err(RadiosityError::Cancelled);
            }
            watch.progress(done as f32 / shares.len() as f32);
            let row = |i| {
                let mut tally = Tally::default();
                (self.row(i, &mut tally), tally)
            };
            for (row, row_tally) in share.clone().into_par_iter().map(row).collect::<Vec<_>>() {
                rows.push(row);
                tally = tally.plus(row_tally);
            }
        }
        watch.progress(1.0);
        Ok((rows, tally))
    }

    /// `G_ij` for j > i, or nothing if all are zero.
    fn row(&self, i: usize, tally: &mut Tally) -> Vec<f32> {
        let row: Vec<f32> = (i + 1..self.patches.len()).map(|j| self.exchange_mm2(i, j, tally) as f32).collect();
        if row.iter().any(|&value| value > 0.0) { row } else { Vec::new() }
    }

    fn exchange_mm2(&self, i: usize, j: usize, tally: &mut Tally) -> f64 {
        let (a, b) = (&self.patches.as_slice()[i], &self.patches.as_slice()[j]);
        let (facing, rays) = unoccluded_exchange_mm2(a, b, self.patches.flat_mm(), self.rays_per_pair);
        let visible = if facing == 0.0 || self.patches.is_unoccluded() {
            facing
        } else {
            facing * visible_fraction(&self.patches, i, j, rays)
        };
        tally.facing_mm2 += facing;
        tally.visible_mm2 += visible;
        visible
    }

    fn report(&self, exchange_sums_mm2: &[f64], tally: Tally) -> FormFactorReport {
        let patches = self.patches.as_slice();
        let with_area = || patches.iter().zip(exchange_sums_mm2).filter(|(patch, _)| patch.area_mm2 > 0.0);
        let row_sums = || with_area().map(|(patch, sum)| sum / patch.area_mm2);
        let area_mm2: f64 = patches.iter().map(|patch| patch.area_mm2).sum();
        FormFactorReport {
            patches: patches.len(),
            row_sum_min: row_sums().fold(f64::INFINITY, f64::min),
            row_sum_mean: exchange_sums_mm2.iter().sum::<f64>() / area_mm2,
            row_sum_max: row_sums().fold(0.0, f64::max),
            reciprocity_residual: self.reciprocity_residual(),
            visible_fraction: if tally.facing_mm2 > 0.0 { tally.visible_mm2 / tally.facing_mm2 } else { 1.0 },
            unoccluded: self.patches.is_unoccluded(),
            stored: self.rows.is_some(),
            bytes: self.rows.iter().flatten().map(|row| 4 * row.len() as u64).sum(),
        }
    }

    fn reciprocity_residual(&self) -> f64 {
        let (patches, flat_mm) = (self.patches.as_slice(), self.patches.flat_mm());
        let sampled = patches.par_iter().step_by(patches.len().div_ceil(100));
        let of_patch = |a| patches.iter().filter_map(|b| reciprocity_residual(a, b, flat_mm)).fold(0.0, f64::max);
        sampled.map(of_patch).reduce(|| 0.0, f64::max)
    }
}

const ROWS_BETWEEN_CANCEL_CHECKS: usize = 256;

/// Adds what patch i (radiosity `own`) sends to the later ones, and returns what they send to it.
fn exchange_row(row: &[f32], own: f64, later: &[f64], sums: &mut [f64]) -> f64 {
    let mut received = 0.0;
    for ((&exchange, radiosity), sum) in row.iter().zip(later).zip(sums) {
        received += f64::from(exchange) * radiosity;
        *sum += f64::from(exchange) * own;
    }
    received
}

/// Tells each hundredth of the pairs of `count` patches, once row `i` of them is finished too.
fn report_row(count: usize, i: usize, finished_pairs: &AtomicUsize, watch: &dyn Watch) {
    let (pairs, all) = (count - i, count * (count + 1) / 2);
    let before = finished_pairs.fetch_add(pairs, Ordering::Relaxed);
    let hundredth = |pairs: usize| pairs * 100 / all;
    if hundredth(before + pairs) > hundredth(before) {
        watch.progress((before + pairs) as f32 / all as f32);
    }
}

/// The rows 0..count of a triangle of pairs in at most `shares` ranges of about equally many pairs.
fn equal_shares(count: usize, shares: usize) -> Vec<Range<usize>> {
    let end = |share: usize| {
        let left = 1.0 - share as f64 / shares as f64;
        count - (left.sqrt() * count as f64).round() as usize
    };
    (0..shares).map(|share| end(share)..end(share + 1)).filter(|range| !range.is_empty()).collect()
}

/// Exchange met on the way, to know how much of it is blocked.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    facing_mm2: f64,
    visible_mm2: f64,
}

impl Tally {
    fn plus(self, other: Self) -> Self {
        Self { facing_mm2: self.facing_mm2 + other.facing_mm2, visible_mm2: self.visible_mm2 + other.visible_mm2 }
    }
}
