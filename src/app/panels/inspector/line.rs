//! Values of pictures along the line that was drawn.

use eframe::egui::{RichText, Role, Ui, WidgetInfo};
use egui_plot::{Legend, Line, Plot};

use super::number;
use crate::app::state::document::Document;
use crate::app::state::layout::Shown;
use crate::app::state::session::Session;
use crate::app::views::{picker, picture};
use crate::app::widgets::advice::advice;

const HEIGHT: f32 = 180.0;

/// The pictures whose profile is shown beside the active one.
#[derive(Default)]
pub struct LineSection {
    others: Vec<Shown>,
}

impl LineSection {
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        active: &Shown,
        line: Option<[[f64; 2]; 2]>,
        document: &Document,
        session: &Session,
    ) {
        let Some([from_px, to_px]) = line else {
            advice(ui, "Choose Line above and drag across a picture, or type its ends.");
            return;
        };
        self.choose(ui, active, document);
        let profiled = std::iter::once(active).chain(self.others.iter().filter(|other| *other != active));
        let mut curves = Vec::new();
        let mut quantity = None;
        for shown in profiled.filter(|shown| shown.subject() == active.subject()) {
            let Ok(picture) = picture(shown, document, &session.results) else { continue };
            // Pictures of several quantities share one axis, which then has no name.
            quantity = Some(if quantity.is_none_or(|known| known == picture.quantity) { picture.quantity } else { "" });
            let (distance_px, channels) = picture.source.along(from_px, to_px);
            for (values, channel) in channels.iter().zip(picture.source.channels()) {
                let points: Vec<_> =
                    distance_px.iter().zip(values).filter(|(_, v)| v.is_finite()).map(|(d, v)| [*d, *v]).collect();
                curves.push((format!("{} {channel}", shown.title()).trim().to_owned(), points));
            }
        }
        let quantity = quantity.unwrap_or_default();
        let length = (to_px[0] - from_px[0]).hypot(to_px[1] - from_px[1]);
        let spoken = format!("Profile of {} pictures over {} pixels", 1 + self.others.len(), number(length));
        let plot = Plot::new("profile")
            .height(HEIGHT)
            .allow_drag(false)
            .allow_zoom(false)
            .allow_scroll(false)
            .allow_boxed_zoom(false)
            .x_axis_label("distance, px")
            .y_axis_label(quantity)
            .legend(Legend::default())
            .show(ui, |plot| {
                curves.into_iter().for_each(|(name, points)| plot.line(Line::new(name, points).width(1.5)));
            });
        plot.response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &spoken));
    }

    fn choose(&mut self, ui: &mut Ui, active: &Shown, document: &Document) {
        ui.menu_button("Add a picture to the profile", |ui| {
            if let Some(chosen) = picker(ui, document, None) {
                let known = chosen == *active || self.others.contains(&chosen);
                if !known && chosen.subject() == active.subject() {
                    self.others.push(chosen);
                }
            }
        });
        self.others.retain(|other| {
            ui.horizontal_wrapped(|ui| {
                ui.label(RichText::new(other.title()).weak());
                !ui.button(format!("Remove {}", other.title())).clicked()
            })
            .inner
        });
    }
}
