//! What makes a measured value doubtful, each with its words and its level.

use std::fmt;

use firstbounce_core::calibrate::{CalibrateError, DirectionSource, Disagreement};
use firstbounce_core::sphere::CircleReport;
use firstbounce_core::trust::{Level, Limits};

use super::BallCircle;
use crate::set::{Circle, SphereKind};

/// What makes a measured direction doubtful.
#[derive(Clone, Debug, PartialEq)]
pub enum DirectionDoubt {
    /// Two highlights on the mirror ball are nearly as likely.
    TwoHighlights,
    /// The highlight is seen under other lamps too.
    Lasting,
    /// A reflection that stays lies against the highlight.
    BesideLasting,
    /// A reflection that stays is much brighter than the highlight.
    Outshone,
    /// Another light has the same direction.
    SameAs {
        /// The other light.
        light: String,
        /// Angle between the two.
        angle_deg: f64,
    },
    /// One ball cannot be used under this light, and the other can.
    Unusable {
        /// Which cannot.
        ball: SphereKind,
        /// Why.
        reason: CalibrateError,
    },
    /// The balls disagree.
    Balls(Disagreement),
    /// The balls contradict what the file gives.
    Given {
        /// What the file gives.
        source: DirectionSource,
        /// Angle between the two.
        angle_deg: f64,
        /// The angle that would have passed.
        allowed_deg: f64,
    },
}

impl DirectionDoubt {
    /// How much it spoils the direction.
    pub fn level(&self) -> Level {
        match self {
            Self::TwoHighlights | Self::BesideLasting | Self::Outshone | Self::Unusable { .. } => Level::TakeCare,
            Self::Lasting | Self::SameAs { .. } => Level::DoNotTrust,
            Self::Balls(Disagreement { angle_deg, .. }) | Self::Given { angle_deg, .. } => {
                Limits::default().normal_deg.level(*angle_deg).max(Level::TakeCare)
            }
        }
    }

    /// Whether it holds of a direction that the file gives too.
    pub(super) fn is_of_any_source(&self) -> bool {
        matches!(self, Self::SameAs { .. } | Self::Given { .. })
    }

    /// Whether the grey ball's shading can clear it up.
    pub(in crate::pipeline) fn is_of_highlight(&self) -> bool {
        matches!(self, Self::TwoHighlights | Self::Lasting | Self::BesideLasting | Self::Outshone)
    }
}

impl fmt::Display for DirectionDoubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TwoHighlights => {
                f.write_str("two highlights on the mirror ball are nearly as likely; look which one is the lamp's")
            }
            Self::Lasting => f.write_str(
                "its highlight on the mirror ball is seen under other lamps too, as a reflection of the room is: choose the \
                 lamp's highlight in Calibrate, or cover what is reflected and photograph the ball again",
            ),
            Self::BesideLasting => f.write_str(
                "a reflection of the room lies against its highlight on the mirror ball and may hide part of it: cover \
                 what is reflected, or turn the rig, and photograph the ball again",
            ),
            Self::Outshone => f.write_str(
                "a reflection of the room on the mirror ball is much brighter than its highlight: look whether that is \
                 the lamp's, or cover what is reflected and photograph the ball again",
            ),
            Self::SameAs { light, angle_deg } => write!(
                f,
                "its direction is that of light {light} to {angle_deg:.1} degrees: check that a reflection of the room was not \
                 taken for the lamp, and that each photo stands under its own light"
            ),
            Self::Unusable { ball, reason } => {
                write!(f, "the {ball} ball is left out, and the direction is that of the other ball: {reason}")
            }
            Self::Balls(disagreement) => disagreement.fmt(f),
            Self::Given { source, angle_deg, allowed_deg } => write!(
                f,
                "{source} and the balls differ by {angle_deg:.1} degrees ({allowed_deg:.1} would pass): check which lamp the \
                 photos are of, or delete what was given"
            ),
        }
    }
}

/// A given circle that does not lie on the edge of its ball.
#[derive(Clone, Debug, PartialEq)]
pub struct CircleDoubt {
    /// The ball.
    pub ball: SphereKind,
    /// The largest distance between the two circles, in pixels.
    pub off_px: f64,
    /// The same in radii of the ball.
    pub off_radii: f64,
    /// The circle on the edge.
    pub edge: Circle,
}

impl CircleDoubt {
    /// Of a given circle and the edge nearby. Circles that the program wrote, or that the user snapped, lie on it to a
    /// fraction of a pixel.
    pub(super) fn of(ball: SphereKind, given: &Circle, edge: &CircleReport) -> Option<Self> {
        let ((x, y), radius) = (edge.circle.centre_px, edge.circle.radius_px);
        let off_px = (x - given.centre[0]).hypot(y - given.centre[1]) + (radius - given.radius).abs();
        let off_radii = off_px / radius;
        let is_off = off_px > MAX_OFF_PX.max(4.0 * edge.sd_px) && off_radii > MAX_OFF_RADII;
        is_off.then_some(Self { ball, off_px, off_radii, edge: Circle { centre: [x, y], radius } })
    }

    /// How much it spoils what was measured on the ball: a normal halfway to the rim turns by this much.
    pub fn level(&self) -> Level {
        Limits::default().normal_deg.level(self.off_radii.to_degrees()).max(Level::TakeCare)
    }
}

/// A given circle may be off by this much without a word.
const MAX_OFF_PX: f64 = 1.0;
const MAX_OFF_RADII: f64 = 0.01;

impl fmt::Display for CircleDoubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Circle { centre: [x, y], radius } = self.edge;
        write!(
            f,
            "the {} ball's circle in capture.toml lies {:.1} px off its edge, which is at centre {x:.1}, {y:.1}, radius \
             {radius:.1}: snap it to the edge in Calibrate, or delete its [[sphere]] to have it found",
            self.ball, self.off_px
        )
    }
}

impl BallCircle {
    /// Whether a given circle lies off the edge of its ball.
    pub fn doubt(&self) -> Option<CircleDoubt> {
        let edge = self.edge.as_ref()?;
        CircleDoubt::of(self.sphere.kind, &self.sphere.circle, edge)
    }
}
