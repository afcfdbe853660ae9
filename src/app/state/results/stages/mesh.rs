//! Depth to triangles.

use std::sync::Arc;

use firstbounce_capture::pipeline::{camera_of, triangulate};
use firstbounce_core::Mesh;
use firstbounce_core::mesh::MeshOptions;
use firstbounce_core::stereo::shape::Shape;

use super::{Shapes, Step};
use crate::app::state::document::Document;
use crate::app::state::results::Results;
use crate::app::state::results::engine::{AnyKey, Done, Known, Stage, Work};
use crate::app::state::results::error::StageError;

/// Before and after as triangles.
#[derive(Clone, Debug)]
pub struct Meshes {
    /// From the direct light that the method in force finds.
    pub after: Arc<Mesh>,
    /// From the photos with all their light.
    pub before: Arc<Mesh>,
}

/// The stage.
pub struct Triangulate;

#[derive(PartialEq)]
struct Key {
    shape: u64,
}

impl Stage for Triangulate {
    fn step(&self) -> Step {
        Step::Mesh
    }

    fn needs(&self) -> Option<Step> {
        Some(Step::Shape)
    }

    fn title(&self) -> String {
        "Meshing".into()
    }

    fn job_name(&self, _: &Document) -> String {
        "Make mesh".into()
    }

    fn key(&self, known: &Known) -> Option<AnyKey> {
        let (_, shape) = known.ready::<Shapes>(Step::Shape)?;
        Some(AnyKey::new(Key { shape }))
    }

    fn work(&self, document: Arc<Document>, results: &Results) -> Option<Work> {
        let shapes = results.shapes()?;
        Some(Box::new(move |_| {
            let camera = camera_of(&document.set, shapes.after.depth.mask.size());
            let mesh =
                |shape: &Shape| Ok::<_, StageError>(Arc::new(triangulate(shape, &camera, &MeshOptions::default())?));
            Ok(Done::new(Meshes { after: mesh(&shapes.after)?, before: mesh(&shapes.before)? }))
        }))
    }
}
