//! The panels beside the views: that of the open step at the left, the inspector at the right; and tiles that show no picture.

mod calibrate;
mod captures;
mod export;
mod inspector;
mod method_options;
mod reference;
mod separate;
mod shape;

use std::path::PathBuf;

use eframe::egui::{Frame, ScrollArea, Ui};

use crate::app::state::layout::{Pane, Shown};
use crate::app::state::panel::PanelName;
use crate::app::state::session::Session;
use crate::app::views::{Over, Overlay};

/// A panel.
pub trait Panel {
    /// Its content, inside a vertical scroll area.
    fn ui(&mut self, ui: &mut Ui, session: &mut Session);

    /// The button of what the step is for, pinned below its content; whether it has one now. Without one it is that to the next
    /// step.
    fn primary_action(&mut self, ui: &mut Ui, session: &mut Session) -> bool {
        let _ = (ui, session);
        false
    }

    /// Draws over a view while the panel is open, and takes its clicks and drags. Called once for every view, after its
    /// canvas; what is registered with `ui.interact` lies above the canvas.
    fn overlay(&mut self, ui: &mut Ui, over: &Over<'_>, session: &mut Session) {
        let _ = (ui, over, session);
    }

    /// Whether dragging with the primary button over this picture is the panel's, and not a pan.
    fn wants_drag(&self, shown: &Shown, session: &Session) -> bool {
        let _ = (shown, session);
        false
    }
}

/// Every panel with what it keeps from frame to frame.
#[derive(Default)]
pub struct Panels {
    /// Which photo is which.
    pub captures: captures::Captures,
    /// Lamps and paint.
    pub calibrate: calibrate::Calibrate,
    /// How direct light is told from indirect light, and what it costs.
    pub separate: separate::Separate,
    /// Normals and depth.
    pub shape: shape::ShapePanel,
    /// Files.
    pub export: export::Export,
    /// Values under the cursor, histogram, profile.
    pub inspector: inspector::Inspector,
}

impl Panels {
    /// The panel of a step.
    pub fn of(&mut self, name: PanelName) -> &mut dyn Panel {
        match name {
            PanelName::Captures => &mut self.captures,
            PanelName::Calibrate => &mut self.calibrate,
            PanelName::Separate => &mut self.separate,
            PanelName::Shape => &mut self.shape,
            PanelName::Export => &mut self.export,
        }
    }

    /// Files and folders that were dropped on the window while a set is open.
    pub fn dropped(&mut self, paths: Vec<PathBuf>, session: &mut Session) {
        session.panel = PanelName::Captures;
        self.captures.dropped(paths, session);
    }
}

impl Overlay for Panels {
    /// The open step and the inspector draw over a view.
    fn overlay(&mut self, ui: &mut Ui, over: &Over<'_>, session: &mut Session) {
        self.of(session.panel).overlay(ui, over, session);
        self.inspector.overlay(ui, over, session);
    }

    fn pane(&mut self, ui: &mut Ui, pane: Pane, session: &mut Session) {
        let shown = |ui: &mut Ui| match pane {
            Pane::Photos => self.captures.photos(ui, session),
            Pane::Dome => self.calibrate.dome(ui, session),
            Pane::Rig => self.calibrate.values(ui, session),
        };
        Frame::new().inner_margin(8.0).show(ui, |ui| ScrollArea::both().auto_shrink(false).show(ui, shown));
    }

    fn wants_drag(&mut self, shown: &Shown, session: &Session) -> bool {
        self.of(session.panel).wants_drag(shown, session) || self.inspector.wants_drag(shown, session)
    }
}
