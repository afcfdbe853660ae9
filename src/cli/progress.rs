//! Progress bars on a terminal, and ctrl-c.

use std::collections::HashMap;
use std::io::IsTerminal;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use firstbounce_capture::pipeline::{PipelineWatch, Stage};
use firstbounce_core::Watch;
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

/// Set by ctrl-c; a run sees it at its next step and leaves no half-written output.
static CANCELLED: AtomicBool = AtomicBool::new(false);

/// Steps of a bar.
const STEPS: u64 = 1000;

/// Shows each stage or job as a bar where standard error is a terminal.
pub struct Terminal {
    bars: Option<(MultiProgress, Mutex<HashMap<&'static str, ProgressBar>>)>,
}

impl Terminal {
    /// Takes ctrl-c as the wish to cancel.
    pub fn attend() -> Self {
        // Without a handler ctrl-c ends the process at once, which leaves the staging folder behind: bearable.
        let _ = ctrlc::set_handler(|| CANCELLED.store(true, Ordering::Relaxed));
        let bars = std::io::stderr().is_terminal().then(|| (MultiProgress::new(), Mutex::new(HashMap::new())));
        Self { bars }
    }

    /// Takes the bars away.
    pub fn finish(&self) {
        if let Some((all, _)) = &self.bars {
            let _ = all.clear();
        }
    }

    /// Watches a job that is no stage of the pipeline.
    pub fn job(&self, name: &'static str) -> Job<'_> {
        Job { terminal: self, name }
    }

    fn show(&self, name: &'static str, fraction: f32) {
        let Some((all, bars)) = &self.bars else { return };
        let Ok(mut bars) = bars.lock() else { return };
        let bar = bars.entry(name).or_insert_with(|| {
            let style = ProgressStyle::with_template("{prefix:>10} {bar:40} {percent:>3} %");
            let bar = all.add(ProgressBar::new(STEPS)).with_prefix(name);
            if let Ok(style) = style { bar.with_style(style) } else { bar }
        });
        bar.set_position((fraction.clamp(0.0, 1.0) * STEPS as f32) as u64);
    }
}

impl PipelineWatch for Terminal {
    fn progress(&self, stage: Stage, fraction: f32) {
        self.show(stage.name(), fraction);
    }

    fn cancelled(&self) -> bool {
        CANCELLED.load(Ordering::Relaxed)
    }
}

/// A bar of its own.
pub struct Job<'a> {
    terminal: &'a Terminal,
    name: &'static str,
}

impl Watch for Job<'_> {
    fn progress(&self, fraction: f32) {
        self.terminal.show(self.name, fraction);
    }

    fn cancelled(&self) -> bool {
        self.terminal.cancelled()
    }
}
