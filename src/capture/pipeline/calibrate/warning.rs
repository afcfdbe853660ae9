//! What the user should know of a calibration before trusting it, beside the doubts about one direction.

use std::fmt;

use super::scale::ScaleSource;
use super::{BallNotFound, CircleDoubt, KnownCrosstalk, MAX_HALF_WIDTHS, Source};
use crate::set::{CaptureSet, SphereKind};

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
    /// beta that differs from light to light in photos whose colours are channels of one file: the light of one lamp colour is in the
    /// channel of another.
    UnknownCrosstalk {
        /// The colour.
        colour: &'a str,
        /// Its lowest and highest beta by light.
        beta: [f64; 2],
    },
    /// A typed share of crosstalk that the shots contradict.
    TypedCrosstalk {
        /// The colour whose channel it is.
        channel: &'a str,
        /// The colour whose lamp it is.
        lamp: &'a str,
        /// What was typed.
        typed: f64,
        /// What the shots say.
        measured: f64,
        /// Half of its 95 % interval.
        half_width: f64,
    },
    /// A scale that the diameter of a ball contradicts.
    Scale {
        /// Which ball.
        ball: SphereKind,
        /// mm per pixel in force.
        in_force: f64,
        /// What the ball says.
        measured: f64,
        /// How it is given.
        source: ScaleSource,
    },
    /// The mirror ball in its second place, in pictures of another size: the camera was not the same.
    MovedBallSize {
        /// Width and height of its pictures in the first place, in pixels.
        expected: (usize, usize),
        /// In the second.
        found: (usize, usize),
    },
    /// Several mirror balls, or one in two places, without a scale.
    NoScaleForPositions,
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
            Self::UnknownCrosstalk { colour, beta: [low, high] } => write!(
                f,
                "beta in {colour} is {low:.4} under one light and {high:.4} under another, in photos whose colours are channels of one \
                 file: a channel probably sees another lamp too. Photograph the grey ball under each lamp colour alone as \
                 \"crosstalk\" shots, or type crosstalk under [camera]"
            ),
            Self::TypedCrosstalk { channel, lamp, typed, measured, half_width } => write!(
                f,
                "the channel of {channel} sees {typed:.4} of the {lamp} lamp by capture.toml, and the shots say {measured:.4} \u{b1} \
                 {half_width:.4}: check which is right, and delete the line to use the shots'"
            ),
            Self::Scale { ball, in_force, measured, source } => {
                let given = match source {
                    ScaleSource::Typed => "by [camera] of capture.toml",
                    ScaleSource::Balls => "by the diameters of all balls",
                };
                write!(
                    f,
                    "a pixel is {in_force:.5} mm {given}, and {measured:.5} mm by the diameter of the {ball} ball: check which is \
                     right, and whether the ball lies at the object's distance from the camera"
                )
            }
            Self::MovedBallSize { expected, found } => write!(
                f,
                "the mirror ball in its second place is left out: its pictures have {} x {} pixels, those in its first place {} x \
                 {}. Move the ball alone, not the camera, and photograph both places at one size",
                found.0, found.1, expected.0, expected.1
            ),
            Self::NoScaleForPositions => f.write_str(
                "the mirror balls could say where near lamps are, but not in mm: give mm_per_pixel under [camera], or diameter_mm in \
                 the [[sphere]] of a ball",
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

/// A typed share of crosstalk may be off by this much beside its interval: of the light of a lamp, no more is seen in the result.
const MAX_TYPED_CROSSTALK: f64 = 0.003;

/// Typed crosstalk that the shots contradict.
pub(super) fn typed_crosstalk<'a>(
    set: &'a CaptureSet,
    typed: &[Vec<f64>],
    measured: &KnownCrosstalk,
) -> Vec<Warning<'a>> {
    let rows = set.colours.iter().zip(typed.iter().zip(measured));
    let entries = rows.flat_map(|(channel, (typed, measured))| {
        let lamps = set.colours.iter().zip(typed.iter().zip(measured));
        lamps.map(move |(lamp, (typed, measured))| (&*channel.name, &*lamp.name, *typed, measured))
    });
    let contradicted = entries.filter_map(|(channel, lamp, typed, known)| {
        let [low, high] = known.interval.filter(|_| known.source == Source::GreyBall)?;
        let (measured, half_width) = (known.value, (high - low) / 2.0);
        let is_off = (typed - measured).abs() > MAX_HALF_WIDTHS * half_width + MAX_TYPED_CROSSTALK;
        is_off.then_some(Warning::TypedCrosstalk { channel, lamp, typed, measured, half_width })
    });
    contradicted.collect()
}
