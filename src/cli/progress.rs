//! Progress bars on a terminal, and ctrl-c.

use std::collections::HashMap;
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, OnceLock};
use std::time::{Duration, Instant};

use firstbounce_capture::pipeline::{PipelineWatch, Stage};
use firstbounce_core::Watch;
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

/// Set by the first ctrl-c; a run sees it at its next step and leaves no half-written output.
static CANCELLED: AtomicBool = AtomicBool::new(false);

/// Whether a run looks at [`CANCELLED`] now.
static ATTENDED: AtomicBool = AtomicBool::new(false);

/// Exit code of a run that a signal ended, as shells count it.
const INTERRUPTED: i32 = 130;

/// Signals closer together are one wish: `timeout` and other wrappers send each twice.
const ONE_WISH: Duration = Duration::from_millis(50);

/// Steps of a bar.
const STEPS: u64 = 1000;

/// Shows each stage or job as a bar where standard error is a terminal, and takes ctrl-c for as long as it is kept. Every
/// command that may take long makes one before it reads a file.
pub struct Terminal {
    bars: Option<(MultiProgress, Mutex<HashMap<&'static str, ProgressBar>>)>,
}

impl Terminal {
    /// Takes the first ctrl-c, or the first wish of the system to end, as the wish to cancel; the second ends the process,
    /// whatever it does.
    pub fn attend() -> Self {
        ATTENDED.store(true, Ordering::Relaxed);
        // Without a handler the first ends the process at once, which leaves the staging folder behind: bearable.
        let _ = ctrlc::set_handler(interrupt);
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

fn interrupt() {
    static FIRST: OnceLock<Instant> = OnceLock::new();
    CANCELLED.store(true, Ordering::Relaxed);
    let is_second = FIRST.get_or_init(Instant::now).elapsed() > ONE_WISH;
    if is_second || !ATTENDED.load(Ordering::Relaxed) {
        std::process::exit(INTERRUPTED);
    }
}

impl Drop for Terminal {
    /// What comes after the run, a window for instance, does not look whether it was cancelled.
    fn drop(&mut self) {
        ATTENDED.store(false, Ordering::Relaxed);
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
