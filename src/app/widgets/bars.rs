//! The bars of a histogram, to be plotted.

use egui_plot::{Bar, BarChart};

use crate::app::base::bars::Bars;

/// The bars as a chart of this name.
pub fn chart(bars: &Bars, name: &str) -> BarChart {
    let (width, bars) = bars.bars();
    BarChart::new(name, bars.map(|(middle, count)| Bar::new(middle, count as f64).width(width)).collect())
}
