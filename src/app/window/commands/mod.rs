//! Every command once: menu, palette, shortcuts and the help sheet are made from this table.

mod help;
mod menu;
mod palette;
mod pictures;

use eframe::egui::{Context, Key, KeyboardShortcut, Modifiers};

use crate::app::state::layout::{Arrange, Compare, Shown};
use crate::app::state::panel::PanelName;
use crate::app::state::preferences::Theme;
use crate::app::state::session::{Open, Session};
use crate::app::state::surfaces::SurfaceLook;
use crate::app::views::{self, Canvases};
use crate::app::window::Chrome;
use crate::gpu::mesh::StandardView;

pub use help::HelpSheet;
pub use menu::menu_bar;
pub use palette::{Chosen as Found, Palette};

/// What a command works on.
pub struct Target<'a> {
    /// The open set and everything around it.
    pub session: &'a mut Session,
    /// What the views keep from frame to frame.
    pub canvases: &'a mut Canvases,
    /// What the window shows over and around them.
    pub chrome: &'a mut Chrome,
    /// egui.
    pub context: &'a Context,
}

/// Names a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[expect(missing_docs, reason = "the table says what each does")]
pub enum CommandId {
    OpenDemo,
    NewSimulatedSet,
    CloseSet,
    Save,
    SaveAs,
    ReloadFromDisk,
    ReloadPhotos,
    Quit,
    Undo,
    Redo,
    ShowCaptures,
    ShowCalibrate,
    ShowSeparate,
    ShowShape,
    ShowExport,
    SplitRight,
    SplitDown,
    NewTab,
    CloseView,
    NextView,
    FitViews,
    ViewsOneToOne,
    ShowSurface,
    PreviousPicture,
    NextPicture,
    NextLight,
    NextBounce,
    NextColour,
    Brighter,
    Darker,
    Normalise,
    Wipe,
    Difference,
    Maximise,
    OneView,
    TwoViews,
    FourViews,
    ResetLayout,
    FrontView,
    BackView,
    LeftView,
    RightView,
    TopView,
    BottomView,
    CornerView,
    Turntable,
    Lens,
    Wireframe,
    ToggleSteps,
    ToggleInspector,
    ToggleLog,
    ZoomIn,
    ZoomOut,
    ZoomReset,
    ThemeSystem,
    ThemeDark,
    ThemeLight,
    WriteResults,
    CancelJobs,
    Retry,
    Palette,
    Help,
    AboutStep,
    FrameTimes,
    WriteFrameTimes,
    About,
    #[cfg(debug_assertions)]
    LoseDevice,
}

/// A menu of the menu bar.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "they are called so")]
pub enum Menu {
    File,
    Edit,
    Steps,
    Picture,
    View,
    Help,
}

impl Menu {
    /// All menus, in order.
    pub const ALL: [Self; 6] = [Self::File, Self::Edit, Self::Steps, Self::Picture, Self::View, Self::Help];

    /// What it is called.
    pub fn title(self) -> &'static str {
        match self {
            Self::File => "File",
            Self::Edit => "Edit",
            Self::Steps => "Steps",
            Self::Picture => "Picture",
            Self::View => "View",
            Self::Help => "Help",
        }
    }
}

/// One command.
pub struct Command {
    /// Its name in the program.
    pub id: CommandId,
    /// Where it is in the menu bar.
    pub menu: Menu,
    /// Its name in the window.
    pub title: &'static str,
    /// Its keys.
    pub shortcut: Option<KeyboardShortcut>,
    /// What it would act on, after the title: "Undo: Move grey ball".
    pub object: fn(&Session) -> Option<String>,
    /// Whether it can be run now.
    pub enabled: fn(&Session) -> bool,
    /// Runs it.
    pub run: fn(Target<'_>),
}

impl Command {
    /// The title with what it acts on.
    pub fn label(&self, session: &Session) -> String {
        match (self.object)(session) {
            Some(object) => format!("{}: {object}", self.title),
            None => self.title.to_owned(),
        }
    }
}

const fn ctrl(key: Key) -> Option<KeyboardShortcut> {
    Some(KeyboardShortcut::new(Modifiers::COMMAND, key))
}

const fn ctrl_shift(key: Key) -> Option<KeyboardShortcut> {
    Some(KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), key))
}

const fn shift(key: Key) -> Option<KeyboardShortcut> {
    Some(KeyboardShortcut::new(Modifiers::SHIFT, key))
}

const fn alone(key: Key) -> Option<KeyboardShortcut> {
    Some(KeyboardShortcut::new(Modifiers::NONE, key))
}

const fn alt(key: Key) -> Option<KeyboardShortcut> {
    Some(KeyboardShortcut::new(Modifiers::ALT, key))
}

fn always(_: &Session) -> bool {
    true
}

fn open(session: &Session) -> bool {
    session.is_open()
}

fn in_3d(session: &Session) -> bool {
    session.is_open() && session.views.active().is_some_and(|view| view.shown == Shown::Surface)
}

fn nothing(_: &Session) -> Option<String> {
    None
}

const fn plain(
    id: CommandId,
    menu: Menu,
    title: &'static str,
    shortcut: Option<KeyboardShortcut>,
    enabled: fn(&Session) -> bool,
    run: fn(Target<'_>),
) -> Command {
    Command { id, menu, title, shortcut, object: nothing, enabled, run }
}

/// Every command, in the order of the menus.
pub static COMMANDS: &[Command] = &[
    plain(CommandId::OpenDemo, Menu::File, "Open the demo", None, always, |target| {
        target.chrome.open_set(target.session, Open::Demo);
    }),
    plain(CommandId::NewSimulatedSet, Menu::File, "New simulated set...", None, always, |target| {
        target.chrome.simulated.open();
    }),
    plain(CommandId::CloseSet, Menu::File, "Open another set...", ctrl(Key::O), always, |target| {
        target.chrome.leave_set(target.session);
    }),
    plain(CommandId::Save, Menu::File, "Save", ctrl(Key::S), open, |target| target.session.save()),
    plain(CommandId::SaveAs, Menu::File, "Save as...", ctrl_shift(Key::S), open, |target| {
        target.chrome.ask_save_as(target.session);
    }),
    plain(CommandId::ReloadFromDisk, Menu::File, "Reload capture.toml from disk", None, open, |target| {
        target.session.reload_from_disk();
    }),
    plain(CommandId::ReloadPhotos, Menu::File, "Read all photos again", alone(Key::F5), open, |target| {
        target.session.results.reload();
    }),
    plain(CommandId::Quit, Menu::File, "Quit", ctrl(Key::Q), always, |target| {
        target.context.send_viewport_cmd(eframe::egui::ViewportCommand::Close);
    }),
    Command {
        id: CommandId::Undo,
        menu: Menu::Edit,
        title: "Undo",
        shortcut: ctrl(Key::Z),
        object: |session| session.editor.undo_name(),
        enabled: |session| session.editor.undo_name().is_some(),
        run: |target| target.session.editor.undo(),
    },
    Command {
        id: CommandId::Redo,
        menu: Menu::Edit,
        title: "Redo",
        shortcut: ctrl_shift(Key::Z),
        object: |session| session.editor.redo_name(),
        enabled: |session| session.editor.redo_name().is_some(),
        run: |target| target.session.editor.redo(),
    },
    plain(CommandId::ShowCaptures, Menu::Steps, "Captures", alone(Key::Num1), open, |t| {
        t.session.panel = PanelName::Captures
    }),
    plain(CommandId::ShowCalibrate, Menu::Steps, "Calibrate", alone(Key::Num2), open, |t| {
        t.session.panel = PanelName::Calibrate;
    }),
    plain(CommandId::ShowSeparate, Menu::Steps, "Separate", alone(Key::Num3), open, |t| {
        t.session.panel = PanelName::Separate
    }),
    plain(CommandId::ShowShape, Menu::Steps, "Shape", alone(Key::Num4), open, |t| t.session.panel = PanelName::Shape),
    plain(CommandId::ShowExport, Menu::Steps, "Export", alone(Key::Num5), open, |t| {
        t.session.panel = PanelName::Export
    }),
    plain(CommandId::WriteResults, Menu::Steps, "Write all results", None, open, |t| {
        t.session.panel = PanelName::Export;
        t.session.export_asked = true;
    }),
    plain(CommandId::CancelJobs, Menu::Steps, "Cancel all jobs", None, always, |target| {
        target.session.jobs.running().iter().for_each(|job| job.cancel());
    }),
    plain(CommandId::Retry, Menu::Steps, "Retry", alone(Key::F9), open, |target| {
        target.session.results.retry();
    }),
    plain(CommandId::SplitRight, Menu::View, "Split view right", ctrl(Key::Backslash), open, |t| {
        t.session.views.arrange_active(Arrange::SplitRight);
    }),
    plain(CommandId::SplitDown, Menu::View, "Split view down", alt(Key::Backslash), open, |t| {
        t.session.views.arrange_active(Arrange::SplitDown);
    }),
    plain(CommandId::NewTab, Menu::View, "New tab", ctrl(Key::T), open, |t| {
        t.session.views.arrange_active(Arrange::NewTab)
    }),
    plain(CommandId::CloseView, Menu::View, "Close view", ctrl(Key::W), open, |t| {
        t.session.views.arrange_active(Arrange::Close)
    }),
    plain(CommandId::NextView, Menu::View, "Next view", alone(Key::F6), open, |t| t.session.views.activate_next()),
    plain(CommandId::FitViews, Menu::View, "Fit pictures to their views", alone(Key::F), open, |t| {
        t.session.views.fit_surfaces();
        t.canvases.fit();
    }),
    plain(CommandId::ViewsOneToOne, Menu::View, "Show pictures 1:1", alone(Key::Num0), open, |t| {
        t.canvases.one_to_one();
    }),
    plain(CommandId::ShowSurface, Menu::View, "Surface in 3D", alone(Key::T), open, |t| {
        t.session.views.open(Shown::Surface)
    }),
    plain(CommandId::PreviousPicture, Menu::Picture, "Previous picture", alone(Key::OpenBracket), open, |t| {
        pictures::in_group(t, false);
    }),
    plain(CommandId::NextPicture, Menu::Picture, "Next picture", alone(Key::CloseBracket), open, |t| {
        pictures::in_group(t, true);
    }),
    plain(CommandId::NextLight, Menu::Picture, "Next light", alone(Key::L), open, pictures::next_light),
    plain(CommandId::NextBounce, Menu::Picture, "Next bounce", alone(Key::K), open, pictures::next_bounce),
    plain(CommandId::NextColour, Menu::Picture, "Next colour", alone(Key::C), open, pictures::next_colour),
    plain(CommandId::Brighter, Menu::Picture, "Brighter", alone(Key::E), open, |t| pictures::expose(t, 1.0)),
    plain(CommandId::Darker, Menu::Picture, "Darker", shift(Key::E), open, |t| pictures::expose(t, -1.0)),
    plain(CommandId::Normalise, Menu::Picture, "Own range or shared scale", alone(Key::N), open, pictures::normalise),
    plain(CommandId::Wipe, Menu::Picture, "Compare by a wipe", alone(Key::W), open, |t| {
        pictures::compare(t, Compare::Wipe);
    }),
    plain(CommandId::Difference, Menu::Picture, "Compare by the difference", alone(Key::D), open, |t| {
        pictures::compare(t, Compare::Difference);
    }),
    plain(CommandId::Maximise, Menu::View, "Only this view, or all", alone(Key::X), open, |t| {
        if let Some(active) = t.session.views.active_id() {
            t.session.views.maximise(active);
        }
    }),
    plain(CommandId::OneView, Menu::View, "One view", alt(Key::Num1), open, |t| t.session.views.preset(1)),
    plain(CommandId::TwoViews, Menu::View, "Two views side by side", alt(Key::Num2), open, |t| {
        t.session.views.preset(2)
    }),
    plain(CommandId::FourViews, Menu::View, "Four views", alt(Key::Num4), open, |t| t.session.views.preset(4)),
    plain(CommandId::ResetLayout, Menu::View, "Reset layout", None, open, |t| {
        let document = t.session.document();
        t.session.views.reset(&document);
    }),
    plain(CommandId::FrontView, Menu::View, "Front view", None, in_3d, |t| look_from(t, StandardView::Front)),
    plain(CommandId::BackView, Menu::View, "Back view", None, in_3d, |t| look_from(t, StandardView::Back)),
    plain(CommandId::LeftView, Menu::View, "Left view", None, in_3d, |t| look_from(t, StandardView::Left)),
    plain(CommandId::RightView, Menu::View, "Right view", None, in_3d, |t| look_from(t, StandardView::Right)),
    plain(CommandId::TopView, Menu::View, "Top view", None, in_3d, |t| look_from(t, StandardView::Top)),
    plain(CommandId::BottomView, Menu::View, "Bottom view", None, in_3d, |t| look_from(t, StandardView::Bottom)),
    plain(CommandId::CornerView, Menu::View, "Corner view", None, in_3d, |t| look_from(t, StandardView::Corner)),
    plain(CommandId::Turntable, Menu::View, "Toggle turntable", alt(Key::T), in_3d, |t| {
        surface(t, |look| look.turntable ^= true);
    }),
    plain(CommandId::Lens, Menu::View, "Toggle perspective", alt(Key::P), in_3d, |t| {
        surface(t, SurfaceLook::other_lens);
    }),
    plain(CommandId::Wireframe, Menu::View, "Toggle wireframe", alt(Key::W), in_3d, |t| {
        surface(t, |look| look.wireframe ^= true);
    }),
    plain(CommandId::ToggleSteps, Menu::View, "Toggle the panel of the step", ctrl(Key::B), open, |t| {
        t.chrome.shows.steps ^= true
    }),
    plain(CommandId::ToggleInspector, Menu::View, "Toggle inspector", ctrl(Key::I), open, |t| {
        t.chrome.shows.inspector ^= true;
    }),
    plain(CommandId::ToggleLog, Menu::View, "Toggle log", ctrl(Key::L), always, |t| t.chrome.shows.log ^= true),
    plain(CommandId::ZoomIn, Menu::View, "Larger text and buttons", ctrl(Key::Plus), always, |t| scale_by(t, 1.1)),
    plain(CommandId::ZoomOut, Menu::View, "Smaller text and buttons", ctrl(Key::Minus), always, |t| {
        scale_by(t, 1.0 / 1.1)
    }),
    plain(CommandId::ZoomReset, Menu::View, "Normal text and buttons", None, always, |t| scale_to(t, 1.0)),
    plain(CommandId::ThemeSystem, Menu::View, "System colours", None, always, |t| theme(t, Theme::System)),
    plain(CommandId::ThemeDark, Menu::View, "Dark colours", None, always, |t| theme(t, Theme::Dark)),
    plain(CommandId::ThemeLight, Menu::View, "Light colours", None, always, |t| theme(t, Theme::Light)),
    plain(CommandId::Palette, Menu::Help, "Find a command...", ctrl(Key::P), always, |t| t.chrome.palette.open()),
    plain(CommandId::Help, Menu::Help, "Keys and commands", alone(Key::F1), always, |t| t.chrome.help.toggle()),
    plain(CommandId::AboutStep, Menu::Help, "About this step", shift(Key::F1), open, |t| {
        t.chrome.pages.toggle(t.session.panel);
    }),
    plain(CommandId::FrameTimes, Menu::Help, "Frame times", ctrl_shift(Key::D), always, |t| {
        t.chrome.frame_times.toggle()
    }),
    plain(CommandId::WriteFrameTimes, Menu::Help, "Write frame times to a file", None, always, |t| {
        t.chrome.frame_times.write(t.session);
    }),
    plain(CommandId::About, Menu::Help, "About Firstbounce", None, always, |t| t.chrome.shows.about ^= true),
    // Only in a build for development: tests take the device away by it.
    #[cfg(debug_assertions)]
    plain(CommandId::LoseDevice, Menu::Help, "Lose the graphics device", None, always, |t| {
        t.chrome.device.lose();
        t.context.request_repaint();
    }),
];

/// The command of this name.
pub fn command(id: CommandId) -> Option<&'static Command> {
    COMMANDS.iter().find(|command| command.id == id)
}

/// Runs a command if it can be run now.
pub fn run(id: CommandId, target: Target<'_>) {
    if let Some(command) = command(id).filter(|command| (command.enabled)(target.session)) {
        (command.run)(target);
    }
}

/// The command whose keys were pressed in this frame. Keys with more modifiers are looked at first: Ctrl+Shift+Z is not
/// Ctrl+Z.
pub fn pressed(context: &Context) -> Option<CommandId> {
    // A field that is being typed in keeps its letters and its own undo.
    let typing = context.text_edit_focused();
    let own = |shortcut: &KeyboardShortcut, id: CommandId| {
        let is_letter =
            !shortcut.modifiers.command && !shortcut.modifiers.alt && !is_function_key(shortcut.logical_key);
        is_letter || matches!(id, CommandId::Undo | CommandId::Redo)
    };
    let mut keys: Vec<_> = COMMANDS.iter().filter_map(|command| Some((command.shortcut?, command.id))).collect();
    keys.sort_by_key(|(shortcut, _)| std::cmp::Reverse(shortcut.modifiers.shift));
    let mut candidates = keys.into_iter().filter(|(shortcut, id)| !(typing && own(shortcut, *id)));
    context.input_mut(|input| candidates.find(|(shortcut, _)| input.consume_shortcut(shortcut)).map(|(_, id)| id))
}

fn is_function_key(key: Key) -> bool {
    (Key::F1..=Key::F35).contains(&key)
}

fn surface(target: Target<'_>, change: impl FnOnce(&mut SurfaceLook)) {
    if let Some(view) = target.session.views.active_mut() {
        change(&mut view.surface);
    }
}

fn look_from(target: Target<'_>, from: StandardView) {
    let Some((id, mut look)) = target.session.views.active().map(|view| (view.id, view.surface.clone())) else {
        return;
    };
    views::surface::look_from(&mut look, target.canvases.surface(id), from, target.session);
    surface(target, |own| *own = look);
}

fn scale_by(target: Target<'_>, factor: f32) {
    let scale = target.session.preferences.ui_scale * factor;
    scale_to(target, scale);
}

fn scale_to(target: Target<'_>, scale: f32) {
    target.session.preferences.ui_scale = scale.clamp(0.5, 3.0);
    target.session.remember();
}

fn theme(target: Target<'_>, theme: Theme) {
    target.session.preferences.theme = theme;
    target.session.remember();
}
