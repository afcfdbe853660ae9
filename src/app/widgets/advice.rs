//! Advice in an empty place: what to do next.

use eframe::egui::{Frame, RichText, Ui};

/// A line of advice in a panel.
pub fn advice(ui: &mut Ui, text: &str) {
    ui.add_space(8.0);
    ui.label(RichText::new(sentence(text)).weak());
}

/// The same in the middle of an empty view.
pub fn advice_in_the_middle(ui: &mut Ui, text: &str) {
    Frame::new().inner_margin(16.0).show(ui, |ui| {
        ui.vertical_centered(|ui| {
            ui.add_space(0.45 * ui.available_height());
            ui.label(RichText::new(sentence(text)).weak());
        });
    });
}

/// A line that may follow another, as a sentence of its own: "beta is unknown" becomes "Beta is unknown". What begins with a
/// name of the set's ("left/green: ...") stays as it is.
pub fn sentence(line: &str) -> String {
    let word = line.split(' ').next().unwrap_or_default();
    let mut letters = line.chars();
    match letters.next() {
        Some(first) if word.len() > 1 && word.chars().all(|c| c.is_ascii_lowercase()) => {
            first.to_uppercase().chain(letters).collect()
        }
        _ => line.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::sentence;

    #[test]
    fn a_line_on_its_own_begins_with_a_capital_and_a_name_stays_itself() {
        assert_eq!(sentence("beta is unknown"), "Beta is unknown");
        assert_eq!(sentence("left/green: 21 % is clipped"), "left/green: 21 % is clipped");
        assert_eq!(sentence("m = 3 instead of 2"), "m = 3 instead of 2", "a symbol stays itself");
        assert_eq!(sentence(""), "");
    }
}
