//! What the user should know of a calibration before trusting it, beside the doubts about one direction.

use std::fmt;

use super::{BallNotFound, CircleDoubt};

/// A warning of a calibration.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Warning<'a> {
    /// A ball without which the values are known too.
    BallNotFound(&'a BallNotFound),
    /// A given circle off its ball's edge.
    Circle(CircleDoubt),
    /// A typed value that a ball contradicts.
    Typed {
        /// "alpha of light left in green"
        what: String,
        /// What was typed.
        typed: f64,
        /// What the ball says.
        measured: f64,
        /// Half of its 95 % interval.
        half_width: f64,
    },
    /// Intensities that nothing gives.
    AssumedIntensities {
        /// Of which lights.
        lights: Vec<&'a str>,
    },
}

impl fmt::Display for Warning<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BallNotFound(ball) => write!(f, "the {} ball is left out: {}", ball.kind, ball.error()),
            Self::Circle(doubt) => doubt.fmt(f),
            Self::Typed { what, typed, measured, half_width } => write!(
                f,
                "{what} is {typed:.4} in capture.toml, and the ball says {measured:.4} \u{b1} {half_width:.4}: check which is \
                 right, and delete the line to use the ball's"
            ),
            Self::AssumedIntensities { lights } => write!(
                f,
                "no grey ball gives the intensity of {}: taken as 1, which bends the normals if these lamps are not equally \
                 strong",
                lights.join(", ")
            ),
        }
    }
}
