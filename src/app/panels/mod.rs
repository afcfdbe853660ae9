//! The panels beside the views: the five steps at the left, the inspector at the right.

mod calibrate;
mod captures;
mod export;
mod inspector;
mod reference;
mod separate;
mod shape;

use std::path::PathBuf;

use eframe::egui::Ui;

use crate::app::state::results::{NO_PHOTOS, StageState, Step};
use crate::app::state::session::Session;
use crate::app::views::canvas::CanvasResponse;
use crate::app::views::{Picture, Shown};

/// The five steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PanelName {
    /// Which photo is which.
    Captures,
    /// Lamps and paint.
    Calibrate,
    /// The order m, and what it costs.
    Separate,
    /// Normals and depth.
    Shape,
    /// Files.
    Export,
}

impl PanelName {
    /// All steps, in order.
    pub const ALL: [Self; 5] = [Self::Captures, Self::Calibrate, Self::Separate, Self::Shape, Self::Export];

    /// What the step is called.
    pub fn title(self) -> &'static str {
        match self {
            Self::Captures => "Captures",
            Self::Calibrate => "Calibrate",
            Self::Separate => "Separate",
            Self::Shape => "Shape",
            Self::Export => "Export",
        }
    }

    /// The stage that this step waits for.
    fn stage(self) -> Step {
        match self {
            Self::Captures => Step::Load,
            Self::Calibrate => Step::Calibrate,
            Self::Separate => Step::Separate,
            Self::Shape => Step::Shape,
            Self::Export => Step::Mesh,
        }
    }

    /// How the step stands.
    pub fn state(self, session: &Session) -> StageState {
        let state = session.results.state(self.stage(), &session.document());
        match (self, &state) {
            (Self::Captures, StageState::Ready) => captures_state(session),
            _ => state,
        }
    }
}

/// Photos are read one by one: that some are there does not mean that all are.
fn captures_state(session: &Session) -> StageState {
    if session.document().set.shots.is_empty() {
        return StageState::Blocked { line: NO_PHOTOS.into() };
    }
    let loaded = session.results.loaded();
    let mut bad = loaded.iter().flat_map(|loaded| &loaded.shots).filter_map(|shot| shot.photo.as_ref().err());
    match (bad.next(), bad.count()) {
        (Some(line), 0) => StageState::Failed { line: line.clone() },
        (Some(line), more) => StageState::Failed { line: format!("{line} (and {more} more)") },
        (None, _) => session
            .problems()
            .first()
            .map_or(StageState::Ready, |problem| StageState::Blocked { line: problem.to_string() }),
    }
}

/// A view while something is drawn over it.
pub struct Over<'a> {
    /// What the view shows.
    pub shown: &'a Shown,
    /// Its numbers.
    pub picture: &'a Picture,
    /// The canvas of this frame: its transform, clicks, and drags if they were asked for.
    pub canvas: &'a CanvasResponse,
}

/// A panel.
pub trait Panel {
    /// Its content, inside a vertical scroll area.
    fn ui(&mut self, ui: &mut Ui, session: &mut Session);

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
    /// The order m, and what it costs.
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

    /// The open step and the inspector draw over a view.
    pub fn overlay(&mut self, ui: &mut Ui, over: &Over<'_>, session: &mut Session) {
        self.of(session.panel).overlay(ui, over, session);
        self.inspector.overlay(ui, over, session);
    }

    /// Whether one of them wants the drags over this picture.
    pub fn wants_drag(&mut self, shown: &Shown, session: &Session) -> bool {
        self.of(session.panel).wants_drag(shown, session) || self.inspector.wants_drag(shown, session)
    }

    /// Files and folders that were dropped on the window while a set is open.
    pub fn dropped(&mut self, paths: Vec<PathBuf>, session: &mut Session) {
        session.panel = PanelName::Captures;
        self.captures.dropped(paths, session);
    }
}
