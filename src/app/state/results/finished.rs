//! The results of every stage together, for the files.

use std::sync::Arc;

use firstbounce_capture::pipeline::{Scene, Solved, Surface, SurfaceName};

use super::{Results, StageState, Step};
use crate::app::state::document::Document;

/// What can be written off the UI thread. Nothing is copied.
pub type Finished = Arc<Solved>;

impl Results {
    /// The surfaces of this document that can be written: those that a method found.
    pub fn surfaces(&self, document: &Document) -> Vec<SurfaceName> {
        let is_ready = |name: &SurfaceName| self.state(last_stage_of(*name), document) == StageState::Ready;
        let all = [SurfaceName::After].into_iter().chain(document.compared().map(SurfaceName::By));
        all.filter(is_ready).collect()
    }

    /// Everything that belongs to a surface, as the command line would write it; `None` until it is there.
    pub fn finished(&self, surface: SurfaceName, document: &Document) -> Option<Finished> {
        match surface {
            SurfaceName::Before | SurfaceName::After => self.by_method_in_force(document).map(Arc::new),
            SurfaceName::By(method) => Some(self.by_method(method)?.solved.clone()),
        }
    }

    fn by_method_in_force(&self, document: &Document) -> Option<Solved> {
        let (loaded, light, shapes, meshes) = (self.loaded()?, self.method_light()?, self.shapes()?, self.meshes()?);
        let (options, calibrated) = (document.options(light.method), self.calibration()?.calibrated.clone());
        let object = loaded.object.as_ref().ok()?;
        let (set, object, calibrated) = if light.method.needs().all_colours {
            (document.set.clone(), object.clone(), calibrated)
        } else {
            let Scene { object, calibrated, .. } =
                light.method.scene_of(Scene::of(&document.set, object, &calibrated), &options);
            let set = document.set.without_lights(&options.left_out);
            (set, Arc::new(object.into_owned()), Arc::new(calibrated.into_owned()))
        };
        let (after, before) = (shapes.after.clone(), shapes.before.clone());
        Some(Solved {
            set: Arc::new(set),
            options,
            object,
            calibrated,
            separated: light.separated.clone(),
            trust: shapes.trust.clone(),
            indirect: light.indirect.clone(),
            direct: light.direct.clone(),
            after: Ok(Surface { shape: after, mesh: meshes.after.clone() }),
            before: Some(Surface { shape: before, mesh: meshes.before.clone() }),
            report: light.report.clone(),
            captures: Arc::new(self.captures(document)),
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
