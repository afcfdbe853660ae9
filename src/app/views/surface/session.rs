//! What 3D views ask of the open set.

use super::canvas::{bounds, seen};
use super::look::{LayerName, SurfaceLook};
use super::profile::Seen;
use super::scene::Heat;
use crate::app::state::session::Session;
use crate::gpu::mesh::StandardView;

/// Width over height of a view that was never drawn.
const USUAL_ASPECT: f64 = 1.5;

impl Session {
    /// Makes ready what 3D views show.
    pub fn update_surfaces(&mut self) {
        let by_nayar = self.results.by_nayar().filter(|_| self.document().settings.nayar.compute);
        let reference = self.reference.mesh();
        self.surfaces.update(self.results.meshes(), by_nayar, reference, &mut self.jobs);
    }

    /// Takes the eye of a view to a named side.
    pub fn stand(&mut self, view: u64, look: &mut SurfaceLook, from: StandardView) {
        let aspect = self.surfaces.view(view).aspect;
        if let Some(bounds) = bounds(&seen(look, self, false)) {
            look.stand(from, &bounds, if aspect > 0.0 { aspect } else { USUAL_ASPECT });
        }
    }

    /// Distances to the reference of both surfaces; the colours end where 95 % of those that are seen do. `None` without a
    /// comparison of what there is.
    pub(super) fn heat(&mut self, look: &SurfaceLook, seen: &[Seen]) -> Option<Heat> {
        let mut p95_mm = 0.0_f64;
        let mut values = Vec::new();
        for name in [LayerName::After, LayerName::Before] {
            let Some(prepared) = self.surfaces.layer(name) else { continue };
            let Some((of_layer, own_mm)) = self.reference.heat(name, prepared) else { continue };
            if seen.iter().any(|seen| seen.name == name) {
                p95_mm = p95_mm.max(own_mm);
            }
            values.push((name, of_layer));
        }
        let largest_mm = look.distance_mm.unwrap_or(p95_mm as f32).max(f32::MIN_POSITIVE);
        (!values.is_empty()).then_some(Heat { values, largest_mm })
    }
}
