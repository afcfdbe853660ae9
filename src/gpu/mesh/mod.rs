//! Surfaces on the graphics card: meshes, an eye, and the shader that lights them.
//!
//! A [`Scene`] says what is seen from where. [`MeshGpu`] draws it into a texture of its own, with a depth buffer and several
//! samples a pixel, whenever it differs from the last one, and lays that into the window.

mod buffers;
mod callback;
mod camera;
mod geometry;
mod pass;
mod pipelines;
mod scene;
mod uniforms;

pub use callback::{Kept, MeshCallback, install};
pub use camera::{Bounds, Camera, Frame, Lens, Ray, StandardView};
pub use geometry::{Geometry, Shared, Vertex};
pub use pass::{Laid, MeshGpu, Picture};
pub use scene::{LayerDrawing, PlaneDrawing, Scene, Shading};
