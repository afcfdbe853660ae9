//! The errors of calibration.

use super::PixelCounts;
use crate::options::OptionError;
use crate::sphere::Circle;

/// Why a calibration value could not be measured.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CalibrateError {
    /// Two photos of one ball differ in size.
    #[error("the photos of the ball differ in size: {first:?} and {other:?} pixels; take them with one camera setting")]
    SizesDiffer {
        /// Width and height of the first photo.
        first: (usize, usize),
        /// Width and height of the other.
        other: (usize, usize),
    },
    /// The ball is cut off.
    #[error(
        "the ball's circle (centre {:.1} {:.1}, radius {:.1} px) leaves the {} x {} photo; correct the circle or photograph the whole ball",
        circle.centre_px.0, circle.centre_px.1, circle.radius_px, size.0, size.1
    )]
    LeavesImage {
        /// The circle.
        circle: Circle,
        /// Width and height of the photo.
        size: (usize, usize),
    },
    /// Too much of the lit part is at the white level.
    #[error(
        "{:.0} % of the ball's lit part is clipped (at most {:.0} % may be); shorten the exposure",
        clipped * 100.0,
        allowed * 100.0
    )]
    Clipped {
        /// Clipped fraction of the lit pixels.
        clipped: f64,
        /// The fraction that was allowed.
        allowed: f64,
    },
    /// Too little of the ball remains.
    #[error("only {} of the {} pixels of the ball can be used, {needed} are needed ({counts}); {}", counts.used, counts.inside(), advice(counts))]
    TooFewPixels {
        /// What became of the ball's pixels.
        counts: PixelCounts,
        /// The number that was asked for.
        needed: usize,
    },
    /// The mirror ball shows no highlight.
    #[error(
        "no highlight on the mirror ball: its brightest pixel, {peak:.4}, is no brighter than its surroundings; check that the lamp was on, or click the highlight"
    )]
    NoHighlight {
        /// Linear light of the brightest pixel.
        peak: f64,
    },
    /// The number makes no sense, as where a circle lies beside its ball.
    #[error(
        "{quantity} came out as {value:.4}, which no lamp can have; check that the circle lies on the ball and the right files are named"
    )]
    Impossible {
        /// What was measured.
        quantity: &'static str,
        /// What came out.
        value: f64,
    },
    /// There is nothing to pool or to compare.
    #[error("{quantity} needs at least one measurement")]
    NothingMeasured {
        /// What was to be measured.
        quantity: &'static str,
    },
    /// An option out of its range.
    #[error(transparent)]
    Option(#[from] OptionError),
}

fn advice(counts: &PixelCounts) -> &'static str {
    let lost = [
        (counts.clipped, "shorten the exposure"),
        (counts.dark + counts.near_terminator, "lengthen the exposure or bring the lamp nearer to the camera"),
        (counts.near_rim, "photograph the ball larger"),
        (counts.highlight + counts.outlier, "check that the circle lies on the ball and that its paint is matt"),
    ];
    lost.into_iter().max_by_key(|&(count, _)| count).map_or("check the circle", |(_, advice)| advice)
}
