//! The ratio in every pixel of a ball: one narrow hill if paint, lamp and circle are as they should be.

use eframe::egui::{ComboBox, Role, Ui, WidgetInfo};
use egui_plot::{Bar, BarChart, Plot, VLine};
use firstbounce_capture::pipeline::{Calibrated, RatioEvidence};
use firstbounce_capture::set::CaptureSet;

use super::ball_title;
use crate::app::window::advice;

const BARS: usize = 60;
/// Ratios beyond this share at either end are left out of the plot: a speck of dust would squeeze it to one bar.
const LEFT_OUT: f64 = 0.005;

/// Which ratio is shown.
#[derive(Default)]
pub struct Histogram {
    chosen: usize,
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
        let (low, width, counts) = count(&shown.report.pixel_ratios);
        let bars = counts
            .iter()
            .enumerate()
            .map(|(index, count)| Bar::new(low + (index as f64 + 0.5) * width, *count as f64).width(width));
        let chart = BarChart::new("pixels", bars.collect());
        let plot = Plot::new("ratios").height(150.0).allow_drag(false).allow_zoom(false).allow_scroll(false);
        ui.label("Pixels by their ratio to the reference colour");
        let response = plot.show(ui, |plot| {
            plot.bar_chart(chart);
            plot.vline(VLine::new("value", ratio.value));
        });
        let words = format!(
            "{title}: {:.4}, {} pixels, one pixel scatters by {:.1} %",
            ratio.value,
            shown.report.pixel_ratios.len(),
            100.0 * shown.report.scatter
        );
        response.response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &words));
        ui.label(words);
    }
}

fn title(set: &CaptureSet, evidence: &RatioEvidence) -> String {
    let light = set.lights.get(evidence.light).map_or("", |light| &light.name);
    let colour = set.colours.get(evidence.colour).map_or("", |colour| &colour.name);
    format!("{}, {light}, {colour}", ball_title(evidence.ball))
}

/// Where the first bar begins, how wide each is, and how many pixels each holds.
fn count(ratios: &[f32]) -> (f64, f64, Vec<usize>) {
    let mut sorted: Vec<f64> = ratios.iter().map(|ratio| f64::from(*ratio)).filter(|ratio| ratio.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    let at = |share: f64| sorted.get((share * sorted.len() as f64) as usize).or(sorted.last()).copied();
    let (Some(low), Some(high)) = (at(LEFT_OUT), at(1.0 - LEFT_OUT)) else { return (0.0, 1.0, Vec::new()) };
    let width = ((high - low) / BARS as f64).max(1e-9);
    let mut counts = vec![0; BARS];
    for ratio in sorted {
        if let Some(count) = counts.get_mut(((ratio - low) / width).floor() as usize).filter(|_| ratio >= low) {
            *count += 1;
        }
    }
    (low, width, counts)
}
