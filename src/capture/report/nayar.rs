//! Nayar's method in words and numbers.

use firstbounce_core::methods::by_shape::ByShapeStep;
use maud::{Markup, html};
use serde::Serialize;

use super::html::number;
use crate::pipeline::NayarSolved;

/// Width and height of the plot, and the room its words take.
const PLOT: (f64, f64) = (420.0, 150.0);
const MARGIN: f64 = 34.0;

/// How Nayar's method went.
#[derive(Clone, Debug, Serialize)]
pub struct NayarWords {
    /// "converged", "out of iterations" or "diverged".
    pub ending: &'static str,
    /// The iteration whose shape is the result; 0 is the pseudo shape.
    pub chosen: usize,
    /// Linear light of a white facet that faces a lamp of intensity 1.
    pub white_light: f64,
    /// Where that comes from.
    pub white_light_source: &'static str,
    /// Patches of the last surface.
    pub patches: usize,
    /// Pixels along a patch.
    pub patch_px: usize,
    /// The pseudo shape, then the shape after each iteration.
    pub iterations: Vec<ByShapeStep>,
}

impl NayarWords {
    /// Of a run.
    pub fn of(nayar: &NayarSolved) -> Self {
        let report = &nayar.report;
        Self {
            ending: report.ending.words(),
            chosen: report.chosen,
            white_light: nayar.white_light.value,
            white_light_source: nayar.white_light.source.words(),
            patches: report.patches,
            patch_px: report.patch_px,
            iterations: report.steps.clone(),
        }
    }
}

impl NayarWords {
    /// Its part of the page.
    pub(super) fn section(&self) -> Markup {
        html! {
            h2 { "Nayar's method" }
            p { "Nayar, Ikeuchi and Kanade 1991: the light that bounces about on the shape is simulated and taken away, over and "
                "over. Outcome: " (self.ending) " after " (self.iterations.len().saturating_sub(1)) " iterations; the result is that of "
                "iteration " (self.chosen) ". " (self.patches) " patches of " (self.patch_px) " pixels. Light of a white facet: "
                (number(self.white_light)) " (" (self.white_light_source) ")." }
            (self.plot())
            table {
                tr { th { "Iteration" } th { "normals turned, degrees" } th { "mean albedo" } th { "indirect light, %" }
                    th { "light unexplained, %" } th { "pixels brighter than any paint" } }
                @for (iteration, step) in self.iterations.iter().enumerate() {
                    tr { td { @if iteration == 0 { "pseudo shape" } @else { (iteration) } }
                        td { @if iteration > 0 { (number(step.change_deg)) } } td { (number(step.mean_albedo)) }
                        td { @if iteration > 0 { (number(100.0 * step.indirect_fraction)) } }
                        td { (number(100.0 * step.residual)) } td { (step.clamped_pixels) } }
                }
            }
        }
    }

    /// How far each iteration turned the normals.
    fn plot(&self) -> Markup {
        let changes: Vec<f64> = self.iterations.iter().skip(1).map(|step| step.change_deg).collect();
        let largest = changes.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let (width, height) = (PLOT.0 - 2.0 * MARGIN, PLOT.1 - 2.0 * MARGIN);
        let x = |k: usize| MARGIN + width * k as f64 / changes.len().saturating_sub(1).max(1) as f64;
        let y = |change: f64| MARGIN + height * (1.0 - change / largest);
        let points: Vec<(f64, f64)> = changes.iter().enumerate().map(|(k, &change)| (x(k), y(change))).collect();
        let line: Vec<String> = points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let (bottom, right) = (PLOT.1 - MARGIN, PLOT.0 - MARGIN);
        html! {
            svg viewBox=(format!("0 0 {} {}", PLOT.0, PLOT.1)) width=(PLOT.0) height=(PLOT.1) role="img"
                aria-label="How far each iteration turned the normals" font-size="11" fill="currentColor" {
                line x1=(MARGIN) y1=(bottom) x2=(right) y2=(bottom) stroke="#888" {}
                polyline points=(line.join(" ")) fill="none" stroke="#38c" stroke-width="2" {}
                @for (x, y) in &points { circle cx=(format!("{x:.1}")) cy=(format!("{y:.1}")) r="3" fill="#38c" {} }
                text x=(MARGIN) y=(MARGIN - 12.0) { "normals turned: " (number(largest)) "\u{b0} at most, "
                    (number(changes.last().copied().unwrap_or(0.0))) "\u{b0} at last" }
                text x=(right) y=(PLOT.1 - 12.0) text-anchor="end" { "iteration 1 to " (changes.len()) }
            }
        }
    }
}
