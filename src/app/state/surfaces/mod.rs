//! The surfaces of the open set, made ready for every 3D view, and how a view shows them.

mod look;
mod prepared;

use std::collections::HashMap;
use std::sync::Arc;

use firstbounce_core::Mesh;

use crate::app::base::jobs::{JobError, Jobs};
use crate::app::base::keyed::{Keyed, Same};

pub use look::{Dragged, LayerColours, LayerLook, LayerName, Shade, SurfaceLook};
pub use prepared::{Prepared, thousands};

/// The surfaces of the open set.
#[derive(Default)]
pub struct Surfaces {
    layers: HashMap<LayerName, Keyed<Same<Mesh>, Prepared>>,
}

impl Surfaces {
    /// Makes ready what has changed. Once a frame for as long as a 3D view is on the screen; the last surfaces stay until the
    /// new ones are there.
    pub fn update(&mut self, mesh: impl Fn(LayerName) -> Option<Arc<Mesh>>, jobs: &mut Jobs) {
        for name in LayerName::all() {
            let Some(mesh) = mesh(name) else {
                self.layers.remove(&name);
                continue;
            };
            let layer = self.layers.entry(name).or_default();
            layer.poll();
            let key = Same(mesh.clone());
            if layer.wants(&key) {
                let job = format!("Prepare {}", name.in_sentence());
                layer.start(key, jobs.start(job, move |_| Prepared::new(mesh)));
            }
        }
    }

    /// A surface that is ready.
    pub fn layer(&self, name: LayerName) -> Option<&Arc<Prepared>> {
        self.layers.get(&name)?.ready()
    }

    /// Why a surface is not there; `None` while it is on its way.
    pub fn failed(&self, name: LayerName) -> Option<&JobError> {
        self.layers.get(&name)?.error()
    }

    /// Whether what is shown is what there is.
    pub fn is_at_rest(&self) -> bool {
        self.layers.values().all(|layer| layer.running().is_none())
    }
}
