//! The ratio in every pixel of a ball: one narrow hill if paint, lamp and circle are as they should be.

use eframe::egui::{ComboBox, Role, Ui, WidgetInfo};
use egui_plot::{Plot, VLine};
use firstbounce_capture::pipeline::{Calibrated, RatioEvidence};
use firstbounce_capture::set::CaptureSet;

use crate::app::base::bars::Bars;
use crate::app::widgets::advice::advice;
use crate::app::widgets::bars::chart;

/// Which ratio is shown.
#[derive(Default)]
pub struct Histogram {
    chosen: usize,
    /// The bars of the ratio that was shown last: which, of how many pixels, its value.
    bars: Option<((usize, usize, f64), Bars)>,
}

impl Histogram {
    pub fn ui(&mut self, ui: &mut Ui, set: &CaptureSet, measured: &Calibrated) {
        self.chosen = self.chosen.min(measured.ratios.len().saturating_sub(1));
        let Some(shown) = measured.ratios.get(self.chosen) else {
            advice(ui, "No ratio was measured: add photos of a grey ball and of a ball of the paint in every colour.");
            return;
        };
        let title = title(set, shown);
        ComboBox::from_label("Ratio").selected_text(&title).width(240.0).show_ui(ui, |ui| {
            for (index, evidence) in measured.ratios.iter().enumerate() {
                ui.selectable_value(&mut self.chosen, index, self::title(set, evidence));
            }
        });
        let ratio = shown.report.ratio;
        let pixels = shown.report.pixel_ratios.len();
        let key = (self.chosen, pixels, ratio.value);
        if self.bars.as_ref().is_none_or(|(of, _)| *of != key) {
            self.bars = Some((key, Bars::of(shown.report.pixel_ratios.iter().map(|ratio| f64::from(*ratio)))));
        }
        let Some((_, bars)) = &self.bars else { return };
        let plot = Plot::new("ratios").height(150.0).allow_drag(false).allow_zoom(false).allow_scroll(false);
        ui.label("Pixels by their ratio to the reference colour");
        let response = plot.show(ui, |plot| {
            plot.bar_chart(chart(bars, "pixels"));
            plot.vline(VLine::new("value", ratio.value));
        });
        let words = format!(
            "{title}: {:.4}, {pixels} pixels, one pixel scatters by {:.1} %",
            ratio.value,
            100.0 * shown.report.scatter
        );
        response.response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &words));
        ui.label(words);
    }
}

fn title(set: &CaptureSet, evidence: &RatioEvidence) -> String {
    let light = set.lights.get(evidence.light).map_or("", |light| &light.name);
    let colour = set.colours.get(evidence.colour).map_or("", |colour| &colour.name);
    format!("{}, {light}, {colour}", evidence.ball.title())
}
