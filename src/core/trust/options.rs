//! The options of a verdict, and the limits of all verdicts.

use super::Level;
use crate::denoise::DenoiseOptions;

/// From where on a number asks for care, and from where on it should not be relied on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoLimits {
    /// Above this: take care.
    pub care: f64,
    /// Above this: do not trust.
    pub distrust: f64,
}

impl TwoLimits {
    /// What to think of a number; what is no number is not to be trusted.
    pub fn level(self, value: f64) -> Level {
        match value {
            value if value.is_nan() || value > self.distrust => Level::DoNotTrust,
            value if value > self.care => Level::TakeCare,
            _ => Level::Fine,
        }
    }
}

/// The limits of every verdict, on a calibration value as on a separation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Gain of bounce 1. Photos in two colours agree to about 0.4 % at best (linearity, lens, lamps that drift), and no
    /// averaging removes that: 10 times is 4 % of a photo, 25 times is 10 %.
    pub gain: TwoLimits,
    /// Angles in degrees. Photometric stereo of a matte object is good to 1 or 2; at 5 a wall is visibly bent and little
    /// better than with the indirect light left in.
    pub normal_deg: TwoLimits,
    /// Errors of bounce 1 in percent of it. On rendered scenes with truth 4 % came with normals 2 degrees off,
    /// 11 % with 3, 23 % with 8.
    pub light_percent: TwoLimits,
    /// Share of its light that an object sends back to itself. A white paint (0.9) inside a hemisphere returns 0.45,
    /// inside a ball with a small hole 0.8; more is rather a wrong beta than an object.
    pub return_share: TwoLimits,
    /// Percent of a ball's pixels that are clipped. Those left still hold a value, so it is never more than care.
    pub ball_clipped_percent: TwoLimits,
    /// Scatter of one pixel's ratio in percent: more comes from dirt, or from a ball of two paints.
    pub ball_scatter_percent: TwoLimits,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            gain: TwoLimits { care: 10.0, distrust: 25.0 },
            normal_deg: TwoLimits { care: 2.0, distrust: 5.0 },
            light_percent: TwoLimits { care: 5.0, distrust: 15.0 },
            return_share: TwoLimits { care: 0.6, distrust: 0.8 },
            ball_clipped_percent: TwoLimits { care: 5.0, distrust: f64::INFINITY },
            ball_scatter_percent: TwoLimits { care: 5.0, distrust: f64::INFINITY },
        }
    }
}

/// What is judged, and by which limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrustOptions {
    /// The order m.
    pub bounces: usize,
    /// How the noise of indirect light is averaged before normals are found.
    pub denoise: DenoiseOptions,
    /// The limits of the verdict.
    pub limits: Limits,
}

impl Default for TrustOptions {
    fn default() -> Self {
        Self { bounces: 2, denoise: DenoiseOptions::default(), limits: Limits::default() }
    }
}
