//! "New simulated set": a shape or mesh is lit and photographed in memory, previewed while the user changes it, judged
//! by the planner, and written as a capture set.

mod form;
mod live;
mod mesh;
mod plan;
mod preview;
mod values;

use std::path::PathBuf;
use std::sync::Arc;

use eframe::egui::{CentralPanel, Context, Panel, ProgressBar, ScrollArea, Ui, Window};
use firstbounce_lab::simulate::{SimulateOptions, check_folder, simulate, write_simulated};

use crate::app::base::dialogs::Choose;
use crate::app::base::jobs::JobError;
use crate::app::base::keyed::Keyed;
use crate::app::state::session::{Open, Session};
use crate::app::widgets::path_field::PathField;
use crate::app::widgets::theme;
use live::Live;
use mesh::MeshChoice;
use plan::{PlanFor, Planned};
use preview::{Preview, Previewer, Shown};
use values::{Values, ValuesError};

/// Of the window, in points; smaller where the program's own window is.
const SIZE: [f32; 2] = [1060.0, 700.0];
const FORM_WIDTH: f32 = 350.0;

/// The window of a set that is to be simulated. What was chosen stays when it is closed.
#[derive(Default)]
pub struct NewSet {
    is_open: bool,
    values: Values,
    mesh: MeshChoice,
    folder: PathField,
    /// The values and the mesh that `options` were made of.
    made_of: Option<(Values, u64)>,
    options: Option<Result<Arc<SimulateOptions>, ValuesError>>,
    preview: Live<SimulateOptions, Preview>,
    previewer: Previewer,
    shown: Shown,
    plan: Live<PlanFor, Planned>,
    making: Keyed<PathBuf, ()>,
    /// Why the last set was not made.
    refused: Option<JobError>,
}

impl NewSet {
    /// Shows the window from now on.
    pub fn open(&mut self) {
        self.is_open = true;
    }

    /// Lets go of what was drawn by a card that is gone.
    pub fn forget_card(&mut self) {
        self.shown = Shown::default();
    }

    /// Shows the window while it is open; a set that has been made.
    pub fn ui(&mut self, context: &Context, session: &mut Session) -> Option<Open> {
        let made = self.take_made(session);
        if !self.is_open {
            return made;
        }
        self.update(context, session);
        let room = context.content_rect().size();
        let size = [SIZE[0].min(room.x - 40.0), SIZE[1].min(room.y - 60.0)];
        let mut is_open = true;
        Window::new("New simulated set").open(&mut is_open).default_size(size).vscroll(false).show(context, |ui| {
            Panel::bottom("simulated set: make").show(ui, |ui| self.make(ui, session));
            Panel::left("simulated set: options").default_size(FORM_WIDTH).show(ui, |ui| {
                ScrollArea::vertical().id_salt("options").auto_shrink(false).show(ui, |ui| {
                    form::ui(ui, &mut self.values, &mut self.mesh, session);
                });
            });
            CentralPanel::default().show(ui, |ui| {
                ScrollArea::vertical().id_salt("outcome").auto_shrink(false).show(ui, |ui| {
                    preview::ui(ui, &self.preview, &mut self.shown);
                    ui.separator();
                    plan::ui(ui, &self.plan, &mut self.values);
                });
            });
        });
        self.is_open = is_open && made.is_none();
        if !self.is_open {
            self.preview.stop();
            self.plan.stop();
        }
        made
    }

    /// Takes what is finished and starts what the choices ask for.
    fn update(&mut self, context: &Context, session: &mut Session) {
        self.mesh.update(&self.values, session);
        let made_of = (self.values.clone(), self.mesh.generation());
        if self.made_of.as_ref() != Some(&made_of) {
            let options = self.values.options(&self.mesh);
            if let Ok(options) = &options {
                self.preview.want(preview::small(options), context);
                self.plan.want(PlanFor::new(options, self.values.order()), context);
            }
            self.options = Some(options.map(Arc::new));
            self.made_of = Some(made_of);
            self.refused = None;
        }
        // Half a picture of a set that cannot be made is no use.
        if matches!(self.options, Some(Err(_))) {
            self.preview.stop();
            self.plan.stop();
            return;
        }
        let previewer = self.previewer.clone();
        self.preview.update(context, &mut session.jobs, "Preview", move |options, job| previewer.preview(options, job));
        // The picture comes first: both would wait for the same cores.
        if self.preview.is_at_rest() {
            self.plan.update(context, &mut session.jobs, "Plan the rig", plan::compute);
        }
    }

    fn make(&mut self, ui: &mut Ui, session: &mut Session) {
        ui.add_space(4.0);
        let dialogs = session.dialogs();
        self.folder.ui(ui, "Folder of the simulated set", Choose::Folder, &dialogs, &mut session.jobs);
        let folder = self.folder.text.trim().to_owned();
        let options = self.options.as_ref().and_then(|options| options.as_ref().ok()).cloned();
        let can_make = options.is_some() && !folder.is_empty() && self.making.running().is_none();
        ui.horizontal(|ui| {
            let button = ui.add_enabled(can_make, theme::primary(ui.visuals(), "Make this set"));
            if let Some(options) = options.filter(|_| button.clicked()) {
                self.start(PathBuf::from(&folder), options, session);
            }
            if let Some(job) = self.making.running() {
                ui.add(ProgressBar::new(job.fraction()).desired_width(220.0).text(job.name()));
                if ui.button("Cancel the simulation").clicked() {
                    job.cancel();
                }
            } else if folder.is_empty() {
                ui.label("Name a new or empty folder for its photos, capture.toml and truth.");
            }
        });
        if let Some(line) = self.error() {
            ui.colored_label(ui.visuals().error_fg_color, line);
        }
    }

    /// The one line that says why something is not there.
    fn error(&self) -> Option<String> {
        let options = self.options.as_ref().and_then(|options| options.as_ref().err()).map(ToString::to_string);
        let refused = || self.refused.as_ref().map(ToString::to_string);
        options.or_else(refused).or_else(|| Some(self.preview.error().or(self.plan.error())?.to_string()))
    }

    fn start(&mut self, folder: PathBuf, options: Arc<SimulateOptions>, session: &mut Session) {
        let folder = std::path::absolute(&folder).unwrap_or(folder);
        let target = folder.clone();
        self.refused = None;
        let task = session.jobs.start("Simulate a set", move |job| {
            check_folder(&target)?;
            write_simulated(&simulate(&options, job)?, &target)
        });
        self.making.start(folder, task);
    }

    fn take_made(&mut self, session: &mut Session) -> Option<Open> {
        let (folder, outcome) = self.making.take()?;
        match outcome {
            Ok(_) => {
                session.done(format!("Simulated a set into {}", folder.display()));
                Some(Open::Set(folder))
            }
            // With the window closed there is another place to say it.
            Err(error) if !self.is_open => {
                session.error(error.to_string());
                None
            }
            Err(error) => {
                self.refused = Some(error);
                None
            }
        }
    }
}
