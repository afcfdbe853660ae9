//! The start screen, shown while no set is open.

use std::path::PathBuf;

use eframe::egui::{
    Button, Color32, Label, Pos2, RichText, Role, ScrollArea, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo, vec2,
};

use crate::app::base::dialogs::Choose;
use crate::app::base::drops;
use crate::app::state::document::{LeftOpening, Recovered};
use crate::app::state::session::{Open, Session};
use crate::app::widgets::path_field::PathField;
use crate::app::widgets::theme::{self, Weight};

/// What a set of one's own needs, with what each photo is for.
const NEEDED: [(Needed, &str, &str); 4] = [
    (
        Needed::Object,
        "The object",
        "at least three lamps, each in two colours or more, best in 16 bits, without clipping",
    ),
    (
        Needed::GreyBall,
        "A grey ball",
        "matte, under the same lamps and colours: how strong each lamp is in each colour",
    ),
    (Needed::PaintBall, "A ball of its paint", "in the same way: how much of each colour the paint sends on"),
    (Needed::MirrorBall, "A mirror ball", "under each lamp: where the lamps are"),
];

/// A drawing beside what is needed.
#[derive(Clone, Copy)]
enum Needed {
    Object,
    GreyBall,
    PaintBall,
    MirrorBall,
}

/// Of the column in the middle, in points.
const WIDTH: f32 = 760.0;
/// Of the three ways to begin, in points.
const CHOICE: Vec2 = vec2(240.0, 40.0);
/// Of a drawing, in points.
const DRAWING: f32 = 44.0;

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
        ui.add_space(32.0);
        ui.label(RichText::new("Firstbounce").semi_bold().size(32.0));
        ui.label(RichText::new("True shape from photos of concave objects").size(16.0));
        ui.label(RichText::new("Photometric stereo, without the light between an object's own walls.").weak());
        ui.add_space(20.0);
        self.offer_recovered(ui, session, chosen);
        self.offer_left_opening(ui, session, chosen);
        self.ways(ui, session, chosen);
        ui.add_space(20.0);
        recent(ui, session, chosen);
        needed(ui);
    }

    /// The ways to begin, side by side, and the field for a path.
    fn ways(&mut self, ui: &mut Ui, session: &mut Session, chosen: &mut Option<Chosen>) {
        ui.horizontal_wrapped(|ui| {
            let demo = theme::primary(ui.visuals(), "Open the demo").min_size(CHOICE);
            let what = "A corner of blue paint under three lamps in two colours, with its calibration balls: the surface \
                        before and after, in seconds";
            if ui.add(demo).on_hover_text(what).clicked() {
                *chosen = Some(Chosen::Open(Open::Demo));
            }
            let simulate = Button::new("New simulated set...").min_size(CHOICE);
            let what =
                "Photos of a shape or mesh with a truth to compare with, and what error a rig can be expected to have";
            if ui.add(simulate).on_hover_text(what).clicked() {
                *chosen = Some(Chosen::NewSimulatedSet);
            }
        });
        ui.add_space(12.0);
        let dialogs = session.dialogs();
        let label = format!("Open a set, or a folder of photos ({})", drops::words("it"));
        let paths = self.path.ui(ui, &label, Choose::Folder, &dialogs, &mut session.jobs);
        let typed = self.path.text.trim();
        let by_button = ui.add_enabled(!typed.is_empty(), Button::new("Open this path")).clicked();
        if let Some(path) = paths.into_iter().next().or_else(|| by_button.then(|| PathBuf::from(typed))) {
            *chosen = Some(Chosen::Open(opening(path)));
        }
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

/// The sets of earlier runs, by their folders' names.
fn recent(ui: &mut Ui, session: &Session, chosen: &mut Option<Chosen>) {
    if session.preferences.recent.is_empty() {
        return;
    }
    ui.label(RichText::new("Recent sets").semi_bold());
    for folder in &session.preferences.recent {
        let path = folder.display().to_string();
        let name = folder.file_name().map_or_else(|| path.clone(), |name| name.to_string_lossy().into_owned());
        ui.horizontal(|ui| {
            let link = ui.link(RichText::new(name).size(14.0));
            link.widget_info(|| WidgetInfo::labeled(Role::Link, true, &path));
            if link.on_hover_text(&path).clicked() {
                *chosen = Some(Chosen::Open(opening(folder.clone())));
            }
            let place = folder.parent().map(|parent| format!("in {}", parent.display())).unwrap_or_default();
            ui.add(Label::new(RichText::new(place).small().weak()).truncate());
        });
    }
    ui.add_space(20.0);
}

/// What to photograph, each with a drawing.
fn needed(ui: &mut Ui) {
    ui.label(RichText::new("What to photograph for a set of your own").semi_bold());
    for (drawing, title, words) in NEEDED {
        ui.horizontal(|ui| {
            draw(ui, drawing);
            ui.vertical(|ui| {
                ui.add_space(4.0);
                ui.label(RichText::new(title).semi_bold());
                ui.label(RichText::new(words).weak());
            });
        });
    }
}

/// A ball as a lamp from the upper left lights it, or a groove.
fn draw(ui: &mut Ui, drawing: Needed) {
    let (response, painter) = ui.allocate_painter(Vec2::splat(DRAWING), Sense::hover());
    let (centre, radius) = (response.rect.center(), DRAWING / 2.0 - 4.0);
    let (paint, light) = match drawing {
        Needed::Object => {
            let at = |x: f32, y: f32| centre + vec2(x, y) * radius;
            let (left, right) = (Color32::from_rgb(70, 110, 190), Color32::from_rgb(110, 150, 225));
            let wall = |points: Vec<Pos2>, colour| Shape::convex_polygon(points, colour, Stroke::NONE);
            painter.add(wall(vec![at(-1.0, -0.7), at(0.0, -0.2), at(0.0, 0.9), at(-1.0, 0.4)], left));
            painter.add(wall(vec![at(1.0, -0.7), at(0.0, -0.2), at(0.0, 0.9), at(1.0, 0.4)], right));
            return;
        }
        Needed::GreyBall => (Color32::from_gray(110), Color32::from_gray(190)),
        Needed::PaintBall => (Color32::from_rgb(60, 96, 176), Color32::from_rgb(128, 166, 236)),
        Needed::MirrorBall => (Color32::from_gray(46), Color32::WHITE),
    };
    painter.circle_filled(centre, radius, paint);
    let spot = if matches!(drawing, Needed::MirrorBall) { 0.14 } else { 0.55 };
    painter.circle_filled(centre + vec2(-0.28, -0.28) * radius, spot * radius, light);
}

/// A folder without a capture.toml becomes a new set.
pub fn opening(path: PathBuf) -> Open {
    if path.is_dir() && !path.join("capture.toml").is_file() { Open::New(path) } else { Open::Set(path) }
}
