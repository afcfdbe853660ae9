//! The photo that is selected: its files, exposure and encoding, and what it is.

use eframe::egui::{ComboBox, RichText, Role, Ui, WidgetInfo};
use firstbounce_capture::set::{Encoding, Number, Shot};

use super::incoming::{name_box, subject_box};
use crate::app::state::layout::Shown;
use crate::app::state::results::ShotName;
use crate::app::state::session::Session;
use crate::app::widgets::number_field::up_to;

/// Everything about one shot that the user may change.
pub fn ui(ui: &mut Ui, session: &mut Session, name: &ShotName, selected: &mut Option<ShotName>) {
    let document = session.document();
    let Some(index) = document.set.shots.iter().position(|shot| ShotName::of(shot) == *name) else {
        *selected = None;
        return;
    };
    let old = &document.set.shots[index];
    let title = Shown::Photo(name.clone()).title();
    let mut new = old.clone();
    let mut remove = false;
    ui.group(|ui| {
        ui.label(RichText::new(&title).strong());
        place(ui, session, &mut new);
        let label = ui.label("Exposure, relative");
        ui.add(up_to(&mut new.exposure, 6, Number::Exposure.range()).speed(0.01)).labelled_by(label.id);
        encoding(ui, &mut new.encoding);
        let mut gone = None;
        for (place, file) in new.files.iter().enumerate() {
            ui.horizontal_wrapped(|ui| {
                ui.label(file);
                let button = ui.small_button("Remove");
                button.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("Remove {file}")));
                if button.clicked() {
                    gone = Some(place);
                }
            });
        }
        if let Some(place) = gone {
            new.files.remove(place);
        }
        ui.horizontal_wrapped(|ui| {
            remove = ui.button("Remove this photo").clicked() || new.files.is_empty();
            if ui.button("Close").clicked() {
                *selected = None;
            }
        });
    });
    if remove {
        session.edit(&format!("Remove {title}"), |document| {
            document.set.shots.remove(index);
        });
        *selected = None;
    } else if new != *old {
        let name = ShotName::of(&new);
        if document.set.shots.iter().enumerate().any(|(other, shot)| other != index && ShotName::of(shot) == name) {
            let there = Shown::Photo(name).title();
            return session.error(format!("There is a photo \"{there}\" already: remove it first, or add files to it"));
        }
        *selected = Some(name);
        session.edit(&format!("Change {title}"), |document| {
            document.set.know_names(new.light.as_deref(), new.colour.as_deref());
            document.set.shots[index] = new;
        });
    }
}

/// What the photo shows, under which light, in which colour.
fn place(ui: &mut Ui, session: &Session, shot: &mut Shot) {
    let document = session.document();
    let mut light = shot.light.clone().unwrap_or_default();
    let mut colour = shot.colour.clone().unwrap_or_default();
    ui.horizontal_wrapped(|ui| {
        subject_box(ui, "Subject of this photo", &mut shot.subject);
        let lights = document.set.lights.iter().map(|light| light.name.as_str());
        name_box(ui, "Light of this photo", &mut light, lights);
        let colours = document.set.colours.iter().map(|colour| colour.name.as_str());
        name_box(ui, "Colour of this photo", &mut colour, colours);
    });
    shot.light = Some(light).filter(|name| !name.is_empty());
    shot.colour = Some(colour).filter(|name| !name.is_empty());
}

/// The encoding of these files, where it differs from the camera's.
fn encoding(ui: &mut Ui, encoding: &mut Option<Encoding>) {
    let words = |encoding: &Option<Encoding>| match encoding {
        None => "as the camera's",
        Some(Encoding::Linear) => "linear",
        Some(Encoding::Srgb) => "sRGB",
        Some(Encoding::Gamma(_)) => "gamma",
    };
    ComboBox::from_label("Encoding of these files").selected_text(words(encoding)).show_ui(ui, |ui| {
        for choice in [None, Some(Encoding::Linear), Some(Encoding::Srgb), Some(Encoding::Gamma(2.2))] {
            ui.selectable_value(encoding, choice, words(&choice));
        }
    });
    if let Some(Encoding::Gamma(gamma)) = encoding {
        let label = ui.label("Gamma");
        ui.add(up_to(gamma, 4, Number::Gamma.range()).speed(0.01)).labelled_by(label.id);
    }
}
