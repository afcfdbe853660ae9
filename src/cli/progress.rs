//! Progress bars on a terminal, and ctrl-c.

use std::collections::HashMap;
use std::io::IsTerminal;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

use firstbounce_capture::pipeline::{PipelineWatch, Stage};
use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

/// Set by ctrl-c; a run sees it at its next step and leaves no half-written output.
static CANCELLED: AtomicBool = AtomicBool::new(false);

/// Steps of a bar.
const STEPS: u64 = 1000;

/// Shows each stage as a bar where standard error is a terminal.
pub struct Terminal {
    bars: Option<(MultiProgress, Mutex<HashMap<Stage, ProgressBar>>)>,
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
}

impl PipelineWatch for Terminal {
    fn progress(&self, stage: Stage, fraction: f32) {
        let Some((all, bars)) = &self.bars else { return };
        let Ok(mut bars) = bars.lock() else { return };
        let bar = bars.entry(stage).or_insert_with(|| {
            let style = ProgressStyle::with_template("{prefix:>10} {bar:40} {percent:>3} %");
            let bar = all.add(ProgressBar::new(STEPS)).with_prefix(stage.name());
            if let Ok(style) = style { bar.with_style(style) } else { bar }
        });
        bar.set_position((fraction.clamp(0.0, 1.0) * STEPS as f32) as u64);
    }

    fn cancelled(&self) -> bool {
        CANCELLED.load(Ordering::Relaxed)
    }
}
