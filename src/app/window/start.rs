//! The start screen, shown while no set is open.

use std::path::PathBuf;

use eframe::egui::{Button, RichText, Role, ScrollArea, Ui, WidgetInfo};

use crate::app::base::dialogs::Choose;
use crate::app::state::document::{LeftOpening, Recovered};
use crate::app::state::session::{Open, Session};
use crate::app::widgets::path_field::PathField;
use crate::app::widgets::theme::{self, Weight};

const NEEDED: [&str; 4] = [
    "photos of the object under at least three lamps, each in two colours or more, best in 16 bits, and without clipping",
    "photos of a matte grey ball under the same lamps and colours: how strong each lamp is in each colour",
    "photos of a ball of the object's own paint, in the same way: how much of each colour the paint sends on",
    "photos of a mirror ball under each lamp: where the lamps are",
];

/// Of the column in the middle, in points.
const WIDTH: f32 = 640.0;

/// What the user chose.
pub enum Chosen {
    /// A set to be opened.
    Open(Open),
    /// The window in which a set is simulated.
    NewSimulatedSet,
}

/// The start screen's own state.
#[derive(Default)]
pub struct StartScreen {
    path: PathField,
    recovered: Option<Vec<(PathBuf, Recovered)>>,
    left_opening: Option<Vec<LeftOpening>>,
}

impl StartScreen {
    /// Shows it; what was chosen in this frame.
    pub fn ui(&mut self, ui: &mut Ui, session: &mut Session) -> Option<Chosen> {
        let mut chosen = None;
        ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
            let margin = ((ui.available_width() - WIDTH) / 2.0).max(0.0);
            ui.horizontal_top(|ui| {
                ui.add_space(margin);
                ui.vertical(|ui| {
                    ui.set_max_width(WIDTH.min(ui.available_width()));
                    self.column(ui, session, &mut chosen);
                });
            });
        });
        chosen
    }

    fn column(&mut self, ui: &mut Ui, session: &mut Session, chosen: &mut Option<Chosen>) {
        ui.add_space(24.0);
        ui.label(RichText::new("Firstbounce").semi_bold().size(28.0));
        ui.label("Shape from photos under several lamps, without the light between an object's own walls.");
        ui.add_space(16.0);
        self.offer_recovered(ui, session, chosen);
        self.offer_left_opening(ui, session, chosen);

        if ui.add(theme::primary(ui.visuals(), "Open the demo")).clicked() {
            *chosen = Some(Chosen::Open(Open::Demo));
        }
        ui.label(
            "A corner of blue paint under three lamps in two colours, with its calibration balls: every step works at once.",
        );
        ui.add_space(8.0);
        if ui.button("New simulated set...").clicked() {
            *chosen = Some(Chosen::NewSimulatedSet);
        }
        ui.label(
            "Photos of a shape or mesh with a truth to compare with, and what error a rig can be expected to have.",
        );
        ui.add_space(16.0);

        let dialogs = session.dialogs();
        let label = "Open a set, or a folder of photos (you can also drop it on this window)";
        let paths = self.path.ui(ui, label, Choose::Folder, &dialogs, &mut session.jobs);
        let typed = self.path.text.trim();
        let by_button = ui.add_enabled(!typed.is_empty(), Button::new("Open this path")).clicked();
        if let Some(path) = paths.into_iter().next().or_else(|| by_button.then(|| PathBuf::from(typed))) {
            *chosen = Some(Chosen::Open(opening(path)));
        }
        ui.add_space(16.0);
        recent(ui, session, chosen);
        ui.label(RichText::new("For a set of your own you need").semi_bold());
        NEEDED.iter().for_each(|needed| {
            ui.label(format!("\u{2022} {needed}"));
        });
    }

    fn offer_recovered(&mut self, ui: &mut Ui, session: &Session, chosen: &mut Option<Chosen>) {
        let found = self.recovered.get_or_insert_with(|| session.file.recovery.found());
        let mut done = None;
        for (index, (folder, kept)) in found.iter().enumerate() {
            ui.group(|ui| {
                ui.label(format!("The last run ended before \"{}\" was saved.", kept.title));
                ui.horizontal(|ui| {
                    if ui.button(format!("Restore {}", kept.title)).clicked() {
                        *chosen = Some(Chosen::Open(Open::Recovered(folder.clone(), Box::new(kept.clone()))));
                        done = Some(index);
                    }
                    if ui.button(format!("Discard {}", kept.title)).clicked() {
                        session.file.recovery.discard(folder);
                        done = Some(index);
                    }
                });
            });
            ui.add_space(8.0);
        }
        if let Some(index) = done {
            found.remove(index);
        }
    }

    /// Sets that were open when a run did not end in order: each may have been why.
    fn offer_left_opening(&mut self, ui: &mut Ui, session: &mut Session, chosen: &mut Option<Chosen>) {
        let left = self.left_opening.get_or_insert_with(|| session.file.recovery.left_opening());
        let mut done = None;
        let mut offered: Vec<&PathBuf> = Vec::new();
        for LeftOpening { set, .. } in &*left {
            if offered.contains(&set) {
                continue;
            }
            offered.push(set);
            let shown = set.display().to_string();
            ui.group(|ui| {
                ui.label(format!("The last run did not end well while {shown} was open."));
                ui.horizontal(|ui| {
                    if button_for(ui, "Open", &shown) {
                        *chosen = Some(Chosen::Open(Open::Set(set.clone())));
                        done = Some(set.clone());
                    }
                    if button_for(ui, "Not now", &shown) {
                        done = Some(set.clone());
                    }
                });
            });
            ui.add_space(8.0);
        }
        let Some(set) = done else { return };
        left.iter().filter(|left| left.set == set).for_each(|left| session.file.recovery.forget_opening(left));
        left.retain(|left| left.set != set);
        session.forget_last_open(&set);
    }
}

/// A button whose name says what it acts on; whether it was pressed.
fn button_for(ui: &mut Ui, text: &str, object: &str) -> bool {
    let button = ui.button(text);
    button.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("{text}: {object}")));
    button.clicked()
}

fn recent(ui: &mut Ui, session: &Session, chosen: &mut Option<Chosen>) {
    if session.preferences.recent.is_empty() {
        return;
    }
    ui.label(RichText::new("Recent sets").semi_bold());
    for folder in &session.preferences.recent {
        if ui.link(folder.display().to_string()).clicked() {
            *chosen = Some(Chosen::Open(opening(folder.clone())));
        }
    }
    ui.add_space(16.0);
}

/// A folder without a capture.toml becomes a new set.
pub fn opening(path: PathBuf) -> Open {
    if path.is_dir() && !path.join("capture.toml").is_file() { Open::New(path) } else { Open::Set(path) }
}
