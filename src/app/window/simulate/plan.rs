//! The rig planner: the error of the normals to be expected, against frames and against the ratio of albedos.

use eframe::egui::{Color32, RichText, Role, Ui, Vec2b, WidgetInfo};
use egui_plot::{Line, LineStyle, Plot, Points};
use firstbounce_core::Portion;
use firstbounce_lab::simulate::{PlanGrid, SimulateError, SimulateOptions, plan_advice, plan_rig};
use firstbounce_lab::{Plan, PlanMethod, PlanPoint};

use super::live::Live;
use super::values::Values;
use crate::app::base::jobs::Job;
use crate::app::widgets::advice::advice;
use crate::app::widgets::theme::{self, Weight};

const HEIGHT: f32 = 170.0;

/// A plan, and what to do about it.
pub struct Planned {
    plan: Plan,
    advice: String,
    /// The order m of the paper's method and its error, where another method is planned for.
    paper: Option<(usize, f64)>,
}

/// What a plan depends on.
#[derive(PartialEq)]
pub struct PlanFor {
    options: SimulateOptions,
    bounces: usize,
}

impl PlanFor {
    /// The plan of a set, beside that of the paper's method with order `bounces`. What it does not depend on is the same for all.
    pub fn new(options: &SimulateOptions, bounces: usize) -> Self {
        let grid = PlanGrid::default();
        let mut small = SimulateOptions {
            name: String::new(),
            patches: options.patches.min(grid.patches),
            size_px: options.size_px.min(grid.size_px),
            balls: None,
            ..options.clone()
        };
        small.sensor.seed = 0;
        Self { options: small, bounces }
    }
}

/// Plans for the rig of these options: by the method that a set of theirs is separated by, and the paper's for comparison.
pub fn compute(PlanFor { options, bounces }: &PlanFor, job: &Job) -> Result<Planned, SimulateError> {
    let own = options.sensor.frames;
    let mut grid = PlanGrid::default();
    grid.frames.push(own);
    grid.frames.sort_unstable();
    grid.frames.dedup();
    let plan = plan_rig(options, &grid, &Portion { watch: job, from: 0.0, to: 0.8 })?;
    let paper = PlanMethod::Colours { bounces: *bounces };
    let paper = if plan.method.method() == paper.method() {
        None
    } else {
        let grid = PlanGrid { method: Some(paper), frames: vec![own], ratios: Vec::new(), ..grid };
        let plan = plan_rig(options, &grid, &Portion { watch: job, from: 0.8, to: 1.0 })?;
        plan.by_frames.first().map(|point| (*bounces, point.error_deg))
    };
    let advice = plan_advice(&plan, own);
    Ok(Planned { plan, advice, paper })
}

/// Shows the plan.
pub fn ui(ui: &mut Ui, live: &Live<PlanFor, Planned>, values: &mut Values) {
    ui.horizontal(|ui| {
        ui.label(RichText::new("Rig planner").semi_bold());
        if live.is_busy() {
            ui.label("is being computed...");
        }
    });
    order(ui, values);
    let frames = values.base.sensor.frames;
    let Some(Planned { plan, advice: words, paper }) = live.outcome().map(AsRef::as_ref) else {
        advice(ui, "The error of the normals that this rig can be expected to have comes here.");
        return;
    };
    ui.label(words);
    let paper =
        paper.map_or_else(String::new, |(m, degrees)| format!("; the paper's method: {degrees:.2} with order m = {m}"));
    ui.label(
        RichText::new(format!("Mean error of the normals in degrees{paper}; before: {:.2}.", plan.raw_deg))
            .small()
            .weak(),
    );
    ui.horizontal_wrapped(|ui| {
        for part in parts(ui, plan.method) {
            ui.colored_label(part.colour, part.name);
        }
    });
    ui.add_space(4.0);
    curve(
        ui,
        "Error in degrees against frames",
        plan.method,
        &plan.by_frames,
        &Axis {
            at: |point| (point.frames as f64).log2(),
            words: |point| point.frames.to_string(),
            // Between two powers of two there is no whole number of frames that the axis could name.
            tick: |x| if (x - x.round()).abs() < 1e-6 { format!("{:.0}", x.exp2()) } else { String::new() },
        },
    );
    if !plan.by_ratio.is_empty() {
        let ratio =
            Axis { at: |point| point.ratio, words: |point| format!("{:.2}", point.ratio), tick: |x| format!("{x:.1}") };
        let of = if frames == 1 { "1 frame".to_owned() } else { format!("{frames} frames") };
        curve(ui, &format!("Error in degrees against the ratio of albedos, {of}"), plan.method, &plan.by_ratio, &ratio);
    }
}

/// The order m of the paper's method, where there is a choice.
fn order(ui: &mut Ui, values: &mut Values) {
    let (colours, chosen) = (values.base.albedos.len(), values.order());
    if colours < 3 {
        return;
    }
    ui.horizontal_wrapped(|ui| {
        ui.label("For comparison, the paper's method with order");
        for m in 2..=colours {
            if ui.radio(m == chosen, format!("m = {m}")).clicked() {
                values.bounces = m;
            }
        }
    });
}

/// What a plot's x axis is.
struct Axis {
    at: fn(&PlanPoint) -> f64,
    words: fn(&PlanPoint) -> String,
    tick: fn(f64) -> String,
}

/// One curve of a plot.
struct Part {
    name: String,
    colour: Color32,
    degrees: fn(&PlanPoint) -> f64,
}

fn parts(ui: &Ui, method: PlanMethod) -> [Part; 3] {
    let visuals = ui.visuals();
    [
        Part { name: "by noise".to_owned(), colour: visuals.hyperlink_color, degrees: |point| point.noise_deg },
        Part {
            name: format!("by {}", method.remainder()),
            colour: visuals.warn_fg_color,
            degrees: |point| point.remainder_deg,
        },
        Part { name: "by both".to_owned(), colour: theme::fine(visuals), degrees: |point| point.error_deg },
    ]
}

fn curve(ui: &mut Ui, title: &str, method: PlanMethod, points: &[PlanPoint], axis: &Axis) {
    ui.label(title);
    let parts = parts(ui, method);
    let plot = Plot::new(title.split(',').next().unwrap_or(title))
        .height(HEIGHT)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .include_y(0.0)
        .auto_bounds(Vec2b::TRUE)
        .x_axis_formatter(|mark, _| (axis.tick)(mark.value))
        .show(ui, |plot| {
            for part in &parts {
                let curve: Vec<_> = points.iter().map(|point| [(axis.at)(point), (part.degrees)(point)]).collect();
                plot.points(Points::new(&part.name, curve.clone()).radius(3.0).color(part.colour));
                let style = if part.name == "by both" { LineStyle::Solid } else { LineStyle::dashed_loose() };
                plot.line(Line::new(&part.name, curve).width(2.0).style(style).color(part.colour));
            }
        });
    let spoken = points.iter().map(|point| format!("{}: {:.2}", (axis.words)(point), point.error_deg));
    let spoken = format!("{title}. {}", spoken.collect::<Vec<_>>().join("; "));
    plot.response.widget_info(|| WidgetInfo::labeled(Role::Image, true, &spoken));
}
