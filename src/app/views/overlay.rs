//! Overlays: drawn over a view by panels, which take its clicks and drags.

use eframe::egui::Ui;

use super::Picture;
use super::canvas::CanvasResponse;
use crate::app::state::layout::{Pane, Shown};
use crate::app::state::session::Session;

/// A view while something is drawn over it.
pub struct Over<'a> {
    /// What the view shows.
    pub shown: &'a Shown,
    /// Its numbers.
    pub picture: &'a Picture,
    /// The canvas of this frame: its transform, clicks, and drags if they were asked for.
    pub canvas: &'a CanvasResponse,
}

/// Draws over views, and takes their clicks and drags.
pub trait Overlay {
    /// Draws over a view. Called once for every view, after its canvas; what is registered with `ui.interact` lies above the
    /// canvas.
    fn overlay(&mut self, ui: &mut Ui, over: &Over<'_>, session: &mut Session);

    /// Fills a tile that shows no picture.
    fn pane(&mut self, ui: &mut Ui, pane: Pane, session: &mut Session);

    /// Whether dragging with the primary button over this picture belongs to the overlay, and is not a pan.
    fn wants_drag(&mut self, shown: &Shown, session: &Session) -> bool;
}
