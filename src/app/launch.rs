//! From the command line to a window, or to one line that says why there is none.

use std::cell::RefCell;
use std::panic::{self, AssertUnwindSafe, PanicHookInfo};
use std::path::PathBuf;
use std::rc::Rc;
use std::sync::Arc;
use std::time::Instant;

use anyhow::{anyhow, bail};
use eframe::egui::{Context, Ui, ViewportBuilder};
use eframe::{App, CreationContext, NativeOptions, egui_wgpu, wgpu};
use firstbounce_capture::guard::is_guarded;

use crate::app::base::dialogs::SystemDialogs;
use crate::app::base::jobs::lower_priority_of_workers;
use crate::app::state::document::save_everything_now;
use crate::app::state::panel::PanelName;
use crate::app::state::preferences::Folders;
use crate::app::state::session::Open;
use crate::app::window::device::{AfterLoss, Losses};
use crate::app::window::{Window, opening};

/// What the window shows first.
#[derive(Clone, Debug, PartialEq)]
pub enum Start {
    /// Where to begin; or the set of the last run.
    Nothing,
    /// A set: its folder or its capture.toml.
    Set(PathBuf),
    /// The same, with what comes out of it.
    Result(PathBuf),
}

const ELSEWHERE: &str = "\"firstbounce solve SET\" works without a window";

/// Whether there is a display to open a window on.
pub fn has_display() -> bool {
    let named = |variable: &str| std::env::var_os(variable).is_some_and(|value| !value.is_empty());
    !cfg!(all(unix, not(target_os = "macos")))
        || ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY"].into_iter().any(named)
}

/// Opens the window, and returns when it is closed.
pub fn run(start: Start) -> anyhow::Result<()> {
    if !has_display() {
        bail!("there is no display to open a window on (DISPLAY and WAYLAND_DISPLAY are not set); {ELSEWHERE}");
    }
    // A set that cannot be opened at all is reported where it was asked for, not in a window.
    if let Start::Set(path) | Start::Result(path) = &start
        && let Open::Set(path) = opening(path.clone())
    {
        crate::app::state::document::Editor::open(&path)?;
    }
    guard_document();
    lower_priority_of_workers();
    let kept = Kept::default();
    let mut losses = Losses::default();
    let mut again = true;
    let result = loop {
        let Attempt { opened, result } = show(&kept, &start, &losses);
        // A device that goes while a frame is drawn ends in a panic, which leaves the event loop half way: its next run only
        // comes to an end, and the one after it shows the window.
        if !opened && result.is_ok() && std::mem::take(&mut again) {
            continue;
        }
        let Some(lost) = kept.borrow_mut().as_mut().and_then(Window::take_lost_device) else { break result };
        again = true;
        if losses.note(lost.adapter().cloned(), Instant::now()) == AfterLoss::GiveUp {
            break Err(anyhow!(
                "the graphics driver stopped twice; start again: an unsaved set is offered there; {ELSEWHERE}"
            ));
        }
    };
    if let (Err(_), Some(window)) = (&result, &*kept.borrow()) {
        window.leave_to_next_run();
    }
    result
}

/// The window outlives what the system shows of it, should the graphics device go away.
type Kept = Rc<RefCell<Option<Window>>>;

/// What became of a window.
struct Attempt {
    /// Whether there was one at all.
    opened: bool,
    result: anyhow::Result<()>,
}

/// Shows the window until it is closed or its device is lost.
fn show(kept: &Kept, start: &Start, losses: &Losses) -> Attempt {
    let options = options(losses);
    let mut opened = false;
    let attempt = panic::catch_unwind(AssertUnwindSafe(|| {
        eframe::run_native(
            "Firstbounce",
            options,
            Box::new(|creation| {
                opened = true;
                let mut slot = kept.borrow_mut();
                match &mut *slot {
                    None => *slot = Some(begin(creation, start)),
                    Some(window) => {
                        window.move_to(creation);
                        let line = losses.words(window.device().adapter());
                        window.session().warn(line);
                    }
                }
                Ok(Box::new(Shell(kept.clone())))
            }),
        )
    }));
    let result = match attempt {
        Ok(result) => result.map_err(|error| explain(&error.to_string())),
        Err(payload) => Err(explain(&panic_words(payload.as_ref()))),
    };
    Attempt { opened, result }
}

fn begin(creation: &CreationContext<'_>, start: &Start) -> Window {
    let mut window = Window::new(creation, Folders::of_system(), Arc::new(SystemDialogs));
    match start {
        Start::Set(path) => window.open_chosen(opening(path.clone())),
        Start::Result(path) => {
            window.open(Open::Set(path.clone()));
            window.session().panel = PanelName::Shape;
        }
        Start::Nothing => window.restore(),
    }
    window
}

/// What eframe owns and drops.
struct Shell(Kept);

impl App for Shell {
    fn logic(&mut self, context: &Context, frame: &mut eframe::Frame) {
        if let Some(window) = &mut *self.0.borrow_mut() {
            window.logic(context, frame);
        }
    }

    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        if let Some(window) = &mut *self.0.borrow_mut() {
            window.ui(ui, frame);
        }
    }

    fn on_exit(&mut self) {
        if let Some(window) = &mut *self.0.borrow_mut() {
            window.on_exit();
        }
    }
}

fn options(losses: &Losses) -> NativeOptions {
    let mut options = NativeOptions {
        viewport: ViewportBuilder::default()
            .with_title("Firstbounce")
            .with_app_id("firstbounce")
            .with_inner_size([1280.0, 800.0])
            .with_min_inner_size([640.0, 400.0])
            .with_drag_and_drop(true),
        ..NativeOptions::default()
    };
    if let egui_wgpu::WgpuSetup::CreateNew(setup) = &mut options.wgpu_options.wgpu_setup {
        // Photos are wider than the 8192 pixels that egui asks for.
        setup.device_descriptor =
            Arc::new(|adapter| wgpu::DeviceDescriptor { required_limits: adapter.limits(), ..Default::default() });
        setup.native_adapter_selector = losses.selector();
    }
    options
}

/// A panic first saves the document, then says one line; one that a reader of files catches does neither.
fn guard_document() {
    panic::set_hook(Box::new(|info: &PanicHookInfo<'_>| {
        if is_guarded() {
            return;
        }
        let saved = save_everything_now();
        let place = info.location().map(|place| format!(" ({}:{})", place.file(), place.line())).unwrap_or_default();
        let words = panic_words(info.payload());
        // Libraries that fail to load say so by a panic on the main thread; `run` explains those.
        if saved {
            eprintln!("firstbounce: {words}{place}; the unsaved set is offered at the next start");
        } else if std::thread::current().name() != Some("main") {
            eprintln!("firstbounce: {words}{place}");
        }
    }));
}

fn panic_words(payload: &(dyn std::any::Any + Send)) -> String {
    let text = payload.downcast_ref::<&str>().map(ToString::to_string);
    text.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_else(|| "something went wrong".into())
}

/// What the user can do about a window that does not open.
fn explain(reason: &str) -> anyhow::Error {
    let reason = reason.replace('\n', " ");
    let lower = reason.to_lowercase();
    if lower.contains("xkbcommon") {
        anyhow!(
            "the library libxkbcommon-x11 is missing: install libxkbcommon-x11-0 (Debian, Ubuntu) or libxkbcommon-x11 (Fedora); {ELSEWHERE}"
        )
    } else if lower.contains("surface") || lower.contains("adapter") || lower.contains("backend") {
        anyhow!(
            "no graphics driver can draw the window ({reason}): install mesa-vulkan-drivers, or libegl1 and libgl1-mesa-dri; {ELSEWHERE}"
        )
    } else if lower.contains("display") || lower.contains("wayland") || lower.contains("x11") {
        anyhow!("the display cannot be opened ({reason}); {ELSEWHERE}")
    } else {
        anyhow!("the window stopped: {reason}; {ELSEWHERE}")
    }
}

#[cfg(test)]
mod tests {
    use super::explain;

    #[test]
    fn what_keeps_a_window_from_opening_is_told_with_what_to_install_or_run() {
        let cases = [
            ("Library libxkbcommon-x11.so could not be loaded.", "libxkbcommon-x11-0"),
            ("Failed to create surface for any enabled backend: {}", "mesa-vulkan-drivers"),
            ("neither WAYLAND_DISPLAY nor WAYLAND_SOCKET nor DISPLAY is set.", "the display cannot be opened"),
            ("index out of bounds", "the window stopped"),
        ];
        for (reason, advice) in cases {
            let line = explain(reason).to_string();
            assert!(line.contains(advice) && line.contains("firstbounce solve SET") && !line.contains('\n'), "{line}");
        }
    }
}
