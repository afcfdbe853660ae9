//! The numbers of Firstbounce: no file, no window, no thread policy but rayon's.
//!
//! Every stage has the same shape: an options struct with defaults and a `check()`, one function, and a report
//! struct. Frame: x right, y up, z from the object toward the camera; a light direction points from the object to
//! the light; lengths in mm. Pixels: x right, y down, the centre of the top left pixel is (0.5, 0.5).

pub mod ball;
mod block;
pub mod calibrate;
pub mod camera;
pub mod colour;
pub mod compare;
pub mod decimate;
pub mod depth;
pub mod evaluate;
pub mod indirect;
pub mod interval;
pub mod lab;
mod linear_algebra;
pub mod mask;
pub mod mesh;
pub mod mesh_topology;
pub mod nayar;
pub mod noise;
pub mod normal_map;
pub mod normals;
pub mod photo;
pub mod plane;
pub mod radiosity;
pub mod scene;
pub mod separate;
pub mod shape;
pub mod statistics;
pub mod trust;
pub mod watch;

pub use camera::{Camera, Projection};
pub use mask::Mask;
pub use mesh::Mesh;
pub use normal_map::{AngularError, NormalMap};
pub use photo::Photo;
pub use plane::Plane;
pub use watch::{Portion, Unwatched, Watch};
