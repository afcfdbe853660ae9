//! From photos of a ball to its circle.

use super::{
    BallError, Circle, CircleReport,
    edges::{Window, edge_points, working_image},
    fit::fit_circle,
    rim::rim_points,
    vote::{Wanted, propose},
};
use crate::Plane;

/// The longest side of the reduced photo in which a ball is looked for.
const WORKING_SIDE: usize = 640;
/// Edge points that are looked at, the strongest first.
const EDGE_POINTS: usize = 8000;
/// Circles that are measured before the best is taken.
const PROPOSALS: usize = 6;

/// How to look for a ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircleOptions {
    /// The smallest radius to look for, in pixels. Without a click, a ball also has to be larger than 1 % of the photo's side.
    pub min_radius_px: f64,
    /// The fraction of the rim on which an edge must be seen, 0.1 to 1.
    pub min_rim_seen: f64,
}

impl Default for CircleOptions {
    fn default() -> Self {
        Self { min_radius_px: 6.0, min_rim_seen: 0.3 }
    }
}

impl CircleOptions {
    /// Whether every option is in its range.
    pub fn check(&self) -> Result<(), BallError> {
        let bad = |option, value, expected| Err(BallError::BadOption { option, value, expected });
        if !(self.min_radius_px >= 3.0) {
            return bad("min_radius_px", self.min_radius_px, "3 or more");
        }
        if !(0.1..=1.0).contains(&self.min_rim_seen) {
            return bad("min_rim_seen", self.min_rim_seen, "between 0.1 and 1");
        }
        Ok(())
    }
}

/// Finds a ball that stands in the same place in all `images` (one lamp each, linear light), from a click `near_px` inside it
/// or from nothing.
///
/// Without a click the ball with the largest visible rim is taken. Errors: no photo, sizes that differ, no circle with enough
/// of its rim in view.
pub fn find_circle(
    images: &[&Plane],
    near_px: Option<(f64, f64)>,
    options: &CircleOptions,
) -> Result<CircleReport, BallError> {
    options.check()?;
    let size = common_size(images)?;
    let mut best: Option<CircleReport> = None;
    let mut best_proposal: Option<(Circle, f64)> = None;
    for window in windows(size, near_px) {
        let points = edge_points(&working_image(images, window), EDGE_POINTS);
        let scale = window.scale as f64;
        let wanted = Wanted {
            radius_px: ((options.min_radius_px / scale).max(5.0), 0.75 * window.width.max(window.height) as f64),
            size: (window.width, window.height),
            around: near_px.map(|near| window.from_photo(near)),
        };
        for proposal in propose(&points, wanted, PROPOSALS) {
            let rough = Circle {
                centre_px: window.to_photo(proposal.circle.centre_px),
                radius_px: proposal.circle.radius_px * scale,
            };
            if best_proposal.is_none_or(|(_, support)| proposal.support > support) {
                best_proposal = Some((rough, proposal.support));
            }
            let Some(found) = measure(images, &rough, 2.5 * scale + 2.0) else { continue };
            let stayed = near_px.is_none_or(|(x, y)| found.circle.radii_from_centre(x, y) < 1.1);
            if stayed && best.as_ref().is_none_or(|best| merit(&found) > merit(best)) {
                best = Some(found);
            }
        }
    }
    accept(best, best_proposal, options)
}

/// Snaps a rough circle, as drawn by hand, to the edge of the ball under it: within a quarter of its radius.
pub fn refine_circle(images: &[&Plane], rough: &Circle, options: &CircleOptions) -> Result<CircleReport, BallError> {
    options.check()?;
    common_size(images)?;
    let reach = |fraction: f64| (fraction * rough.radius_px).max(3.0);
    let found = [0.06, 0.12, 0.25]
        .into_iter()
        .filter_map(|fraction| measure(images, rough, reach(fraction)))
        .max_by(|a, b| merit(a).total_cmp(&merit(b)));
    accept(found, None, options)
}

fn accept(
    found: Option<CircleReport>,
    proposal: Option<(Circle, f64)>,
    options: &CircleOptions,
) -> Result<CircleReport, BallError> {
    match found {
        Some(found) if found.rim_seen >= options.min_rim_seen => Ok(found),
        found => Err(BallError::NotFound {
            best: found.map(|f| (f.circle, f.rim_seen)).or(proposal),
            needed: options.min_rim_seen,
        }),
    }
}

/// How much rim was seen and how well it lies on the circle.
fn merit(report: &CircleReport) -> f64 {
    let agreed = report.points_used as f64 / (report.points_used + report.points_refused) as f64;
    report.rim_seen * agreed * report.circle.radius_px.sqrt() / (1.0 + report.residual_rms_px)
}

/// Follows the rim from a rough circle in ever narrower bands, and twice in the narrowest: wide enough for the blur of a
/// lens that fills the sensor with a ball, narrow enough to leave the neighbourhood out.
fn measure(images: &[&Plane], rough: &Circle, half_width_px: f64) -> Option<CircleReport> {
    let finest_px = (0.015 * rough.radius_px).clamp(3.0, 12.0);
    let every_pixel = ((std::f64::consts::TAU * rough.radius_px) as usize).clamp(180, 1440);
    let mut circle = *rough;
    let mut half_width = half_width_px;
    loop {
        let report = fit_circle(&rim_points(images, &circle, half_width, 180), &circle)?;
        let (x, y) = report.circle.centre_px;
        let moved = (x - rough.centre_px.0).hypot(y - rough.centre_px.1);
        if moved > 2.0 * half_width_px || !(0.5..2.0).contains(&(report.circle.radius_px / rough.radius_px)) {
            return None;
        }
        circle = report.circle;
        if half_width <= finest_px {
            return fit_circle(&rim_points(images, &circle, finest_px, every_pixel), &circle);
        }
        half_width = (0.5 * half_width).max(finest_px);
    }
}

fn common_size(images: &[&Plane]) -> Result<(usize, usize), BallError> {
    let first = images.first().ok_or(BallError::NoImage)?.size();
    match images.iter().map(|image| image.size()).find(|&size| size != first) {
        Some(other) => Err(BallError::SizesDiffer { first, other }),
        None => Ok(first),
    }
}

/// Where to look: everywhere; or around the click, in squares that double, so that a small ball is not lost in a large photo.
fn windows((width, height): (usize, usize), near_px: Option<(f64, f64)>) -> Vec<Window> {
    let Some((x, y)) = near_px else {
        return vec![Window::new(0..width, 0..height, WORKING_SIDE)];
    };
    let clip = |centre: f64, half: f64, side: usize| {
        let low = (centre - half).max(0.0) as usize;
        let high = ((centre + half).max(0.0) as usize).min(side);
        low.min(high)..high
    };
    let mut windows = Vec::new();
    let mut half = 80.0;
    loop {
        windows.push(Window::new(clip(x, half, width), clip(y, half, height), WORKING_SIDE / 2));
        if half >= width.max(height) as f64 {
            return windows;
        }
        half *= 2.0;
    }
}
