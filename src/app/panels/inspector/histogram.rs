//! The histogram: how often a value occurs.

use eframe::egui::{Color32, Role, Ui, WidgetInfo};
use egui_plot::{Line, Plot};
use firstbounce_core::image::statistics::{Histogram, Scale};

use super::number;

const HEIGHT: f32 = 120.0;
/// One for each channel; a picture of single values is drawn in the colour of text.
const CHANNELS: [Color32; 3] =
    [Color32::from_rgb(230, 80, 70), Color32::from_rgb(70, 170, 90), Color32::from_rgb(80, 130, 240)];

pub fn ui(ui: &mut Ui, histograms: &[Histogram], channels: &[&str], log_counts: bool) {
    let Some(first) = histograms.first() else { return };
    let logarithmic = first.scale == Scale::Logarithmic;
    let plot = Plot::new("histogram")
        .height(HEIGHT)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .show_axes([true, false])
        .include_y(0.0)
        .x_axis_formatter(move |mark, _| number(if logarithmic { 10f64.powf(mark.value) } else { mark.value }))
        .show(ui, |plot| {
            let ink = plot.ctx().global_style().visuals.text_color();
            for (histogram, (channel, colour)) in histograms.iter().zip(channels.iter().zip(CHANNELS)) {
                let colour = if channels.len() > 1 { colour } else { ink };
                plot.line(Line::new(format!("Pixels {channel}"), steps(histogram, log_counts)).color(colour).fill(0.0));
            }
        });
    let counts = if log_counts { "Histogram, logarithmic counts," } else { "Histogram" };
    let spoken = format!("{counts} from {} to {}", number(first.range[0]), number(first.range[1]));
    plot.response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &spoken));
    let below: u64 = histograms.iter().map(|histogram| histogram.below).sum();
    if logarithmic && below > 0 {
        ui.label(format!("{below} values are zero, negative or too small for this scale."));
    }
}

/// The outline of the bars.
fn steps(histogram: &Histogram, log_counts: bool) -> Vec<[f64; 2]> {
    let height = |count: u64| if log_counts { (1.0 + count as f64).log10() } else { count as f64 };
    let place = |value: f64| if histogram.scale == Scale::Logarithmic { value.log10() } else { value };
    let bar = |(bin, count): (usize, &u64)| {
        let [low, high] = histogram.bin(bin);
        [[place(low), height(*count)], [place(high), height(*count)]]
    };
    histogram.counts.iter().enumerate().flat_map(bar).collect()
}
