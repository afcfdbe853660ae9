//! A stage: what it was computed from, what came out, and whether that still holds.

use std::fmt;
use std::sync::Arc;

use crate::app::base::jobs::drop_aside;

/// The stages, in the order in which they run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Step {
    /// Photos to linear light.
    Load,
    /// What the balls say, whatever the file gives.
    Measure,
    /// The rig in force.
    Calibrate,
    /// Photos to bounces.
    Separate,
    /// Bounce 1, and the photos as they are, to normals and depth.
    Shape,
    /// Depth to triangles.
    Mesh,
    /// The other method, where it is asked for.
    Nayar,
}

impl Step {
    /// All stages, in order.
    pub const ALL: [Self; 7] =
        [Self::Load, Self::Measure, Self::Calibrate, Self::Separate, Self::Shape, Self::Mesh, Self::Nayar];

    /// The stage whose result this one takes.
    pub fn needs(self) -> Option<Self> {
        match self {
            Self::Load => None,
            Self::Measure | Self::Calibrate => Some(Self::Load),
            Self::Separate => Some(Self::Calibrate),
            Self::Shape => Some(Self::Separate),
            Self::Mesh | Self::Nayar => Some(Self::Shape),
        }
    }

    /// What its job is called while it runs.
    pub(super) fn job_name(self) -> &'static str {
        match self {
            Self::Load => "Read photos",
            Self::Measure => "Measure balls",
            Self::Calibrate => "Calibrate",
            Self::Separate => "Separate bounces",
            Self::Shape => "Recover shape",
            Self::Mesh => "Make mesh",
            Self::Nayar => "Solve by Nayar's method",
        }
    }
}

impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Load => "Loading",
            Self::Measure => "Measuring the balls",
            Self::Calibrate => "Calibration",
            Self::Separate => "Separation",
            Self::Shape => "Shape recovery",
            Self::Mesh => "Meshing",
            Self::Nayar => "Nayar's method",
        })
    }
}

/// How a stage stands with respect to the document.
#[derive(Clone, Debug, PartialEq)]
pub enum StageState {
    /// Something that it depends on has changed; it will be computed anew.
    Stale,
    /// It is being computed.
    Running {
        /// 0 to 1.
        fraction: f32,
    },
    /// Its result is that of the document.
    Ready,
    /// It failed.
    Failed {
        /// What to do.
        line: String,
    },
    /// It cannot be computed: something before it is missing.
    Blocked {
        /// What to do.
        line: String,
    },
}

/// The last attempt at a stage, and its last good result.
pub(super) struct Slot<K, T> {
    /// The last good result.
    pub last: Option<Arc<T>>,
    /// Counts the good results: what later stages depend on.
    pub generation: u64,
    tried: Option<K>,
    error: Option<String>,
}

impl<K, T> Default for Slot<K, T> {
    fn default() -> Self {
        Self { last: None, generation: 0, tried: None, error: None }
    }
}

impl<K: PartialEq, T: Send + Sync + 'static> Slot<K, T> {
    /// `None`: it cannot be tried.
    pub fn is_stale(&self, wanted: Option<&K>) -> bool {
        wanted.is_some() && self.tried.as_ref() != wanted
    }

    pub fn state(&self, wanted: Option<&K>) -> StageState {
        match (wanted, &self.error) {
            (None, _) => StageState::Blocked { line: String::new() },
            (Some(_), _) if self.is_stale(wanted) => StageState::Stale,
            (Some(_), Some(line)) => StageState::Failed { line: line.clone() },
            (Some(_), None) => StageState::Ready,
        }
    }

    /// Whether the last good result is that of `wanted`.
    pub fn is_ready(&self, wanted: Option<&K>) -> bool {
        self.state(wanted) == StageState::Ready
    }

    /// Forgets an attempt that failed.
    pub fn retry(&mut self) {
        if self.error.take().is_some() {
            self.tried = None;
        }
    }

    pub fn finish(&mut self, key: K, result: Result<T, String>) {
        self.tried = Some(key);
        match result {
            Ok(result) => {
                drop_aside(self.last.replace(Arc::new(result)));
                self.generation += 1;
                self.error = None;
            }
            Err(line) => self.error = Some(line),
        }
    }
}
