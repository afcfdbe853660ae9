//! Frame times: how long frames kept the UI thread: nothing may block it.

use std::collections::VecDeque;
use std::fmt::Write;
use std::time::Instant;

use eframe::egui::{Align2, Context, Window, vec2};
use firstbounce_capture::atomic::write_file;

use crate::app::state::session::Session;

/// Frames that are remembered.
const KEPT: usize = 20_000;
/// Longer frames are felt.
const LIMIT_MS: f32 = 50.0;
/// Frames whose times are shown one by one.
const SHOWN: usize = 10;

/// What goes on while a frame is made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// A set was opened and its results are not all there yet.
    Opening,
    /// All results were there at least once.
    Steady,
}

impl Phase {
    const ALL: [Self; 2] = [Self::Opening, Self::Steady];

    fn words(self) -> &'static str {
        match self {
            Self::Opening => "opening",
            Self::Steady => "steady",
        }
    }
}

/// One frame, in milliseconds.
#[derive(Clone, Copy, Debug)]
struct FrameTime {
    phase: Phase,
    /// From its begin to its end, without the wait for the screen.
    whole_ms: f32,
    /// What the UI thread itself worked since the frame before; `None` where the system does not report it.
    worked_ms: Option<f32>,
    /// The part of `whole_ms` in which results are taken and work is started.
    logic_ms: f32,
    /// The part in which widgets are laid out; the rest is drawing.
    widgets_ms: f32,
}

/// The frames of one phase.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Summary {
    count: usize,
    mean_ms: f32,
    longest_ms: f32,
    over: usize,
    longest_worked_ms: f32,
    worked_over: usize,
}

/// The last frames of this run.
#[derive(Default)]
pub struct FrameTimes {
    is_open: bool,
    frames: VecDeque<FrameTime>,
    worked_before_s: Option<f64>,
    began: Option<Instant>,
    logic_ms: f32,
    widgets_ms: f32,
}

impl FrameTimes {
    /// Opens or closes the overlay.
    pub fn toggle(&mut self) {
        self.is_open ^= true;
    }

    /// Begins a frame; the one before took `frame_s` seconds, the wait for the screen left out.
    pub fn begin_frame(&mut self, phase: Phase, frame_s: Option<f32>) {
        let worked_s = worked_s();
        let worked_ms = worked_s.zip(self.worked_before_s).map(|(now, before)| (1000.0 * (now - before)) as f32);
        self.worked_before_s = worked_s;
        if let Some(frame_s) = frame_s {
            if self.frames.len() == KEPT {
                self.frames.pop_front();
            }
            let (logic_ms, widgets_ms) = (self.logic_ms, self.widgets_ms);
            self.frames.push_back(FrameTime { phase, whole_ms: 1000.0 * frame_s, worked_ms, logic_ms, widgets_ms });
        }
        (self.logic_ms, self.widgets_ms) = (0.0, 0.0);
        self.began = Some(Instant::now());
    }

    /// Results are taken, work is started.
    pub fn end_logic(&mut self) {
        self.logic_ms = self.lap_ms();
    }

    /// Widgets are laid out from here.
    pub fn begin_widgets(&mut self) {
        self.lap_ms();
    }

    /// Widgets are laid out; what follows is drawing.
    pub fn end_widgets(&mut self) {
        self.widgets_ms = self.lap_ms();
    }

    fn lap_ms(&mut self) -> f32 {
        let now = Instant::now();
        self.began.replace(now).map_or(0.0, |began| 1000.0 * (now - began).as_secs_f32())
    }

    /// Shows the overlay while it is open.
    pub fn ui(&mut self, context: &Context) {
        let mut is_open = self.is_open;
        let mut again = false;
        let window = Window::new("Frame times").open(&mut is_open).resizable(false);
        window.anchor(Align2::RIGHT_BOTTOM, vec2(-16.0, -48.0)).show(context, |ui| {
            for phase in Phase::ALL {
                ui.label(self.summary(phase).words(phase));
            }
            let last: Vec<_> =
                self.frames.iter().rev().take(SHOWN).map(|frame| format!("{:.1}", frame.whole_ms)).collect();
            ui.label(format!("last, ms: {}", last.join(" ")));
            again = ui.button("Count again").clicked();
        });
        self.is_open = is_open;
        if again {
            self.frames.clear();
        }
    }

    /// Writes every frame that is remembered beside the preferences, and says how they were.
    pub fn write(&self, session: &mut Session) {
        let place = session.folders().preferences.join("frame-times.csv");
        match write_file(&place, self.table().as_bytes()) {
            Ok(()) => {
                Phase::ALL.iter().for_each(|phase| session.done(self.summary(*phase).words(*phase)));
                session.done(format!("Wrote {}", place.display()));
            }
            Err(error) => session.error(error.to_string()),
        }
    }

    fn table(&self) -> String {
        let mut text = "phase,whole_ms,worked_ms,logic_ms,widgets_ms\n".to_owned();
        for frame in &self.frames {
            let FrameTime { phase, whole_ms, worked_ms, logic_ms, widgets_ms } = frame;
            let worked = worked_ms.map(|ms| format!("{ms:.3}")).unwrap_or_default();
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{},{whole_ms:.3},{worked},{logic_ms:.3},{widgets_ms:.3}", phase.words());
        }
        text
    }

    fn summary(&self, phase: Phase) -> Summary {
        let mut summary = Summary::default();
        for frame in self.frames.iter().filter(|frame| frame.phase == phase) {
            let worked_ms = frame.worked_ms.unwrap_or(0.0);
            summary.count += 1;
            summary.mean_ms += frame.whole_ms;
            summary.longest_ms = summary.longest_ms.max(frame.whole_ms);
            summary.over += usize::from(frame.whole_ms > LIMIT_MS);
            summary.longest_worked_ms = summary.longest_worked_ms.max(worked_ms);
            summary.worked_over += usize::from(worked_ms > LIMIT_MS);
        }
        summary.mean_ms /= summary.count.max(1) as f32;
        summary
    }
}

impl Summary {
    fn words(&self, phase: Phase) -> String {
        let Self { count, mean_ms, longest_ms, over, longest_worked_ms, worked_over } = self;
        let phase = phase.words();
        format!(
            "{count} frames {phase}: mean {mean_ms:.1} ms, longest {longest_ms:.1} ms, {over} over {LIMIT_MS:.0} ms; \
             work of the thread alone: longest {longest_worked_ms:.1} ms, {worked_over} over {LIMIT_MS:.0} ms"
        )
    }
}

/// How long this thread has worked since it began, in seconds: other programs on a busy machine do not count.
#[cfg(unix)]
fn worked_s() -> Option<f64> {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Some(time.tv_sec as f64 + time.tv_nsec as f64 * 1e-9)
}

#[cfg(not(unix))]
fn worked_s() -> Option<f64> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_counted_by_phase_and_long_ones_told() {
        let mut times = FrameTimes::default();
        for (phase, frame_s) in [(Phase::Opening, 0.08), (Phase::Steady, 0.01), (Phase::Steady, 0.03)] {
            times.begin_frame(phase, Some(frame_s));
        }
        times.begin_frame(Phase::Steady, None);
        let (opening, steady) = (times.summary(Phase::Opening), times.summary(Phase::Steady));
        assert_eq!((opening.count, opening.over), (1, 1));
        assert_eq!((steady.count, steady.over), (2, 0));
        assert!((steady.mean_ms - 20.0).abs() < 0.01 && (steady.longest_ms - 30.0).abs() < 0.01);
        assert!(
            steady.words(Phase::Steady).starts_with("2 frames steady: mean 20.0 ms, longest 30.0 ms, 0 over 50 ms")
        );
        assert_eq!(times.table().lines().count(), 4);
    }
}
