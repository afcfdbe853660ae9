//! Nayar's method on the page of a run.

use maud::{Markup, html};

use super::run::number;
use crate::report::NayarRecord;

/// Width and height of the plot, and the room its words take.
const PLOT: (f64, f64) = (420.0, 150.0);
const MARGIN: f64 = 34.0;

/// Its part of the page.
pub(super) fn section(nayar: &NayarRecord) -> Markup {
    html! {
        h2 { "Nayar's method" }
        p { "Nayar, Ikeuchi and Kanade 1991: the light that bounces about on the shape is simulated and taken away, over and "
            "over. Outcome: " (nayar.ending) " after " (nayar.iterations.len().saturating_sub(1)) " iterations; the result is that of "
            "iteration " (nayar.chosen) ". " (nayar.patches) " patches of " (nayar.patch_px) " pixels. Light of a white facet: "
            (number(nayar.white_light)) " (" (nayar.white_light_source) ")." }
        (plot(nayar))
        table {
            tr { th { "Iteration" } th { "normals turned, degrees" } th { "mean albedo" } th { "indirect light, %" }
                th { "light unexplained, %" } th { "pixels brighter than any paint" } }
            @for (iteration, step) in nayar.iterations.iter().enumerate() {
                tr { td { @if iteration == 0 { "pseudo shape" } @else { (iteration) } }
                    td { @if iteration > 0 { (number(step.change_deg)) } } td { (number(step.mean_albedo)) }
                    td { @if iteration > 0 { (number(100.0 * step.indirect_fraction)) } }
                    td { (number(100.0 * step.residual)) } td { (step.clamped_pixels) } }
            }
        }
    }
}

/// How far each iteration turned the normals.
fn plot(nayar: &NayarRecord) -> Markup {
    let changes: Vec<f64> = nayar.iterations.iter().skip(1).map(|step| step.change_deg).collect();
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
