//! Other methods beside the one in force: whether to run them, how they converge, how they compare.

use eframe::egui::{Checkbox, Color32, RichText, Role, Ui, WidgetInfo};
use egui_plot::{Legend, Line, Plot, PlotPoints, Points};
use firstbounce_capture::pipeline::{Method, NayarErrors};
use firstbounce_core::methods::by_shape::ByShapeReport;

use crate::app::panels::method_options;
use crate::app::state::document::Document;
use crate::app::state::layout::Shown;
use crate::app::state::results::{ByMethod, Of, Plain, StageState, Step, SurfaceName};
use crate::app::state::session::Session;
use crate::app::widgets::advice::{advice, sentence};
use crate::app::widgets::theme::Weight;

const HEIGHT: f32 = 170.0;

/// `errors` are what the truth says of every iteration, where it was asked.
pub fn ui(ui: &mut Ui, session: &mut Session, document: &Document, errors: Option<&NayarErrors>) {
    ui.label(RichText::new("Another method, to compare").semi_bold());
    for method in Method::ALL.into_iter().filter(|method| *method != document.method()) {
        one(ui, session, document, method, errors);
    }
}

fn one(ui: &mut Ui, session: &mut Session, document: &Document, method: Method, errors: Option<&NayarErrors>) {
    let (title, mut compare) = (method.title(), document.is_compared(method));
    let hover = format!("{}. Takes seconds.", method.purpose());
    let impossible = method.impossible_for(&document.set);
    let tick = Checkbox::new(&mut compare, format!("Also solve by {title}"));
    // What was ticked before the colours went can be taken back.
    let tick = ui.add_enabled(impossible.is_none() || document.is_compared(method), tick);
    if tick.on_hover_text(hover).on_disabled_hover_text(sentence(impossible.unwrap_or_default())).changed() {
        let verb = if compare { "Solve" } else { "Stop solving" };
        session.edit(&format!("{verb} by {title}"), |document| document.settings.compare(method, compare));
    }
    if !compare {
        return;
    }
    method_options::ui(ui, session, document, method);
    let state = session.results.state(Step::ByMethod(method), document);
    match &state {
        StageState::Failed { line } | StageState::Blocked { line } | StageState::Cancelled { line } => {
            ui.colored_label(ui.visuals().error_fg_color, line);
        }
        StageState::Running { .. } | StageState::Stale => advice(ui, &format!("{} is running.", upper_first(title))),
        StageState::Ready => {}
    }
    // What failed for this document says nothing of an older result.
    if let Some(found) = session.results.by_method(method).filter(|_| !matches!(state, StageState::Failed { .. })) {
        outcome(ui, &found, document.method());
        if let Some(nayar) = found.solved.report.nayar() {
            convergence(ui, &nayar.report, errors);
        }
        pictures(ui, session, document, method);
    }
}

fn outcome(ui: &mut Ui, found: &ByMethod, in_force: Method) {
    if let Some(nayar) = found.solved.report.nayar() {
        iterations(ui, &nayar.report);
    }
    if let Some(angle) = found.from_after {
        let of = in_force.title();
        ui.label(format!("Its normals are {:.2} degrees from those by {of} on the mean.", angle.mean_deg));
    }
    for warning in &found.warnings {
        ui.colored_label(ui.visuals().warn_fg_color, warning);
    }
}

fn iterations(ui: &mut Ui, report: &ByShapeReport) {
    let iterations = report.steps.len().saturating_sub(1);
    ui.label(format!(
        "{} after {iterations} iterations over {} patches.",
        upper_first(report.ending.words()),
        report.patches
    ));
    if let (Some(first), Some(last)) = (report.steps.first(), report.steps.get(report.chosen)) {
        ui.label(format!(
            "Mean albedo {:.3}, before {:.3}. Light unexplained {:.1} %, before {:.1} %.",
            last.mean_albedo,
            first.mean_albedo,
            100.0 * last.residual,
            100.0 * first.residual
        ));
    }
}

/// How far each iteration turned the normals and, where the truth is known, how wrong they still were.
fn convergence(ui: &mut Ui, report: &ByShapeReport, errors: Option<&NayarErrors>) {
    let changes: Vec<[f64; 2]> = report.steps.iter().skip(1).map(|s| [s.iteration as f64, s.change_deg]).collect();
    let errors: Vec<[f64; 2]> = errors
        .iter()
        .flat_map(|all| &all.iterations)
        .zip(0..)
        .map(|(of, k)| [f64::from(k), of.error_deg.mean])
        .collect();
    let largest = changes.iter().chain(&errors).map(|[_, degrees]| *degrees).fold(0.1, f64::max);
    let widest = changes.len().max(1) as f64;
    let plot = Plot::new("convergence of Nayar's method")
        .height(HEIGHT)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .x_axis_label("iteration")
        .y_axis_label("degrees")
        .default_x_bounds(0.0, widest * 1.02)
        .default_y_bounds(0.0, largest * 1.1)
        .legend(Legend::default())
        .show(ui, |plot| {
            let visuals = &plot.ctx().global_style().visuals;
            let (blue, ink) = (visuals.hyperlink_color, visuals.warn_fg_color);
            let mut curve = |name: &str, points: &[[f64; 2]], colour: Color32| {
                plot.line(Line::new(name.to_owned(), PlotPoints::from(points.to_vec())).color(colour).width(2.0));
                plot.points(Points::new(name.to_owned(), points.to_vec()).color(colour).radius(3.0));
            };
            curve("normals turned", &changes, blue);
            if !errors.is_empty() {
                curve("normal error", &errors, ink);
            }
        });
    let turned: Vec<_> = changes.iter().map(|[k, degrees]| format!("iteration {k}: {degrees:.2}")).collect();
    let wrong: Vec<_> = errors.iter().map(|[k, degrees]| format!("iteration {k}: {degrees:.2}")).collect();
    let mut spoken = format!("Convergence of Nayar's method. Normals turned, degrees: {}", turned.join(", "));
    if !wrong.is_empty() {
        spoken += &format!(". Normal error, degrees: {}", wrong.join(", "));
    }
    plot.response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &spoken));
}

fn pictures(ui: &mut Ui, session: &mut Session, document: &Document, method: Method) {
    let name = SurfaceName::By(method);
    let depth = Plain::Depth.of(name);
    let minus_after = Shown::difference(depth.clone(), Plain::Depth.of(SurfaceName::After));
    let mut offered = vec![Shown::Normals(name), depth.into(), minus_after];
    if let Some(light) = document.set.lights.first() {
        let direct = Plain::DirectBy.of(Of::light_by(method, &light.name));
        let minus_direct = Shown::difference(direct.clone(), Plain::Direct.of(Of::light(&light.name)));
        offered.extend([direct.into(), minus_direct]);
    }
    ui.horizontal_wrapped(|ui| {
        for shown in offered {
            if ui.button(format!("Show {}", lower_first(&shown.title()))).clicked() {
                session.views.show(shown);
            }
        }
    });
}

fn upper_first(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Names keep their capitals.
fn lower_first(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_lowercase().chain(letters).collect())
}
