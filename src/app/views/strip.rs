//! The strip under a picture: exposure, scale, colour map, and what it is compared with.

use eframe::egui::{ComboBox, Label, RichText, Role, Ui, WidgetInfo};

use super::picture::picture;
use super::{Canvases, picker};
use crate::app::state::layout::{Compare, Look, Scale, View};
use crate::app::state::session::Session;
use crate::app::widgets::number_field::up_to;
use crate::gpu::ColourMap;

/// Of the strip, in points.
pub const HEIGHT: f32 = 26.0;
/// Narrower views have their colour map in the menu of a wider one alone.
const WIDE: f32 = 300.0;
/// Of its fields, in points.
const FIELD: f32 = 58.0;

/// Shows it.
pub fn ui(ui: &mut Ui, view: &mut View, session: &mut Session, canvases: &mut Canvases) {
    let title = view.shown.title();
    let is_wide = ui.available_width() > WIDE;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let field = up_to(&mut view.look.exposure_stops, 1, Look::EXPOSURE_STOPS).speed(0.05).suffix(" EV");
        let exposure = ui.add(field);
        exposure.widget_info(|| WidgetInfo::labeled(Role::SpinButton, true, format!("Exposure, {title}")));
        exposure.on_hover_text("Exposure in stops: E brighter, Shift+E darker");
        scale(ui, view, session);
        if is_wide {
            map(ui, &mut view.look, &title);
        }
        compare(ui, view, session);
        let (document, drawn) = (session.document(), view.drawn());
        let Session { results, jobs, .. } = session;
        if let Some(words) = canvases.statistics.words(view.id, &drawn, &document, results, jobs) {
            ui.add(Label::new(RichText::new(&words).small()).truncate()).on_hover_text(words);
        }
    });
}

/// Where the ends of the colours come from.
fn scale(ui: &mut Ui, view: &mut View, session: &Session) {
    let title = view.shown.title();
    let own = view.look.range.is_some();
    let words = match (own, view.look.scale) {
        (true, _) => "custom",
        (false, Scale::Locked) => "locked",
        (false, Scale::Own) => "auto",
    };
    let shown = ComboBox::from_id_salt("scale").width(FIELD).selected_text(words).show_ui(ui, |ui| {
        for (scale, name, what) in [
            (Scale::Locked, "locked", "One scale for all light of a lamp: the same value has the same grey"),
            (Scale::Own, "auto", "The picture's own values"),
        ] {
            if ui.selectable_label(!own && view.look.scale == scale, name).on_hover_text(what).clicked() {
                (view.look.scale, view.look.range) = (scale, None);
            }
        }
        if ui.selectable_label(own, "custom").clicked() && !own {
            let range = picture(&view.drawn(), &session.document(), &session.results).map(|shown| shown.display.range);
            view.look.range = Some(range.unwrap_or([0.0, 1.0]));
        }
    });
    named(&shown.response, format!("Scale, {title}"), words);
    shown.response.on_hover_text("The values at the two ends of the colours: N changes between locked and auto");
    if let Some(ends) = &mut view.look.range {
        let speed = f64::from((ends[1] - ends[0]).abs()) * 0.005;
        for (end, name) in ends.iter_mut().zip(["Low end", "High end"]) {
            let field = ui.add(up_to(end, 5, Look::ENDS).speed(speed));
            field.widget_info(|| WidgetInfo::labeled(Role::SpinButton, true, format!("{name}, {title}")));
        }
    }
}

/// The colour map, and what goes with it.
fn map(ui: &mut Ui, look: &mut Look, title: &str) {
    let words = look.map.map_or("colours", ColourMap::name);
    let shown = ComboBox::from_id_salt("map").width(FIELD).selected_text(words).show_ui(ui, |ui| {
        ui.selectable_value(&mut look.map, None, "As the picture has them");
        for map in ColourMap::ALL {
            ui.selectable_value(&mut look.map, Some(map), map.name());
        }
        ui.separator();
        let mut gamma = look.gamma.is_some();
        ui.checkbox(&mut gamma, "Gamma instead of the sRGB curve");
        look.gamma = gamma.then(|| look.gamma.unwrap_or(2.2));
        if let Some(gamma) = &mut look.gamma {
            let label = ui.label("Gamma");
            ui.add(up_to(gamma, 2, Look::GAMMA).speed(0.02)).labelled_by(label.id);
        }
        ui.checkbox(&mut look.clip_zebra, "Stripes where values are clipped");
        ui.checkbox(&mut look.negative_zebra, "Stripes below zero");
        ui.checkbox(&mut look.plain, "Hide the tints of clipped and dark pixels");
        if ui.button("Reset colours").clicked() {
            *look = Look::default();
        }
    });
    named(&shown.response, format!("Colours, {title}"), words);
}

/// What the picture is compared with, and how.
fn compare(ui: &mut Ui, view: &mut View, session: &mut Session) {
    let document = session.document();
    let title = view.against.as_ref().map_or("Compare".to_owned(), |other| format!("Compare: {}", other.title()));
    let menu = ui.menu_button(if view.against.is_some() { "Compare \u{2022}" } else { "Compare" }, |ui| {
        if ui.selectable_label(view.against.is_none(), "Nothing").clicked() {
            view.against = None;
            ui.close();
        }
        if let Some(chosen) = picker::ui(ui, &document, view.against.as_ref()) {
            view.against = Some(chosen);
            session.views.activate(view.id);
        }
    });
    menu.response.widget_info(|| WidgetInfo::labeled(Role::Button, true, &title));
    menu.response.on_hover_text(title);
    if view.against.is_some() {
        for (compare, name, what) in Compare::ALL {
            ui.selectable_value(&mut view.compare, compare, name).on_hover_text(what);
        }
    }
}

fn named(response: &eframe::egui::Response, name: String, value: &str) {
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::ComboBox, true, &name);
        info.current_text_value = Some(value.to_owned());
        info
    });
}
