//! Units of length.

/// The unit of a mesh's coordinates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LengthUnit {
    /// Millimetres: the camera's scale is known.
    Millimetre,
    /// Pixels: no scale is known, the shape is right up to one.
    Pixel,
}
