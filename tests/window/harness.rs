//! A window over folders of its own, and a person's hands.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use eframe::egui::accesskit::Role;
use eframe::egui::{DroppedFile, Event, Key, Modifiers, Pos2, Vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use egui_kittest::{Harness, HarnessBuilder};
use firstbounce::app::base::dialogs::{Choose, Dialogs};
use firstbounce::app::state::preferences::Folders;
use firstbounce::app::state::session::{Open, Session};
use firstbounce::app::views::canvas::View;
use firstbounce::app::window::Window;
use firstbounce::app::window::commands::CommandId;
use firstbounce_capture::pipeline::Method;
use tempfile::TempDir;

/// Longer than any machine needs for the demo.
const PATIENCE: Duration = Duration::from_secs(180);

/// Answers in the place of a person.
#[derive(Default)]
pub struct Answers(pub Mutex<Vec<PathBuf>>);

impl Dialogs for Answers {
    fn ask(&self, _: Choose, _: &str, _: &Path) -> Vec<PathBuf> {
        std::mem::take(&mut *self.0.lock().expect("no test panics while it answers"))
    }
}

pub struct Hands {
    pub harness: Harness<'static, Window>,
    pub answers: Arc<Answers>,
    pub folder: TempDir,
}

impl Hands {
    /// A window that was never opened before.
    pub fn new() -> Self {
        Self::with_folder(tempfile::tempdir().expect("a temporary folder"))
    }

    /// A window that remembers what lies in `folder`.
    pub fn with_folder(folder: TempDir) -> Self {
        Self::built(folder, Harness::builder())
    }

    /// A window that draws; needs a graphics adapter.
    pub fn drawing() -> Self {
        Self::built(tempfile::tempdir().expect("a temporary folder"), Harness::builder().wgpu())
    }

    fn built(folder: TempDir, builder: HarnessBuilder<Window>) -> Self {
        let answers = Arc::new(Answers::default());
        let (folders, dialogs) = (Folders::below(&folder.path().join("config")), answers.clone());
        let mut harness = builder
            .with_size(Vec2::new(1280.0, 800.0))
            .with_max_steps(200)
            .with_step_dt(1.0 / 60.0)
            .build_eframe(|creation| Window::new(creation, folders, dialogs));
        harness.run_steps(3);
        Self { harness, answers, folder }
    }

    /// The same with a copy of the demo set open.
    pub fn with_demo() -> Self {
        let mut hands = Self::new();
        let set = hands.demo();
        hands.open(Open::Set(set));
        hands
    }

    /// The same, separated by the paper's method, which tells bounces apart.
    pub fn with_demo_by_colours() -> Self {
        let mut hands = Self::with_demo();
        hands.choose_method(Method::Colours);
        hands
    }

    /// As the Separate step does.
    pub fn choose_method(&mut self, method: Method) {
        self.session().edit("Choose a method", |document| document.set.separation.method = Some(method));
        self.steps();
    }

    /// A copy of the demo set, for this test alone.
    pub fn demo(&self) -> PathBuf {
        let set = self.folder.path().join("set");
        firstbounce::demo::unpack(&set).expect("the demo is written");
        set
    }

    /// Runs a command, as its menu entry does.
    pub fn run(&mut self, command: CommandId) {
        let context = self.harness.ctx.clone();
        self.harness.state_mut().run(command, &context);
    }

    pub fn open(&mut self, open: Open) {
        self.harness.state_mut().open(open);
        self.harness.run_steps(3);
    }

    pub fn session(&mut self) -> &mut Session {
        self.harness.state_mut().session()
    }

    pub fn steps(&mut self) {
        self.harness.run_steps(3);
    }

    /// Waits until every result is that of the document.
    pub fn rest(&mut self) {
        self.wait_until("the results to rest", |session| session.results.is_at_rest(&session.document()));
    }

    pub fn wait_until(&mut self, what: &str, mut holds: impl FnMut(&mut Session) -> bool) {
        let since = Instant::now();
        loop {
            self.harness.run_steps(2);
            if holds(self.session()) {
                self.harness.run_steps(2);
                return;
            }
            assert!(since.elapsed() < PATIENCE, "waited in vain for {what}");
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Waits until a text is there; panics if it never comes.
    pub fn wait_to_see(&mut self, text: &str) {
        let since = Instant::now();
        while !self.sees(text) {
            assert!(since.elapsed() < PATIENCE, "waited in vain for \"{text}\"");
            self.harness.run_steps(2);
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    pub fn press(&mut self, modifiers: Modifiers, key: Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.steps();
    }

    /// To the next control, or with Shift to the one before.
    pub fn tab(&mut self, modifiers: Modifiers) {
        for pressed in [true, false] {
            let (key, physical_key, repeat) = (Key::Tab, None, false);
            self.harness.input_mut().events.push(Event::Key { key, physical_key, pressed, repeat, modifiers });
        }
        self.harness.run_steps(2);
    }

    /// As a screen reader presses it, wherever the panel is scrolled to.
    pub fn click_button(&mut self, label: &str) {
        self.harness.get_by_role_and_label(Role::Button, label).click_accesskit();
        self.steps();
    }

    /// Opens a section that is folded, and waits until it is.
    pub fn unfold(&mut self, label: &str) {
        self.harness.get_by_label(label).click_accesskit();
        self.harness.run_steps(30);
    }

    pub fn sees(&self, text: &str) -> bool {
        self.harness.query_all_by_label_contains(text).next().is_some()
    }

    /// Replaces what stands in a field.
    pub fn retype(&mut self, label: &str, text: &str) {
        self.harness.get_by_role_and_label(Role::TextInput, label).focus();
        self.steps();
        self.press(Modifiers::COMMAND, Key::A);
        self.harness.get_by_role_and_label(Role::TextInput, label).type_text(text);
        self.steps();
    }

    pub fn type_into(&mut self, label: &str, text: &str) {
        self.harness.get_by_role_and_label(Role::TextInput, label).focus();
        self.steps();
        self.harness.get_by_role_and_label(Role::TextInput, label).type_text(text);
        self.steps();
    }

    /// Types a number into a field with this label, as with the keyboard.
    pub fn type_number(&mut self, label: &str, text: &str) {
        self.harness.get_by_role_and_label(Role::SpinButton, label).focus();
        self.steps();
        self.press(Modifiers::COMMAND, Key::A);
        self.harness.get_by_role_and_label(Role::SpinButton, label).type_text(text);
        self.steps();
        self.press(Modifiers::NONE, Key::Enter);
    }

    /// Opens a step by its name in the list of steps.
    pub fn open_step(&mut self, name: &str) {
        self.harness.get_by_label(name).click();
        self.steps();
    }

    /// Clicks into the picture of this name, of this size and fitted into its view, at a position in its pixels.
    pub fn click_picture(&mut self, name: &str, size: (usize, usize), at_px: [f64; 2]) {
        let at = self.on_picture(name, size, at_px);
        self.harness.hover_at(at);
        self.steps();
        self.harness.drag_at(at);
        self.steps();
        self.harness.drop_at(at);
        self.steps();
    }

    /// Drags along a line in the picture of this name, as for a click.
    pub fn drag_on_picture(&mut self, name: &str, size: (usize, usize), [from_px, to_px]: [[f64; 2]; 2]) {
        let [from, to] = [from_px, to_px].map(|at_px| self.on_picture(name, size, at_px));
        self.harness.hover_at(from);
        self.steps();
        self.harness.drag_at(from);
        self.steps();
        for part in [0.5, 1.0] {
            self.harness.hover_at(from + part * (to - from));
            self.steps();
        }
        self.harness.drop_at(to);
        self.steps();
    }

    /// Where a pixel of a picture that is fitted into its view lies in the window.
    fn on_picture(&self, name: &str, size: (usize, usize), at_px: [f64; 2]) -> Pos2 {
        let bounds = self.harness.get_by_role_and_label(Role::Image, name).rect();
        View::Fit.transform(bounds, size, 1.0).to_screen(at_px)
    }

    /// What stands in a field of numbers.
    pub fn number(&self, label: &str) -> f64 {
        let node = self.harness.get_by_role_and_label(Role::SpinButton, label);
        node.accesskit_node().numeric_value().unwrap_or_else(|| panic!("{label} is no number"))
    }

    /// Chooses what a view shows, by its menu.
    pub fn choose_picture(&mut self, menu: &str, group: &str, picture: &str) {
        self.click_button(menu);
        for entry in [group, picture] {
            self.harness.get_by_role_and_label(Role::Button, entry).click();
            self.steps();
        }
    }

    /// Drops files or folders on the window, and waits until they were looked through.
    pub fn drop_files(&mut self, paths: &[PathBuf]) {
        for path in paths {
            self.harness.input_mut().dropped_files.push(Arc::new(Dropped(path.clone())));
        }
        self.steps();
        self.wait_until("the search for pictures", |session| {
            session.jobs.running().iter().all(|job| job.name() != "Look for pictures")
        });
    }

    /// Opens a choice of names and types a new one.
    pub fn name_by_hand(&mut self, choice: &str, name: &str) {
        self.harness.get_by_role_and_label(Role::ComboBox, choice).click();
        self.steps();
        self.type_into("New name", name);
        self.press(Modifiers::NONE, Key::Enter);
    }
}

/// A file as the system drops it.
#[derive(Debug)]
struct Dropped(PathBuf);

impl DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}
