//! The Shape panel: lights, shadow thresholds, and the surface before and after.

mod card;
mod methods;
mod paint;

use std::sync::Arc;

use eframe::egui::{Button, DragValue, Grid, RichText, Ui, Vec2, vec2};
use firstbounce_capture::pipeline::{Evaluation, Method, PipelineError, evaluate};
use firstbounce_capture::set::{Number, ShapeSettings};
use firstbounce_core::stereo::shape::Shape;

use super::Panel;
use super::reference::ReferencePanel;
use crate::app::base::jobs::Job;
use crate::app::base::keyed::Keyed;
use crate::app::state::document::Document;
use crate::app::state::layout::Shown;
use crate::app::state::results::{Plain, Shapes, StageState, Step, SurfaceName, stage_of};
use crate::app::state::session::Session;
use crate::app::widgets::advice::advice;
use crate::app::widgets::number_field;
use crate::app::widgets::part::part;
use crate::app::widgets::theme::Weight;

/// Between the cells of tables, in points.
const TIGHT: Vec2 = vec2(8.0, 4.0);

/// Photometric stereo solves for three unknowns.
const MIN_LIGHTS: usize = 3;

/// The panel.
#[derive(Default)]
pub struct ShapePanel {
    /// What the truth says of a document.
    evaluated: Keyed<Arc<Document>, Evaluated>,
    /// What decides over it, of the document that was looked at last.
    judged: Option<(Arc<Document>, Arc<Document>)>,
    reference: ReferencePanel,
}

impl Panel for ShapePanel {
    fn ui(&mut self, ui: &mut Ui, session: &mut Session) {
        let document = session.document();
        self.evaluate(session, &document);
        match session.results.state(Step::Shape, &document) {
            StageState::Failed { line } | StageState::Blocked { line } | StageState::Cancelled { line } => {
                ui.colored_label(ui.visuals().error_fg_color, line);
            }
            StageState::Running { .. } | StageState::Stale => advice(ui, "The surface is being computed."),
            StageState::Ready => {}
        }
        let judged = self.judged(&document);
        let evaluated = self.evaluated.of(&judged).and_then(|outcome| outcome.as_ref().ok());
        if let Some(shapes) = session.results.shapes() {
            let truth = evaluated.map(|evaluated| &evaluated.in_force);
            part(ui, "result", |ui| card::ui(ui, session, &document, &shapes, truth));
            paint::found(ui, &document, &shapes.after);
            part(ui, "numbers", |ui| before_and_after(ui, session, &shapes));
        }
        part(ui, "lights and thresholds", |ui| {
            ui.collapsing("Lights and thresholds", |ui| {
                lights(ui, session, &document);
                options(ui, session, &document);
            })
        });
        ui.separator();
        let errors = evaluated.and_then(|evaluated| evaluated.compared.iter().find_map(|(_, of)| of.nayar.as_ref()));
        methods::ui(ui, session, &document, errors);
        self.truth(ui, &document);
        self.reference.ui(ui, session, &document);
    }
}

fn lights(ui: &mut Ui, session: &mut Session, document: &Document) {
    ui.label(RichText::new("Lights").semi_bold());
    if document.set.lights.is_empty() {
        advice(ui, "This set has no light yet: add photos in Captures.");
    }
    let left_out = &document.set.shape.leave_out;
    let used = document.set.lights.iter().filter(|light| !left_out.contains(&light.name)).count();
    for light in &document.set.lights {
        let mut is_used = !left_out.contains(&light.name);
        // A normal needs at least three lights; the fourth can be spared.
        let can_change = !is_used || used > MIN_LIGHTS;
        let check =
            ui.add_enabled(can_change, eframe::egui::Checkbox::new(&mut is_used, format!("Use {}", light.name)));
        if check.on_disabled_hover_text("Normals need at least three lights").changed() {
            let name = light.name.clone();
            let verb = if is_used { "Use light" } else { "Leave out light" };
            session.edit(&format!("{verb} {name}"), |document| {
                let left_out = &mut document.set.shape.leave_out;
                left_out.retain(|other| *other != name);
                if !is_used {
                    left_out.push(name);
                }
            });
        }
    }
}

fn options(ui: &mut Ui, session: &mut Session, document: &Document) {
    let mut settings = document.set.shape.clone();
    let mut changed = None;
    Grid::new("shape options").num_columns(2).show(ui, |ui| {
        let mut percent = |ui: &mut Ui, label: &str, hover: &str, share: &mut f64| {
            let name = ui.label(label).on_hover_text(hover);
            let field = number_field::percent(share, 1, Number::ShadowShare.range()).speed(0.001);
            if ui.add(field).labelled_by(name.id).changed() {
                changed = Some(format!("Change {}", label.to_lowercase()));
            }
            ui.end_row();
        };
        percent(
            ui,
            "Shadow threshold",
            "A light is in shadow at a pixel where it is weaker than this share of the brightest light",
            &mut settings.shadow_share,
        );
        percent(
            ui,
            "Misfit threshold",
            "With five or more lights, one that misses the fit by more than this share of the brightest is left out",
            &mut settings.misfit_share,
        );
        let near = "How often the directions to near lamps are computed again from the depth; distant lamps need one iteration";
        let name = ui.label("Near-light iterations").on_hover_text(near);
        let field = DragValue::new(&mut settings.rounds).range(Number::Rounds.whole_range()).speed(0.05);
        if ui.add(field).labelled_by(name.id).changed() {
            changed = Some("Change near-light iterations".into());
        }
        ui.end_row();
    });
    if let Some(name) = paint::choice(ui, document, &mut settings) {
        changed = Some(name);
    }
    if let Some(name) = changed {
        session.edit(&name, |document| document.set.shape = settings);
    }
    let ShapeSettings { leave_out, indirect_window_px, .. } = document.set.shape.clone();
    let default = ShapeSettings { leave_out, indirect_window_px, ..ShapeSettings::default() };
    let is_default = document.set.shape == default;
    if ui.add_enabled(!is_default, Button::new("Reset to defaults")).clicked() {
        session.edit("Reset shape options", |document| document.set.shape = default);
    }
}

fn before_and_after(ui: &mut Ui, session: &mut Session, shapes: &Shapes) {
    let document = session.document();
    let others = document.compared().map(SurfaceName::By);
    let is_ready = |name: &SurfaceName| session.results.state(stage_of(*name), &document) == StageState::Ready;
    let mut columns = vec![("before".to_owned(), shapes.before.clone()), ("after".to_owned(), shapes.after.clone())];
    columns.extend(others.filter(is_ready).filter_map(|name| Some((name.words(), session.results.shape(name)?))));
    ui.collapsing("Numbers before and after", |ui| {
        Grid::new("before and after").num_columns(1 + columns.len()).striped(true).spacing(TIGHT).show(ui, |ui| {
            ui.label("");
            for (heading, _) in &columns {
                ui.label(RichText::new(heading).semi_bold());
            }
            ui.end_row();
            for (what, meaning, value) in ROWS {
                ui.label(*what).on_hover_text(*meaning);
                for (_, shape) in &columns {
                    ui.monospace(value(shape));
                }
                ui.end_row();
            }
        });
    });
    if let Some(turned) = shapes.turned {
        ui.label(format!(
            "Mean change of the normals {:.2}\u{b0}, median {:.2}\u{b0}.",
            turned.mean_deg, turned.median_deg
        ));
    }
    ui.horizontal_wrapped(|ui| {
        for shown in [
            Shown::Normals(SurfaceName::After),
            Shown::Normals(SurfaceName::Before),
            Plain::Depth.of(SurfaceName::After).into(),
            Plain::Albedo.of(SurfaceName::After).into(),
            Shown::difference(Plain::Depth.of(SurfaceName::After), Plain::Depth.of(SurfaceName::Before)),
        ] {
            if ui.button(format!("Show {}", shown.title().to_lowercase())).clicked() {
                session.views.show(shown);
            }
        }
    });
}

/// What it is called, what it means, and the value.
type Row = (&'static str, &'static str, fn(&Shape) -> String);

const ROWS: &[Row] = &[
    ("Solved", "Pixels with a normal", |shape| shape.report.normals.solved_pixels.to_string()),
    ("Unsolved", "Pixels without a normal", |shape| shape.report.normals.unsolved_pixels.to_string()),
    ("In shadow", "Pixels with a light left out, for it is in shadow there", |shape| {
        shape.report.normals.shadowed_pixels.to_string()
    }),
    ("Noise, degrees", "Expected noise of the normals", |shape| format!("{:.2}", shape.report.normals.mean_noise_deg)),
    ("Albedo", "Mean albedo", |shape| format!("{:.4}", shape.report.normals.mean_albedo)),
    ("Conditioning", "Condition number of the light matrix", |shape| {
        format!("{:.2}", shape.report.normals.condition_number)
    }),
    ("Slope residual", "Slope residual of the depth", |shape| format!("{:.4}", shape.depth.report.rms_slope_residual)),
    ("Parts", "Unconnected parts of the object", |shape| shape.depth.report.islands.to_string()),
];

impl ShapePanel {
    /// Compares with the truth of a set that knows it, as soon as there is a surface.
    fn evaluate(&mut self, session: &mut Session, document: &Arc<Document>) {
        self.evaluated.poll();
        let is_ready =
            session.results.is_at_rest(document) && session.results.state(Step::Shape, document) == StageState::Ready;
        let judged = self.judged(document);
        if is_ready && self.evaluated.wants(&judged) && document.set.truth_normals().is_file() {
            let edited = judged.clone();
            let task = session.jobs.start("Compare with the truth", move |job| Evaluated::of(&edited, job));
            self.evaluated.start(judged, task);
        }
    }

    /// The document without what the truth says nothing of: exports, and a scan.
    fn judged(&mut self, document: &Arc<Document>) -> Arc<Document> {
        if let Some((_, judged)) = self.judged.as_ref().filter(|(of, _)| Arc::ptr_eq(of, document)) {
            return judged.clone();
        }
        let mut judged = Document::clone(document);
        (judged.settings.reference, judged.settings.export) = Default::default();
        let judged = Arc::new(judged);
        self.judged = Some((document.clone(), judged.clone()));
        judged
    }

    /// For sets that know the truth.
    fn truth(&mut self, ui: &mut Ui, document: &Arc<Document>) {
        let judged = self.judged(document);
        if !document.set.truth_normals().is_file() {
            return;
        }
        ui.separator();
        ui.label(RichText::new("Against the truth of this set").semi_bold());
        if self.evaluated.running().is_some() {
            advice(ui, "Comparing with the truth.");
        }
        match self.evaluated.last() {
            Some((_, Err(error))) => {
                ui.colored_label(ui.visuals().error_fg_color, error.to_string());
            }
            Some((of, Ok(evaluation))) => {
                evaluation_ui(ui, evaluation);
                if *of != judged {
                    ui.colored_label(ui.visuals().warn_fg_color, "Of the set before it was edited.");
                }
            }
            None => {}
        }
    }
}

/// What the truth says of the method in force and of those that are compared.
struct Evaluated {
    in_force: Evaluation,
    compared: Vec<(Method, Evaluation)>,
}

impl Evaluated {
    fn of(document: &Document, job: &Job) -> Result<Self, PipelineError> {
        let by = |method: Method| evaluate(&document.set, &document.options(method), job);
        let in_force = by(document.method())?;
        let compared = document.compared().map(|method| Ok((method, by(method)?)));
        Ok(Self { in_force, compared: compared.collect::<Result<_, PipelineError>>()? })
    }
}

fn evaluation_ui(ui: &mut Ui, Evaluated { in_force: evaluation, compared }: &Evaluated) {
    let errors = &evaluation.normal_error_deg;
    Grid::new("truth").num_columns(2).striped(true).spacing(TIGHT).show(ui, |ui| {
        let mut row = |what: &str, value: String| {
            ui.label(what);
            ui.monospace(value);
            ui.end_row();
        };
        row("Normal error before, mean", format!("{:.2}\u{b0}", errors.raw.mean));
        row("Normal error after, mean", format!("{:.2}\u{b0}", errors.separated.mean));
        for (method, of) in compared {
            let mean = of.normal_error_deg.separated.mean;
            row(&format!("Normal error by {}, mean", method.title()), format!("{mean:.2}\u{b0}"));
        }
        if let Some(direct) = errors.true_direct {
            row("From true direct light, mean", format!("{:.2}\u{b0}", direct.mean));
        }
        for (what, rmse) in
            [("Depth error before", evaluation.depth_rmse_raw_mm), ("Depth error after", evaluation.depth_rmse_mm)]
        {
            if let Some(rmse) = rmse {
                row(what, format!("{rmse:.3} mm"));
            }
        }
    });
    ui.label(format!("{} of {} pixels compared.", evaluation.pixels, evaluation.pixels_with_truth));
}
