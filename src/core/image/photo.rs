//! One photo in linear light, with the pixels that must not be used marked.

use super::raster::Raster;
use crate::Plane;

/// The sensor was at its white level: the true light is unknown, only larger.
pub const CLIPPED: u8 = 1;
/// The light is within the noise of no light at all.
pub const DARK: u8 = 2;

/// Bits for each pixel that say why it must not be used, or how it was used: those of photos are here, those of results
/// beside the stage that sets them. 0 is a good pixel.
pub type Marks = Raster<u8>;

impl Marks {
    /// How many pixels carry any of the marks `any_of`.
    pub fn count(&self, any_of: u8) -> usize {
        self.data().iter().filter(|&&mark| mark & any_of != 0).count()
    }
}

/// A photo in linear light: black level and dark frame subtracted, divided by flat field and exposure, repeats averaged.
/// The white level at exposure 1 is 1.0; values may exceed it where the exposure was shorter, and noise may make them negative.
#[derive(Clone, Debug, PartialEq)]
pub struct Photo {
    /// Linear light.
    pub linear: Plane,
    /// For each pixel of `linear`, why it must not be used: `CLIPPED`, `DARK`, their sum, or 0 for a good pixel.
    pub marks: Marks,
}

impl Photo {
    /// A photo without a bad pixel.
    pub fn unmarked(linear: Plane) -> Self {
        let marks = Marks::filled(linear.width(), linear.height(), 0);
        Self { linear, marks }
    }
}
