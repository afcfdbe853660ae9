//! Progress and cancelling of long work.

/// Watches long work. Stages call it from any thread, a few hundred times a run at most.
pub trait Watch: Sync {
    /// The work is this far, 0 to 1.
    fn progress(&self, fraction: f32);
    /// Whether the work should stop; it then returns its `Cancelled` error.
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

/// A part of longer work: its own 0 to 1 is `from` to `to` of the whole.
#[derive(Clone, Copy)]
pub struct Portion<'a> {
    /// Watches the whole.
    pub watch: &'a dyn Watch,
    /// Where the part begins.
    pub from: f32,
    /// Where it ends.
    pub to: f32,
}

impl<'a> Portion<'a> {
    /// Part `index` of `count` equal ones.
    pub fn of(watch: &'a dyn Watch, index: usize, count: usize) -> Self {
        let count = count.max(1) as f32;
        Self { watch, from: index as f32 / count, to: (index + 1) as f32 / count }
    }

    /// Work that can be cancelled and is too short to show: the whole stays at `fraction`.
    pub fn still(watch: &'a dyn Watch, fraction: f32) -> Self {
        Self { watch, from: fraction, to: fraction }
    }
}

impl Watch for Portion<'_> {
    fn progress(&self, fraction: f32) {
        self.watch.progress(self.from + fraction * (self.to - self.from));
    }

    fn cancelled(&self) -> bool {
        self.watch.cancelled()
    }
}
