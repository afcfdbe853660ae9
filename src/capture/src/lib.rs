//! What lies on disk, and the pipeline that turns a capture set into a mesh, stage by stage.

pub mod mesh_file;
