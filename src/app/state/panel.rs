//! The five steps of the work, each with a panel of its own, and the state of each.

use firstbounce_core::trust::{Level, Names};

use super::results::{StageError, StageState, Step};
use super::session::Session;
use super::words::{names, problem_words};

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
    pub fn state(self, session: &Session) -> StepState {
        let document = session.document();
        match session.results.state(self.stage(), &document) {
            StageState::Blocked { line } | StageState::Failed { line } if document.set.shots.is_empty() => {
                StepState::Empty { line }
            }
            StageState::Blocked { line } => StepState::Incomplete { line },
            StageState::Failed { line } => StepState::Failed { line },
            StageState::Cancelled { line } => StepState::Cancelled { line },
            StageState::Stale => StepState::Running { fraction: 0.0 },
            StageState::Running { fraction } => StepState::Running { fraction },
            StageState::Ready => self.judged(session),
        }
    }

    /// What to know before trusting the results of a step, the worst first.
    pub fn cares(self, session: &Session) -> Option<String> {
        let results = &session.results;
        match self {
            Self::Captures => {
                let of_files = results.loaded().into_iter().flat_map(|loaded| loaded.warnings.clone());
                capture_warnings(session).into_iter().chain(of_files).next()
            }
            Self::Calibrate => results.calibration()?.calibrated.warnings.first().cloned(),
            Self::Separate => {
                let shapes = results.shapes()?;
                let (colours, lights) = names(&session.document().set);
                let worst = shapes.trust.reasons.iter().max_by_key(|(level, _)| *level)?;
                Some(worst.1.words(&Names { colours: &colours, lights: &lights }))
            }
            Self::Shape | Self::Export => None,
        }
    }

    /// The state of a step whose stage is ready.
    fn judged(self, session: &Session) -> StepState {
        let results = &session.results;
        let takes_care = match self {
            Self::Captures => return captures_state(session),
            Self::Calibrate => results.calibration().is_some_and(|rig| !rig.calibrated.warnings.is_empty()),
            Self::Separate => results.shapes().is_some_and(|shapes| shapes.trust.level != Level::Fine),
            Self::Shape | Self::Export => false,
        };
        if takes_care { StepState::TakeCare } else { StepState::Ready }
    }
}

/// The state of a step.
#[derive(Clone, Debug, PartialEq)]
pub enum StepState {
    /// The set has no photo yet.
    Empty {
        /// What to do.
        line: String,
    },
    /// Something before it is missing.
    Incomplete {
        /// What to do.
        line: String,
    },
    /// Its results are being computed.
    Running {
        /// 0 to 1.
        fraction: f32,
    },
    /// Its results are those of the document.
    Ready,
    /// The same, but its panel warns of them.
    TakeCare,
    /// Its results could not be computed.
    Failed {
        /// What to do.
        line: String,
    },
    /// The user stopped what computes them.
    Cancelled {
        /// What to do.
        line: String,
    },
}

impl StepState {
    /// The word for it.
    pub fn word(&self) -> String {
        match self {
            Self::Empty { .. } => "empty".into(),
            Self::Incomplete { .. } => "incomplete".into(),
            Self::Running { fraction } => format!("running, {:.0} %", 100.0 * fraction),
            Self::Ready => "ready".into(),
            Self::TakeCare => "take care".into(),
            Self::Failed { .. } => "failed".into(),
            Self::Cancelled { .. } => "cancelled".into(),
        }
    }
}

/// What the checks of the captures found, the worst first.
fn capture_warnings(session: &Session) -> Vec<String> {
    session.results.captures(&session.document()).lines()
}

/// Photos are read one by one: that some are there does not mean that all are.
fn captures_state(session: &Session) -> StepState {
    if session.document().set.shots.is_empty() {
        return StepState::Empty { line: StageError::NoPhotos.to_string() };
    }
    let loaded = session.results.loaded();
    let mut bad = loaded.iter().flat_map(|loaded| &loaded.shots).filter_map(|shot| shot.photo.as_ref().err());
    match (bad.next(), bad.count()) {
        (Some(line), 0) => StepState::Failed { line: line.to_string() },
        (Some(line), more) => StepState::Failed { line: format!("{line} (and {more} more)") },
        (None, _) => match session.problems().first() {
            Some(problem) => StepState::Incomplete { line: problem_words(problem, &session.document().set) },
            None if !capture_warnings(session).is_empty() => StepState::TakeCare,
            None => StepState::Ready,
        },
    }
}
