//! Whole methods that take the indirect light out of photos.

pub mod by_shape;
pub mod colours_and_shape;
