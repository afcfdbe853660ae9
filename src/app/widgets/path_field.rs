//! A field to type a path into, with a button that opens the system's dialog.

use std::path::PathBuf;
use std::sync::Arc;

use eframe::egui::{Key, TextEdit, Ui};

use crate::app::base::dialogs::{Choose, Dialogs};
use crate::app::base::jobs::{Jobs, Task};

/// What is typed, and the dialog that is open.
#[derive(Default)]
pub struct PathField {
    /// What is typed.
    pub text: String,
    asking: Option<Task<Vec<PathBuf>>>,
}

impl PathField {
    /// A field in which this is typed already.
    pub fn holding(text: impl Into<String>) -> Self {
        Self { text: text.into(), asking: None }
    }

    /// Shows the field under `label` and a button "Browse"; the paths that were chosen in this frame, by Enter or in the
    /// dialog.
    pub fn ui(
        &mut self,
        ui: &mut Ui,
        label: &str,
        choose: Choose,
        dialogs: &Arc<dyn Dialogs>,
        jobs: &mut Jobs,
    ) -> Vec<PathBuf> {
        let mut chosen = Vec::new();
        let name = ui.label(label);
        ui.horizontal(|ui| {
            let width = (ui.available_width() - 80.0).max(80.0);
            let field = ui.add(TextEdit::singleline(&mut self.text).desired_width(width)).labelled_by(name.id);
            if field.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter)) && !self.text.trim().is_empty() {
                chosen.push(PathBuf::from(self.text.trim()));
            }
            let waits = self.asking.is_some();
            if ui.add_enabled(!waits, eframe::egui::Button::new("Browse...")).clicked() {
                let (dialogs, title) = (dialogs.clone(), label.to_owned());
                let near = PathBuf::from(self.text.trim());
                self.asking = Some(jobs.compute(title.clone(), move |_| dialogs.ask(choose, &title, &near)));
            }
        });
        if let Some(answer) = self.asking.as_ref().and_then(Task::poll) {
            self.asking = None;
            // A dialog that broke is one that was cancelled: the field is still there.
            let paths = answer.unwrap_or_default();
            if let Some(first) = paths.first() {
                self.text = first.display().to_string();
            }
            chosen.extend(paths);
        }
        chosen
    }
}
