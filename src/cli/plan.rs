//! `firstbounce plan SCENE`

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use firstbounce_capture::pipeline::Method;
use firstbounce_lab::simulate::{PlanGrid, plan_advice, plan_rig};
use firstbounce_lab::{Plan, PlanMethod, PlanPoint};
use serde::Serialize;

use super::progress::Terminal;
use super::scene::SceneArgs;
use super::table::{row, table};
use super::{PrintArgs, print, print_json, print_warnings};

#[derive(Args, Debug)]
pub struct PlanArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// How direct light will be told from indirect light [default: colours-and-shape where there are two colours]
    #[arg(long, value_parser = methods())]
    method: Option<Method>,
    /// How many bounces the paper's method will separate; chooses --method colours [default: 2, or 1 for one colour]
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

/// The methods that a plan knows.
const METHODS: [Method; 2] = [Method::ColoursAndShape, Method::Colours];

fn methods() -> impl TypedValueParser<Value = Method> {
    let named = |method: Method| PossibleValue::new(method.name()).aliases(method.alias()).help(method.purpose());
    PossibleValuesParser::new(METHODS.map(named)).map(|name| Method::from_name(&name).unwrap_or_default())
}

impl PlanArgs {
    /// What is asked for; `None` for what a set of these colours is separated by.
    fn method_for(&self, colours: usize) -> anyhow::Result<Option<PlanMethod>> {
        match (self.method, self.bounces) {
            (None | Some(Method::Colours), Some(bounces)) => Ok(Some(PlanMethod::Colours { bounces })),
            (Some(method), Some(_)) => anyhow::bail!(
                "--bounces is for --method {}; {} takes all indirect light together, leave it out",
                Method::Colours,
                method.title()
            ),
            (Some(Method::ColoursAndShape), None) if colours < 2 => {
                anyhow::bail!("--method {} needs two colours: give --albedos two or more", Method::ColoursAndShape)
            }
            (Some(Method::ColoursAndShape), None) => Ok(Some(PlanMethod::ColoursAndShape)),
            (Some(_), None) => Ok(Some(PlanMethod::paper(colours))),
            (None, None) => Ok(None),
        }
    }
}

/// The plan, for programs. Angles are means over the pixels that three lamps light.
#[derive(Debug, Serialize)]
struct PlanRecord<'a> {
    scene: String,
    method: Method,
    /// The order m; 1 where all indirect light is taken together.
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
        method: args.method_for(options.albedos.len())?,
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
            method: plan.method.method(),
            bounces: plan.method.bounces(),
            raw_deg: plan.raw_deg,
            by_frames: &plan.by_frames,
            by_ratio: &plan.by_ratio,
            warnings,
        }
    }
}

fn text(plan: &Plan, scene: &str) -> String {
    let errors = |point: &PlanPoint| {
        [point.noise_deg, point.remainder_deg, point.error_deg].map(|degrees| format!("{degrees:.2}")).to_vec()
    };
    let remainder = format!("by {}", plan.method.remainder());
    let rows = |heading: &str, points: &[PlanPoint], first: &dyn Fn(&PlanPoint) -> String| {
        let mut rows = vec![row([heading, "gain", "by noise, degrees", &remainder, "both"])];
        rows.extend(points.iter().map(|point| {
            let mut cells = vec![first(point), format!("{:.1}", point.gain)];
            cells.extend(errors(point));
            cells
        }));
        table(&rows)
    };
    let how = match plan.method {
        PlanMethod::ColoursAndShape => format!("separated by {}", Method::ColoursAndShape.title()),
        PlanMethod::Colours { bounces: 1 } => "nothing separated".to_owned(),
        PlanMethod::Colours { bounces } => format!("{bounces} bounces separated by {}", Method::Colours.title()),
    };
    let mut lines = vec![
        format!("{scene}, {how}; normals before separation: {:.2} degrees off", plan.raw_deg),
        String::new(),
        rows("frames", &plan.by_frames, &|point| point.frames.to_string()),
    ];
    if let (Some(best), Some(first)) = (plan.best_ratio(), plan.by_ratio.first()) {
        lines.push(String::new());
        lines.push(rows("ratio of albedos", &plan.by_ratio, &|point| point.ratio.to_string()));
        lines.push(format!(
            "of these ratios {} is best for {}: {:.2} degrees",
            best.ratio,
            if first.frames == 1 { "1 frame".to_owned() } else { format!("{} frames", first.frames) },
            best.error_deg
        ));
    }
    lines.join("\n")
}
