//! What the names of incoming files leave in doubt, asked once for all files that it concerns.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use eframe::egui::{ComboBox, Role, Ui, WidgetInfo};
use firstbounce_capture::set::{Doubt, Subject, Word};

/// The user's answers.
#[derive(Clone, Debug, Default)]
pub struct Questions {
    /// What the files of a folder show.
    pub folders: HashMap<PathBuf, Subject>,
    /// Whether words that are none for a colour are colours all the same.
    pub any_colour: bool,
}

/// Asks about the files that are in doubt, among all that came in.
pub fn questions(ui: &mut Ui, files: &[PathBuf], doubts: &[(&Path, &Doubt)], answers: &mut Questions) {
    let mut words: Vec<&str> = Vec::new();
    let mut folders: Vec<&Path> = Vec::new();
    for (file, doubt) in doubts {
        match doubt {
            Doubt::NoColourWord(word) if !words.contains(&word.as_str()) => words.push(word),
            Doubt::SameNames { folders: same } => folders.extend(same.iter().map(PathBuf::as_path)),
            Doubt::SomeBall => folders.extend(file.parent().filter(|folder| all_are_balls(folder, files, doubts))),
            _ => {}
        }
    }
    // What was answered stays to be changed.
    folders.extend(answers.folders.keys().map(PathBuf::as_path));
    let mut folders: Vec<PathBuf> = folders.into_iter().map(Path::to_owned).collect();
    folders.sort();
    folders.dedup();
    for folder in folders {
        folder_box(ui, &folder, answers);
    }
    if !words.is_empty() {
        ui.checkbox(&mut answers.any_colour, format!("These are colours: {}", words.join(", ")));
    }
}

/// Whether every file of a folder shows a ball of an unknown kind: the folder's name says so, or that of each.
fn all_are_balls(folder: &Path, files: &[PathBuf], doubts: &[(&Path, &Doubt)]) -> bool {
    let is_ball = |file: &PathBuf| doubts.iter().any(|(path, doubt)| path == file && **doubt == Doubt::SomeBall);
    files.iter().filter(|file| file.parent() == Some(folder)).all(is_ball)
}

fn folder_box(ui: &mut Ui, folder: &Path, answers: &mut Questions) {
    let name =
        folder.file_name().map_or_else(|| folder.display().to_string(), |name| name.to_string_lossy().into_owned());
    let label = format!("Folder {name} shows");
    ui.horizontal_wrapped(|ui| {
        ui.label(&label);
        let mut chosen = answers.folders.get(folder).copied();
        let title = |chosen: Option<Subject>| chosen.map_or("choose", Subject::title);
        let shown = ComboBox::from_id_salt(folder).width(90.0).selected_text(title(chosen)).show_ui(ui, |ui| {
            for &choice in Subject::ALL {
                ui.selectable_value(&mut chosen, Some(choice), choice.title());
            }
        });
        shown.response.widget_info(|| {
            let mut info = WidgetInfo::labeled(Role::ComboBox, true, &label);
            info.current_text_value = Some(title(chosen).to_owned());
            info
        });
        if let Some(chosen) = chosen {
            answers.folders.insert(folder.to_owned(), chosen);
        }
    });
}
