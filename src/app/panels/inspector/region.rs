//! Statistics and histogram of the active picture, in a region or over the whole object.

use eframe::egui::{Grid, RichText, Ui};
use firstbounce_core::Mask;
use firstbounce_core::statistics::{Histogram, Region, RegionStatistics, Scale, statistics};

use super::{histogram, number};
use crate::app::jobs::Task;
use crate::app::session::Session;
use crate::app::views::{Picture, Shown};
use crate::gpu::Source;

const BINS: usize = 128;

/// What was measured last, and what is being measured.
#[derive(Default)]
pub struct RegionSection {
    scale: Scale,
    measured: Option<Measured>,
    task: Option<Task<Measured>>,
}

/// The numbers of a picture in a region, and of which.
#[derive(Clone, Debug)]
struct Measured {
    source: Source,
    region: Option<Region>,
    scale: Scale,
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
        self.measure(&picture.source, region, session);
        let of = match region {
            Some(Region::Rectangle(a, b)) => {
                format!("{} x {} px", number((b[0] - a[0]).abs()), number((b[1] - a[1]).abs()))
            }
            Some(Region::Lasso(_)) => "inside the lasso".into(),
            None if picture.source.inside().is_some() => "whole object".into(),
            None => "whole picture".into(),
        };
        ui.label(format!("{}: {of}", shown.title()));
        ui.label(RichText::new(picture.quantity).weak());
        let Some(measured) = &self.measured else {
            ui.label(RichText::new("Being measured.").weak());
            return;
        };
        table(ui, measured);
        ui.horizontal_wrapped(|ui| {
            ui.label("Histogram");
            ui.radio_value(&mut self.scale, Scale::Linear, "Linear");
            ui.radio_value(&mut self.scale, Scale::Logarithmic, "Logarithmic");
        });
        histogram::ui(ui, &measured.histograms, measured.source.channels());
    }

    /// Takes what is ready, and starts anew when it is not that of this frame.
    fn measure(&mut self, source: &Source, region: Option<&Region>, session: &mut Session) {
        if let Some(result) = self.task.as_ref().and_then(Task::poll) {
            self.task = None;
            self.measured = result.ok();
        }
        let is_it = |measured: &Measured| {
            measured.scale == self.scale && measured.region.as_ref() == region && measured.source.same_numbers(source)
        };
        if self.task.is_some() || self.measured.as_ref().is_some_and(is_it) {
            return;
        }
        let (source, region, scale) = (source.clone(), region.cloned(), self.scale);
        self.task = Some(session.jobs.start("Measure region", move |_| Ok(measure(source, region, scale))));
    }
}

fn measure(source: Source, region: Option<Region>, scale: Scale) -> Measured {
    let (width, height) = source.size();
    let mask = match &region {
        Some(region) => region.mask(width, height),
        None => source.inside().unwrap_or_else(|| Mask::filled(width, height, true)),
    };
    let planes = source.planes();
    let statistics = planes.iter().map(|plane| statistics(plane, &mask)).collect();
    let histograms = planes.iter().map(|plane| Histogram::new(plane, Some(&mask), BINS, scale)).collect();
    Measured { source, region, scale, statistics, histograms }
}

fn table(ui: &mut Ui, measured: &Measured) {
    type Value = fn(&RegionStatistics) -> String;
    let rows: [(&str, Value); 8] = [
        ("Mean", |found| number(found.mean)),
        ("Standard deviation", |found| number(found.sd)),
        ("Smallest", |found| number(found.min)),
        ("5 % are below", |found| number(found.percentile_5)),
        ("Median", |found| number(found.median)),
        ("95 % are below", |found| number(found.percentile_95)),
        ("Largest", |found| number(found.max)),
        ("Pixels", |found| found.pixels.to_string()),
    ];
    let channels = measured.source.channels();
    Grid::new("statistics").striped(true).show(ui, |ui| {
        if channels.len() > 1 {
            ui.label("");
            channels.iter().for_each(|channel| {
                ui.label(RichText::new(*channel).strong());
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
