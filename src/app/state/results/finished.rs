//! The results of every stage together, for the files.

use std::sync::Arc;

use firstbounce_capture::pipeline::{Separated, Solved, Surfaced};
use firstbounce_core::Mesh;
use firstbounce_core::stereo::shape::Shape;

use super::{Calibration, Loaded, Meshes, Results, Shapes};

/// The results of every stage, to be written off the UI thread.
pub struct Finished {
    loaded: Arc<Loaded>,
    calibration: Arc<Calibration>,
    separated: Arc<Separated>,
    shapes: Arc<Shapes>,
    meshes: Arc<Meshes>,
}

impl Results {
    /// The results of every stage; `None` until all of them are there.
    pub fn finished(&self) -> Option<Finished> {
        Some(Finished {
            loaded: self.loaded()?,
            calibration: self.calibration()?,
            separated: self.separated()?,
            shapes: self.shapes()?,
            meshes: self.meshes()?,
        })
    }
}

impl Finished {
    /// As the pipeline's writer takes them. Copies marks, so call it in a job.
    pub fn solved(&self) -> Result<Solved, String> {
        let surfaced = |shape: &Shape, mesh: &Mesh| Surfaced { shape: shape.clone(), mesh: mesh.clone() };
        Ok(Solved {
            object: self.loaded.object.clone()?,
            calibrated: self.calibration.calibrated.clone(),
            separated: Separated::clone(&self.separated),
            trust: self.shapes.trust.clone(),
            direct: self.shapes.direct.clone(),
            after: Ok(surfaced(&self.shapes.after, &self.meshes.after)),
            before: Some(surfaced(&self.shapes.before, &self.meshes.before)),
            nayar: None,
            stages: Vec::new(),
        })
    }
}
