//! The numbers of Firstbounce: no file, no window, no thread policy but rayon's.
//!
//! Every stage has the same shape: an options struct with defaults and a `check()`, one function, and a report
//! struct. Frame: x right, y up, z from the object toward the camera; a light direction points from the object to
//! the light; lengths in mm. Pixels: x right, y down, the centre of the top left pixel is (0.5, 0.5).
//!
//! One pixel, separated into direct light and light that bounced twice:
//!
//! ```
//! use firstbounce_core::image::noise::NoiseModel;
//! use firstbounce_core::separate::{LightPhotos, SeparateError, SeparateOptions, separate};
//! use firstbounce_core::{Mask, Photo, Plane, Unwatched};
//!
//! // The paint reflects half as much green light as blue (beta); the green lamp is twice as strong (alpha).
//! let (alpha, beta) = ([1.0, 2.0], [1.0, 0.5_f64]);
//! let (direct, indirect) = (0.3, 0.1);
//! let photos = [0, 1].map(|c| {
//!     let light = alpha[c] * (beta[c] * direct + beta[c].powi(2) * indirect);
//!     Photo::unmarked(Plane::filled(1, 1, light as f32))
//! });
//!
//! let light = LightPhotos {
//!     photos: &[&photos[0], &photos[1]],
//!     noise: &[NoiseModel::of_camera(20_000.0, 5.0, 1, 1.0); 2],
//!     alpha: &alpha,
//!     beta: &beta,
//!     mask: &Mask::filled(1, 1, true),
//! };
//! let (separation, report) = separate(&light, &SeparateOptions { bounces: 2 }, &Unwatched)?;
//!
//! assert!((separation.bounces[0].at(0, 0) - 0.3).abs() < 1e-6);
//! assert!((separation.bounces[1].at(0, 0) - 0.1).abs() < 1e-6);
//! assert!((report.gain[0] - 4.12).abs() < 0.01, "noise of bounce 1 for unit noise of a photo");
//! # Ok::<(), SeparateError>(())
//! ```

mod block;
pub mod calibrate;
pub mod camera;
pub mod capture_checks;
pub mod denoise;
pub mod image;
pub mod interval;
pub mod length;
pub mod light;
mod linear_algebra;
pub mod mesh;
#[doc = include_str!("METHOD.md")]
pub mod method {}
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
