//! One picture at one place of the target.

use super::pyramid::level_count;
use super::{Display, Source};

/// From this many screen pixels per texel on, texels are crisp squares.
const CRISP_FROM: f32 = 4.0;

/// Where the picture lies on the target, in physical pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// The picture's top left corner, from the target's.
    pub origin_px: [f32; 2],
    /// Pixels of the target for a pixel of the picture.
    pub scale: f32,
}

/// Which copy of the picture is read, and how.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sampling {
    /// 0 for the picture itself, k for the copy at `1 / 2^k` of its resolution.
    pub level: u32,
    /// Whether texels are shown as squares instead of blended.
    pub nearest: bool,
}

impl Placement {
    /// The copy with one to two texels for a pixel of the target, or the finest there is: `finest` is the least level that can
    /// be read.
    pub fn sampling(&self, size: (usize, usize), finest: u32) -> Sampling {
        let wanted = (1.0 / self.scale).log2().floor().max(0.0) as u32;
        let level = wanted.max(finest).min(level_count(size) - 1);
        Sampling { level, nearest: self.scale * (level as f32).exp2() >= CRISP_FROM }
    }
}

/// What to draw, how, and where.
#[derive(Clone, Copy)]
pub struct Drawing<'a> {
    /// The numbers.
    pub source: &'a Source,
    /// Their colours.
    pub display: &'a Display,
    /// Their place.
    pub placement: Placement,
    /// The colour around the picture and where it has no value, 0 to 1 in gamma space.
    pub background: [f32; 3],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_copy_read_has_one_to_two_texels_a_pixel() {
        let sampling = |scale| Placement { origin_px: [0.0; 2], scale }.sampling((4000, 3000), 0);
        assert_eq!(sampling(1.0), Sampling { level: 0, nearest: false });
        assert_eq!(sampling(0.3), Sampling { level: 1, nearest: false });
        assert_eq!(sampling(0.25), Sampling { level: 2, nearest: false });
        assert_eq!(sampling(4.0), Sampling { level: 0, nearest: true });
        assert_eq!(sampling(1e-6).level, level_count((4000, 3000)) - 1);
    }
}
