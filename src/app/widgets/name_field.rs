//! A field for a name, which is taken over when it is typed to its end: on the way it may be that of another.

use std::hash::Hash;

use eframe::egui::{Key, Response, TextEdit, Ui};

/// A field of this frame.
pub struct NameField {
    /// The widget; it has no accessible name yet.
    pub response: Response,
    /// Its text.
    pub text: String,
    /// Another name, once the field is left, unless it is given up by Escape.
    pub done: Option<String>,
}

/// Shows a field that holds `name` until the user types; `salt` distinguishes it from others in this place.
pub fn name_field(ui: &mut Ui, salt: impl Hash + std::fmt::Debug, name: &str, width: f32) -> NameField {
    let kept = ui.scope_id().with(("typed name", salt));
    let mut text = ui.data(|data| data.get_temp::<String>(kept)).unwrap_or_else(|| name.to_owned());
    let response = ui.add(TextEdit::singleline(&mut text).desired_width(width));
    if response.lost_focus() {
        ui.data_mut(|data| data.remove::<String>(kept));
    } else if response.changed() {
        ui.data_mut(|data| data.insert_temp(kept, text.clone()));
    }
    let left = response.lost_focus() && !ui.input(|input| input.key_pressed(Key::Escape));
    let done = Some(text.trim().to_owned()).filter(|typed| left && typed != name);
    NameField { response, text, done }
}
