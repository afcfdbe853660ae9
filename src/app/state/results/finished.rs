//! The results of every stage together, for the files.

use std::sync::Arc;

use firstbounce_capture::pipeline::{Method, MethodReport, Solved, Surface, SurfaceName};

use super::{Results, StageState, Step};
use crate::app::state::document::Document;

/// What can be written off the UI thread. Nothing is copied.
pub type Finished = Arc<Solved>;

impl Results {
    /// The surfaces of this document that can be written: those that a method found.
    pub fn surfaces(&self, document: &Document) -> Vec<SurfaceName> {
        let is_ready = |name: &SurfaceName| self.state(last_stage_of(*name), document) == StageState::Ready;
        Method::ALL.into_iter().map(SurfaceName::By).filter(is_ready).collect()
    }

    /// Everything that belongs to a surface, as the command line would write it; `None` until it is there.
    pub fn finished(&self, surface: SurfaceName, document: &Document) -> Option<Finished> {
        match surface {
            SurfaceName::Before | SurfaceName::After => self.finished_by_colours(document).map(Arc::new),
            SurfaceName::By(method) => Some(self.by_method(method)?.solved.clone()),
        }
    }

    fn finished_by_colours(&self, document: &Document) -> Option<Solved> {
        let (loaded, shapes, meshes) = (self.loaded()?, self.shapes()?, self.meshes()?);
        let (after, before) = (shapes.after.clone(), shapes.before.clone());
        Some(Solved {
            set: Arc::new(document.set.clone()),
            options: document.options(Method::Colours),
            object: loaded.object.as_ref().ok()?.clone(),
            calibrated: self.calibration()?.calibrated.clone(),
            separated: self.separated()?,
            trust: shapes.trust.clone(),
            indirect: Arc::default(),
            direct: shapes.direct.clone(),
            after: Ok(Surface { shape: after, mesh: meshes.after.clone() }),
            before: Some(Surface { shape: before, mesh: meshes.before.clone() }),
            report: MethodReport::None,
            stages: Vec::new(),
        })
    }
}

/// The stage after which a surface has its triangles.
pub fn last_stage_of(surface: SurfaceName) -> Step {
    match surface {
        SurfaceName::Before | SurfaceName::After => Step::Mesh,
        SurfaceName::By(method) => Step::ByMethod(method),
    }
}
