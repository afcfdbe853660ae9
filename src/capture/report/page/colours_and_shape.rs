//! Colours and shape together on the page of a run.

use maud::{Markup, html};

use super::run::number;
use crate::report::ColoursAndShapeRecord;

/// Its part of the page.
pub(super) fn section(record: &ColoursAndShapeRecord) -> Markup {
    let range = |[low, high]: [f64; 2]| format!("{low:.4} to {high:.4}");
    html! {
        h2 { "Colours and shape" }
        p { "The colours tell direct from indirect light, the shape says what the indirect light is made of; arriving light was "
            "computed on cells of " (record.step_px) " pixels." @if let Some(line) = record.line() { " " (capitalised(&line)) "." } }
        @if let Some((white, source)) = record.white_light.zip(record.white_light_source) {
            p { "Light of a white facet: " (number(white)) " (" (source) ")." }
        }
        @if !record.verdict.is_empty() { ul { @for line in &record.verdict { li { (capitalised(line)) "." } } } }
        table {
            tr { th { "Light" } th { "mean direct light" } th { "mean indirect light" } th { "colour ratios of all light" } }
            @for (light, words) in &record.light {
                tr { td { (light) } td { (number(words.mean_direct)) } td { (number(words.mean_indirect)) }
                    td { (words.ratio.iter().map(|ratio| number(*ratio)).collect::<Vec<_>>().join(", ")) } }
            }
        }
        @if !record.beta.is_empty() {
            table {
                tr { th { "Colour" } th { "beta in force" } th { "by the object" } th { "95 % interval" } th { "end of the ratio" } th { "beta for which s = k" } }
                @for (colour, words) in &record.beta {
                    tr { td { (colour) } td { (number(words.in_force)) } td { (words.object.map_or_else(String::new, number)) }
                        td { (words.interval.map_or_else(String::new, range)) } td { (words.end.map_or_else(String::new, |end| number(end.value))) }
                        td { (words.agreeing.map_or_else(String::new, number)) } }
                }
            }
        }
    }
}

fn capitalised(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}
