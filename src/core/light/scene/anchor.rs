//! Indirect light is smooth where the surface is: it is gathered at every few pixels, and between them where those
//! disagree.

use rayon::prelude::*;

use super::{SceneError, gather::Gatherer, lamp::Receiver};
use crate::Watch;

/// A pixel at which light was gathered.
pub(super) struct Anchor {
    receiver: Receiver,
    irradiance: Vec<f64>,
}

/// Anchors at the centres of every `spacing_px`-th pixel and one beyond the border.
pub(super) struct Anchors {
    spacing_px: usize,
    columns: usize,
    tolerance: f64,
    anchors: Vec<Option<Anchor>>,
    /// The mean of each channel.
    means: Vec<f64>,
}

impl Anchors {
    /// Gathers at the anchors, `hit` being what an image position shows.
    pub(super) fn new(
        (width, height): (usize, usize),
        spacing_px: usize,
        tolerance: f64,
        gatherer: &Gatherer,
        hit: impl Fn(f64, f64) -> Option<Receiver> + Sync,
        watch: &dyn Watch,
    ) -> Result<Self, SceneError> {
        // A grid as fine as the pixels would gather everything twice.
        let lines = |pixels: usize| if spacing_px > 1 { (pixels - 1) / spacing_px + 2 } else { 0 };
        let (columns, rows) = (lines(width), lines(height));
        let centre = |line: usize| (line * spacing_px) as f64 + 0.5;
        let anchor = |column: usize, row: usize| {
            let receiver = hit(centre(column), centre(row))?;
            Some(Anchor { irradiance: gatherer.irradiance(&receiver), receiver })
        };
        let line = |row: usize| {
            if watch.cancelled() {
                return Err(SceneError::Cancelled);
            }
            Ok((0..columns).map(|column| anchor(column, row)).collect::<Vec<_>>())
        };
        let lines = (0..rows).into_par_iter().map(line).collect::<Result<Vec<_>, _>>()?;
        let anchors: Vec<Option<Anchor>> = lines.into_iter().flatten().collect();
        let gathered = || anchors.iter().flatten().map(|anchor| &anchor.irradiance);
        let count = gathered().count().max(1) as f64;
        let channels = gathered().next().map_or(0, Vec::len);
        let means = (0..channels).map(|k| gathered().map(|irradiance| irradiance[k]).sum::<f64>() / count).collect();
        Ok(Self { spacing_px, columns, tolerance, anchors, means })
    }

    /// How many anchors gathered light.
    pub(super) fn gathers(&self) -> usize {
        self.anchors.iter().flatten().count()
    }

    /// The irradiance of a surface in a pixel, bilinear between the four anchors around; `None` where one of them lies on
    /// another surface or they differ by more than the tolerance.
    pub(super) fn irradiance(&self, column: usize, row: usize, receiver: &Receiver) -> Option<Vec<f64>> {
        let (i, j) = (column / self.spacing_px, row / self.spacing_px);
        let at = |i: usize, j: usize| self.anchors.get(j * self.columns + i)?.as_ref();
        let around = [at(i, j)?, at(i + 1, j)?, at(i, j + 1)?, at(i + 1, j + 1)?];
        if !around.iter().all(|anchor| anchor.receiver.continues(receiver)) {
            return None;
        }
        let fraction = |pixel: usize, line: usize| (pixel - line * self.spacing_px) as f64 / self.spacing_px as f64;
        let (u, v) = (fraction(column, i), fraction(row, j));
        let weights = [(1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v];
        let channel = |channel: usize| {
            let values = around.map(|anchor| anchor.irradiance[channel]);
            let (low, high) = values.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), &v| (low.min(v), high.max(v)));
            let mean: f64 = weights.iter().zip(values).map(|(weight, value)| weight * value).sum();
            (high - low <= self.tolerance * high.max(self.means[channel])).then_some(mean)
        };
        (0..around[0].irradiance.len()).map(channel).collect()
    }
}
