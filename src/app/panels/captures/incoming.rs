//! Incoming files: what each becomes by the pattern, and what the user assigns the others to.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use eframe::egui::load::SizedTexture;
use eframe::egui::{ComboBox, ImageSource, Key, PopupCloseBehavior, RichText, Role, TextEdit, Ui, WidgetInfo};
use egui_extras::{Column, TableBuilder};
use firstbounce_capture::CaptureSet;
use firstbounce_capture::image_file::{TimeTaken, time_taken};
use firstbounce_capture::set::{
    Doubt, GuessOptions, Naming, Pattern, PatternError, Subject, Word, assign, is_mask_name, plan, propose, put,
};

use super::in_order::{InOrder, InPlace};
use super::questions::{Questions, questions};
use super::thumbnails::Thumbnails;
use crate::app::state::session::Session;
use crate::app::widgets::name_field::name_field;
use crate::app::widgets::part::part;
use crate::app::widgets::theme::{Weight, primary};

/// Of a row and its small picture, in points.
const THUMBNAIL: f32 = 52.0;

/// Files that the user dropped, before they are the set's.
pub struct Incoming {
    files: Vec<PathBuf>,
    /// When each was taken, as far as that is known.
    times: HashMap<PathBuf, TimeTaken>,
    /// The pattern as the user writes it, and as it is read.
    pattern: (String, Result<Pattern, PatternError>),
    subject: Subject,
    rgb: bool,
    questions: Questions,
    /// The user's assignment of a file.
    by_hand: HashMap<PathBuf, InPlace>,
    in_order: Option<InOrder>,
    thumbnails: Thumbnails,
    /// The set with the files that are assigned, and what each file is, as of this frame.
    after: CaptureSet,
    previews: Vec<Preview>,
}

/// What a file would become.
enum Preview {
    Mask,
    Shots(String),
    Unassigned(Open),
}

/// Why a file would become nothing.
enum Open {
    NoPattern,
    SecondMask,
    /// The user has begun to say what it is.
    Lacks(&'static str),
    Doubt(Doubt),
}

impl Open {
    fn words(&self) -> String {
        match self {
            Self::NoPattern => "the pattern cannot be read".into(),
            Self::SecondMask => "a second mask: the set has one".into(),
            Self::Lacks(name) => format!("choose a {name}"),
            Self::Doubt(doubt) => doubt.to_string(),
        }
    }
}

impl Incoming {
    pub fn new(files: Vec<PathBuf>) -> Self {
        let proposed = propose(&files);
        let rgb = proposed.as_ref().is_some_and(|pattern| !pattern.names_colour());
        let text = proposed.map_or_else(|| "{light}-{colour}".to_owned(), |pattern| pattern.to_string());
        let pattern = (text.clone(), text.parse());
        let times = files.iter().filter_map(|file| Some((file.clone(), time_taken(file)?))).collect();
        let questions = Questions::default();
        Self {
            files,
            times,
            pattern,
            subject: Subject::Object,
            rgb,
            questions,
            by_hand: HashMap::new(),
            in_order: None,
            thumbnails: Thumbnails::default(),
            after: CaptureSet::default(),
            previews: Vec::new(),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }

    pub fn take_more(&mut self, more: Self) {
        let new: Vec<_> = more.files.into_iter().filter(|file| !self.files.contains(file)).collect();
        self.files.extend(new);
        self.times.extend(more.times);
    }

    /// Works out what each file is. Once a frame, before anything of it is shown.
    pub fn update(&mut self, set: &CaptureSet) {
        let options = self.guess_options();
        let mut after = set.clone();
        self.previews = self.apply(&mut after, options.as_ref());
        self.after = after;
    }

    fn assigned(&self) -> usize {
        self.previews.iter().filter(|preview| !matches!(preview, Preview::Unassigned(_))).count()
    }

    /// What holds for many files at once.
    pub fn ui(&mut self, ui: &mut Ui, session: &Session) {
        ui.label(RichText::new(format!("{} to add", count_of(self.files.len()))).semi_bold());
        self.options(ui);
        let doubts: Vec<(&Path, &Doubt)> =
            self.files.iter().map(PathBuf::as_path).zip(&self.previews).filter_map(doubt).collect();
        part(ui, "questions", |ui| questions(ui, &self.files, &doubts, &mut self.questions));
        let unassigned = self.previews.len() - self.assigned();
        if unassigned > 0 {
            let words = if unassigned == 1 { "is not recognised" } else { "are not recognised" };
            ui.label(format!("{} {words}: change the pattern, or assign them in the table.", count_of(unassigned)));
            part(ui, "in order", |ui| self.order(ui, &session.document().set));
        }
    }

    /// The buttons that add or forget the files; whether they are done with.
    pub fn buttons(&mut self, ui: &mut Ui, session: &mut Session) -> bool {
        let assigned = self.assigned();
        let add = primary(ui.visuals(), format!("Add {}", count_of(assigned)));
        let mut done = false;
        if ui.add_enabled(assigned > 0, add).clicked() {
            session.edit("Add photos", |document| document.set = self.after.clone());
            let left = self.previews.len() - assigned;
            if left == 0 {
                session.done(format!("Added {}", count_of(assigned)));
            } else {
                session.warn(format!("Added {}; {left} not assigned yet", count_of(assigned)));
            }
            let mut kept = self.previews.iter().map(|preview| matches!(preview, Preview::Unassigned(_)));
            self.files.retain(|_| kept.next().unwrap_or(false));
            self.previews.clear();
            done = self.files.is_empty();
        }
        done | ui.button("Discard").clicked()
    }

    /// Every file with a small picture: what it is, and what it may be.
    pub fn table(&mut self, ui: &mut Ui, session: &mut Session) {
        let previews = std::mem::take(&mut self.previews);
        let set = session.document().set.clone();
        let narrow = Column::exact(THUMBNAIL);
        let table = TableBuilder::new(ui).striped(true).column(narrow).column(Column::remainder().clip(true));
        table.body(|body| {
            body.rows(THUMBNAIL, self.files.len().min(previews.len()), |mut row| {
                let index = row.index();
                let file = self.files[index].clone();
                row.col(|ui| {
                    if let Some(small) = self.thumbnails.of(&file, ui, &mut session.jobs) {
                        let size = small.size_vec2();
                        let points = size * ((THUMBNAIL - 4.0) / size.max_elem().max(1.0));
                        ui.image(ImageSource::Texture(SizedTexture::new(small.id(), points)));
                    }
                });
                row.col(|ui| part(ui, &file, |ui| self.row(ui, &set, &file, &previews[index])));
            });
        });
        self.previews = previews;
    }

    /// Says at once of all files that are not assigned what they are, by their order.
    fn order(&mut self, ui: &mut Ui, set: &CaptureSet) {
        let open =
            self.files.iter().zip(&self.previews).filter(|(_, preview)| matches!(preview, Preview::Unassigned(_)));
        let open: Vec<_> = open.map(|(file, _)| file.clone()).collect();
        let in_order = self.in_order.get_or_insert_with(|| InOrder::new(set, &open));
        let title = "By the order in which they were taken";
        let said = ui.collapsing(title, |ui| in_order.ui(ui, &open, &self.times)).body_returned;
        self.by_hand.extend(said.flatten().unwrap_or_default());
    }

    /// The pattern field and what goes with it.
    fn options(&mut self, ui: &mut Ui) {
        let name = ui.label("Pattern of the names");
        let (text, parsed) = &mut self.pattern;
        if ui.add(TextEdit::singleline(text).desired_width(f32::INFINITY)).labelled_by(name.id).changed() {
            *parsed = text.parse();
        }
        ui.label(RichText::new("{subject}  {light}  {colour}  {repeat}  {any}, [what may be absent]").small().weak());
        if let Err(error) = parsed {
            ui.label(RichText::new(error.to_string()).color(ui.visuals().error_fg_color));
        }
        if parsed.as_ref().is_ok_and(|pattern| !pattern.names_subject()) {
            subject_box(ui, "These files show", &mut self.subject);
        }
        if parsed.as_ref().is_ok_and(|pattern| !pattern.names_colour()) {
            ui.checkbox(&mut self.rgb, "One RGB photo holds all colours");
        }
    }

    /// `None` while the pattern is none.
    fn guess_options(&self) -> Option<GuessOptions> {
        let Questions { folders, any_colour } = self.questions.clone();
        self.pattern.1.clone().ok().map(|pattern| GuessOptions {
            pattern,
            subject: self.subject,
            rgb: self.rgb,
            any_colour,
            folders,
        })
    }

    /// Makes shots of the files in `set`; what each became.
    fn apply(&self, set: &mut CaptureSet, options: Option<&GuessOptions>) -> Vec<Preview> {
        let is_read = |file: &&PathBuf| !self.by_hand.contains_key(*file) && !is_mask_name(file);
        let read: Vec<&PathBuf> = self.files.iter().filter(is_read).collect();
        let mut places = options.map(|options| plan(set, &read, options)).unwrap_or_default().into_iter();
        let mut has_mask = false;
        let mut preview = |file: &PathBuf| {
            if let Some(hand) = self.by_hand.get(file) {
                return by_hand(set, file, hand);
            }
            if is_mask_name(file) {
                if std::mem::replace(&mut has_mask, true) {
                    return Preview::Unassigned(Open::SecondMask);
                }
                set.mask = Some(set.written(file));
                return Preview::Mask;
            }
            match places.next() {
                Some(Ok(place)) => {
                    let shots = put(set, file, &place);
                    Preview::Shots(described(set, &shots))
                }
                Some(Err(doubt)) => Preview::Unassigned(Open::Doubt(doubt)),
                None => Preview::Unassigned(Open::NoPattern),
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
            Preview::Unassigned(open) => {
                ui.label(RichText::new(format!("{shown}: {}", open.words())).color(ui.visuals().warn_fg_color));
            }
        }
        let mut hand = self.by_hand.get(file).cloned().unwrap_or_else(|| self.read(file));
        let before = hand.clone();
        ui.horizontal(|ui| {
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

    /// What a file is by its name or its place; the next is likely to show what the last one did.
    fn read(&self, file: &Path) -> InPlace {
        let written = self.after.written(file);
        let shot = self.after.shots.iter().find(|shot| shot.files.contains(&written));
        match shot {
            Some(shot) => InPlace {
                subject: shot.subject,
                light: shot.light.clone().unwrap_or_default(),
                colour: shot.colour.clone().unwrap_or_default(),
            },
            None => InPlace { subject: self.subject, light: String::new(), colour: String::new() },
        }
    }

    fn typed<'a>(&'a self, name: fn(&'a InPlace) -> &'a String) -> impl Iterator<Item = &'a str> {
        self.files.iter().filter_map(|file| self.by_hand.get(file)).map(move |hand| name(hand).as_str())
    }
}

fn doubt<'p>((file, preview): (&'p Path, &'p Preview)) -> Option<(&'p Path, &'p Doubt)> {
    match preview {
        Preview::Unassigned(Open::Doubt(doubt)) => Some((file, doubt)),
        Preview::Unassigned(_) | Preview::Mask | Preview::Shots(_) => None,
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

fn by_hand(set: &mut CaptureSet, file: &Path, hand: &InPlace) -> Preview {
    let given = |name: &String| Some(name.trim().to_owned()).filter(|name| !name.is_empty());
    let (subject, refused) = (hand.subject, Naming::Refused);
    let light = given(&hand.light).filter(|_| subject.light() != refused);
    let colour = given(&hand.colour).filter(|_| subject.colour() != refused);
    if light.is_none() && subject.light() == Naming::Required {
        return Preview::Unassigned(Open::Lacks("light"));
    }
    if colour.is_none() && subject.colour() == Naming::Required {
        return Preview::Unassigned(Open::Lacks("colour"));
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
