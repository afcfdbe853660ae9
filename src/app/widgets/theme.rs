//! The theme: letters, room around them, and the colours that carry a meaning, readable on dark and light.

use std::sync::Arc;

use eframe::egui::{
    Button, Color32, Context, FontData, FontDefinitions, FontFamily, FontId, RichText, Style, TextStyle, Theme,
    Visuals, vec2,
};

/// Inter, by The Inter Project Authors, under the SIL Open Font License 1.1 (assets/fonts).
const REGULAR: &[u8] = include_bytes!("../../../assets/fonts/Inter-Regular.otf");
const SEMI_BOLD: &[u8] = include_bytes!("../../../assets/fonts/Inter-SemiBold.otf");
/// The family of what stands out.
const STRONG: &str = "Inter SemiBold";

/// Text that stands out by its weight.
pub trait Weight {
    /// In semi-bold letters.
    fn semi_bold(self) -> Self;
}

impl Weight for RichText {
    fn semi_bold(self) -> Self {
        self.strong().family(FontFamily::Name(STRONG.into()))
    }
}

/// Letters of both weights; what they lack comes from egui's own, as before.
fn letters() -> FontDefinitions {
    let mut fonts = FontDefinitions::default();
    let fallback = fonts.families.get(&FontFamily::Proportional).cloned().unwrap_or_default();
    for (name, data, family) in
        [("Inter", REGULAR, FontFamily::Proportional), (STRONG, SEMI_BOLD, FontFamily::Name(STRONG.into()))]
    {
        fonts.font_data.insert(name.to_owned(), Arc::new(FontData::from_static(data)));
        let letters = [name.to_owned()].into_iter().chain(fallback.iter().cloned());
        fonts.families.insert(family, letters.collect());
    }
    fonts
}

/// Sets letters and both themes.
pub fn install(context: &Context) {
    context.set_fonts(letters());
    context.all_styles_mut(sizes);
    for theme in [Theme::Dark, Theme::Light] {
        context.style_mut_of(theme, |style| colours(&mut style.visuals));
    }
}

fn sizes(style: &mut Style) {
    for (text, points) in [(TextStyle::Small, 11.0), (TextStyle::Body, 13.0), (TextStyle::Button, 13.0)] {
        style.text_styles.insert(text, FontId::proportional(points));
    }
    style.text_styles.insert(TextStyle::Monospace, FontId::monospace(12.0));
    style.text_styles.insert(TextStyle::Heading, FontId::new(22.0, FontFamily::Name(STRONG.into())));
    style.spacing.item_spacing = vec2(8.0, 4.0);
    style.spacing.button_padding = vec2(8.0, 3.0);
    // Edges of scroll areas would fade over the canvas.
    style.spacing.scroll.fade.strength = 0.0;
}

fn colours(visuals: &mut Visuals) {
    // egui's own labels, hints, links and warnings are too faint for small text that is to be read.
    visuals.widgets.noninteractive.fg_stroke.color = by_theme(visuals, Color32::from_gray(205), Color32::from_gray(40));
    visuals.weak_text_alpha = 0.75;
    visuals.hyperlink_color = by_theme(visuals, Color32::from_rgb(110, 180, 255), Color32::from_rgb(0, 92, 170));
    visuals.warn_fg_color = by_theme(visuals, Color32::from_rgb(240, 180, 60), Color32::from_rgb(140, 84, 0));
    visuals.error_fg_color = by_theme(visuals, Color32::from_rgb(255, 120, 110), Color32::from_rgb(176, 20, 20));
}

/// The colour of what can be relied on; `warn_fg_color` and `error_fg_color` are its siblings.
pub fn fine(visuals: &Visuals) -> Color32 {
    by_theme(visuals, Color32::from_rgb(96, 200, 120), Color32::from_rgb(16, 110, 44))
}

/// The colours of before and after: of text, where those of surfaces would be too faint.
pub fn before(visuals: &Visuals) -> Color32 {
    by_theme(visuals, Color32::from_rgb(236, 172, 72), Color32::from_rgb(138, 82, 0))
}

/// See [`before`].
pub fn after(visuals: &Visuals) -> Color32 {
    by_theme(visuals, Color32::from_rgb(84, 204, 196), Color32::from_rgb(0, 102, 98))
}

/// Around pictures and surfaces: neutral, and in light colours no white that dazzles.
pub fn canvas(visuals: &Visuals) -> Color32 {
    by_theme(visuals, visuals.extreme_bg_color, Color32::from_gray(188))
}

/// The button of what a panel is for: one a panel.
pub fn primary<'a>(visuals: &Visuals, text: impl Into<String>) -> Button<'a> {
    let text = RichText::new(text).semi_bold().color(visuals.selection.stroke.color);
    Button::new(text).fill(visuals.selection.bg_fill).min_size(vec2(180.0, 32.0))
}

fn by_theme(visuals: &Visuals, dark: Color32, light: Color32) -> Color32 {
    if visuals.dark_mode { dark } else { light }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// WCAG 2: relative luminance of an sRGB colour.
    fn luminance(colour: Color32) -> f64 {
        let linear = |byte: u8| {
            let value = f64::from(byte) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * linear(colour.r()) + 0.7152 * linear(colour.g()) + 0.0722 * linear(colour.b())
    }

    fn contrast(a: Color32, b: Color32) -> f64 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn text_that_carries_a_meaning_has_the_contrast_that_wcag_asks_of_small_text() {
        let context = Context::default();
        install(&context);
        for theme in [Theme::Dark, Theme::Light] {
            let style = context.style_of(theme);
            let visuals = &style.visuals;
            let panel = visuals.panel_fill;
            let on_panel = panel.blend(visuals.weak_text_color());
            for colour in [
                visuals.warn_fg_color,
                visuals.error_fg_color,
                visuals.hyperlink_color,
                fine(visuals),
                on_panel,
                before(visuals),
                after(visuals),
            ] {
                assert!(contrast(colour, panel) >= 4.5, "{theme:?} {colour:?}: {:.2}", contrast(colour, panel));
            }
            let chosen = contrast(visuals.selection.stroke.color, visuals.selection.bg_fill);
            assert!(chosen >= 4.5, "{theme:?}: {chosen:.2}");
        }
    }
}
