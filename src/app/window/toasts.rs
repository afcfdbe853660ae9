//! The log on the screen: toasts over everything else, and lines in the colour of their level.

use eframe::egui::{Align2, Area, Context, Frame, Id, Label, Order, RichText, Role, Visuals, WidgetInfo, vec2};

use crate::app::state::log::{Level, Log};

/// The toasts, over everything else.
pub fn ui(context: &Context, log: &mut Log) {
    let (toasts, Some(next)) = log.toasts() else { return };
    context.request_repaint_after(next);
    let area = Area::new(Id::unique("toasts")).order(Order::Foreground).interactable(true);
    let mut dismissed = None;
    area.anchor(Align2::RIGHT_TOP, vec2(-8.0, 4.0)).show(context, |ui| {
        for (index, toast) in toasts.iter().enumerate() {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_max_width(420.0);
                ui.horizontal(|ui| {
                    let shown = ui.add(Label::new(coloured(ui.visuals(), toast.level, &toast.text)).wrap());
                    shown.widget_info(|| WidgetInfo::labeled(Role::Alert, true, &toast.text));
                    if ui.small_button("Dismiss").clicked() {
                        dismissed = Some(index);
                    }
                });
            });
        }
    });
    if let Some(index) = dismissed {
        log.dismiss_one(index);
    }
}

/// A line in the colour of its level; the words say it too.
pub fn coloured(visuals: &Visuals, level: Level, text: &str) -> RichText {
    match level {
        Level::Done => RichText::new(text),
        Level::Warning => RichText::new(format!("Warning: {text}")).color(visuals.warn_fg_color),
        Level::Error => RichText::new(format!("Error: {text}")).color(visuals.error_fg_color),
    }
}
