//! The numbers of a difference: computed off the UI thread, for the pictures of this frame.

use std::collections::HashMap;

use super::picture::sides;
use crate::app::base::jobs::{Jobs, Task};
use crate::app::base::keyed::Keyed;
use crate::app::state::document::Document;
use crate::app::state::layout::Shown;
use crate::app::state::results::Results;
use crate::gpu::{Difference, Layer, PlaneKey, difference};

/// A mean this much smaller than the differences themselves is rounding.
const ROUNDING: f64 = 1e-6;

/// Which planes, and with which weights: the same terms, the same numbers.
type Terms = Vec<(PlaneKey, f32)>;

/// The differences on screen, by their view.
#[derive(Default)]
pub struct Statistics {
    of_view: HashMap<u64, Keyed<Terms, Difference>>,
}

impl Statistics {
    /// Mean, rms and largest difference that a view shows, in words; `None` for other pictures.
    pub fn words(
        &mut self,
        view: u64,
        shown: &Shown,
        document: &Document,
        results: &Results,
        jobs: &mut Jobs,
    ) -> Option<String> {
        let Shown::Difference(a, b) = shown else {
            self.of_view.remove(&view);
            return None;
        };
        let unit = shown.quantity(&document.set).unit;
        let [a, b] = sides(a, b, document, results).ok()?;
        let terms: Terms = a.terms().iter().chain(b.terms()).map(|(plane, weight)| (plane.key, *weight)).collect();
        let found = self.of_view.entry(view).or_default();
        found.poll();
        if found.wants(&terms) {
            found.start(terms, start(a, b, results, jobs));
        }
        Some(match found.last().map(|(_, outcome)| outcome) {
            Some(Ok(found)) => format!(
                "mean {}{unit}, rms {}{unit}, largest {}{unit} at column {}, row {} ({} pixels)",
                number(if found.mean.abs() < ROUNDING * found.rms { 0.0 } else { found.mean }),
                number(found.rms),
                number(found.max),
                found.max_at.0,
                found.max_at.1,
                found.pixels
            ),
            Some(Err(error)) => error.to_string(),
            None => "comparing".into(),
        })
    }
}

/// Four digits; powers of ten only where they are needed.
fn number(value: f64) -> String {
    match value.abs() {
        0.0 => "0".into(),
        size if size >= 100.0 => format!("{value:.1}"),
        size if size >= 0.001 => format!("{value:.4}"),
        _ => format!("{value:.2e}"),
    }
}

fn start(a: Layer, b: Layer, results: &Results, jobs: &mut Jobs) -> Task<Difference> {
    let loaded = results.loaded();
    jobs.start("Compare pictures", move |_| {
        let mask = loaded.as_ref().and_then(|loaded| loaded.object.as_ref().ok()).map(|object| &object.mask);
        let mask = mask.filter(|mask| mask.size() == a.size());
        difference(&a, &b, mask)
    })
}
