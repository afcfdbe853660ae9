//! One pixel's light against beta: what the photos measured, the fitted polynomial, and its bounces stacked.

use eframe::egui::{Color32, Grid, Role, Ui, WidgetInfo};
use egui_plot::{FilledArea, Line, Plot, Points};
use firstbounce_capture::set::Subject;
use firstbounce_core::separate::PixelPolynomial;

use super::number;
use crate::app::state::document::Document;
use crate::app::state::layout::Hover;
use crate::app::state::results::StageError;
use crate::app::state::session::Session;
use crate::app::widgets::advice::advice;

const HEIGHT: f32 = 170.0;
const SAMPLES: usize = 60;
/// Fill of each bounce, to be distinguished in dark and light and without colour vision.
const BOUNCES: [Color32; 4] = [
    Color32::from_rgb(86, 180, 233),
    Color32::from_rgb(230, 159, 0),
    Color32::from_rgb(0, 158, 115),
    Color32::from_rgb(204, 121, 167),
];

pub fn ui(ui: &mut Ui, at: &Hover, document: &Document, session: &Session) {
    let light = at.shown.light().or(document.set.lights.first().map(|light| light.name.as_str()));
    let Some(light) = light.filter(|_| at.shown.subject() == Subject::Object) else {
        advice(ui, "Point at a pixel of the object.");
        return;
    };
    match of_pixel(light, at.pixel, document, session) {
        Ok(pixel) => {
            ui.label(format!("Light {light}, column {}, row {}", at.pixel.0, at.pixel.1));
            plot(ui, &pixel, document);
            table(ui, &pixel, document);
        }
        Err(error) => advice(ui, &error.to_string()),
    }
}

fn of_pixel(
    light: &str,
    (x, y): (usize, usize),
    document: &Document,
    session: &Session,
) -> Result<PixelPolynomial, StageError> {
    let loaded = session.results.loaded().ok_or(StageError::Reading)?;
    let object = loaded.object.as_ref().map_err(Clone::clone)?;
    let rig = session.results.rig(document);
    let system = rig.system(light)?;
    let index = rig
        .lights
        .iter()
        .position(|name| name == light)
        .ok_or_else(|| StageError::NoLight { light: light.to_owned() })?;
    let photos = object.photos.get(index).ok_or(StageError::Reading)?;
    let inside = photos.iter().all(|photo| x < photo.linear.width() && y < photo.linear.height());
    let (Some(alpha), Some(beta), true) = (&rig.alpha[index], &rig.beta, inside) else {
        return Err(rig.missing().unwrap_or(StageError::Outside));
    };
    if photos.len() != system.operator.ncols() {
        return Err(StageError::Reading);
    }
    let light: Vec<_> = photos.iter().map(|photo| f64::from(photo.linear.at(x, y))).collect();
    let bounces = system.operator.row_iter().map(|row| row.iter().zip(&light).map(|(w, n)| w * n).sum()).collect();
    Ok(PixelPolynomial::new(&light, alpha, beta, bounces))
}

fn plot(ui: &mut Ui, pixel: &PixelPolynomial, document: &Document) {
    let widest = 1.05 * pixel.measured.iter().map(|[beta, _]| *beta).fold(1.0, f64::max);
    let betas: Vec<f64> = (0..=SAMPLES).map(|i| widest * i as f64 / SAMPLES as f64).collect();
    let upto = |k: usize| betas.iter().map(|beta| pixel.sum_to(k, *beta)).collect::<Vec<_>>();
    let plot = Plot::new("polynomial")
        .height(HEIGHT)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .x_axis_label("beta")
        .y_axis_label("N / alpha")
        .show(ui, |plot| {
            let ink = plot.ctx().global_style().visuals.text_color();
            for k in 1..=pixel.bounces.len() {
                let colour = BOUNCES[(k - 1) % BOUNCES.len()];
                let (below, above) = (upto(k - 1), upto(k));
                let name = format!("Bounce {k}");
                plot.add(FilledArea::new(&name, &betas, &below, &above).fill_color(colour.gamma_multiply(0.45)));
                let edge: Vec<_> = betas.iter().zip(&above).map(|(beta, n)| [*beta, *n]).collect();
                plot.line(Line::new(name, edge).color(colour).width(2.0));
            }
            for (colour, point) in document.set.colours.iter().zip(&pixel.measured) {
                plot.points(Points::new(format!("Photo, {}", colour.name), vec![*point]).radius(4.5).color(ink));
            }
        });
    let spoken: Vec<_> =
        (1..).zip(&pixel.bounces).map(|(k, bounce)| format!("bounce {k} {}", number(*bounce))).collect();
    let spoken = format!("Light of the pixel against beta: {}", spoken.join(", "));
    plot.response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &spoken));
}

fn table(ui: &mut Ui, pixel: &PixelPolynomial, document: &Document) {
    Grid::new("pixel polynomial").num_columns(2).striped(true).show(ui, |ui| {
        for (k, bounce) in (1..).zip(&pixel.bounces) {
            ui.horizontal(|ui| {
                let (rect, _) = ui.allocate_exact_size(eframe::egui::Vec2::splat(10.0), eframe::egui::Sense::hover());
                ui.painter().rect_filled(rect, 2.0, BOUNCES[(k - 1) % BOUNCES.len()]);
                ui.label(format!("L{k}"));
            });
            ui.monospace(number(*bounce));
            ui.end_row();
        }
        if pixel.measured.len() > pixel.bounces.len() {
            for (colour, left) in document.set.colours.iter().zip(pixel.residuals()) {
                ui.label(format!("Residual, {}", colour.name));
                ui.monospace(number(left));
                ui.end_row();
            }
        }
    });
}
