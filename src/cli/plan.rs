//! `firstbounce plan SCENE`

use clap::Args;
use firstbounce_capture::pipeline::simulate::{PlanGrid, plan_advice, plan_rig};
use firstbounce_core::lab::{Plan, PlanPoint};
use serde::Serialize;

use super::progress::Terminal;
use super::scene::SceneArgs;
use super::table::{row, table};
use super::{PrintArgs, print, print_json, print_warnings};

#[derive(Args, Debug)]
pub struct PlanArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// The order m that will be separated [default: 2, or 1 for one colour]
    #[arg(long, value_name = "M")]
    bounces: Option<usize>,
    /// Numbers of frames to look at
    #[arg(long, value_name = "A,B,..", value_delimiter = ',', default_values_t = PlanGrid::default().frames)]
    try_frames: Vec<usize>,
    /// Ratios of the last albedo to the first to look at
    #[arg(long, value_name = "A,B,..", value_delimiter = ',', default_values_t = PlanGrid::default().ratios)]
    try_ratios: Vec<f64>,
    #[command(flatten)]
    print: PrintArgs,
}

/// The plan, for programs. Angles are means over the pixels that three lamps light.
#[derive(Debug, Serialize)]
struct PlanWords {
    scene: String,
    bounces: usize,
    raw_deg: f64,
    by_frames: Vec<PlanPointWords>,
    by_ratio: Vec<PlanPointWords>,
    warnings: Vec<String>,
}

#[derive(Debug, Serialize)]
struct PlanPointWords {
    albedos: Vec<f64>,
    ratio: f64,
    frames: usize,
    gain: f64,
    noise_deg: f64,
    tail_deg: f64,
    error_deg: f64,
}

/// Runs the command.
pub fn run(args: &PlanArgs) -> anyhow::Result<()> {
    let terminal = Terminal::attend();
    let (options, warnings) = args.scene.options()?;
    let grid = PlanGrid {
        bounces: args.bounces,
        frames: args.try_frames.clone(),
        ratios: args.try_ratios.clone(),
        ..PlanGrid::default()
    };
    let plan = plan_rig(&options, &grid, &terminal.job("plan"));
    terminal.finish();
    let plan = plan?;
    print_warnings(&warnings);
    if args.print.json {
        print_json(&PlanWords::of(&plan, options.scene.name(), warnings))
    } else {
        let advice = plan_advice(&plan, options.sensor.frames);
        print(&format!("{}\n\n{advice}", text(&plan, options.scene.name())))
    }
}

impl PlanWords {
    fn of(plan: &Plan, scene: &str, warnings: Vec<String>) -> Self {
        let words = |points: &[PlanPoint]| points.iter().map(PlanPointWords::of).collect();
        Self {
            scene: scene.to_owned(),
            bounces: plan.bounces,
            raw_deg: plan.raw_deg,
            by_frames: words(&plan.by_frames),
            by_ratio: words(&plan.by_ratio),
            warnings,
        }
    }
}

impl PlanPointWords {
    fn of(point: &PlanPoint) -> Self {
        let PlanPoint { ratio, frames, gain, noise_deg, tail_deg, error_deg, .. } = *point;
        Self { albedos: point.albedos.clone(), ratio, frames, gain, noise_deg, tail_deg, error_deg }
    }
}

fn text(plan: &Plan, scene: &str) -> String {
    let errors = |point: &PlanPoint| {
        [point.noise_deg, point.tail_deg, point.error_deg].map(|degrees| format!("{degrees:.2}")).to_vec()
    };
    let rows = |heading: &str, points: &[PlanPoint], first: &dyn Fn(&PlanPoint) -> String| {
        let mut rows = vec![row([heading, "gain", "by noise, degrees", "by later bounces", "both"])];
        rows.extend(points.iter().map(|point| {
            let mut cells = vec![first(point), format!("{:.1}", point.gain)];
            cells.extend(errors(point));
            cells
        }));
        table(&rows)
    };
    let mut lines = vec![
        format!(
            "{scene}, {} bounces separated; normals from the photos as they are: {:.2} degrees off",
            plan.bounces, plan.raw_deg
        ),
        String::new(),
        rows("frames", &plan.by_frames, &|point| point.frames.to_string()),
    ];
    if let (Some(best), Some(first)) = (plan.best_ratio(), plan.by_ratio.first()) {
        lines.push(String::new());
        lines.push(rows("ratio of albedos", &plan.by_ratio, &|point| point.ratio.to_string()));
        lines.push(format!(
            "of these ratios {} is best for {} frames: {:.2} degrees",
            best.ratio, first.frames, best.error_deg
        ));
    }
    lines.join("\n")
}
