//! The strip below: jobs with progress and cancel, the last line of the log, and the log itself.

use eframe::egui::{Label, Panel, ProgressBar, Role, ScrollArea, TextWrapMode, Ui, WidgetInfo};

use super::toasts::coloured;
use crate::app::state::session::Session;

const LOG_HEIGHT: f32 = 140.0;

/// Shows the strip, and the log above it while it is open.
pub fn ui(ui: &mut Ui, session: &mut Session, log_is_open: &mut bool) {
    Panel::bottom("strip").show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.toggle_value(log_is_open, "Log");
            for job in session.jobs.running() {
                ui.add(ProgressBar::new(job.fraction()).desired_width(240.0).text(job.name()));
                let cancel = ui.small_button("Cancel");
                let what = format!("Cancel: {}", job.name());
                cancel.widget_info(|| WidgetInfo::labeled(Role::Button, true, &what));
                if cancel.on_hover_text(&what).clicked() {
                    job.cancel();
                }
            }
            if let Some(last) = session.log.lines().next_back() {
                ui.add(Label::new(coloured(ui.visuals(), last.level, &last.text)).wrap_mode(TextWrapMode::Truncate));
            }
        });
    });
    if *log_is_open {
        Panel::bottom("log").default_size(LOG_HEIGHT).resizable(true).show(ui, |ui| {
            ScrollArea::vertical().auto_shrink(false).stick_to_bottom(true).show(ui, |ui| {
                for line in session.log.lines() {
                    ui.label(coloured(ui.visuals(), line.level, &line.text));
                }
            });
        });
    }
}
