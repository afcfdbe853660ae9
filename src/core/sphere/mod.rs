//! Finding the circle of a ball by its outer edge, and what lies on the ball.
//!
//! A ball lit from one side shows its edge on the lit half only; where the light ends is no edge of the ball. So all
//! functions take the photos of several lamps at once and use the edge points of all.

mod edges;
mod find;
mod fit;
mod geometry;
mod refusal;
mod rim;
mod vote;

pub use find::{CircleOptions, find_circle, refine_circle};
pub(crate) use geometry::seen_from_centre;
pub use geometry::{Ball, SurfacePoint, View, circle_through};
pub use refusal::{Refusal, RefusedCircle};

use crate::interval::Interval;
use crate::options::OptionError;

/// The outline of a ball in a photo. Pixel centres lie at .5.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Centre in pixels, x right, y down.
    pub centre_px: (f64, f64),
    /// Radius in pixels.
    pub radius_px: f64,
}

impl Circle {
    /// Distance of a point from the centre, in radii: 1 on the rim.
    pub fn radii_from_centre(&self, x_px: f64, y_px: f64) -> f64 {
        (x_px - self.centre_px.0).hypot(y_px - self.centre_px.1) / self.radius_px
    }

    /// Whether the whole circle lies in an image of this size, to within a pixel.
    pub fn lies_in(&self, (width, height): (usize, usize)) -> bool {
        let ((x, y), r) = (self.centre_px, self.radius_px - 1.0);
        x - r >= 0.0 && y - r >= 0.0 && x + r <= width as f64 && y + r <= height as f64
    }
}

/// A circle that was found, and how well it holds.
#[derive(Clone, Debug, PartialEq)]
pub struct CircleReport {
    /// The circle.
    pub circle: Circle,
    /// 95 % interval of the centre, x then y, in pixels.
    pub centre_interval_px: (Interval, Interval),
    /// 95 % interval of the radius in pixels.
    pub radius_interval_px: Interval,
    /// The largest of the standard deviations of centre x, centre y and radius; `circle_sd_px` of the calibration
    /// options.
    pub sd_px: f64,
    /// Root mean square distance of the edge points used from the circle, in pixels.
    pub residual_rms_px: f64,
    /// Fraction of the rim on which an edge was seen, 0 to 1.
    pub rim_seen: f64,
    /// How much brighter the ball is just inside its rim than outside, 1 being the photo's white; negative for a dark
    /// ball.
    pub contrast: f64,
    /// Edge points that hold the circle.
    pub points_used: usize,
    /// Edge points refused because they lie off the circle.
    pub points_refused: usize,
}

/// Why no circle was found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BallError {
    /// There is nothing to look at.
    #[error("no photo to find a ball in: name at least one photo of it")]
    NoImage,
    /// The photos do not lie on one another.
    #[error("the photos of the ball differ in size: {first:?} and {other:?} pixels; take them with one camera setting")]
    SizesDiffer {
        /// Width and height of the first photo.
        first: (usize, usize),
        /// Width and height of one that differs.
        other: (usize, usize),
    },
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
    /// No circle that holds.
    #[error(
        "no ball found: {}. Give three points of its rim, its circle, or that of another ball in the same place",
        refused.as_ref().map_or("no edge bends like a circle; the ball may be as dark as what lies behind it".to_owned(), ToString::to_string)
    )]
    NotFound {
        /// The circle with most support, and what speaks against it.
        refused: Option<RefusedCircle>,
    },
    /// Three points that no circle goes through.
    #[error("the three points lie on one line: take them well apart on the rim")]
    OnOneLine,
}
