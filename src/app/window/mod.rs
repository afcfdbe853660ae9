//! The window: steps at the left, views in the centre, the inspector at the right, log and jobs below.

mod chrome;
mod frame_times;
mod steps;
mod strip;

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use eframe::egui::{
    self, CentralPanel, Context, Frame, Key, Panel as SidePanel, RichText, ScrollArea, ThemePreference, Ui,
    ViewportCommand,
};
use eframe::wgpu::DeviceLostReason;
use eframe::{App, CreationContext};

use super::commands::{self, CommandId, Target};
use super::dialogs::Dialogs;
use super::panels::{Panel, Panels};
use super::preferences::{Folders, Theme};
use super::results::Next;
use super::session::{Open, Session};
use super::start::{StartScreen, opening};
use super::theme;
use super::views;
use crate::gpu;

pub use chrome::Chrome;

/// The window.
pub struct Window {
    session: Session,
    panels: Panels,
    chrome: Chrome,
    start: StartScreen,
    /// Whether the graphics device went away under the window.
    device_lost: Arc<AtomicBool>,
    /// Which of the opened sets the panels belong to.
    begun: u64,
    /// The title and scale that the system was told.
    told: (String, f32, Option<Theme>),
}

impl Window {
    /// A window without a set.
    pub fn new(creation: &CreationContext<'_>, folders: Folders, dialogs: Arc<dyn Dialogs>) -> Self {
        let context = creation.egui_ctx.clone();
        if let Some(render_state) = &creation.wgpu_render_state {
            gpu::install(render_state);
        }
        theme::apply(&context);
        // egui's own zoom would not be remembered.
        context.options_mut(|options| options.zoom_with_keyboard = false);
        let session = Session::new(folders, dialogs, Arc::new(move || context.request_repaint()));
        Self {
            session,
            panels: Panels::default(),
            chrome: Chrome::default(),
            start: StartScreen::default(),
            device_lost: Arc::default(),
            begun: 0,
            told: Default::default(),
        }
    }

    /// Opens a set.
    pub fn open(&mut self, open: Open) {
        self.session.open(open);
        self.begin_panels();
    }

    /// What panels keep from frame to frame belongs to one set.
    fn begin_panels(&mut self) {
        if self.begun != self.session.opened {
            self.begun = self.session.opened;
            self.panels = Panels::default();
        }
    }

    /// Opens the set of the last run, if it is still there and no run before was lost.
    pub fn restore(&mut self) {
        let last = self.session.preferences.last_open.clone();
        if let Some(last) =
            last.filter(|last| last.join("capture.toml").is_file() && self.session.recovery.found().is_empty())
        {
            self.open(Open::Set(last));
        }
    }

    /// The open set and everything around it.
    pub fn session(&mut self) -> &mut Session {
        &mut self.session
    }

    /// Runs a command.
    pub fn run(&mut self, id: CommandId, context: &Context) {
        let Self { session, panels, chrome, .. } = self;
        commands::run(id, Target { session, panels, chrome, context });
    }

    /// Closes the window when its graphics device goes away, and notes that in `lost`.
    pub fn watch_device(&mut self, creation: &CreationContext<'_>, lost: Arc<AtomicBool>) {
        self.device_lost = lost.clone();
        let Some(render_state) = &creation.wgpu_render_state else { return };
        let context = creation.egui_ctx.clone();
        render_state.device.set_device_lost_callback(move |reason, _| {
            // The device also goes when the window is closed.
            if reason == DeviceLostReason::Unknown {
                lost.store(true, Ordering::Relaxed);
                context.request_repaint();
            }
        });
    }

    fn tell_system(&mut self, context: &Context) {
        let document = self.session.document();
        let title = match (self.session.is_open(), self.session.editor.is_dirty()) {
            (false, _) => "Firstbounce".to_owned(),
            (true, false) => format!("{} - Firstbounce", document.set.title()),
            (true, true) => format!("*{} - Firstbounce", document.set.title()),
        };
        if self.told.0 != title {
            context.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.told.0 = title;
        }
        let scale = self.session.preferences.ui_scale;
        if self.told.1 != scale {
            context.set_zoom_factor(scale);
            self.told.1 = scale;
        }
        let theme = self.session.preferences.theme;
        if self.told.2 != Some(theme) {
            context.set_theme(match theme {
                Theme::System => ThemePreference::System,
                Theme::Dark => ThemePreference::Dark,
                Theme::Light => ThemePreference::Light,
            });
            self.told.2 = Some(theme);
        }
    }

    /// A press or another focused field begins a new edit: what comes before is undone apart from it.
    fn mark_gestures(&mut self, context: &Context) {
        let pressed = context.input(|input| input.pointer.any_pressed() || input.key_pressed(Key::Enter));
        let focused = context.memory(|memory| memory.focused());
        if pressed || focused != self.chrome.focused {
            self.chrome.focused = focused;
            self.session.editor.begin_gesture();
        }
    }

    fn take_dropped(&mut self, context: &Context) {
        let paths: Vec<_> =
            context.input(|input| input.raw.dropped_files.iter().map(|file| file.path().to_owned()).collect());
        match paths.as_slice() {
            [] => {}
            [set] if set.join("capture.toml").is_file() || set.ends_with("capture.toml") => {
                self.chrome.open_set(&mut self.session, Open::Set(set.clone()));
            }
            _ if self.session.is_open() => self.panels.dropped(paths, &mut self.session),
            [folder] if folder.is_dir() => {
                let folder = folder.clone();
                self.open(opening(folder.clone()));
                self.panels.dropped(vec![folder], &mut self.session);
            }
            [first, ..] => {
                let folder = first.parent().map(ToOwned::to_owned).unwrap_or_default();
                self.open(Open::New(folder));
                self.panels.dropped(paths, &mut self.session);
            }
        }
    }

    fn run_requested(&mut self, context: &Context, chosen: Vec<Option<CommandId>>) {
        let requested = self.session.take_requests();
        for id in chosen.into_iter().flatten().chain(requested) {
            self.run(id, context);
            self.begin_panels();
        }
    }

    fn workplace(&mut self, ui: &mut Ui) {
        let Self { session, panels, chrome, .. } = self;
        if chrome.steps {
            SidePanel::left("steps").default_size(340.0).size_range(220.0..=640.0).show(ui, |ui| {
                steps::ui(ui, session);
                ui.separator();
                steps::next(ui, session);
                let panel = session.panel;
                ScrollArea::vertical().id_salt(panel.title()).auto_shrink(false).show(ui, |ui| {
                    ui.push_id(panel.title(), |ui| panels.of(panel).ui(ui, session));
                });
            });
        }
        if chrome.inspector {
            SidePanel::right("inspector").default_size(280.0).size_range(180.0..=640.0).show(ui, |ui| {
                ui.label(RichText::new("Inspector").strong());
                ui.separator();
                ScrollArea::vertical().auto_shrink(false).show(ui, |ui| panels.inspector.ui(ui, session));
            });
        }
        let frame = Frame::central_panel(ui.style()).inner_margin(0.0);
        CentralPanel::default_margins().frame(frame).show(ui, |ui| views::ui(ui, session, panels));
    }
}

impl App for Window {
    fn logic(&mut self, context: &Context, _: &mut eframe::Frame) {
        self.mark_gestures(context);
        if let Next::Again(after) = self.session.update() {
            context.request_repaint_after(after);
        }
        self.tell_system(context);
        if self.device_lost.load(Ordering::Relaxed) {
            self.session.recovery.leave_to_next_run();
            context.send_viewport_cmd(ViewportCommand::Close);
            return;
        }
        self.chrome.guard_close(context, &mut self.session);
    }

    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let context = ui.ctx().clone();
        self.chrome.frame_times.note(frame.info().cpu_usage);
        self.take_dropped(&context);
        let by_keys = commands::pressed(&context);
        let by_menu = SidePanel::top("menu").show(ui, |ui| commands::menu_bar(ui, &self.session)).inner;
        self.chrome.notices(ui, &mut self.session);
        strip::ui(ui, &mut self.session, &mut self.chrome.log);
        if self.session.is_open() {
            self.workplace(ui);
        } else {
            let chosen = CentralPanel::default_margins().show(ui, |ui| self.start.ui(ui, &mut self.session)).inner;
            if let Some(open) = chosen {
                self.open_chosen(open);
            }
        }
        let by_palette = self.chrome.palette.ui(&context, &self.session);
        self.chrome.dialogs(&context, &mut self.session);
        self.session.log.show_toasts(&context);
        self.run_requested(&context, vec![by_keys, by_menu, by_palette]);
        self.begin_panels();
    }

    fn on_exit(&mut self) {
        self.session.keep_layout();
    }
}

impl Window {
    fn open_chosen(&mut self, open: Open) {
        let folder = match &open {
            Open::New(folder) => Some(folder.clone()),
            _ => None,
        };
        self.open(open);
        // A folder without a set is a set of the photos in it.
        if let Some(folder) = folder {
            self.panels.dropped(vec![folder], &mut self.session);
        }
    }
}

/// What is drawn in the middle of an empty place: what to do next.
pub fn advice(ui: &mut Ui, text: &str) {
    ui.add_space(8.0);
    ui.label(egui::RichText::new(text).weak());
}
