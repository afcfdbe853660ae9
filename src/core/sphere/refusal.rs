//! Why a circle that edge points propose is not taken for a ball.

use std::fmt;

use super::{Circle, rim::RimPoint};
use crate::linear_algebra;
use nalgebra::{SMatrix, SVector};

/// A circle that was looked at and refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RefusedCircle {
    /// The circle.
    pub circle: Circle,
    /// What speaks against it.
    pub refusal: Refusal,
}

/// What speaks against a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Refusal {
    /// An edge shows on too little of it.
    RimSeen {
        /// The fraction of the rim on which one was seen.
        seen: f64,
        /// The fraction that was asked for.
        needed: f64,
    },
    /// Its edge is too faint to be followed.
    Faint {
        /// The fraction of the rim on which any edge stood out from the noise.
        seen: f64,
    },
    /// Edge points lie anywhere near it.
    Scattered {
        /// Root mean square distance of its edge points, in pixels.
        rms_px: f64,
        /// What would have passed.
        allowed_px: f64,
    },
    /// Its edge points leave its place open.
    Loose {
        /// Standard deviation of its place and size, in pixels.
        sd_px: f64,
        /// What would have passed.
        allowed_px: f64,
    },
    /// Its edge is an ellipse, as that of a ball far from the optical axis.
    Elliptic {
        /// The long axis over the short one.
        axes: f64,
    },
    /// Its edge leads to another place or size.
    Drifted,
}

impl fmt::Display for RefusedCircle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Circle { centre_px: (x, y), radius_px } = self.circle;
        write!(
            f,
            "the best circle (centre {x:.0} {y:.0}, radius {radius_px:.0} px) was refused, since {}",
            self.refusal
        )
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::RimSeen { seen, needed } => {
                write!(f, "an edge shows on {:.0} % of its rim and {:.0} % are needed", 100.0 * seen, 100.0 * needed)
            }
            Self::Faint { seen } => write!(
                f,
                "its edge is too faint: it stands out from the noise on {:.0} % of its rim; light the ball or change what lies \
                 behind it",
                100.0 * seen
            ),
            Self::Scattered { rms_px, allowed_px } => write!(
                f,
                "its edge points scatter by {rms_px:.1} px ({allowed_px:.1} would pass), as on things that are not round"
            ),
            Self::Loose { sd_px, allowed_px } => {
                write!(f, "its edge points hold it to {sd_px:.1} px only ({allowed_px:.1} would pass)")
            }
            Self::Elliptic { axes } => write!(
                f,
                "its edge is an ellipse of axes {axes:.2} to 1: place the ball nearer to the middle of the picture, or take a \
                 longer lens"
            ),
            Self::Drifted => f.write_str("its edge leads to another place"),
        }
    }
}

/// An ellipse has to explain this share of what a circle leaves.
const EXPLAINED: f64 = 0.6;
/// Rounder ones pass for circles.
const MIN_AXES: f64 = 1.02;

/// The axes of the ellipse through edge points near a circle, long over short; `None` where an ellipse fits them little
/// better than a circle. The edge of an ellipse of axes r + a and r - a lies a cos 2 (phi - phi0) off the circle of radius r.
pub(super) fn ellipse_axes(points: &[RimPoint], circle: &Circle) -> Option<f64> {
    let mut normal = SMatrix::<f64, 5, 5>::zeros();
    let mut right = SVector::<f64, 5>::zeros();
    let (mut squares, mut count) = (0.0, 0.0);
    for point in points {
        let (dx, dy) = (point.x - circle.centre_px.0, point.y - circle.centre_px.1);
        let (turn, off) = (dy.atan2(dx), dx.hypot(dy) - circle.radius_px);
        let row = SVector::from([1.0, turn.cos(), turn.sin(), (2.0 * turn).cos(), (2.0 * turn).sin()]);
        normal += row * row.transpose();
        right += row * off;
        squares += off * off;
        count += 1.0;
    }
    let fit = linear_algebra::solve_positive_definite(normal, &right).filter(|_| count > 30.0)?;
    let left = squares - fit.dot(&right);
    let (radius, half_difference) = (circle.radius_px + fit[0], fit[3].hypot(fit[4]));
    let axes = (radius + half_difference) / (radius - half_difference);
    (left < (1.0 - EXPLAINED) * squares && axes > MIN_AXES).then_some(axes)
}
