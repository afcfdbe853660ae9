//! Pictures as numbers: planes, masks, photos in linear light, normal maps, and what is measured on them.

pub mod bracket;
pub mod colour;
pub mod distortion;
pub mod evaluate;
pub mod gaussian;
pub mod mask;
pub mod mixing;
pub mod noise;
pub mod normal_map;
pub mod photo;
pub mod plane;
pub mod raster;
pub mod statistics;

pub use mask::Mask;
pub use normal_map::{AngularError, NormalMap};
pub use photo::{Marks, Photo};
pub use plane::Plane;
pub use raster::Raster;
