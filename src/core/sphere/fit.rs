//! The circle through rim points, some of which lie on something else.

use super::{Circle, CircleReport, rim::RimPoint};
use crate::interval::{Interval, coverage_factor, jackknife, robust_sd};
use crate::linear_algebra;
use nalgebra::{Matrix3, Vector3};

/// Sectors of the rim that the jackknife leaves out in turn.
const SECTORS: usize = 12;
/// Beyond this many standard deviations a point has no say (Tukey's biweight at 95 % efficiency).
const TUKEY: f64 = 4.685;
/// Scatter that rim points have beyond their own standard deviations: pixels are square, rims are not perfect.
const SCATTER_PX: f64 = 0.03;
/// Error of the circle that is the same all round and that no scatter shows: the blur model, the pixel grid.
const COMMON_SD_PX: f64 = 0.03;

/// Fits a circle to the points by least squares on their distance (geometric fit, Gauss-Newton with Tukey weights),
/// starting at `start`; `places` is how many points the whole rim would have given. `None` if they do not hold a
/// circle.
pub(super) fn fit_circle(points: &[RimPoint], places: usize, start: &Circle) -> Option<CircleReport> {
    let (circle, scale) = converge(points, *start)?;
    let used: Vec<&RimPoint> = points.iter().filter(|p| weight(distance(p, &circle), scale) > 0.0).collect();
    let sector = |p: &RimPoint| ((p.turn * SECTORS as f64) as usize).min(SECTORS - 1);
    let mut counts = [0usize; SECTORS];
    used.iter().for_each(|p| counts[sector(p)] += 1);
    let spread = jackknife(&counts, |left_out| {
        let kept = used.iter().copied().filter(|p| Some(sector(p)) != left_out);
        Some(vector(&refined(kept, &circle, scale)?))
    })?;
    let sd = spread.covariance.diagonal().map(|variance| (variance + COMMON_SD_PX.powi(2)).sqrt());
    let around = |value: f64, sd: f64| Interval::around(value, sd * coverage_factor(spread.groups));
    let squared: f64 = used.iter().map(|p| distance(p, &circle).powi(2)).sum();
    Some(CircleReport {
        circle,
        centre_interval_px: (around(circle.centre_px.0, sd[0]), around(circle.centre_px.1, sd[1])),
        radius_interval_px: around(circle.radius_px, sd[2]),
        sd_px: sd.max(),
        residual_rms_px: (squared / used.len() as f64).sqrt(),
        rim_seen: used.len() as f64 / places as f64,
        contrast: used.iter().map(|p| p.height).sum::<f64>() / used.len() as f64,
        points_used: used.len(),
        points_refused: points.len() - used.len(),
    })
}

fn converge(points: &[RimPoint], start: Circle) -> Option<(Circle, f64)> {
    if points.len() < 12 {
        return None;
    }
    let mut circle = start;
    let mut scale = f64::INFINITY;
    for _ in 0..30 {
        let moved = refined(points.iter(), &circle, scale)?;
        let step = (vector(&moved) - vector(&circle)).norm();
        circle = moved;
        scale = robust_sd(points.iter().map(|p| distance(p, &circle))).max(SCATTER_PX);
        if step < 1e-4 {
            return Some((circle, scale));
        }
    }
    Some((circle, scale))
}

/// One Gauss-Newton step.
fn refined<'a>(points: impl Iterator<Item = &'a RimPoint>, circle: &Circle, scale: f64) -> Option<Circle> {
    let mut normal = Matrix3::zeros();
    let mut right = Vector3::zeros();
    for point in points {
        let (dx, dy) = (point.x - circle.centre_px.0, point.y - circle.centre_px.1);
        let length = dx.hypot(dy).max(1e-9);
        let row = Vector3::new(dx / length, dy / length, 1.0);
        let weight = weight(length - circle.radius_px, scale) / (point.sd_px.powi(2) + SCATTER_PX.powi(2));
        normal += weight * row * row.transpose();
        right += weight * (length - circle.radius_px) * row;
    }
    let step = linear_algebra::solve_positive_definite(normal, &right)?;
    let radius_px = circle.radius_px + step[2];
    let moved = Circle { centre_px: (circle.centre_px.0 + step[0], circle.centre_px.1 + step[1]), radius_px };
    (radius_px > 1.0).then_some(moved)
}

fn weight(distance_px: f64, scale: f64) -> f64 {
    let u = distance_px / (TUKEY * scale);
    if u.abs() < 1.0 { (1.0 - u * u).powi(2) } else { 0.0 }
}

fn distance(point: &RimPoint, circle: &Circle) -> f64 {
    (point.x - circle.centre_px.0).hypot(point.y - circle.centre_px.1) - circle.radius_px
}

fn vector(circle: &Circle) -> Vector3<f64> {
    Vector3::new(circle.centre_px.0, circle.centre_px.1, circle.radius_px)
}
