//! Whole methods that take the indirect light out of photos.

pub mod by_shape;
