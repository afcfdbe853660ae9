//! How long the last frames kept the UI thread: nothing may block it.

use std::collections::VecDeque;

use eframe::egui::{Align2, Context, Window, vec2};

/// Frames that are remembered.
const KEPT: usize = 600;
/// Longer frames are felt.
const LIMIT_MS: f32 = 50.0;

/// The last frames, in milliseconds of the UI thread.
#[derive(Default)]
pub struct FrameTimes {
    is_open: bool,
    frames_ms: VecDeque<f32>,
}

impl FrameTimes {
    /// Opens or closes the overlay.
    pub fn toggle(&mut self) {
        self.is_open ^= true;
    }

    /// Notes how long the frame before took, in seconds.
    pub fn note(&mut self, frame_s: Option<f32>) {
        let Some(frame_s) = frame_s else { return };
        if self.frames_ms.len() == KEPT {
            self.frames_ms.pop_front();
        }
        self.frames_ms.push_back(1000.0 * frame_s);
    }

    /// Shows the overlay while it is open.
    pub fn ui(&mut self, context: &Context) {
        let frames = &self.frames_ms;
        let window = Window::new("Frame times").open(&mut self.is_open).resizable(false);
        window.anchor(Align2::RIGHT_BOTTOM, vec2(-16.0, -48.0)).show(context, |ui| {
            let count = frames.len();
            let longest = frames.iter().copied().fold(0.0, f32::max);
            let mean = frames.iter().sum::<f32>() / count.max(1) as f32;
            let over = frames.iter().filter(|frame| **frame > LIMIT_MS).count();
            ui.label(format!("Last {count} frames on the UI thread"));
            ui.label(format!("mean {mean:.1} ms, longest {longest:.1} ms, {over} over {LIMIT_MS:.0} ms"));
            let last: Vec<_> = frames.iter().rev().take(10).map(|frame| format!("{frame:.1}")).collect();
            ui.label(format!("last, ms: {}", last.join(" ")));
        });
    }
}
