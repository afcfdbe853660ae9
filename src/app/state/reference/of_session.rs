//! The reference and the open set.

use firstbounce_capture::mesh_file::read::LengthScale;
use firstbounce_core::mesh::compare::Start;
use nalgebra::{Isometry3, Point3};

use super::{How, News, Pairs};
use crate::app::state::document::{ReferenceSettings, ReferenceSource};
use crate::app::state::layout::Shown;
use crate::app::state::session::Session;
use crate::app::state::surfaces::{LayerName, Shade};

impl Session {
    /// Takes what the reference's work has found. Once a frame.
    pub(in crate::app) fn update_reference(&mut self) {
        let document = self.document();
        for news in self.reference.update(&document, &mut self.jobs) {
            match news {
                News::Failed(error) => self.error(error.to_string()),
                News::Aligned(poses) => {
                    self.edit("Align with the reference", |document| {
                        if let Some(reference) = &mut document.settings.reference {
                            reference.poses = Some(poses);
                        }
                    });
                    self.done("Aligned with the reference");
                }
            }
        }
    }

    /// Chooses the reference.
    pub fn load_reference(&mut self, source: ReferenceSource, unit: LengthScale) {
        self.edit("Load a reference", |document| {
            document.settings.reference = Some(Box::new(ReferenceSettings { source, unit, poses: None }));
        });
    }

    /// Compares before and after with the reference.
    pub fn compare_with_reference(&mut self, how: How) {
        let poses = self.document().settings.reference.as_ref().and_then(|reference| reference.poses);
        // The last good surface may be of another beta.
        let meshes = self.results.current_meshes(&self.document());
        if let Err(error) = self.reference.compare(how, poses, meshes, &mut self.jobs) {
            self.error(error.to_string());
        }
    }

    /// Aligns from the pairs that were picked.
    pub fn align_from_pairs(&mut self) {
        if let Some(pairs) = self.reference.pairs.take() {
            self.compare_with_reference(How::Align(Start::Pairs(pairs.pairs())));
        }
    }

    /// Begins to pick pairs in a 3D view.
    pub fn pick_pairs(&mut self) {
        self.reference.pairs = Some(Pairs::default());
        self.views.open(Shown::Surface);
    }

    /// A point that was clicked on while pairs are being picked, in the frame of its own mesh.
    pub(in crate::app) fn pick_for_pair(&mut self, point: Point3<f64>) {
        if let Some(pairs) = &mut self.reference.pairs {
            pairs.add(point);
        }
    }

    /// Shows the surface coloured by its distance.
    pub fn show_heat_map(&mut self) {
        self.views.open(Shown::Surface);
        if let Some(view) = self.views.active_mut() {
            view.surface.shade = Shade::Distance;
            view.surface.layer_mut(LayerName::Reference).visible = false;
        }
    }

    /// Where the reference lies in the object frame: the surface after stays where it is. Its own frame while pairs are picked.
    pub(in crate::app) fn reference_pose(&self) -> Isometry3<f64> {
        let document = self.document();
        let poses = document.settings.reference.as_ref().and_then(|reference| reference.poses);
        match poses {
            Some(poses) if self.reference.pairs.is_none() => Isometry3::from(poses.after).inverse(),
            _ => Isometry3::identity(),
        }
    }
}
