//! Channels, and the curve between light and what a file stores, both scaled to 0..1.

use std::fmt;

use firstbounce_core::image::colour::{linear_from_srgb, srgb_from_linear};

/// How far two curves that count as one may lie apart, in light of 0 to 1: profiles round their tables.
const MAX_DEVIATION: f32 = 1e-3;
/// Where they are compared.
const STEPS: u16 = 64;

/// A channel of a picture file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Channel {
    /// Red.
    R,
    /// Green.
    G,
    /// Blue.
    B,
    /// The mean of what the file has.
    #[default]
    Grey,
}

/// How light becomes stored values.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Encoding {
    /// Stored values are proportional to light.
    #[default]
    Linear,
    /// The sRGB curve.
    Srgb,
    /// Stored = light ^ (1 / gamma).
    Gamma(f64),
}

impl Encoding {
    /// Light from a stored value. Below 0 the linear toe of sRGB goes on, and a gamma curve is mirrored, so that noise
    /// around black keeps its mean.
    pub fn decode(self, stored: f32) -> f32 {
        match self {
            Self::Linear => stored,
            Self::Srgb => linear_from_srgb(stored),
            Self::Gamma(gamma) => stored.abs().powf(gamma as f32).copysign(stored),
        }
    }

    /// Whether the two give the same light, within 0.001 of white.
    pub fn is_near(self, other: Self) -> bool {
        self.follows(|stored| other.decode(stored))
    }

    /// Whether a curve from stored values to light is this one, within 0.001 of white.
    pub(super) fn follows(self, light: impl Fn(f32) -> f32) -> bool {
        let mut stored = (0..=STEPS).map(|step| f32::from(step) / f32::from(STEPS));
        stored.all(|stored| (light(stored) - self.decode(stored)).abs() <= MAX_DEVIATION)
    }

    /// The stored value of light, the inverse of [`Self::decode`].
    pub fn encode(self, light: f32) -> f32 {
        match self {
            Self::Linear => light,
            Self::Srgb => srgb_from_linear(light),
            Self::Gamma(gamma) => light.abs().powf(1.0 / gamma as f32).copysign(light),
        }
    }
}

impl fmt::Display for Encoding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Linear => f.write_str("linear light"),
            Self::Srgb => f.write_str("the sRGB curve"),
            Self::Gamma(gamma) => write!(f, "a gamma of {gamma:.2}"),
        }
    }
}

impl Channel {
    /// How a capture file and a message call it.
    pub fn word(self) -> &'static str {
        match self {
            Self::R => "r",
            Self::G => "g",
            Self::B => "b",
            Self::Grey => "grey",
        }
    }
}

impl fmt::Display for Channel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.word())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_meets_the_standard_at_its_known_points() {
        for (stored, light) in [(0.0, 0.0), (0.5, 0.214_041), (1.0, 1.0), (128.0 / 255.0, 0.215_861)] {
            assert!((Encoding::Srgb.decode(stored) - light).abs() < 1e-5, "{stored}");
        }
    }

    #[test]
    fn encoding_undoes_decoding() {
        for encoding in [Encoding::Linear, Encoding::Srgb, Encoding::Gamma(2.2)] {
            for stored in [-0.01, 0.0, 0.02, 0.2, 0.7, 1.0] {
                assert!((encoding.encode(encoding.decode(stored)) - stored).abs() < 1e-5, "{encoding:?} {stored}");
            }
        }
    }
}
