//! The noise gain against the albedo ratio of two colours (the paper's Figure 3), with this set's pairs on it.

use eframe::egui::{Align2, RichText, Role, Ui, Vec2b, WidgetInfo};
use egui_plot::{HLine, Line, LineStyle, Plot, PlotPoint, PlotPoints, Points, Text, VLine};
use firstbounce_core::trust::{ColourPair, TrustOptions, gain_of_ratio, pairs};

use crate::app::state::document::Document;
use crate::app::state::session::Session;
use crate::app::widgets::theme::Weight;

/// Larger gains lie beyond the plot: what counts is where the curve leaves it.
const LARGEST_GAIN: f64 = 32.0;
const HEIGHT: f32 = 190.0;
const SAMPLES: usize = 160;

pub fn ui(ui: &mut Ui, document: &Document, options: &TrustOptions, session: &Session) {
    let set = &document.set;
    let Some(beta) = session.results.rig(document).beta else { return };
    if beta.len() < 2 {
        return;
    }
    let named: Vec<_> = pairs(&beta)
        .into_iter()
        .filter_map(|pair| {
            Some((pair, format!("{} / {}", set.colours.get(pair.second)?.name, set.colours.get(pair.first)?.name)))
        })
        .collect();
    let widest = named.iter().map(|(pair, _)| pair.ratio).fold(1.6, f64::max) * 1.1;
    ui.add_space(4.0);
    ui.label(RichText::new("Gain of bounce 1 against albedo ratio").semi_bold());
    let plot = Plot::new("gain against ratio")
        .height(HEIGHT)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .default_x_bounds(0.0, widest)
        .default_y_bounds(0.0, LARGEST_GAIN)
        .auto_bounds(Vec2b::FALSE)
        .show(ui, |plot| {
            let ink = plot.ctx().global_style().visuals.text_color();
            for (name, limit) in
                [("take care", options.limits.gain.care), ("do not trust", options.limits.gain.distrust)]
            {
                plot.hline(HLine::new(name, limit).style(LineStyle::dashed_loose()).color(ink.gamma_multiply(0.6)));
                let at = PlotPoint::new(widest * 0.99, limit);
                plot.text(Text::new(name, at, format!("above: {name}")).anchor(Align2::RIGHT_BOTTOM).color(ink));
            }
            plot.vline(VLine::new("alike", 1.0).style(LineStyle::dotted_dense()).color(ink.gamma_multiply(0.6)));
            for (from, to) in [(0.02, 0.985), (1.015, widest)] {
                let curve = Line::new("two colours, m = 2", curve(from, to)).width(2.0);
                plot.line(curve.color(plot.ctx().global_style().visuals.hyperlink_color));
            }
            for (pair, name) in &named {
                let at = [pair.ratio, pair.gain.min(LARGEST_GAIN * 0.97)];
                plot.points(Points::new(name.clone(), vec![at]).radius(5.0).color(ink));
                let text = format!(" {name}: {}", gain_words(pair));
                plot.text(
                    Text::new(name.clone(), PlotPoint::new(at[0], at[1] + 1.2), text)
                        .anchor(anchor(pair, widest))
                        .color(ink),
                );
            }
        });
    let spoken = named.iter().map(|(pair, name)| format!("{name}: ratio {:.2}, gain {}", pair.ratio, gain_words(pair)));
    let spoken = format!("Gain against albedo ratio. {}", spoken.collect::<Vec<_>>().join("; "));
    plot.response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &spoken));
}

fn curve(from: f64, to: f64) -> PlotPoints<'static> {
    let at = |i: usize| from + (to - from) * i as f64 / (SAMPLES - 1) as f64;
    (0..SAMPLES).map(|i| [at(i), gain_of_ratio(at(i))]).filter(|[_, gain]| *gain < 2.0 * LARGEST_GAIN).collect()
}

fn gain_words(pair: &ColourPair) -> String {
    match pair.gain {
        gain if gain.is_finite() && gain < 1000.0 => format!("{gain:.1}"),
        _ => "without bound".into(),
    }
}

/// Labels stay inside the plot.
fn anchor(pair: &ColourPair, widest: f64) -> Align2 {
    match (pair.ratio > 0.55 * widest, pair.gain > 0.8 * LARGEST_GAIN) {
        (true, true) => Align2::RIGHT_TOP,
        (true, false) => Align2::RIGHT_BOTTOM,
        (false, true) => Align2::LEFT_TOP,
        (false, false) => Align2::LEFT_BOTTOM,
    }
}
