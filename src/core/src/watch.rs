//! How a long job tells how far it is, and learns that nobody wants it any more.

/// Watches a long job. Stages call it from any thread, a few hundred times a run at most.
pub trait Watch: Sync {
    /// The job is this far, 0 to 1.
    fn progress(&self, fraction: f32);
    /// Whether the job should stop; it then returns its `Cancelled` error.
    fn cancelled(&self) -> bool;
}

/// Watches nothing and never cancels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unwatched;

impl Watch for Unwatched {
    fn progress(&self, _fraction: f32) {}
    fn cancelled(&self) -> bool {
        false
    }
}
