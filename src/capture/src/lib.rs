//! What lies on disk, and the pipeline that turns a capture set into a mesh, stage by stage.

pub mod atomic;
pub mod guard;
pub mod image_file;
pub mod light_file;
pub mod mesh_file;
pub mod open;
pub mod pipeline;
pub mod report;
pub mod set;

pub use atomic::{OutputFolder, WriteError};
pub use set::CaptureSet;
