//! The window: the steps in a row, the panel of the open one at the left, its tiles in the centre, the inspector at the right, log and
//! jobs below.

mod chrome;
pub mod commands;
pub mod device;
mod frame_times;
mod pages;
pub mod simulate;
mod start;
mod steps;
mod strip;
mod toasts;

use std::sync::Arc;

use eframe::egui::{
    CentralPanel, Context, Frame, Key, Panel as SidePanel, RichText, ScrollArea, ThemePreference, Ui, UiBuilder,
    ViewportCommand, mutex::Mutex,
};
use eframe::{App, CreationContext};

use crate::app::base::dialogs::Dialogs;
use crate::app::panels::{Panel, Panels};
use crate::app::state::document::save_everything_now;
use crate::app::state::panel::PanelName;
use crate::app::state::preferences::{Folders, Theme};
use crate::app::state::results::Next;
use crate::app::state::session::{Open, Session};
use crate::app::views::{self, Canvases};
use crate::app::widgets::theme::{self, Weight};
use crate::gpu;
use commands::{CommandId, Found, Target};
use device::DeviceWatch;
pub(in crate::app) use start::opening;
use start::{Chosen, StartScreen};

pub use chrome::Chrome;
use frame_times::Phase;

/// Widths of the panels beside the centre, in points: nothing that a set contains changes them.
const LEFT: f32 = 280.0;
const RIGHT: f32 = 232.0;

/// The window.
pub struct Window {
    session: Session,
    panels: Panels,
    canvases: Canvases,
    chrome: Chrome,
    start: StartScreen,
    /// What work off the UI thread wakes; another one when the window is opened again.
    context: Arc<Mutex<Context>>,
    /// Which of the opened sets the panels belong to.
    begun: u64,
    /// Whether the results of the open set were never all there.
    is_opening: bool,
    /// The title, scale and theme that the system knows.
    known: (String, f32, Option<Theme>),
}

impl Window {
    /// A window without a set.
    pub fn new(creation: &CreationContext<'_>, folders: Folders, dialogs: Arc<dyn Dialogs>) -> Self {
        let context = Arc::new(Mutex::new(creation.egui_ctx.clone()));
        let woken = context.clone();
        let wake = move || {
            let context = woken.lock().clone();
            context.request_repaint();
        };
        let mut window = Self {
            session: Session::new(folders, dialogs, Arc::new(wake)),
            panels: Panels::default(),
            canvases: Canvases::default(),
            chrome: Chrome::default(),
            start: StartScreen::default(),
            context,
            begun: 0,
            is_opening: false,
            known: Default::default(),
        };
        window.prepare(creation);
        window
    }

    /// Goes on in another window of the system, because the device of the one before went away. Set, history and results stay;
    /// what was on the card is sent again.
    pub fn move_to(&mut self, creation: &CreationContext<'_>) {
        // Sizes of panels, open sections and the like.
        let arranged = self.context.lock().data(|data| data.clone());
        creation.egui_ctx.data_mut(|data| *data = arranged);
        *self.context.lock() = creation.egui_ctx.clone();
        self.panels = Panels::default();
        self.canvases.forget_card();
        self.chrome.simulated.forget_card();
        self.known = Default::default();
        self.prepare(creation);
    }

    fn prepare(&mut self, creation: &CreationContext<'_>) {
        let context = creation.egui_ctx.clone();
        theme::install(&context);
        // egui's own zoom would not be remembered.
        context.options_mut(|options| options.zoom_with_keyboard = false);
        if let Some(render_state) = &creation.wgpu_render_state {
            gpu::install(render_state);
            gpu::mesh::install(render_state);
            self.chrome.device = DeviceWatch::new(render_state, move || context.request_repaint());
        }
    }

    /// What the window draws with, and whether that is still there.
    pub fn device(&self) -> &DeviceWatch {
        &self.chrome.device
    }

    /// The device that went away, if it did: nothing holds it any more.
    pub fn take_lost_device(&mut self) -> Option<DeviceWatch> {
        self.chrome.device.is_lost().then(|| std::mem::take(&mut self.chrome.device))
    }

    /// Keeps what is unsaved for the next run: this one cannot go on.
    pub fn leave_to_next_run(&self) {
        self.session.file.recovery.leave_to_next_run();
    }

    /// Opens a set.
    pub fn open(&mut self, open: Open) {
        self.session.open(open);
        self.begin_panels();
    }

    /// What panels and views keep from frame to frame belongs to one set.
    fn begin_panels(&mut self) {
        let opened = self.session.file.opened_sets();
        if self.begun != opened {
            self.begun = opened;
            self.is_opening = true;
            self.panels = Panels::default();
            self.canvases = Canvases::default();
        }
    }

    /// Opens the set of the last run, if it is still there and no run before was lost; the start screen offers what was.
    pub fn restore(&mut self) {
        let recovery = &self.session.file.recovery;
        let was_lost = !recovery.found().is_empty() || !recovery.left_opening().is_empty();
        let last = self.session.preferences.last_open.clone().filter(|last| last.join("capture.toml").is_file());
        if let (Some(last), false) = (last, was_lost) {
            self.open(Open::Set(last));
        }
    }

    /// The open set and everything around it.
    pub fn session(&mut self) -> &mut Session {
        &mut self.session
    }

    /// What the views keep from frame to frame.
    pub fn canvases(&mut self) -> &mut Canvases {
        &mut self.canvases
    }

    /// Runs a command.
    pub fn run(&mut self, id: CommandId, context: &Context) {
        let Self { session, canvases, chrome, .. } = self;
        commands::run(id, Target { session, canvases, chrome, context });
        self.begin_panels();
    }

    fn inform_system(&mut self, context: &Context) {
        let document = self.session.document();
        let title = match (self.session.is_open(), self.session.editor.is_dirty()) {
            (false, _) => "Firstbounce".to_owned(),
            (true, false) => format!("{} - Firstbounce", document.set.title()),
            (true, true) => format!("*{} - Firstbounce", document.set.title()),
        };
        if self.known.0 != title {
            context.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.known.0 = title;
        }
        let scale = self.session.preferences.ui_scale;
        if self.known.1 != scale {
            context.set_zoom_factor(scale);
            self.known.1 = scale;
        }
        let theme = self.session.preferences.theme;
        if self.known.2 != Some(theme) {
            context.set_theme(match theme {
                Theme::System => ThemePreference::System,
                Theme::Dark => ThemePreference::Dark,
                Theme::Light => ThemePreference::Light,
            });
            self.known.2 = Some(theme);
        }
    }

    /// A press or another focused field begins a new edit: what comes before is undone apart from it.
    fn mark_gestures(&mut self, context: &Context) {
        let pressed = context.input(|input| input.pointer.any_pressed() || input.key_pressed(Key::Enter));
        let focused = context.memory(|memory| memory.focused());
        // What is dragged may take the focus on the way.
        let is_dragging = context.input(|input| input.pointer.any_down());
        if pressed || (focused != self.chrome.focused && !is_dragging) {
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
                self.open(opening(folder));
                self.panels.dropped(paths, &mut self.session);
            }
        }
    }

    fn run_chosen(&mut self, context: &Context, chosen: Vec<Option<CommandId>>) {
        for id in chosen.into_iter().flatten() {
            self.run(id, context);
        }
    }

    /// What was chosen in the palette; a command is left to be run.
    fn take_found(&mut self, found: Found) -> Option<CommandId> {
        match found {
            Found::Command(id) => return Some(id),
            Found::Picture(shown) => self.session.views.show(shown),
            Found::Order(m) => self.session.edit(&format!("Choose order m = {m}"), |document| {
                document.set.separation.bounces = Some(m);
            }),
            Found::Recent(folder) => self.chrome.open_set(&mut self.session, opening(folder)),
        }
        None
    }

    fn workplace(&mut self, ui: &mut Ui) {
        let Self { session, panels, canvases, chrome, .. } = self;
        steps::ui(ui, session, &mut chrome.pages);
        if chrome.shows.steps {
            SidePanel::left("steps").resizable(false).exact_size(LEFT).show(ui, |ui| {
                within(ui, |ui| {
                    let panel = session.panel;
                    SidePanel::bottom("primary action").show_separator_line(false).show(ui, |ui| {
                        ui.vertical_centered_justified(|ui| {
                            if !panels.of(panel).primary_action(ui, session) {
                                steps::next(ui, session);
                            }
                        });
                    });
                    let salt = (panel.title(), session.file.opened_sets());
                    ScrollArea::vertical().id_salt(salt).auto_shrink(false).show(ui, |ui| {
                        ui.push_id(panel.title(), |ui| panels.of(panel).ui(ui, session));
                    });
                });
            });
        }
        if chrome.shows.inspector {
            SidePanel::right("inspector").resizable(false).exact_size(RIGHT).show(ui, |ui| {
                within(ui, |ui| {
                    ui.label(RichText::new("Inspector").semi_bold());
                    ui.separator();
                    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| panels.inspector.ui(ui, session));
                });
            });
        }
        let frame = Frame::central_panel(ui.style()).inner_margin(0.0);
        CentralPanel::default_margins().frame(frame).show(ui, |ui| {
            let places_files = session.panel == PanelName::Captures && panels.captures.table_of_incoming(ui, session);
            if !places_files {
                views::ui(ui, session, canvases, panels);
            }
        });
    }
}

impl App for Window {
    fn logic(&mut self, context: &Context, frame: &mut eframe::Frame) {
        let phase = if self.is_opening { Phase::Opening } else { Phase::Steady };
        self.chrome.frame_times.begin_frame(phase, frame.info().cpu_usage);
        self.mark_gestures(context);
        if let Next::Again(after) = self.session.update() {
            context.request_repaint_after(after);
        }
        if self.is_opening {
            self.is_opening = !self.session.results.is_at_rest(&self.session.document());
            if !self.is_opening {
                // The next frame knows that this one drew the results.
                context.request_repaint();
            }
        } else {
            self.session.file.opened_well();
        }
        self.inform_system(context);
        self.chrome.frame_times.end_logic();
        #[cfg(debug_assertions)]
        self.chrome.device.begin_frame();
        if self.chrome.device.is_lost() {
            // Should the window not open again, the next run has it.
            save_everything_now();
            context.send_viewport_cmd(ViewportCommand::Close);
            return;
        }
        self.chrome.guard_close(context, &mut self.session);
    }

    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        // What is drawn without a device ends in a panic.
        if self.chrome.device.is_lost() {
            return;
        }
        let context = ui.ctx().clone();
        self.chrome.frame_times.begin_widgets();
        self.take_dropped(&context);
        self.begin_panels();
        let by_keys = commands::pressed(&context);
        let by_menu = SidePanel::top("menu").show(ui, |ui| commands::menu_bar(ui, &self.session)).inner;
        self.chrome.notices(ui, &mut self.session);
        strip::ui(ui, &mut self.session, &mut self.chrome.shows.log);
        let mut by_start = None;
        if self.session.is_open() {
            self.panels.captures.update(&mut self.session);
            self.workplace(ui);
        } else {
            let chosen = CentralPanel::default_margins().show(ui, |ui| self.start.ui(ui, &mut self.session)).inner;
            match chosen {
                Some(Chosen::Open(open)) => self.open_chosen(open),
                Some(Chosen::NewSimulatedSet) => by_start = Some(CommandId::NewSimulatedSet),
                None => {}
            }
        }
        let by_palette = self.chrome.palette.ui(&context, &self.session).and_then(|found| self.take_found(found));
        self.chrome.dialogs(&context, &mut self.session);
        toasts::ui(&context, &mut self.session.log);
        self.run_chosen(&context, vec![by_keys, by_menu, by_start, by_palette]);
        self.chrome.frame_times.end_widgets();
        self.begin_panels();
    }

    fn on_exit(&mut self) {
        self.session.keep_layout();
        self.session.file.opened_well();
    }
}

/// Keeps a panel as wide as it is, whatever lies in it.
fn within(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    let space = ui.available_rect_before_wrap();
    let mut inner = ui.new_child(UiBuilder::new().max_rect(space));
    inner.set_clip_rect(space.intersect(ui.clip_rect()));
    contents(&mut inner);
    ui.advance_cursor_after_rect(space);
}

impl Window {
    /// Opens what was asked for; a folder without a set becomes one of the photos in it.
    pub(in crate::app) fn open_chosen(&mut self, open: Open) {
        let folder = match &open {
            Open::New(folder) => Some(folder.clone()),
            _ => None,
        };
        self.open(open);
        if let Some(folder) = folder {
            self.panels.dropped(vec![folder], &mut self.session);
        }
    }
}
