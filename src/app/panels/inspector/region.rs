//! Statistics and histogram of the active picture, in a region or over the whole object.

use std::time::{Duration, Instant};

use eframe::egui::{Grid, RichText, Ui};
use firstbounce_core::Mask;
use firstbounce_core::image::statistics::{Histogram, Region, RegionStatistics, Scale, statistics};

use super::{histogram, number};
use crate::app::base::keyed::Keyed;
use crate::app::state::layout::Shown;
use crate::app::state::session::Session;
use crate::app::views::Picture;
use crate::app::widgets::theme::Weight;
use crate::gpu::Source;

const BINS: usize = 128;
/// Pictures up to this many pixels are measured whenever their numbers change.
const AT_ONCE_PIXELS: usize = 1 << 20;
/// Larger ones when their numbers have stayed for so long.
const REST: Duration = Duration::from_millis(200);

/// What was measured last, and what is being measured.
#[derive(Default)]
pub struct RegionSection {
    scale: Scale,
    /// Whether the histogram's counts are shown by their logarithm, so that rare values are seen too.
    log_counts: bool,
    measured: Keyed<Wanted, Measured>,
    /// What is to be measured once it has rested, and since when it rests.
    rests: Option<(Source, Instant)>,
}

/// Which numbers are measured, and where.
#[derive(Clone)]
struct Wanted {
    shown: Shown,
    source: Source,
    region: Option<Region>,
    scale: Scale,
}

impl PartialEq for Wanted {
    fn eq(&self, other: &Self) -> bool {
        self.scale == other.scale
            && self.region == other.region
            && self.shown == other.shown
            && self.source.same_numbers(&other.source)
    }
}

/// The numbers of a picture in a region.
struct Measured {
    statistics: Vec<Option<RegionStatistics>>,
    histograms: Vec<Histogram>,
}

impl RegionSection {
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        shown: &Shown,
        picture: &Picture,
        region: Option<&Region>,
        session: &mut Session,
    ) {
        let source = picture.source.clone();
        let wanted = Wanted { shown: shown.clone(), source, region: region.cloned(), scale: self.scale };
        self.measure(ui, wanted, session);
        let of = match region {
            Some(Region::Rectangle(a, b)) => {
                format!("{} x {} px", number((b[0] - a[0]).abs()), number((b[1] - a[1]).abs()))
            }
            Some(Region::Lasso(_)) => "inside the lasso".into(),
            None if picture.source.has_mask() => "whole object".into(),
            None => "whole picture".into(),
        };
        ui.label(format!("{}: {of}", shown.title()));
        ui.label(RichText::new(picture.quantity).weak());
        ui.horizontal_wrapped(|ui| {
            ui.label("Histogram");
            ui.radio_value(&mut self.scale, Scale::Linear, "Linear");
            ui.radio_value(&mut self.scale, Scale::Logarithmic, "Logarithmic");
            ui.checkbox(&mut self.log_counts, "Logarithmic counts")
                .on_hover_text("Shows rare values beside frequent ones");
        });
        // While a value is dragged the numbers may lag, but never are those of another picture.
        let last = self.measured.last().filter(|(of, _)| of.shown == *shown);
        let Some((of, measured)) = last.and_then(|(of, outcome)| Some((of, outcome.as_ref().ok()?))) else {
            ui.label(RichText::new("Measuring.").weak());
            return;
        };
        let channels = of.source.channels();
        table(ui, channels, measured);
        histogram::ui(ui, &measured.histograms, channels, self.log_counts);
    }

    /// Whether the numbers stay: those of a large picture are not measured in every frame of a drag, which would
    /// take the cores from the drag.
    fn has_rested(&mut self, ui: &Ui, source: &Source) -> bool {
        let (width, height) = source.size();
        if width * height <= AT_ONCE_PIXELS {
            return true;
        }
        match &self.rests {
            Some((wanted, since)) if wanted.same_numbers(source) => match REST.checked_sub(since.elapsed()) {
                Some(left) if !left.is_zero() => ui.ctx().request_repaint_after(left),
                _ => return true,
            },
            _ => {
                self.rests = Some((source.clone(), Instant::now()));
                ui.ctx().request_repaint_after(REST);
            }
        }
        false
    }

    /// Takes what is ready, and starts again when it is not that of this frame.
    fn measure(&mut self, ui: &Ui, wanted: Wanted, session: &mut Session) {
        self.measured.poll();
        if self.measured.wants(&wanted) && self.has_rested(ui, &wanted.source) {
            let of = wanted.clone();
            self.measured.start(wanted, session.jobs.compute("Measure region", move |_| measure(&of)));
        }
    }
}

fn measure(Wanted { source, region, scale, .. }: &Wanted) -> Measured {
    let (width, height) = source.size();
    let mask = match region {
        Some(region) => region.mask(width, height),
        None => source.inside().unwrap_or_else(|| Mask::filled(width, height, true)),
    };
    let planes = source.planes();
    let statistics = planes.iter().map(|plane| statistics(plane, &mask)).collect();
    let histograms = planes.iter().map(|plane| Histogram::new(plane, Some(&mask), BINS, *scale)).collect();
    Measured { statistics, histograms }
}

fn table(ui: &mut Ui, channels: &[&str], measured: &Measured) {
    type Value = fn(&RegionStatistics) -> String;
    let rows: [(&str, Value); 8] = [
        ("Mean", |found| number(found.mean)),
        ("Standard deviation", |found| number(found.sd)),
        ("Smallest", |found| number(found.min)),
        ("5th percentile", |found| number(found.percentile_5)),
        ("Median", |found| number(found.median)),
        ("95th percentile", |found| number(found.percentile_95)),
        ("Largest", |found| number(found.max)),
        ("Pixels", |found| found.pixels.to_string()),
    ];
    Grid::new("statistics").striped(true).show(ui, |ui| {
        if channels.len() > 1 {
            ui.label("");
            channels.iter().for_each(|channel| {
                ui.label(RichText::new(*channel).semi_bold());
            });
            ui.end_row();
        }
        for (name, value) in rows {
            ui.label(name);
            for found in &measured.statistics {
                ui.monospace(found.as_ref().map_or("no value".into(), value));
            }
            ui.end_row();
        }
    });
}
