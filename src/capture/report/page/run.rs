//! `report.html`: one page that needs no other file.

use std::borrow::Cow;

use firstbounce_core::Plane;
use maud::{Markup, html};
use percent_encoding::{AsciiSet, NON_ALPHANUMERIC, utf8_percent_encode};
use rayon::prelude::*;

use super::frame::page;
use super::{Picture, Pictures, colours_and_shape, nayar};
use crate::pipeline::{Method, PipelineError, Solved, Surface};
use crate::report::{Report, Row, ShapeRecord};
use crate::set::CaptureSet;

/// A run at a glance: the first light's photo, its bounces as in the paper's Figure 1, normals before and after.
pub fn overview(solved: &Solved) -> Picture {
    let pictures = Pictures::of(&solved.object.mask);
    let bounces = &solved.separated.lights[0].bounces;
    let mut shown = vec![pictures.light(&solved.object.photos[0][0].linear)];
    if let Some(indirect) = indirect_of(solved, 0) {
        shown.push(pictures.composite(&bounces[0], &indirect).0);
    }
    let surfaces = [solved.before.as_ref(), solved.after.as_ref().ok()];
    shown.extend(surfaces.into_iter().flatten().map(|surface| pictures.normals(&surface.shape.normals.map)));
    Picture::row(&shown)
}

/// All light of light `l` that bounced more than once, as far as the method tells it.
fn indirect_of(solved: &Solved, l: usize) -> Option<Cow<'_, Plane>> {
    let later = &solved.separated.lights[l].bounces[1..];
    match solved.indirect.get(l) {
        Some(indirect) => Some(Cow::Borrowed(indirect)),
        None => (!later.is_empty()).then(|| Cow::Owned(sum_of(later))),
    }
}

/// The page of a run.
pub fn html(solved: &Solved, report: &Report) -> Result<String, PipelineError> {
    let (set, pictures) = (&*solved.set, Pictures::of(&solved.object.mask));
    let all_colours = solved.options.method.needs().all_colours;
    let body = html! {
        p { (summary(report, solved.options.method)) }
        (warnings(report))
        @if all_colours { (trust_section(report, solved.options.method)) }
        h2 { "Captures and their light" }
        @for l in 0..set.lights.len() { (light_section(set, solved, report, pictures, l)?) }
        @if let Some(record) = &report.nayar { (nayar::section(record)) }
        @if let Some(record) = &report.colours_and_shape { (colours_and_shape::section(record)) }
        (shape_section(solved, report, pictures)?)
        h2 { "Calibration" }
        (calibration_table(report))
        h2 { "Files" }
        (export(report))
        (files(report))
        h2 { "Cost" }
        (costs(report))
    };
    Ok(page(&report.set.name, "", &report.program, &body))
}

fn summary(report: &Report, method: Method) -> String {
    let [width, height] = report.set.size;
    let how = match method {
        Method::Colours => format!("{} bounces separated", report.bounces),
        other => format!("direct light found by {}", other.title()),
    };
    format!(
        "{} lights ({}), {} colours ({}, reference first), {width} x {height} pixels, {} of them object; {how}.",
        report.set.lights.len(),
        report.set.lights.join(", "),
        report.set.colours.len(),
        report.set.colours.join(", "),
        report.set.mask_pixels,
    )
}

fn warnings(report: &Report) -> Markup {
    let is_other = |line: &&String| report.capture_warnings.iter().all(|warning| warning.words != **line);
    let others: Vec<&String> = report.warnings.iter().filter(is_other).collect();
    html! {
        @if let Some(reason) = &report.no_shape { p.problem { "No surface: " (reason) } }
        @if !report.capture_warnings.is_empty() {
            div.warning {
                h2 { "Capture warnings" }
                ol { @for warning in &report.capture_warnings { li { (warning.words) } } }
            }
        }
        @if !others.is_empty() {
            div.warning { h2 { "Take care" } ul { @for warning in others { li { (warning) } } } }
        }
    }
}

fn trust_section(report: &Report, method: Method) -> Markup {
    let trust = &report.trust;
    let by_colours = method == Method::Colours;
    html! {
        h2 { "Trust" }
        p { "Verdict: " strong { (trust.level) } "." }
        table {
            tr {
                th { "Light" } th { "noise of bounce 1, %" }
                @if by_colours { th { "once denoised, %" } th { "calibration, %" } th { "truncation, %" } }
            }
            @for (light, words) in &trust.light {
                tr {
                    td { (light) } td { (number(words.noise_percent)) }
                    @if by_colours {
                        td { (number(words.denoised_noise_percent)) } td { (words.calibration_percent.map_or("?".into(), number)) }
                        td { (words.truncation_percent.map_or("?".into(), number)) }
                    }
                }
            }
        }
        @if let Some(normal) = &trust.normal {
            p { "Expected error of normals: " (number(normal.denoised_noise_deg)) " degrees by noise, "
                (number(normal.calibration_deg)) @if by_colours { " by calibration." } @else { " by the interval of beta." } }
        }
        @if !trust.advice.is_empty() { p { "Better:" } ul { @for line in &trust.advice { li { (line) } } } }
    }
}

fn light_section(
    set: &CaptureSet,
    solved: &Solved,
    report: &Report,
    pictures: Pictures,
    l: usize,
) -> Result<Markup, PipelineError> {
    let name = &set.lights[l].name;
    let bounces = &solved.separated.lights[l].bounces;
    let mut shown = Vec::new();
    for (colour, photo) in set.colours.iter().zip(&solved.object.photos[l]) {
        shown.push((format!("Photo, {}", colour.name), pictures.light(&photo.linear).data_address()?));
    }
    let white = pictures.white(&bounces[0]);
    let of_method = solved.indirect.get(l);
    let direct = if of_method.is_some() { "Direct light" } else { "Bounce 1" };
    shown.push((direct.into(), pictures.light_with_white(&bounces[0], white).data_address()?));
    let later = (2..).zip(&bounces[1..]).map(|(k, bounce)| (format!("Bounce {k}"), bounce));
    for (title, light) in later.chain(of_method.map(|light| ("Indirect light".to_owned(), light))) {
        let own = pictures.white(light);
        let caption = format!("{title}, {:.1} times brightened", white / own);
        shown.push((caption, pictures.light_with_white(light, own).data_address()?));
    }
    if let Some(indirect) = indirect_of(solved, l) {
        let (composite, amplification) = pictures.composite(&bounces[0], &indirect);
        let caption = format!("{direct} red, the rest cyan, {amplification:.1} times brightened");
        shown.push((caption, composite.data_address()?));
    }
    let words = &report.separation[name];
    Ok(html! {
        h3 { "Light " (name) }
        div.pictures { @for (caption, address) in &shown { (figure(caption, address)) } }
        table {
            tr { th { "Bounce" } th { "mean light" } th { "predicted noise" } th { "gain" } }
            @for k in 0..words.mean.len() {
                tr { td { (k + 1) } td { (number(words.mean[k])) } td { (number(words.noise[k])) } td { (number(words.gain[k])) } }
            }
        }
        p {
            @if let Some(condition) = words.condition_number { "Condition number " (number(condition)) ". " }
            (words.solved_pixels) " pixels solved, "
            (words.reduced_pixels) " of them without a clipped or dark colour; left out: "
            (words.unsolved_clipped_pixels) " clipped, " (words.unsolved_dark_pixels) " dark." }
    })
}

fn shape_section(solved: &Solved, report: &Report, pictures: Pictures) -> Result<Markup, PipelineError> {
    let (Ok(after), Some(words)) = (&solved.after, &report.shape) else { return Ok(html! {}) };
    let mut shown = Vec::new();
    let mut add = |what: &str, surface: &Surface| -> Result<(), PipelineError> {
        let shape = &surface.shape;
        shown.push((format!("Normals {what}"), pictures.normals(&shape.normals.map).data_address()?));
        shown.push((format!("Depth {what}"), pictures.depth(&shape.depth.depth_mm, &shape.depth.mask).data_address()?));
        Ok(())
    };
    if let Some(before) = &solved.before {
        add("before separation", before)?;
    }
    match solved.options.method {
        Method::Colours => add("after: bounce 1 alone", after)?,
        other => add(&format!("after: {}", other.title()), after)?,
    }
    shown.push(("Albedo".into(), pictures.light(&after.shape.normals.albedo).data_address()?));
    Ok(html! {
        h2 { "Shape" }
        div.pictures { @for (caption, address) in &shown { (figure(caption, address)) } }
        (shape_table(words, report.before.as_ref()))
        p { "Axes: " (report.conventions.frame) ". Normal map: " (report.conventions.normals) ". Mesh and depth in "
            (words.mesh.unit) @if words.mesh.unit == "px" { " (the camera's scale is not known)" } "." }
    })
}

fn shape_table(after: &ShapeRecord, before: Option<&ShapeRecord>) -> Markup {
    type Cell = fn(&ShapeRecord) -> String;
    let rows: [(&str, Cell); 8] = [
        ("Pixels with a normal", |words| words.solved_pixels.to_string()),
        ("of these in some shadow", |words| (words.shadowed_pixels + words.shadow_used_pixels).to_string()),
        ("Object pixels without one", |words| words.unsolved_pixels.to_string()),
        ("Predicted noise of normals, degrees", |words| number(words.mean_noise_deg)),
        ("Slopes that fit no surface, rms", |words| number(words.depth.rms_slope_residual)),
        ("Islands", |words| words.depth.islands.to_string()),
        ("Depth range", |words| {
            words.mesh.bounds.map_or_else(String::new, |[a, b]| format!("{:.3} {}", b[2] - a[2], words.mesh.unit))
        }),
        ("Triangles", |words| words.mesh.triangles.to_string()),
    ];
    html! {
        table {
            tr { th { "" } @if before.is_some() { th { "before" } } th { "after" } }
            @for (name, cell) in &rows {
                tr { td { (name) } @if let Some(before) = before { td { (cell(before)) } } td { (cell(after)) } }
            }
        }
    }
}

fn calibration_table(report: &Report) -> Markup {
    html! {
        table {
            tr { th { "Quantity" } th { "value" } th { "95 % interval" } th { "source" } th { "pixels used" } th { "pixels refused" } }
            @for Row { quantity, value, interval, source, used, refused } in report.calibration.rows() {
                tr { td { (quantity) } td { (value) } td { (interval) } td { (source) } td { (used) } td { (refused) } }
            }
        }
        @if !report.calibration.circle.is_empty() {
            table {
                tr { th { "Ball" } th { "centre, px" } th { "radius, px" } }
                @for (subject, circle) in &report.calibration.circle {
                    tr {
                        td { (subject) }
                        td { (format!("{:.2}, {:.2}", circle.centre[0], circle.centre[1])) }
                        td { (format!("{:.2}", circle.radius)) }
                    }
                }
            }
        }
    }
}

fn export(report: &Report) -> Markup {
    let export = &report.export;
    html! {
        @if !export.meshes.is_empty() {
            table {
                tr { th { "Mesh file" } th { "axes" } th { "unit" } }
                @for (extension, words) in &export.meshes {
                    tr { td { "." (extension) } td { (words.axes) } td { (words.unit) } }
                }
            }
        }
        @for line in export.decimation_lines() { p { (line) "." } }
        @for (name, scale) in &export.depth_png { p { (name) ": " (scale.words()) "." } }
    }
}

fn files(report: &Report) -> Markup {
    html! {
        table { @for (name, what) in &report.files { tr { td { a href=(link_to(name)) { (name) } } td { (what) } } } }
    }
}

/// What a link to a file beside the page may hold as it is (RFC 3986); all else would end it or mean something.
const IN_LINKS: &AsciiSet = &NON_ALPHANUMERIC.remove(b'-').remove(b'.').remove(b'_').remove(b'~').remove(b'/');

fn link_to(name: &str) -> String {
    utf8_percent_encode(name, IN_LINKS).to_string()
}

fn costs(report: &Report) -> Markup {
    let mebibytes = |bytes: Option<u64>| bytes.map_or_else(String::new, |bytes| format!("{} MiB", bytes >> 20));
    html! {
        table {
            tr { th { "Stage" } th { "seconds" } th { "most memory so far" } }
            @for cost in &report.stages {
                tr { td { (cost.stage) } td { (format!("{:.2}", cost.seconds)) } td { (mebibytes(cost.peak_rss_bytes)) } }
            }
        }
    }
}

fn figure(caption: &str, address: &str) -> Markup {
    html! { figure { img src=(address) alt=(caption); figcaption { (caption) } } }
}

/// Three significant digits or more, never an exponent for what the user meets daily.
pub(super) fn number(value: f64) -> String {
    match value.abs() {
        // A percentage of a bounce 1 that comes out negative.
        size if !size.is_finite() => "none".into(),
        0.0 => "0".into(),
        size if size >= 100.0 => format!("{value:.0}"),
        size if size >= 1.0 => format!("{value:.2}"),
        size if size >= 0.001 => format!("{value:.4}"),
        _ => format!("{value:.1e}"),
    }
}

fn sum_of(planes: &[Plane]) -> Plane {
    let mut sum = planes[0].clone();
    for plane in &planes[1..] {
        sum.data_mut().par_iter_mut().zip(plane.data()).for_each(|(sum, value)| *sum += value);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn links_to_files_with_signs_that_mean_something_lead_there() {
        assert_eq!(link_to("direct-left.exr"), "direct-left.exr");
        assert_eq!(link_to("direct-lamp #1 100%?.exr"), "direct-lamp%20%231%20100%25%3F.exr");
        assert_eq!(link_to("direct-\u{fc}ber.exr"), "direct-%C3%BCber.exr");
    }
}
