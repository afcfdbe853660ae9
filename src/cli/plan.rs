//! `firstbounce plan SCENE`

use clap::Args;
use firstbounce_lab::simulate::{PlanGrid, plan_advice, plan_rig};
use firstbounce_lab::{Plan, PlanPoint};
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
struct PlanRecord<'a> {
    scene: String,
    bounces: usize,
    raw_deg: f64,
    by_frames: &'a [PlanPoint],
    by_ratio: &'a [PlanPoint],
    warnings: Vec<String>,
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
        print_json(&PlanRecord::of(&plan, options.scene.name(), warnings))
    } else {
        let advice = plan_advice(&plan, options.sensor.frames);
        print(&format!("{}\n\n{advice}", text(&plan, options.scene.name())))
    }
}

impl<'a> PlanRecord<'a> {
    fn of(plan: &'a Plan, scene: &str, warnings: Vec<String>) -> Self {
        Self {
            scene: scene.to_owned(),
            bounces: plan.bounces,
            raw_deg: plan.raw_deg,
            by_frames: &plan.by_frames,
            by_ratio: &plan.by_ratio,
            warnings,
        }
    }
}

fn text(plan: &Plan, scene: &str) -> String {
    let errors = |point: &PlanPoint| {
        [point.noise_deg, point.truncation_deg, point.error_deg].map(|degrees| format!("{degrees:.2}")).to_vec()
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
            "{scene}, {} bounces separated; normals before separation: {:.2} degrees off",
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
