//! How the pipeline tells which stage it is in and how far, and learns that it is no longer wanted.

use std::fmt;

use firstbounce_core::Watch;

/// A stage of the pipeline, in the order in which they run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stage {
    /// Photos to linear light.
    Load,
    /// Balls to alpha, beta, intensity and direction.
    Calibrate,
    /// Whether photos and rig are as a capture should be.
    Check,
    /// Photos to bounces.
    Separate,
    /// Bounce 1 to normals and, with near lamps, back again.
    Shape,
    /// Bounces simulated on the shape and taken away (Nayar's method).
    Nayar,
    /// Depth to triangles.
    Mesh,
    /// Results to files.
    Write,
}

impl Stage {
    /// All stages, in order.
    pub const ALL: [Self; 8] =
        [Self::Load, Self::Calibrate, Self::Check, Self::Separate, Self::Shape, Self::Nayar, Self::Mesh, Self::Write];

    /// The stage's name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Load => "load",
            Self::Calibrate => "calibrate",
            Self::Check => "check",
            Self::Separate => "separate",
            Self::Shape => "shape",
            Self::Nayar => "nayar",
            Self::Mesh => "mesh",
            Self::Write => "write",
        }
    }
}

impl fmt::Display for Stage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Watches a run of the pipeline. Called from any thread.
pub trait PipelineWatch: Sync {
    /// The stage is this far, 0 to 1.
    fn progress(&self, stage: Stage, fraction: f32);
    /// Whether the run should stop; it then returns [`super::PipelineError::Cancelled`].
    fn cancelled(&self) -> bool;
}

/// Watches nothing and never cancels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unattended;

impl PipelineWatch for Unattended {
    fn progress(&self, _stage: Stage, _fraction: f32) {}
    fn cancelled(&self) -> bool {
        false
    }
}

/// One part of a stage, as the core sees its watcher: its own 0 to 1 is `from` to `to` of the stage.
pub(crate) struct Part<'a> {
    pub watch: &'a dyn PipelineWatch,
    pub stage: Stage,
    pub from: f32,
    pub to: f32,
}

impl<'a> Part<'a> {
    /// Part `index` of `count` equal ones.
    pub fn of(watch: &'a dyn PipelineWatch, stage: Stage, index: usize, count: usize) -> Self {
        let count = count.max(1) as f32;
        Self { watch, stage, from: index as f32 / count, to: (index + 1) as f32 / count }
    }
}

impl Watch for Part<'_> {
    fn progress(&self, fraction: f32) {
        self.watch.progress(self.stage, self.from + fraction * (self.to - self.from));
    }

    fn cancelled(&self) -> bool {
        self.watch.cancelled()
    }
}
