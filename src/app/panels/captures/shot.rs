//! The photo that is selected: its files, exposure and encoding, and what it is.

use eframe::egui::{RichText, Role, Ui, WidgetInfo};
use firstbounce_capture::set::{Number, Shot};

use super::camera::{encoding_box, optional};
use super::incoming::{name_box, subject_box};
use crate::app::state::layout::Shown;
use crate::app::state::results::ShotName;
use crate::app::state::session::Session;
use crate::app::widgets::theme::Weight;

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
        ui.label(RichText::new(&title).semi_bold());
        place(ui, session, &mut new);
        optional(
            ui,
            "Exposure, relative",
            "Exposure as the files say, else 1",
            (Number::Exposure, &mut new.exposure, 1.0),
        );
        encoding_box(ui, "Encoding of these files", "as the camera's", &mut new.encoding);
        let mut gone = None;
        let loaded = session.results.loaded();
        let said = loaded.as_ref().and_then(|loaded| loaded.shot(name)).map_or(&[][..], |shot| &shot.files);
        for (place, file) in new.files.iter().enumerate() {
            ui.horizontal_wrapped(|ui| {
                ui.label(file);
                if let Some(said) = said.get(place).filter(|said| !said.is_empty()) {
                    ui.label(RichText::new(said).small());
                }
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
