//! The set's name, its lights and its colours.

use eframe::egui::{Button, ComboBox, Role, TextEdit, Ui, WidgetInfo};
use firstbounce_capture::set::{CaptureSet, Channel, Word};

use crate::app::state::session::Session;
use crate::app::widgets::name_field::{NameField, name_field};

/// Names to change, channels to choose, and what no shot uses to take away.
pub fn ui(ui: &mut Ui, session: &mut Session) {
    ui.collapsing("Names, lights and colours", |ui| {
        let document = session.document();
        let set = &document.set;
        let label = ui.label("Name of the set");
        let mut name = set.name.clone();
        if ui.add(TextEdit::singleline(&mut name)).labelled_by(label.id).changed() {
            session.edit("Name the set", |document| document.set.name = name);
        }
        ui.label("Lights");
        for (index, light) in set.lights.iter().enumerate() {
            let used = set.shots.iter().any(|shot| shot.light.as_ref() == Some(&light.name));
            ui.horizontal_wrapped(|ui| match named(ui, "Light", index, &light.name, used) {
                Some(Change::Name(name)) => rename_light(session, index, &name),
                Some(Change::Remove) => session.edit("Remove light", |document| {
                    remove_light(&mut document.set, index);
                }),
                None => {}
            });
        }
        ui.label("Colours; the first is the reference");
        for (index, colour) in set.colours.iter().enumerate() {
            let used = set.shots.iter().any(|shot| shot.colour.as_ref() == Some(&colour.name));
            ui.horizontal_wrapped(|ui| {
                match named(ui, "Colour", index, &colour.name, used) {
                    Some(Change::Name(name)) => rename_colour(session, index, &name),
                    Some(Change::Remove) => session.edit("Remove colour", |document| {
                        document.set.colours.remove(index);
                    }),
                    None => {}
                }
                let mut channel = colour.channel;
                channel_box(ui, &format!("Channel of {}", colour.name), &mut channel);
                if channel != colour.channel {
                    session.edit("Choose channel", |document| document.set.colours[index].channel = channel);
                }
                if index > 0 && ui.small_button(format!("Make {} the reference", colour.name)).clicked() {
                    session.edit("Choose reference colour", |document| refer_to(&mut document.set, index));
                }
            });
        }
    });
}

enum Change {
    Name(String),
    Remove,
}

fn named(ui: &mut Ui, what: &str, index: usize, name: &str, used: bool) -> Option<Change> {
    let NameField { response, text, done } = name_field(ui, (what, index), name, 90.0);
    response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::TextInput, true, format!("{what} {}", index + 1));
        info.current_text_value = Some(text.clone());
        info
    });
    let remove = ui.add_enabled(!used, Button::new("Remove").small());
    remove.widget_info(|| WidgetInfo::labeled(Role::Button, !used, format!("Remove {what} {name}")));
    let removed = remove.on_disabled_hover_text("Photos use it").clicked().then_some(Change::Remove);
    done.filter(|name| !name.is_empty()).map(Change::Name).or(removed)
}

fn rename_light(session: &mut Session, index: usize, name: &str) {
    let document = session.document();
    if document.set.light_index(name).is_some() {
        return session.error(format!("There is a light \"{name}\" already: choose another name"));
    }
    session.edit("Rename light", |document| document.set.rename_light(index, name));
}

fn rename_colour(session: &mut Session, index: usize, name: &str) {
    if session.document().set.colour_index(name).is_some() {
        return session.error(format!("There is a colour \"{name}\" already: choose another name"));
    }
    session.edit("Rename colour", |document| document.set.rename_colour(index, name));
}

fn channel_box(ui: &mut Ui, label: &str, channel: &mut Channel) {
    let shown = ComboBox::from_id_salt(label).width(60.0).selected_text(channel.word()).show_ui(ui, |ui| {
        for &choice in Channel::ALL {
            ui.selectable_value(channel, choice, choice.word());
        }
    });
    shown.response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, label));
    shown.response.on_hover_text("The channel of the files that holds this colour; grey is the mean of all");
}

fn remove_light(set: &mut CaptureSet, index: usize) {
    let light = set.lights.remove(index);
    set.calibration.alpha.shift_remove(&light.name);
    set.calibration.direction.shift_remove(&light.name);
    set.calibration.intensity.shift_remove(&light.name);
    set.shape.leave_out.retain(|other| *other != light.name);
}

/// Puts a colour first. Given ratios count by the reference colour: they are carried over to the new one.
fn refer_to(set: &mut CaptureSet, index: usize) {
    let old = set.clone();
    let colour = set.colours.remove(index);
    set.colours.insert(0, colour);
    set.calibration.beta = None;
    set.calibration.alpha.clear();
    set.calibration.intensity.clear();
    set.use_rig(&old, &old.calibration, true);
}
