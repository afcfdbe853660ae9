//! Whether the object has one albedo: the choice, and what came of it.

use eframe::egui::{RichText, Ui};
use firstbounce_capture::pipeline::Method;
use firstbounce_capture::set::ShapeSettings;
use firstbounce_core::stereo::normals::{MAX_STRAY_SHARE, Paint};
use firstbounce_core::stereo::shape::Shape;

use crate::app::state::document::Document;

const CHOICES: [(Paint, &str, &str); 3] = [
    (Paint::Auto, "Auto", "One albedo for the whole object where the photos agree with that: less noise"),
    (Paint::One, "One paint", "One albedo for the whole object, whatever the photos say"),
    (Paint::Any, "Any paint", "Each pixel has its own albedo"),
];

/// The choice; returns the name of the edit, where there was one.
pub fn choice(ui: &mut Ui, document: &Document, settings: &mut ShapeSettings) -> Option<String> {
    let counts = document.method() != Method::Shape;
    let mut changed = None;
    ui.horizontal_wrapped(|ui| {
        ui.label("Paint").on_hover_text("Whether the object has one albedo");
        ui.add_enabled_ui(counts, |ui| {
            for (paint, name, hover) in CHOICES {
                let why_not = "Nayar's method finds an albedo for each pixel";
                let radio = ui.radio_value(&mut settings.paint, paint, name);
                if radio.on_hover_text(hover).on_disabled_hover_text(why_not).changed() {
                    changed = Some(format!("Choose paint: {}", name.to_lowercase()));
                }
            }
        });
    });
    changed
}

/// Whether the surface is that of one paint, and why not.
pub fn found(ui: &mut Ui, document: &Document, after: &Shape) {
    ui.label(RichText::new(words(document, after)).weak());
}

fn words(document: &Document, after: &Shape) -> String {
    let method = document.method();
    match after.report.normals.paint {
        Some(paint) if paint.one => format!(
            "One paint: albedo {:.4} everywhere; alone, {:.1} % of the pixels would have another.",
            paint.albedo,
            100.0 * paint.stray_share
        ),
        Some(paint) => format!(
            "Each pixel has its own albedo: {:.1} % of them differ from that of most, and one paint allows {:.0} %.",
            100.0 * paint.stray_share,
            100.0 * MAX_STRAY_SHARE
        ),
        None if method == Method::Shape => "Each pixel has its own albedo, as Nayar's method finds it.".into(),
        None if document.options(method).shape_after().normals.paint != Paint::Any => {
            "Each pixel has its own albedo: too few pixels are lit by every light to look for one.".into()
        }
        None if document.set.shape.paint == Paint::Any => "Each pixel has its own albedo, as chosen.".into(),
        None => format!(
            "Each pixel has its own albedo: {} looks for one paint only where \"One paint\" is chosen.",
            method.title()
        ),
    }
}
