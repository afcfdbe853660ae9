//! The surfaces of the open set, made ready for every 3D view, and how a view shows them.

mod look;
mod prepared;

use std::sync::Arc;

use firstbounce_core::Mesh;

use crate::app::base::jobs::{Jobs, Task};
use crate::app::state::results::{ByNayar, Meshes};

pub use look::{LayerColours, LayerLook, LayerName, Shade, SurfaceLook};
pub use prepared::{Prepared, Source, thousands};

/// A surface, and the one that is being made ready in its place.
#[derive(Default)]
struct Slot {
    /// What was asked for last.
    wanted: Option<Source>,
    task: Option<Task<Prepared>>,
    ready: Option<Arc<Prepared>>,
    failed: Option<String>,
}

/// The surfaces of the open set.
#[derive(Default)]
pub struct Surfaces {
    after: Slot,
    before: Slot,
    nayar: Slot,
    reference: Slot,
}

impl Surfaces {
    /// Makes ready what has changed. Once a frame for as long as a 3D view is on the screen; the last surfaces stay until the
    /// new ones are there.
    pub fn update(
        &mut self,
        meshes: Option<Arc<Meshes>>,
        by_nayar: Option<Arc<ByNayar>>,
        reference: Option<Arc<Mesh>>,
        jobs: &mut Jobs,
    ) {
        self.after.update(meshes.clone().map(Source::After), LayerName::After, jobs);
        self.before.update(meshes.map(Source::Before), LayerName::Before, jobs);
        self.nayar.update(by_nayar.map(Source::Nayar), LayerName::Nayar, jobs);
        self.reference.update(reference.map(Source::Scan), LayerName::Reference, jobs);
    }

    /// A surface that is ready.
    pub fn layer(&self, name: LayerName) -> Option<&Arc<Prepared>> {
        self.slot(name).ready.as_ref()
    }

    /// Why a surface is not there; `None` while it is on its way.
    pub fn failed(&self, name: LayerName) -> Option<&str> {
        self.slot(name).failed.as_deref()
    }

    /// Whether what is shown is what there is.
    pub fn is_at_rest(&self) -> bool {
        LayerName::ALL.iter().map(|name| self.slot(*name)).all(|slot| slot.task.is_none())
    }

    fn slot(&self, name: LayerName) -> &Slot {
        match name {
            LayerName::After => &self.after,
            LayerName::Before => &self.before,
            LayerName::Nayar => &self.nayar,
            LayerName::Reference => &self.reference,
        }
    }
}

impl Slot {
    fn update(&mut self, source: Option<Source>, name: LayerName, jobs: &mut Jobs) {
        if let Some(outcome) = self.task.as_ref().and_then(Task::poll) {
            self.task = None;
            match outcome {
                Ok(prepared) => (self.ready, self.failed) = (Some(Arc::new(prepared)), None),
                Err(line) => (self.ready, self.failed) = (None, Some(line)),
            }
        }
        let Some(source) = source else {
            *self = Self::default();
            return;
        };
        let is_wanted = self.wanted.as_ref().is_some_and(|wanted| wanted.is(&source));
        if self.task.is_none() && !is_wanted {
            self.wanted = Some(source.clone());
            let job = format!("Prepare the surface: {}", name.in_sentence());
            self.task = Some(jobs.start(job, move |_| Prepared::new(source)));
        }
    }
}
