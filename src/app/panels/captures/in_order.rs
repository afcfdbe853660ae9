//! Files whose names have no pattern: assigned by the order in which they were taken.

use eframe::egui::{Button, RichText, TextEdit, Ui};
use firstbounce_capture::CaptureSet;
use firstbounce_capture::set::Subject;

use super::incoming::subject_box;

/// The order that the user gives.
pub struct InOrder {
    /// What all of these files show.
    pub subject: Subject,
    lights: String,
    colours: String,
    /// Whether all colours of one light come before the next light.
    colours_first: bool,
}

impl InOrder {
    /// Begins with the lights and colours that the set has.
    pub fn new(set: &CaptureSet) -> Self {
        let list = |names: Vec<&str>| names.join(", ");
        Self {
            subject: Subject::Object,
            lights: list(set.lights.iter().map(|light| light.name.as_str()).collect()),
            colours: list(set.colours.iter().map(|colour| colour.name.as_str()).collect()),
            colours_first: true,
        }
    }

    /// Asks for the order of `count` files; the light and the colour of each, once the user confirms.
    pub fn ui(&mut self, ui: &mut Ui, count: usize) -> Option<Vec<(String, String)>> {
        subject_box(ui, "Subject of these files", &mut self.subject);
        for (title, text) in [("Lights in order", &mut self.lights), ("Colours in order", &mut self.colours)] {
            let label = ui.label(title);
            let hint = "names, with commas between them";
            ui.add(TextEdit::singleline(text).hint_text(hint).desired_width(f32::INFINITY)).labelled_by(label.id);
        }
        ui.radio_value(&mut self.colours_first, true, "All colours of a light, then the next light");
        ui.radio_value(&mut self.colours_first, false, "All lights of a colour, then the next colour");
        let order = order(&names(&self.lights), &names(&self.colours), self.colours_first);
        let fits = order.len() == count;
        let pressed = ui.add_enabled(fits, Button::new(format!("Assign these {count} files in order"))).clicked();
        if !fits {
            let words = format!("This names {} photos, for {count} files.", order.len());
            ui.label(RichText::new(words).small().color(ui.visuals().warn_fg_color));
        }
        pressed.then_some(order)
    }
}

fn names(text: &str) -> Vec<String> {
    text.split(',').map(str::trim).filter(|name| !name.is_empty()).map(str::to_owned).collect()
}

/// Every light with every colour; without a colour, as for a mirror ball, every light once.
fn order(lights: &[String], colours: &[String], colours_first: bool) -> Vec<(String, String)> {
    let none = [String::new()];
    let colours = if colours.is_empty() { &none } else { colours };
    let pair = |light: &String, colour: &String| (light.clone(), colour.clone());
    if colours_first {
        lights.iter().flat_map(|light| colours.iter().map(move |colour| pair(light, colour))).collect()
    } else {
        colours.iter().flat_map(|colour| lights.iter().map(move |light| pair(light, colour))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_are_counted_light_by_light_or_colour_by_colour() {
        let (lights, colours) = (names("left, top"), names(" blue,green ,"));
        let said = |colours_first| {
            let pairs = order(&lights, &colours, colours_first).into_iter();
            pairs.map(|(light, colour)| format!("{light} {colour}")).collect::<Vec<_>>()
        };
        assert_eq!(said(true), ["left blue", "left green", "top blue", "top green"]);
        assert_eq!(said(false), ["left blue", "top blue", "left green", "top green"]);
        assert_eq!(order(&lights, &[], true).len(), 2);
    }
}
