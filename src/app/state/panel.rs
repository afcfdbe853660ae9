//! The five steps of the work, each with a panel of its own, and the state of each.

use super::results::{StageError, StageState, Step};
use super::session::Session;

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

    /// The state of the step.
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
        return StageState::Blocked { line: StageError::NoPhotos.to_string() };
    }
    let loaded = session.results.loaded();
    let mut bad = loaded.iter().flat_map(|loaded| &loaded.shots).filter_map(|shot| shot.photo.as_ref().err());
    match (bad.next(), bad.count()) {
        (Some(line), 0) => StageState::Failed { line: line.to_string() },
        (Some(line), more) => StageState::Failed { line: format!("{line} (and {more} more)") },
        (None, _) => session
            .problems()
            .first()
            .map_or(StageState::Ready, |problem| StageState::Blocked { line: problem.to_string() }),
    }
}
