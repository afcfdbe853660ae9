//! The state of the canvases: zoom and pan, tools of the 3D views, statistics. It belongs to one open set.

use std::collections::HashMap;
use std::sync::Arc;

use super::canvas::{self, CanvasState};
use super::saving::Saving;
use super::statistics::Statistics;
use super::surface::ViewState;
use crate::app::state::layout::View;
use crate::gpu::mesh::Camera;

/// What each view keeps from frame to frame, by its id.
#[derive(Default)]
pub struct Canvases {
    pub(super) pictures: HashMap<u64, CanvasState>,
    surfaces: HashMap<u64, ViewState>,
    pub(super) statistics: Statistics,
    pub(super) saving: Saving,
    /// The zoom and pan that linked views share.
    pub(super) shared: canvas::View,
    /// The eye that linked 3D views share, once one has been drawn.
    eye: Option<Option<Camera>>,
    /// The eye that each of them was drawn with last.
    eyes: HashMap<u64, Option<Camera>>,
}

impl Canvases {
    /// The whole picture in every view.
    pub fn fit(&mut self) {
        self.shared = canvas::View::Fit;
        self.pictures.values_mut().for_each(|canvas| canvas.view = canvas::View::Fit);
    }

    /// A pixel of the screen for every pixel of the picture, in every view.
    pub fn one_to_one(&mut self) {
        self.shared = self.shared.one_to_one();
        self.pictures.values_mut().for_each(|canvas| canvas.view = canvas.view.one_to_one());
    }

    /// The same for one view, and for those that are linked with it.
    pub(super) fn zoom(&mut self, view: &View, one_to_one: bool) {
        let zoomed = |of: canvas::View| if one_to_one { of.one_to_one() } else { canvas::View::Fit };
        if view.linked {
            self.shared = zoomed(self.shared);
        }
        let canvas = self.pictures.entry(view.id).or_default();
        canvas.view = zoomed(canvas.view);
    }

    /// Gives a linked 3D view the eye of the others, unless its own was moved since it was drawn, as by a command.
    pub(super) fn take_eye(&mut self, view: &mut View) {
        let is_moved = self.eyes.get(&view.id).is_some_and(|last| *last != view.surface.camera);
        if let (true, false, Some(eye)) = (view.linked, is_moved, self.eye) {
            view.surface.camera = eye;
        }
    }

    /// Takes the eye of a linked 3D view for the others.
    pub(super) fn give_eye(&mut self, view: &View) {
        self.eyes.insert(view.id, view.surface.camera);
        if view.linked {
            self.eye = Some(view.surface.camera);
        }
    }

    /// What a 3D view keeps.
    pub fn surface(&mut self, id: u64) -> &mut ViewState {
        self.surfaces.entry(id).or_default()
    }

    /// Lets go of what was drawn by a card that is gone.
    pub fn forget_card(&mut self) {
        self.surfaces.values_mut().for_each(|view| view.kept = Arc::default());
    }
}
