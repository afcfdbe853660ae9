//! What the separation did to the shape, told once and large.

use eframe::egui::{Color32, Frame, RichText, Ui};
use firstbounce_capture::pipeline::Evaluation;

use crate::app::state::document::Document;
use crate::app::state::results::{Plain, Shapes, SurfaceName};
use crate::app::state::session::Session;
use crate::app::widgets::theme::{Weight, after, before};

/// The card; `truth` is what a truth says, `session.reference` what a scan says.
pub fn ui(ui: &mut Ui, session: &Session, document: &Document, shapes: &Shapes, truth: Option<&Evaluation>) {
    Frame::group(ui.style()).show(ui, |ui| {
        ui.set_width(ui.available_width());
        if let Some(turned) = shapes.turned {
            ui.label(RichText::new(format!("Normals turned by {:.1}\u{b0}", turned.mean_deg)).semi_bold().size(16.0));
        }
        let unit = (Plain::Depth.row().quantity)(&document.set).unit;
        if let (Some(was), Some(is)) = (height(session, SurfaceName::Before), height(session, SurfaceName::After)) {
            line(ui, "Depth", format!("{was:.1}"), format!("{is:.1}{unit}"));
        }
        if let Some(of) = truth {
            let errors = &of.normal_error_deg;
            line(ui, "Error", format!("{:.2}\u{b0}", errors.raw.mean), format!("{:.2}\u{b0}", errors.separated.mean));
        }
        if let Some(Ok(outcome)) = session.reference.compared()
            && let Ok(was) = &outcome.before
        {
            let mm = |mean: f64| format!("{mean:.3} mm");
            line(ui, "To the scan", mm(was.comparison.mean_mm), mm(outcome.after.comparison.mean_mm));
        }
    });
}

/// "Error 15.4 -> 0.5", in the colours of before and after.
fn line(ui: &mut Ui, what: &str, was: String, is: String) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 5.0;
        ui.label(what);
        let number = |text: String, colour: Color32| RichText::new(text).semi_bold().size(15.0).color(colour);
        ui.label(number(was, before(ui.visuals()))).on_hover_text("Before");
        ui.label("\u{2192}");
        ui.label(number(is, after(ui.visuals()))).on_hover_text("After");
    });
}

/// From the deepest to the highest point, but for the outermost pixels.
fn height(session: &Session, name: SurfaceName) -> Option<f32> {
    let [low, high] = session.results.pictures().plane(&Plain::Depth.of(name).into())?.range;
    Some(high - low)
}
