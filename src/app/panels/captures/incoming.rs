//! Incoming files: what each becomes by the pattern, and what the user assigns the others to.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use eframe::egui::{Button, ComboBox, Key, PopupCloseBehavior, RichText, Role, TextEdit, Ui, WidgetInfo};
use firstbounce_capture::CaptureSet;
use firstbounce_capture::set::{Became, GuessOptions, Naming, Pattern, Subject, Word, add_files, assign, propose};

use super::in_order::InOrder;
use crate::app::state::session::Session;
use crate::app::widgets::name_field::name_field;
use crate::app::widgets::part::part;

/// Files that the user dropped, before they are the set's.
pub struct Incoming {
    files: Vec<PathBuf>,
    pattern: String,
    subject: Subject,
    rgb: bool,
    by_hand: HashMap<PathBuf, Hand>,
    in_order: Option<InOrder>,
}

/// The user's assignment of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Hand {
    subject: Subject,
    light: String,
    colour: String,
}

/// What a file would become.
enum Preview {
    Mask,
    Shots(String),
    Unassigned(String),
}

impl Incoming {
    pub fn new(files: Vec<PathBuf>) -> Self {
        let proposed = propose(&files);
        let rgb = proposed.as_ref().is_some_and(|pattern| !pattern.names_colour());
        // A pattern that explains little is worse than none: every unnamed file would be a lamp of its own.
        let useful = proposed.filter(|pattern| pattern.names_colour() || pattern.names_subject());
        let rgb = rgb && useful.is_some();
        let pattern = useful.map_or_else(|| "{light}-{colour}".to_owned(), |pattern| pattern.to_string());
        Self { files, pattern, subject: Subject::Object, rgb, by_hand: HashMap::new(), in_order: None }
    }

    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    pub fn take_more(&mut self, more: Self) {
        let new: Vec<_> = more.files.into_iter().filter(|file| !self.files.contains(file)).collect();
        self.files.extend(new);
    }

    /// Shows the files; whether they are done with.
    pub fn ui(&mut self, ui: &mut Ui, session: &mut Session) -> bool {
        let document = session.document();
        ui.label(RichText::new(format!("{} to add", count_of(self.files.len()))).strong());
        let options = self.options(ui);
        let mut after = document.set.clone();
        let previews = self.apply(&mut after, options.as_ref());
        let assigned = previews.iter().filter(|preview| !matches!(preview, Preview::Unassigned(_))).count();

        let mut done = false;
        ui.horizontal_wrapped(|ui| {
            let text = format!("Add {}", count_of(assigned));
            if ui.add_enabled(assigned > 0, Button::new(text)).clicked() {
                session.edit("Add photos", |document| document.set = after.clone());
                if document.set.shots.is_empty() {
                    session.show_first_photo();
                }
                let left = previews.len() - assigned;
                if left == 0 {
                    session.done(format!("Added {}", count_of(assigned)));
                } else {
                    session.warn(format!("Added {}; {left} not assigned yet", count_of(assigned)));
                }
                let mut kept = previews.iter().map(|preview| matches!(preview, Preview::Unassigned(_)));
                self.files.retain(|_| kept.next().unwrap_or(false));
                done = self.files.is_empty();
            }
            done |= ui.button("Discard").clicked();
        });
        let unassigned = previews.len() - assigned;
        if unassigned > 0 {
            let words = if unassigned == 1 { "is not recognised" } else { "are not recognised" };
            ui.label(format!("{} {words}: change the pattern, or assign them below.", count_of(unassigned)));
            part(ui, "in order", |ui| self.order(ui, &document.set, &previews));
        }
        for (index, preview) in previews.iter().enumerate() {
            if let Some(file) = self.files.get(index).cloned() {
                part(ui, &file, |ui| self.row(ui, &document.set, &file, preview));
            }
        }
        done
    }

    /// Says at once of all files that are not assigned what they are, by their order.
    fn order(&mut self, ui: &mut Ui, set: &CaptureSet, previews: &[Preview]) {
        let open = self.files.iter().zip(previews).filter(|(_, preview)| matches!(preview, Preview::Unassigned(_)));
        let open: Vec<_> = open.map(|(file, _)| file.clone()).collect();
        let in_order = self.in_order.get_or_insert_with(|| InOrder::new(set));
        let said =
            ui.collapsing("By the order in which they were taken", |ui| in_order.ui(ui, open.len())).body_returned;
        let subject = in_order.subject;
        for (file, (light, colour)) in open.into_iter().zip(said.flatten().unwrap_or_default()) {
            self.by_hand.insert(file, Hand { subject, light, colour });
        }
    }

    /// The pattern field and what goes with it; `None` while it is no pattern.
    fn options(&mut self, ui: &mut Ui) -> Option<GuessOptions> {
        let name = ui.label("Pattern of the names");
        ui.add(TextEdit::singleline(&mut self.pattern).desired_width(f32::INFINITY)).labelled_by(name.id);
        ui.label(RichText::new("{subject}  {light}  {colour}  {repeat}  {any}, [what may be absent]").small().weak());
        let parsed = self.pattern.parse::<Pattern>();
        if let Err(error) = &parsed {
            ui.label(RichText::new(error.to_string()).color(ui.visuals().error_fg_color));
        }
        if parsed.as_ref().is_ok_and(|pattern| !pattern.names_subject()) {
            subject_box(ui, "These files show", &mut self.subject);
        }
        if parsed.as_ref().is_ok_and(|pattern| !pattern.names_colour()) {
            ui.checkbox(&mut self.rgb, "One RGB photo holds all colours");
        }
        parsed.ok().map(|pattern| GuessOptions { pattern, subject: self.subject, rgb: self.rgb })
    }

    /// Makes shots of the files in `set`; what each became.
    fn apply(&self, set: &mut CaptureSet, options: Option<&GuessOptions>) -> Vec<Preview> {
        let mut preview = |file: &PathBuf| {
            if let Some(hand) = self.by_hand.get(file) {
                return by_hand(set, file, hand);
            }
            if file.file_stem().is_some_and(|stem| stem.eq_ignore_ascii_case("mask")) {
                set.mask = Some(set.written(file));
                return Preview::Mask;
            }
            let Some(options) = options else { return Preview::Unassigned("the pattern cannot be read".into()) };
            match add_files(set, std::slice::from_ref(file), options).pop() {
                Some(Became::Shots(shots)) => Preview::Shots(described(set, &shots)),
                Some(Became::Unassigned(reason)) => Preview::Unassigned(reason),
                None => Preview::Unassigned(String::new()),
            }
        };
        self.files.iter().map(&mut preview).collect()
    }

    fn row(&mut self, ui: &mut Ui, set: &CaptureSet, file: &PathBuf, preview: &Preview) {
        let shown = short(set, file);
        match preview {
            Preview::Mask => {
                ui.label(format!("{shown}: the object's mask"));
            }
            Preview::Shots(words) => {
                ui.label(format!("{shown}: {words}"));
            }
            Preview::Unassigned(reason) => {
                ui.label(RichText::new(format!("{shown}: {reason}")).color(ui.visuals().warn_fg_color));
            }
        }
        let known = self.by_hand.contains_key(file);
        if !known && matches!(preview, Preview::Shots(_) | Preview::Mask) {
            return;
        }
        let mut hand = self.by_hand.get(file).cloned().unwrap_or_else(|| self.next_hand());
        let before = hand.clone();
        ui.horizontal_wrapped(|ui| {
            subject_box(ui, &format!("Subject of {shown}"), &mut hand.subject);
            if hand.subject.light() != Naming::Refused {
                let lights = set.lights.iter().map(|light| light.name.as_str()).chain(self.typed(|hand| &hand.light));
                name_box(ui, &format!("Light of {shown}"), &mut hand.light, lights);
                let colours =
                    set.colours.iter().map(|colour| colour.name.as_str()).chain(self.typed(|hand| &hand.colour));
                name_box(ui, &format!("Colour of {shown}"), &mut hand.colour, colours);
            }
        });
        if hand != before {
            self.by_hand.insert(file.clone(), hand);
        }
    }

    /// The next file is likely to show what the last one did.
    fn next_hand(&self) -> Hand {
        Hand { subject: self.subject, light: String::new(), colour: String::new() }
    }

    fn typed<'a>(&'a self, name: fn(&'a Hand) -> &'a String) -> impl Iterator<Item = &'a str> {
        self.files.iter().filter_map(|file| self.by_hand.get(file)).map(move |hand| name(hand).as_str())
    }
}

/// As the set names the file; one from elsewhere by its folder and its name.
fn short(set: &CaptureSet, file: &Path) -> String {
    let written = set.written(file);
    let name = |path: &Path| path.file_name().map(|name| name.to_string_lossy().into_owned());
    match (Path::new(&written).is_absolute(), file.parent().and_then(name), name(file)) {
        (true, Some(folder), Some(file)) => format!("{folder}/{file}"),
        _ => written,
    }
}

/// "1 file", "6 files"
fn count_of(files: usize) -> String {
    if files == 1 { "1 file".into() } else { format!("{files} files") }
}

fn by_hand(set: &mut CaptureSet, file: &Path, hand: &Hand) -> Preview {
    let given = |name: &String| Some(name.trim().to_owned()).filter(|name| !name.is_empty());
    let (subject, refused) = (hand.subject, Naming::Refused);
    let light = given(&hand.light).filter(|_| subject.light() != refused);
    let colour = given(&hand.colour).filter(|_| subject.colour() != refused);
    if light.is_none() && subject.light() == Naming::Required {
        return Preview::Unassigned("choose a light".into());
    }
    if colour.is_none() && subject.colour() == Naming::Required {
        return Preview::Unassigned("choose a colour".into());
    }
    let index = assign(set, file, hand.subject, light.as_deref(), colour.as_deref());
    Preview::Shots(described(set, &[index]))
}

/// "object, left, blue"
fn described(set: &CaptureSet, shots: &[usize]) -> String {
    let words = shots.iter().filter_map(|&index| set.shots.get(index)).map(|shot| {
        let subject = shot.subject.to_string();
        [Some(subject), shot.light.clone(), shot.colour.clone()].into_iter().flatten().collect::<Vec<_>>().join(", ")
    });
    words.collect::<Vec<_>>().join("; ")
}

/// A choice of what a file shows.
pub fn subject_box(ui: &mut Ui, label: &str, subject: &mut Subject) {
    let title = subject.title();
    let shown = ComboBox::from_id_salt(label).width(90.0).selected_text(title).show_ui(ui, |ui| {
        for &choice in Subject::ALL {
            ui.selectable_value(subject, choice, choice.title());
        }
    });
    let title = subject.title();
    shown.response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::ComboBox, true, label);
        info.current_text_value = Some(title.to_owned());
        info
    });
    shown.response.on_hover_text(label);
}

/// A choice among names, or a new one.
pub fn name_box<'a>(ui: &mut Ui, label: &str, name: &mut String, known: impl Iterator<Item = &'a str>) {
    // "Light of img_0001.png" asks "light?"
    let asked = label.split(' ').next().unwrap_or_default().to_lowercase();
    let text = if name.is_empty() { format!("{asked}?") } else { name.clone() };
    let mut names: Vec<&str> = Vec::new();
    known.filter(|known| !known.is_empty()).for_each(|known| {
        if !names.contains(&known) {
            names.push(known);
        }
    });
    let shown = ComboBox::from_id_salt(label)
        .width(80.0)
        .selected_text(&text)
        .close_behavior(PopupCloseBehavior::CloseOnClickOutside)
        .show_ui(ui, |ui| {
            let mut chosen = None;
            for known in names {
                if ui.selectable_label(*name == known, known).clicked() {
                    chosen = Some(known.to_owned());
                    ui.close();
                }
            }
            let heading = ui.label("New name");
            let field = name_field(ui, label, name, 100.0);
            let response = field.response.labelled_by(heading.id);
            if response.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter)) {
                ui.close();
            }
            let chosen = chosen.or(field.done);
            if let Some(chosen) = chosen {
                *name = chosen;
            }
        });
    shown.response.widget_info(|| {
        let mut info = WidgetInfo::labeled(Role::ComboBox, true, label);
        info.current_text_value = Some(text.clone());
        info
    });
    shown.response.on_hover_text(label);
}
