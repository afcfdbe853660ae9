//! The numbers of Firstbounce: no file, no window, no thread policy but rayon's.
//!
//! Every stage has the same shape: an options struct with defaults and a `check()`, one function, and a report
//! struct. Frame: x right, y up, z from the object toward the camera; a light direction points from the object to
//! the light; lengths in mm. Pixels: x right, y down, the centre of the top left pixel is (0.5, 0.5).

mod block;
pub mod calibrate;
pub mod camera;
pub mod denoise;
pub mod image;
pub mod interval;
pub mod length;
pub mod light;
pub mod mesh;
pub mod methods;
pub mod options;
pub mod separate;
pub mod sphere;
pub mod stereo;
pub mod trust;
pub mod watch;

pub use camera::{Camera, Projection};
pub use image::{AngularError, Marks, Mask, NormalMap, Photo, Plane, Raster};
pub use mesh::Mesh;
pub use watch::{Portion, Unwatched, Watch};
