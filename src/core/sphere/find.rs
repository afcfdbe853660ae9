//! From photos of a ball to its circle.

use super::{
    BallError, Circle, CircleReport, Refusal, RefusedCircle,
    edges::{Window, edge_points, working_image},
    fit::fit_circle,
    refusal::ellipse_axes,
    rim::rim_points,
    vote::propose,
};
use crate::Plane;
use crate::options::check_range;

/// The longest side of the reduced photo in which a ball is looked for.
const WORKING_SIDE: usize = 640;
/// Edge points that are looked at, the strongest first.
const EDGE_POINTS: usize = 8000;
/// Circles that are measured before the best is taken.
const PROPOSALS: usize = 6;
/// Smaller circles cannot be distinguished from noise in the reduced photo.
const MIN_WORKING_RADIUS: f64 = 5.0;

/// Rim points that leave the circle more uncertain than this many radii, and this many pixels, lie on several things.
const LOOSE_RADII: f64 = 0.003;
const LOOSE_PX: f64 = 0.3;
/// Rim points of which the root mean square distance is more of the band's half width lie anywhere in it.
const SCATTERED: f64 = 0.28;

/// Where the edge of an ellipse is looked for, in radii to either side of the circle nearest to it.
const ELLIPSE_BAND_RADII: f64 = 0.15;

/// How to look for a ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CircleOptions {
    /// The smallest radius to look for, in pixels. Without a click, a ball also has to be larger than 1 % of the
    /// photo's side.
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
        check_range("min_radius_px", self.min_radius_px, self.min_radius_px >= 3.0, "3 or more")?;
        let rim_seen = self.min_rim_seen;
        Ok(check_range("min_rim_seen", rim_seen, (0.1..=1.0).contains(&rim_seen), "between 0.1 and 1")?)
    }
}

/// Finds a ball that is in the same place in all `images` (one lamp each, linear light), from a click `near_px`
/// inside it or from nothing.
///
/// Without a click the ball with the largest visible rim is taken. Errors: no photo, sizes that differ, no circle with
/// enough of its rim in view.
pub fn find_circle(
    images: &[&Plane],
    near_px: Option<(f64, f64)>,
    options: &CircleOptions,
) -> Result<CircleReport, BallError> {
    options.check()?;
    let size = common_size(images)?;
    let wanted = |circle: &Circle| {
        let fits = circle.radius_px >= options.min_radius_px && circle.radius_px <= 0.75 * size.0.max(size.1) as f64;
        let (x, y) = circle.centre_px;
        let in_photo = x > 0.0 && y > 0.0 && x < size.0 as f64 && y < size.1 as f64;
        fits && in_photo && near_px.is_none_or(|(x, y)| circle.radii_from_centre(x, y) < 1.05)
    };
    search(images, &windows(size, near_px), wanted, options)
}

/// Snaps a rough circle, as drawn by hand, to the edge of the ball under it: centre and radius within a quarter of its
/// radius.
///
/// Errors as in [`find_circle`].
pub fn refine_circle(images: &[&Plane], rough: &Circle, options: &CircleOptions) -> Result<CircleReport, BallError> {
    options.check()?;
    let size = common_size(images)?;
    let reach = 1.6 * rough.radius_px;
    let window = square(size, rough.centre_px, reach, WORKING_SIDE);
    let wanted = |circle: &Circle| {
        let (x, y) = circle.centre_px;
        let moved = (x - rough.centre_px.0).hypot(y - rough.centre_px.1);
        moved < 0.25 * rough.radius_px && (circle.radius_px - rough.radius_px).abs() < 0.25 * rough.radius_px
    };
    search(images, &[window], wanted, options)
}

/// Proposes circles in each window, follows their rims in the photos and takes the best.
fn search(
    images: &[&Plane],
    windows: &[Window],
    wanted: impl Fn(&Circle) -> bool,
    options: &CircleOptions,
) -> Result<CircleReport, BallError> {
    let mut found: Vec<CircleReport> = Vec::new();
    let mut refused: Option<(RefusedCircle, f64)> = None;
    for &window in windows {
        let scale = window.scale as f64;
        let points = edge_points(&working_image(images, window), EDGE_POINTS);
        let in_photo = |circle: &Circle| Circle {
            centre_px: window.to_photo(circle.centre_px),
            radius_px: circle.radius_px * scale,
        };
        let visible = |circle: &Circle| circle.radius_px >= MIN_WORKING_RADIUS && wanted(&in_photo(circle));
        for proposal in propose(&points, visible, PROPOSALS) {
            let circle = in_photo(&proposal.circle);
            let measured = measure(images, &circle, 2.5 * scale + 2.0)
                .and_then(|report| if wanted(&report.circle) { Ok(report) } else { Err(Refusal::Drifted) });
            match measured {
                Ok(report) => found.push(report),
                Err(refusal) if refused.is_none_or(|(_, support)| proposal.support > support) => {
                    refused = Some((RefusedCircle { circle, refusal }, proposal.support));
                }
                Err(_) => {}
            }
        }
    }
    accept(best_of(found), refused.map(|(refused, _)| refused), options)
}

/// The circle with most merit; but where light ends on a ball looks like a fainter rim inside its true one, so among
/// circles that overlap that one by most and are nearly as good, the one of most contrast.
fn best_of(found: Vec<CircleReport>) -> Option<CircleReport> {
    let first = found.iter().max_by(|a, b| merit(a).total_cmp(&merit(b)))?;
    let (circle, enough) = (first.circle, 0.5 * merit(first));
    let rivals = |report: &CircleReport| {
        let (x, y) = report.circle.centre_px;
        let apart = (x - circle.centre_px.0).hypot(y - circle.centre_px.1);
        apart + (report.circle.radius_px - circle.radius_px).abs() < 0.4 * circle.radius_px && merit(report) >= enough
    };
    let strength = |report: &CircleReport| report.contrast.abs() * merit(report);
    found.into_iter().filter(rivals).max_by(|a, b| strength(a).total_cmp(&strength(b)))
}

fn accept(
    found: Option<CircleReport>,
    refused: Option<RefusedCircle>,
    options: &CircleOptions,
) -> Result<CircleReport, BallError> {
    match found {
        Some(found) if found.rim_seen >= options.min_rim_seen => Ok(found),
        Some(CircleReport { circle, rim_seen: seen, .. }) => {
            let refusal = Refusal::RimSeen { seen, needed: options.min_rim_seen };
            Err(BallError::NotFound { refused: Some(RefusedCircle { circle, refusal }) })
        }
        None => Err(BallError::NotFound { refused }),
    }
}

/// How much rim was seen and how well it lies on the circle.
fn merit(report: &CircleReport) -> f64 {
    let agreed = report.points_used as f64 / (report.points_used + report.points_refused) as f64;
    report.rim_seen * agreed * report.circle.radius_px.sqrt() / (1.0 + report.residual_rms_px)
}

/// Follows the rim from a rough circle in ever narrower bands, and twice in the narrowest: wide enough for the blur of
/// a lens that fills the sensor with a ball, narrow enough to leave the neighbourhood out. Refuses points that scatter over
/// the band instead of lying on a circle.
fn measure(images: &[&Plane], rough: &Circle, half_width_px: f64) -> Result<CircleReport, Refusal> {
    let finest_px = (0.02 * rough.radius_px).clamp(3.0, 12.0);
    let every_pixel = ((std::f64::consts::TAU * rough.radius_px) as usize).clamp(180, 1440);
    let fit = |circle: &Circle, half_width: f64, places: usize| {
        let points = rim_points(images, circle, half_width, places);
        fit_circle(&points, places, circle).ok_or(Refusal::Faint { seen: points.len() as f64 / places as f64 })
    };
    let mut circle = *rough;
    let mut half_width = half_width_px;
    loop {
        let report = fit(&circle, half_width, 180)?;
        let (x, y) = report.circle.centre_px;
        let moved = (x - rough.centre_px.0).hypot(y - rough.centre_px.1);
        if moved > 2.0 * half_width_px || !(0.5..2.0).contains(&(report.circle.radius_px / rough.radius_px)) {
            return Err(Refusal::Drifted);
        }
        circle = report.circle;
        if half_width <= finest_px {
            return firm(images, fit(&circle, finest_px, every_pixel)?, finest_px);
        }
        half_width = (0.5 * half_width).max(finest_px);
    }
}

/// A circle that its edge points hold.
fn firm(images: &[&Plane], report: CircleReport, band_px: f64) -> Result<CircleReport, Refusal> {
    let loosest_px = LOOSE_PX.max(LOOSE_RADII * report.circle.radius_px);
    let widest_px = SCATTERED * band_px;
    let is_loose = report.sd_px >= loosest_px;
    if !is_loose && report.residual_rms_px < widest_px {
        return Ok(report);
    }
    let around = rim_points(images, &report.circle, ELLIPSE_BAND_RADII * report.circle.radius_px, 180);
    Err(match ellipse_axes(&around, &report.circle) {
        Some(axes) => Refusal::Elliptic { axes },
        None if is_loose => Refusal::Loose { sd_px: report.sd_px, allowed_px: loosest_px },
        None => Refusal::Scattered { rms_px: report.residual_rms_px, allowed_px: widest_px },
    })
}

fn common_size(images: &[&Plane]) -> Result<(usize, usize), BallError> {
    let first = images.first().ok_or(BallError::NoImage)?.size();
    match images.iter().map(|image| image.size()).find(|&size| size != first) {
        Some(other) => Err(BallError::SizesDiffer { first, other }),
        None => Ok(first),
    }
}

/// Where to look: everywhere; or around the click, in squares that double, so that a small ball is not lost in a large
/// photo.
fn windows((width, height): (usize, usize), near_px: Option<(f64, f64)>) -> Vec<Window> {
    let Some((x, y)) = near_px else {
        return vec![Window::new(0..width, 0..height, WORKING_SIDE)];
    };
    let mut windows = Vec::new();
    let mut half = 80.0;
    loop {
        windows.push(square((width, height), (x, y), half, WORKING_SIDE / 2));
        if half >= width.max(height) as f64 {
            return windows;
        }
        half *= 2.0;
    }
}

/// The part of a square around a point that lies in the photo.
fn square((width, height): (usize, usize), (x, y): (f64, f64), half: f64, max_side: usize) -> Window {
    let clip = |centre: f64, side: usize| {
        let low = (centre - half).max(0.0) as usize;
        let high = ((centre + half).max(0.0) as usize).min(side);
        low.min(high)..high
    };
    Window::new(clip(x, width), clip(y, height), max_side)
}
