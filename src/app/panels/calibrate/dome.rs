//! The lights on the dome over the object, as the camera sees it: the middle is straight above, the rim is the horizon.

use eframe::egui::{Align2, Color32, FontId, Label, Pos2, RichText, Role, Sense, Stroke, Ui, WidgetInfo, vec2};
use firstbounce_capture::pipeline::Calibrated;
use firstbounce_capture::set::CaptureSet;

/// The smallest and the largest, in points.
const SIDES: (f32, f32) = (120.0, 420.0);
/// Below it, in points.
const TEXT: f32 = 44.0;
const LAMP: Color32 = Color32::from_rgb(255, 196, 60);

pub fn ui(ui: &mut Ui, set: &CaptureSet, in_force: &Calibrated) {
    let space = ui.available_size();
    let side = space.x.min(space.y - TEXT).clamp(SIDES.0, SIDES.1);
    let (response, painter) = ui.allocate_painter(vec2(space.x.max(side), side), Sense::hover());
    let centre = response.rect.center();
    let radius = side / 2.0 - 14.0;
    let line = ui.visuals().widgets.noninteractive.bg_stroke;
    for elevation_deg in [0.0_f32, 30.0, 60.0] {
        painter.circle_stroke(centre, radius * elevation_deg.to_radians().cos(), line);
    }
    painter.hline(centre.x - radius..=centre.x + radius, centre.y, line);
    painter.vline(centre.x, centre.y - radius..=centre.y + radius, line);
    let mut words = Vec::new();
    for (light, known) in set.lights.iter().zip(&in_force.direction) {
        let Some([x, y, z]) = known.as_ref().map(|known| known.value) else { continue };
        let length = (x * x + y * y + z * z).sqrt().max(f64::MIN_POSITIVE);
        let at = Pos2::new(centre.x + radius * (x / length) as f32, centre.y - radius * (y / length) as f32);
        let colour = if z > 0.0 { LAMP } else { ui.visuals().error_fg_color };
        painter.circle(at, 5.0, colour, Stroke::new(1.0, Color32::BLACK));
        let text = ui.visuals().text_color();
        painter.text(at + vec2(8.0, 0.0), Align2::LEFT_CENTER, &light.name, FontId::proportional(12.0), text);
        let elevation_deg = (z / length).clamp(-1.0, 1.0).asin().to_degrees();
        words.push(format!("{}: {elevation_deg:.0}\u{b0} above the horizon", light.name));
    }
    let value = words.join(", ");
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, format!("Lights on a dome. {value}")));
    response.on_hover_text(words.join("\n"));
    let note = "As the camera sees them; rings are 30 and 60 degrees above the horizon";
    ui.add(Label::new(RichText::new(note).small().weak()).truncate());
}
