//! The amount of indirect light over the object: even where all walls are in view, higher where some are not.

use std::ops::Range;

use super::fit::{Amount, Fit};
use super::indirect::Indirect;
use crate::{Mask, Plane};

/// Tiles along each side of the object.
const SIDE: usize = 8;
/// A tile of less than this share of what is known says nothing of its own.
const MIN_INFORMATION: f64 = 0.002;
/// The share of the object, by what is known of it, that counts as the part where the amount is lowest.
const LOWEST_SHARE: f64 = 0.2;
/// The amount varies by more than this where walls are out of view: rendered bowls vary by 5 %, corners and grooves that run out
/// of the picture by 16 to 30 %.
pub const MAX_UNEVENNESS: f64 = 0.1;

/// A smaller share of the object whose colours do not fit beta is dirt, gloss or an edge.
const MAX_OTHER_PAINT: f64 = 0.02;

/// The amount s of indirect light, `I = s K N_ref`, over the object, all lights together.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct AmountReport {
    /// Its mean, weighted by what the pixels know of it: the albedo of the reference colour where the whole cavity is in view.
    pub mean: f64,
    /// Half of what is known of it lies below this.
    pub median: f64,
    /// What it falls to where it is lowest (in a tenth of the object): nearer to the albedo where walls are out of view.
    pub lowest: f64,
    /// How much it varies: from its 5 % to its 95 % quantile, relative to the median.
    pub unevenness: f64,
    /// Standard deviation of the mean by noise alone.
    pub noise: f64,
    /// The share of the object whose colours do not fit beta: another paint, which the reference colour alone is used of.
    pub other_paint_share: f64,
    /// The share of indirect light that no surface in view explains.
    pub outside_share: f64,
}

/// More is no measure of anything.
const UNEVENNESS_BOUND: f64 = 10.0;
/// Where noise alone leaves the mean uncertain by more than this, parts of the object differ by noise: hardly any light arrives.
const MAX_NOISE: f64 = 0.005;

impl AmountReport {
    /// Whether walls that send light are likely out of view.
    pub fn is_uneven(&self) -> bool {
        self.is_known() && self.median > 0.0 && self.unevenness > MAX_UNEVENNESS
    }

    /// Whether the colours of a part of the object do not fit beta.
    pub fn has_other_paint(&self) -> bool {
        self.is_known() && self.other_paint_share > MAX_OTHER_PAINT
    }

    /// Whether enough light arrives to say anything of its amount.
    pub fn is_known(&self) -> bool {
        self.noise < MAX_NOISE
    }

    /// Adds what the windows of all lights found.
    pub(super) fn with_lights(self, mask: &Mask, lights: &[Indirect]) -> Self {
        let amounts: Vec<_> = lights.iter().filter_map(|light| light.amount.as_ref()).collect();
        let inside = || (0..mask.data().len()).filter(|&cell| mask.data()[cell]);
        let other = inside().filter(|&cell| amounts.first().is_some_and(|amount| !amount.fits.data()[cell])).count();
        let sum = |of: fn(&Amount) -> &Plane| {
            let of_light = |amount: &&Amount| inside().map(|cell| f64::from(of(amount).data()[cell])).sum::<f64>();
            amounts.iter().map(of_light).sum::<f64>()
        };
        Self {
            other_paint_share: other as f64 / mask.count().max(1) as f64,
            outside_share: sum(|amount| &amount.outside) / sum(|amount| &amount.light).max(f64::MIN_POSITIVE),
            ..self
        }
    }
}

/// What the parts of the object say of the amount: information, and the amount times information.
pub(super) struct Tiles([(f64, f64); SIDE * SIDE]);

impl Tiles {
    /// `None` where no light arrives anywhere.
    pub(super) fn of(mask: &Mask, fits: &[Fit]) -> Option<Self> {
        let (columns, rows) = extent(mask)?;
        let place = |at: usize, range: &Range<usize>| (at - range.start) * SIDE / range.len();
        let mut tiles = [(0.0_f64, 0.0_f64); SIDE * SIDE];
        for y in rows.clone() {
            for x in columns.clone() {
                let (information, weighted) = &mut tiles[place(y, &rows) * SIDE + place(x, &columns)];
                for fit in fits {
                    *information += f64::from(fit.information.at(x, y));
                    *weighted += f64::from(fit.weighted.at(x, y));
                }
            }
        }
        (tiles.iter().map(|tile| tile.0).sum::<f64>() > 0.0).then_some(Self(tiles))
    }

    /// Tiles that say something, with the amount and the information of each, the lowest amount first.
    fn known(&self) -> Vec<(usize, f64, f64)> {
        let least = MIN_INFORMATION * self.0.iter().map(|tile| tile.0).sum::<f64>();
        let known = self.0.iter().enumerate().filter(|(_, tile)| tile.0 > least);
        let mut known: Vec<_> = known.map(|(tile, (info, weighted))| (tile, weighted / info, *info)).collect();
        known.sort_by(|a, b| a.1.total_cmp(&b.1));
        known
    }

    pub(super) fn report(&self) -> AmountReport {
        let known: Vec<(f64, f64)> = self.known().into_iter().map(|(_, amount, info)| (amount, info)).collect();
        let spread = quantile(&known, 0.95) - quantile(&known, 0.05);
        let all: Vec<usize> = (0..self.0.len()).collect();
        let (mean, noise) = self.mean_of(&all).unwrap_or_default();
        AmountReport {
            mean,
            median: quantile(&known, 0.5),
            lowest: quantile(&known, 0.1),
            unevenness: (spread / quantile(&known, 0.5).abs().max(f64::MIN_POSITIVE)).min(UNEVENNESS_BOUND),
            noise,
            other_paint_share: 0.0,
            outside_share: 0.0,
        }
    }

    /// The tiles where the amount can be held against the albedo: all where it is even, else those where it is lowest.
    pub(super) fn comparable(&self) -> Vec<usize> {
        if !self.report().is_uneven() {
            return (0..self.0.len()).collect();
        }
        let known = self.known();
        let all: f64 = known.iter().map(|(.., information)| information).sum();
        let mut below = 0.0;
        let lowest = known.into_iter().take_while(|(.., information)| {
            let is_low = below < LOWEST_SHARE * all;
            below += information;
            is_low
        });
        lowest.map(|(tile, ..)| tile).collect()
    }

    /// The mean amount of some tiles and its noise; `None` where they say nothing.
    pub(super) fn mean_of(&self, tiles: &[usize]) -> Option<(f64, f64)> {
        let sum = |of: fn(&(f64, f64)) -> f64| tiles.iter().map(|tile| of(&self.0[*tile])).sum::<f64>();
        let information = sum(|tile| tile.0);
        (information > 0.0).then(|| (sum(|tile| tile.1) / information, information.sqrt().recip()))
    }
}

/// The value that this share of the weight lies below; `sorted` holds values and weights.
fn quantile(sorted: &[(f64, f64)], share: f64) -> f64 {
    let all: f64 = sorted.iter().map(|(_, weight)| weight).sum();
    let mut below = 0.0;
    let reached = sorted.iter().find(|(_, weight)| {
        below += weight;
        below >= share * all
    });
    reached.or(sorted.last()).map_or(0.0, |(value, _)| *value)
}

/// Columns and rows between which the object lies.
fn extent(mask: &Mask) -> Option<(Range<usize>, Range<usize>)> {
    let inside = |&y: &usize| mask.row(y).contains(&true);
    let (top, bottom) = ((0..mask.height()).find(inside)?, (0..mask.height()).rfind(inside)?);
    let left = (top..=bottom).filter_map(|y| mask.row(y).iter().position(|inside| *inside)).min()?;
    let right = (top..=bottom).filter_map(|y| mask.row(y).iter().rposition(|inside| *inside)).max()?;
    Some((left..right + 1, top..bottom + 1))
}
