//! How direct light is told from indirect light: the choice of the method, and how far it is.

use eframe::egui::{ProgressBar, RadioButton, RichText, Role, Ui, WidgetInfo, vec2};
use firstbounce_capture::pipeline::Method;

use crate::app::state::document::Document;
use crate::app::state::layout::Shown;
use crate::app::state::results::{Plain, StageState, Step};
use crate::app::state::session::Session;
use crate::app::widgets::advice::sentence;
use crate::app::widgets::theme::Weight;

/// Of the line that says how far the method is: the same whatever it says, so that nothing below it moves.
const LINE_HEIGHT: f32 = 20.0;

pub fn choice(ui: &mut Ui, document: &Document, session: &mut Session) {
    ui.label(RichText::new("Method").semi_bold());
    let one_colour = document.set.colours.len() < 2;
    for method in Method::ALL {
        let impossible = method.impossible_for(&document.set);
        let is_chosen = document.method() == method && impossible.is_none();
        let radio = ui.add_enabled(impossible.is_none(), RadioButton::new(is_chosen, name(method)));
        let why = impossible.map(sentence);
        let radio = radio.on_hover_text(purpose(method)).on_disabled_hover_text(why.as_deref().unwrap_or_default());
        if radio.clicked() {
            session.edit(&format!("Separate by {}", method.title()), |document| {
                document.set.separation.method = Some(method);
            });
        }
        if let Some(why) = why {
            ui.indent(name(method), |ui| ui.label(RichText::new(why).small().weak()));
        }
    }
    if one_colour {
        // Without a second colour the paper's method takes nothing away.
        let nothing = document.method() == Method::Colours;
        if ui.radio(nothing, "None: all light counts as direct").clicked() {
            session.edit("Count all light as direct", |document| document.set.separation.method = None);
        }
    }
}

fn name(method: Method) -> &'static str {
    match method {
        Method::ColoursAndShape => "Colours and shape",
        Method::Colours => "Colours (the paper's bounces)",
        Method::Shape => "Shape (Nayar, one colour)",
    }
}

fn purpose(method: Method) -> &'static str {
    match method {
        Method::ColoursAndShape => "Least noise: the shape says what the indirect light is made of.",
        Method::Colours => "Tells bounces 1 to m apart, with more noise for each.",
        Method::Shape => "Simulates the bounces on the shape; needs the albedo of the grey ball.",
    }
}

/// How far the method is, and what to know of what it found. Why it failed is told in the list of steps.
pub fn outcome(ui: &mut Ui, document: &Document, session: &Session) {
    let title = document.method().title();
    let state = session.results.state(Step::Separate, document);
    let size = vec2(ui.available_width(), LINE_HEIGHT);
    let line = |ui: &mut Ui, words: String| ui.allocate_ui(size, |ui| ui.label(RichText::new(words).weak()));
    let running = |ui: &mut Ui, fraction: f32| {
        let words = format!("Separating by {title}");
        let bar = ui.add_sized(size, ProgressBar::new(fraction).text(&words));
        bar.widget_info(|| WidgetInfo::labeled(Role::ProgressIndicator, true, &words));
    };
    match state {
        StageState::Stale => running(ui, 0.0),
        StageState::Running { fraction } => running(ui, fraction),
        StageState::Failed { .. } | StageState::Blocked { .. } | StageState::Cancelled { .. } => {
            line(ui, format!("Not separated by {title}."));
        }
        StageState::Ready => {
            line(ui, format!("Separated by {title}."));
            for warning in session.results.method_light().iter().flat_map(|light| &light.warnings) {
                ui.colored_label(ui.visuals().warn_fg_color, sentence(warning));
            }
        }
    }
}

/// What the method finds under the light that is looked at.
pub fn pictures(ui: &mut Ui, document: &Document, session: &mut Session) {
    let shown = session.views.active().and_then(|view| view.shown.light().map(str::to_owned));
    let is_there = |light: &String| document.set.light_index(light).is_some();
    let Some(light) = shown.filter(is_there).or_else(|| document.set.lights.first().map(|light| light.name.clone()))
    else {
        return;
    };
    let all = [Plain::Direct, Plain::Indirect, Plain::IndirectRatio, Plain::IndirectAmount];
    ui.horizontal_wrapped(|ui| {
        for picture in all.into_iter().flat_map(|plain| plain.under(&light, document)) {
            let shown = Shown::from(picture);
            let title = shown.title();
            let (first, rest) = title.split_at(1);
            if ui.button(format!("Show {}{rest}", first.to_lowercase())).clicked() {
                session.views.show(shown);
            }
        }
    });
}
