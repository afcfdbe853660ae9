//! Photometric stereo: normals from light, depth from normals, and both as one shape.

pub mod depth;
pub mod normals;
pub mod shape;
