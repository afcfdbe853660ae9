//! The numbers of Firstbounce: no file, no window, no thread policy but rayon's.
//!
//! Every stage has the same shape: an options struct with defaults and a `check()`, one function, and a report
//! struct. Frame: x right, y up, z from the object toward the camera; a light direction points from the object to
//! the light; lengths in mm. Pixels: x right, y down, the centre of the top left pixel is (0.5, 0.5).

pub mod colour;
pub mod compare;
pub mod mask;
pub mod mesh;
pub mod mesh_topology;
pub mod photo;
pub mod plane;
pub mod watch;

pub use mask::Mask;
pub use mesh::Mesh;
pub use photo::Photo;
pub use plane::Plane;
pub use watch::{Unwatched, Watch};
