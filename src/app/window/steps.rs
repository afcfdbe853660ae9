//! The five steps in one row, and below it the one thing to know of the open step, with a button that mends it.

use eframe::egui::{Align, Button, Color32, Label, Layout, Panel, RichText, Role, Ui, WidgetInfo};
use firstbounce_capture::pipeline::Method;

use super::pages::Pages;
use crate::app::state::panel::{PanelName, StepState};
use crate::app::state::session::Session;
use crate::app::state::words::in_window;
use crate::app::widgets::advice::sentence;
use crate::app::widgets::theme::{self, Weight};

/// Of the line below the steps, in points: it stays as high whatever it says.
const MESSAGE_HEIGHT: f32 = 22.0;

/// What mends the most important thing.
enum Remedy {
    Open(PanelName),
    ReadAgain,
    Retry,
}

impl Remedy {
    fn words(&self) -> String {
        match self {
            Self::Open(step) => format!("Go to {}", step.title()),
            Self::ReadAgain => "Read the photos again".into(),
            Self::Retry => "Retry".into(),
        }
    }

    fn run(&self, session: &mut Session) {
        match self {
            Self::Open(step) => session.panel = *step,
            Self::ReadAgain => session.results.reload(),
            Self::Retry => session.results.retry(),
        }
    }
}

/// Shows the steps; a click opens one.
pub fn ui(ui: &mut Ui, session: &mut Session, pages: &mut Pages) {
    Panel::top("steps row").show(ui, |ui| {
        ui.add_space(2.0);
        ui.horizontal(|ui| {
            for (number, name) in (1..).zip(PanelName::ALL) {
                let state = name.state(session);
                let (sign, colour) = look(&state, ui);
                let text = RichText::new(format!("{number}  {}", name.title())).semi_bold();
                let is_open = session.panel == name;
                let step = ui.selectable_label(is_open, text);
                step.widget_info(|| {
                    WidgetInfo::selected(Role::Button, true, is_open, format!("{number}  {}", name.title()))
                });
                if step.on_hover_text(state.word()).clicked() {
                    session.panel = name;
                }
                let word = ui.label(RichText::new(sign).color(colour));
                word.widget_info(|| WidgetInfo::labeled(Role::Label, true, state.word()));
                ui.add_space(10.0);
            }
            let about = ui.small_button("?");
            about.widget_info(|| WidgetInfo::labeled(Role::Button, true, format!("About {}", session.panel.title())));
            if about.on_hover_text("What this step is for, and what to do in it").clicked() {
                pages.toggle(session.panel);
            }
        });
        message(ui, session);
        ui.add_space(2.0);
    });
}

/// One line of fixed height: what is most important in the open step.
fn message(ui: &mut Ui, session: &mut Session) {
    let document = session.document();
    let (line, colour, remedy) = most_important(ui, session);
    ui.horizontal(|ui| {
        ui.set_min_height(MESSAGE_HEIGHT);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            if let Some(remedy) = remedy.filter(|remedy| ui.add(Button::new(remedy.words())).clicked()) {
                remedy.run(session);
            }
            let line = sentence(&in_window(&line, &document.set));
            ui.with_layout(Layout::left_to_right(Align::Center), |ui| {
                ui.add(Label::new(RichText::new(&line).color(colour)).truncate()).on_hover_text(line);
            });
        });
    });
}

fn most_important(ui: &Ui, session: &Session) -> (String, Color32, Option<Remedy>) {
    let visuals = ui.visuals();
    let (step, error, warning) = (session.panel, visuals.error_fg_color, visuals.warn_fg_color);
    match step.state(session) {
        StepState::Empty { line } if step == PanelName::Captures => (line, visuals.weak_text_color(), None),
        StepState::Empty { line } => (line, visuals.weak_text_color(), Some(Remedy::Open(PanelName::Captures))),
        StepState::Incomplete { line } => match lacking(step, session) {
            // Told where it is: the later step says only which one it waits for.
            Some(before) => (format!("Waits for {}", before.title()), warning, Some(Remedy::Open(before))),
            None => (line, warning, None),
        },
        StepState::Failed { line } if step == PanelName::Captures => (line, error, Some(Remedy::ReadAgain)),
        StepState::Failed { line } => (line, error, Some(Remedy::Retry)),
        StepState::Cancelled { line } => (line, visuals.weak_text_color(), Some(Remedy::Retry)),
        StepState::Running { .. } => (format!("{} is being computed", step.title()), visuals.weak_text_color(), None),
        StepState::TakeCare => (step.cares(session).unwrap_or_else(|| look_at(session).into()), warning, None),
        StepState::Ready => (look_at(session).into(), visuals.weak_text_color(), None),
    }
}

/// The first step before this one that has no results.
fn lacking(step: PanelName, session: &Session) -> Option<PanelName> {
    let before = PanelName::ALL.into_iter().take_while(|before| *before != step);
    let lacks = |name: &PanelName| !matches!(name.state(session), StepState::Ready | StepState::TakeCare);
    before.into_iter().find(lacks)
}

/// What to look at in a step that is ready.
fn look_at(session: &Session) -> &'static str {
    match session.panel {
        PanelName::Captures => "Check that no photo is clipped and few pixels are dark",
        PanelName::Calibrate => "Circles on the balls' edges, highlights on the lamps, every value fine",
        PanelName::Separate if session.document().method() == Method::Colours => {
            "Choose the highest order m whose verdict is fine"
        }
        PanelName::Separate => "Little light should be left in the creases of the direct light",
        PanelName::Shape => "Compare the surface before and after: drag either to turn both",
        PanelName::Export => "Choose what to write, and where",
    }
}

/// The primary action of a step that has none of its own: the next step.
pub fn next(ui: &mut Ui, session: &mut Session) {
    let place = PanelName::ALL.iter().position(|name| *name == session.panel);
    let Some(next) = place.and_then(|place| PanelName::ALL.get(place + 1)) else { return };
    if ui.add(theme::primary(ui.visuals(), format!("Next: {}", next.title()))).clicked() {
        session.panel = *next;
    }
}

fn look(state: &StepState, ui: &Ui) -> (&'static str, Color32) {
    let visuals = ui.visuals();
    match state {
        StepState::Empty { .. } => ("\u{25cb}", visuals.weak_text_color()),
        StepState::Incomplete { .. } => ("\u{25cb}", visuals.warn_fg_color),
        StepState::Running { .. } => ("\u{2026}", visuals.hyperlink_color),
        StepState::Ready => ("\u{2714}", theme::fine(visuals)),
        StepState::TakeCare => ("\u{26a0}", visuals.warn_fg_color),
        StepState::Failed { .. } => ("\u{2716}", visuals.error_fg_color),
        StepState::Cancelled { .. } => ("\u{25cb}", visuals.weak_text_color()),
    }
}
