//! Colours and sizes of text: legible at arm's length, in either theme. Every colour of words has a contrast of 4.5 or more
//! against the panels.

use eframe::egui::{Color32, Context, FontId, TextStyle, Visuals};

const SMALL_POINTS: f32 = 11.0;

/// Sets up both themes.
pub fn apply(context: &Context) {
    context.all_styles_mut(|style| {
        style.text_styles.insert(TextStyle::Small, FontId::proportional(SMALL_POINTS));
        let visuals = &mut style.visuals;
        let (text, warn, error, link) = match visuals.dark_mode {
            true => (Color32::from_gray(205), [240, 180, 60], [255, 120, 110], [110, 180, 255]),
            false => (Color32::from_gray(40), [140, 84, 0], [176, 20, 20], [0, 84, 166]),
        };
        let rgb = |[red, green, blue]: [u8; 3]| Color32::from_rgb(red, green, blue);
        visuals.widgets.noninteractive.fg_stroke.color = text;
        visuals.weak_text_alpha = 0.75;
        visuals.warn_fg_color = rgb(warn);
        visuals.error_fg_color = rgb(error);
        visuals.hyperlink_color = rgb(link);
        // Edges of scroll areas would fade over the canvas.
        style.spacing.scroll.fade.strength = 0.0;
    });
}

/// Of a verdict that nothing spoils.
pub fn good(visuals: &Visuals) -> Color32 {
    if visuals.dark_mode { Color32::from_rgb(96, 200, 120) } else { Color32::from_rgb(16, 110, 44) }
}
