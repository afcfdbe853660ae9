//! Meshes on disk: scans are read, results are written.

pub mod gltf;
pub mod read;
pub mod stl;

#[cfg(test)]
mod test_mesh;
