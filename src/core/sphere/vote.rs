//! Circles that edge points agree on.

use super::{Circle, edges::EdgePoint};
use rayon::prelude::*;

/// Rim sectors in which a circle's support is counted.
const SECTORS: usize = 90;
/// Edge points within this distance of a circle support it, working pixels.
const TOLERANCE_PX: f64 = 1.5;
/// Pairs of edge points that are drawn at most, and circles through them that are tried.
const PAIRS: u64 = 200_000;
const TRIED: usize = 2500;

/// A proposed circle and the fraction of its rim that edge points support.
#[derive(Clone, Copy, Debug)]
pub(super) struct Proposal {
    pub circle: Circle,
    pub support: f64,
}

impl Proposal {
    /// A whole rim counts more than a part of one, and of two whole rims the larger: a ball holds smaller circles
    /// (highlights), and half a ball is more than a whole highlight.
    pub fn score(&self) -> f64 {
        self.support * self.circle.radius_px.sqrt()
    }
}

/// The best circles through the edge points, best first and well apart: random sampling of two points with the
/// direction of their gradients (Fischler and Bolles 1981). Only circles that are `wanted`, in working pixels, are
/// tried. The sampling is seeded, so that the same photo gives the same circle.
pub(super) fn propose(points: &[EdgePoint], wanted: impl Fn(&Circle) -> bool, count: usize) -> Vec<Proposal> {
    if points.len() < 8 {
        return Vec::new();
    }
    let circles: Vec<(Circle, bool)> = (0..PAIRS)
        .filter_map(|draw| {
            let random = scrambled(draw);
            let first = &points[(random >> 32) as usize % points.len()];
            let second = &points[(random & 0xffff_ffff) as usize % points.len()];
            circle_through(first, second).filter(|(circle, _)| wanted(circle))
        })
        .take(TRIED)
        .collect();
    let mut proposals: Vec<Proposal> = circles
        .into_par_iter()
        .map(|(circle, brighter_inside)| Proposal { circle, support: support(points, &circle, brighter_inside) })
        .filter(|proposal| proposal.support > 0.1)
        .collect();
    proposals.sort_by(|a, b| b.score().total_cmp(&a.score()));

    let mut apart: Vec<Proposal> = Vec::new();
    for proposal in proposals {
        if apart.len() == count {
            break;
        }
        if apart.iter().all(|kept| !are_alike(&kept.circle, &proposal.circle)) {
            apart.push(proposal);
        }
    }
    apart
}

/// The circle through two points whose centre lies on the first one's gradient, if the second's gradient points there
/// too; and whether it is brighter inside.
fn circle_through(first: &EdgePoint, second: &EdgePoint) -> Option<(Circle, bool)> {
    let (dx, dy) = (second.x - first.x, second.y - first.y);
    let along = dx * first.uphill.0 + dy * first.uphill.1;
    let reach = (dx * dx + dy * dy) / (2.0 * along);
    if !reach.is_finite() {
        return None;
    }
    let centre_px = (first.x + reach * first.uphill.0, first.y + reach * first.uphill.1);
    let (to_x, to_y) = (centre_px.0 - second.x, centre_px.1 - second.y);
    let aligned = (to_x * second.uphill.0 + to_y * second.uphill.1) / reach;
    (aligned > 0.97).then_some((Circle { centre_px, radius_px: reach.abs() }, reach > 0.0))
}

/// The fraction of rim sectors that hold an edge point on the circle, facing its centre.
fn support(points: &[EdgePoint], circle: &Circle, brighter_inside: bool) -> f64 {
    let mut seen = [false; SECTORS];
    let side = if brighter_inside { -1.0 } else { 1.0 };
    for point in points {
        let (dx, dy) = (point.x - circle.centre_px.0, point.y - circle.centre_px.1);
        let distance = dx.hypot(dy);
        let facing = side * (dx * point.uphill.0 + dy * point.uphill.1);
        if (distance - circle.radius_px).abs() < TOLERANCE_PX && facing > 0.94 * distance {
            let turn = (dy.atan2(dx) / std::f64::consts::TAU).rem_euclid(1.0);
            seen[((turn * SECTORS as f64) as usize).min(SECTORS - 1)] = true;
        }
    }
    seen.iter().filter(|&&s| s).count() as f64 / SECTORS as f64
}

fn are_alike(a: &Circle, b: &Circle) -> bool {
    let apart = (a.centre_px.0 - b.centre_px.0).hypot(a.centre_px.1 - b.centre_px.1);
    apart + (a.radius_px - b.radius_px).abs() < 0.1 * a.radius_px + 4.0
}

/// A well mixed number for each draw (SplitMix64, Steele, Lea, Flood 2014).
fn scrambled(draw: u64) -> u64 {
    let mut z = (draw + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
