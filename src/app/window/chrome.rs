//! The chrome of the window, over and around panels and views: palette, help, questions, notices.

use eframe::egui::{Context, Id, Modal, Panel, Ui, ViewportCommand, Window};

use super::frame_times::FrameTimes;
use super::pages::Pages;
use crate::app::base::dialogs::Choose;
use crate::app::state::session::{Open, Session};
use crate::app::widgets::path_field::PathField;
use crate::app::window::commands::{HelpSheet, Palette};
use crate::app::window::device::DeviceWatch;
use crate::app::window::simulate::NewSet;

/// What is open around the panels.
pub struct Chrome {
    /// Which parts of the window are shown.
    pub shows: Parts,
    /// Commands by their letters.
    pub palette: Palette,
    /// Commands with their keys.
    pub help: HelpSheet,
    /// What each step is for.
    pub pages: Pages,
    /// How long frames take.
    pub frame_times: FrameTimes,
    /// What is to be simulated.
    pub simulated: NewSet,
    /// What the window draws with.
    pub device: DeviceWatch,
    pub(super) focused: Option<Id>,
    save_as: Option<PathField>,
    leaving: Option<Leaving>,
    may_close: bool,
}

/// The parts of the window that can be hidden: whether each is shown.
pub struct Parts {
    /// The panel of the step at the left.
    pub steps: bool,
    /// The inspector at the right.
    pub inspector: bool,
    /// The log below.
    pub log: bool,
    /// The window about the program.
    pub about: bool,
}

/// What waits for an answer about unsaved edits.
#[derive(Debug)]
enum Leaving {
    /// For the start screen.
    Set,
    /// For another set.
    For(Open),
    Program,
}

impl Default for Chrome {
    fn default() -> Self {
        Self {
            shows: Parts { steps: true, inspector: true, log: false, about: false },
            palette: Palette::default(),
            help: HelpSheet::default(),
            pages: Pages::default(),
            frame_times: FrameTimes::default(),
            simulated: NewSet::default(),
            device: DeviceWatch::default(),
            focused: None,
            save_as: None,
            leaving: None,
            may_close: false,
        }
    }
}

impl Chrome {
    /// Leaves the open set for the start screen, after asking about unsaved edits.
    pub fn leave_set(&mut self, session: &mut Session) {
        if session.is_open() && session.editor.is_dirty() {
            self.leaving = Some(Leaving::Set);
        } else {
            session.leave();
        }
    }

    /// Opens a set in place of the one that is open, after asking about unsaved edits.
    pub fn open_set(&mut self, session: &mut Session, open: Open) {
        if session.is_open() && session.editor.is_dirty() {
            self.leaving = Some(Leaving::For(open));
        } else {
            session.open(open);
        }
    }

    /// Asks for the folder to save into.
    pub fn ask_save_as(&mut self, session: &Session) {
        self.save_as = Some(PathField::holding(session.document().set.folder.display().to_string()));
    }

    /// Keeps the window open while something is unsaved, until the user decides what to do with it.
    pub fn guard_close(&mut self, context: &Context, session: &mut Session) {
        if context.input(|input| input.viewport().close_requested()) && !self.may_close && session.editor.is_dirty() {
            context.send_viewport_cmd(ViewportCommand::CancelClose);
            self.leaving = Some(Leaving::Program);
        }
    }

    /// What happened to the file of the set.
    pub fn notices(&mut self, ui: &mut Ui, session: &mut Session) {
        if !session.file.changed_on_disk {
            return;
        }
        Panel::top("changed on disk").show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                ui.colored_label(ui.visuals().warn_fg_color, "Another program has changed capture.toml.");
                if ui.button("Reload it").clicked() {
                    session.reload_from_disk();
                }
                if ui.button("Keep mine").on_hover_text("Saving will replace what the other program wrote").clicked() {
                    session.keep_mine();
                }
            });
        });
    }

    /// Everything that lies over the window.
    pub fn dialogs(&mut self, context: &Context, session: &mut Session) {
        self.help.ui(context);
        self.pages.ui(context);
        self.frame_times.ui(context);
        Window::new("About Firstbounce").open(&mut self.shows.about).resizable(false).show(context, |ui| {
            ui.label(format!("Firstbounce {}", env!("CARGO_PKG_VERSION")));
            ui.label("Takes the light between an object's own walls out of photometric stereo.");
            ui.label("Method: Liao, Huang, Yang, CVPR 2011.");
            ui.label(format!("Licence: {}", env!("CARGO_PKG_LICENSE")));
            if cfg!(feature = "raw") {
                ui.label("Camera raw files are read by rawler, licensed under the LGPL 2.1.");
            }
        });
        if let Some(made) = self.simulated.ui(context, session) {
            self.open_set(session, made);
        }
        self.ask_where(context, session);
        self.ask_about_unsaved(context, session);
    }

    fn ask_where(&mut self, context: &Context, session: &mut Session) {
        let Some(field) = &mut self.save_as else { return };
        let mut done = false;
        let modal = Modal::new(Id::unique("save as")).show(context, |ui| {
            ui.set_width(460.0);
            ui.heading("Save as");
            let dialogs = session.dialogs();
            let label = "Folder of the new set";
            let mut chosen = field.ui(ui, label, Choose::Folder, &dialogs, &mut session.jobs).into_iter().next();
            ui.label("The photos stay where they are; the new capture.toml names them.");
            ui.horizontal(|ui| {
                if ui.button("Save here").clicked() && !field.text.trim().is_empty() {
                    chosen = Some(field.text.trim().into());
                }
                done |= ui.button("Cancel").clicked();
            });
            if let Some(folder) = chosen {
                session.save_as(&folder);
                done = true;
            }
        });
        if done || modal.should_close() {
            self.save_as = None;
        }
    }

    fn ask_about_unsaved(&mut self, context: &Context, session: &mut Session) {
        if self.leaving.is_none() {
            return;
        }
        let mut answer = None;
        let modal = Modal::new(Id::unique("unsaved")).show(context, |ui| {
            ui.heading(format!("Save the changes to {}?", session.document().set.title()));
            ui.horizontal(|ui| {
                if ui.button("Save").clicked() {
                    session.save();
                    answer = Some(!session.editor.is_dirty());
                }
                if ui.button("Discard changes").clicked() {
                    answer = Some(true);
                }
                if ui.button("Cancel").clicked() {
                    answer = Some(false);
                }
            });
        });
        if modal.should_close() {
            answer = Some(false);
        }
        let Some(leave) = answer else { return };
        match self.leaving.take().filter(|_| leave) {
            Some(Leaving::Set) => session.leave(),
            Some(Leaving::For(open)) => session.open(open),
            Some(Leaving::Program) => {
                self.may_close = true;
                context.send_viewport_cmd(ViewportCommand::Close);
            }
            None => {}
        }
    }
}
