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

/// A part of a longer piece of work: its own 0 to 1 is `from` to `to` of the whole.
#[derive(Clone, Copy)]
pub struct Portion<'a> {
    /// Watches the whole.
    pub watch: &'a dyn Watch,
    /// Where the part begins.
    pub from: f32,
    /// Where it ends.
    pub to: f32,
}

impl Watch for Portion<'_> {
    fn progress(&self, fraction: f32) {
        self.watch.progress(self.from + fraction * (self.to - self.from));
    }

    fn cancelled(&self) -> bool {
        self.watch.cancelled()
    }
}
