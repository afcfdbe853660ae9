//! `firstbounce evaluate SET`

use clap::Args;
use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::{Angles, Evaluation, Method, Work, evaluate};

use super::memory::MemoryArgs;
use super::progress::Terminal;
use super::solve::MethodArgs;
use super::table::{row, table};
use super::{PrintArgs, SetArgs, print, print_json, print_warnings};

#[derive(Args, Debug)]
pub struct EvaluateArgs {
    #[command(flatten)]
    set: SetArgs,
    #[command(flatten)]
    solve: MethodArgs,
    #[command(flatten)]
    memory: MemoryArgs,
    #[command(flatten)]
    print: PrintArgs,
}

/// Runs the command.
pub fn run(args: &EvaluateArgs) -> anyhow::Result<()> {
    let terminal = Terminal::attend();
    let set = CaptureSet::open(&args.set.path)?;
    let options = args.solve.options(&set)?;
    args.memory.check(&set, Work::Evaluate)?;
    let evaluation = evaluate(&set, &options, &terminal);
    terminal.finish();
    let evaluation = evaluation?;
    print_warnings(&evaluation.warnings);
    if args.print.json { print_json(&evaluation) } else { print(&text(&evaluation)) }
}

fn text(evaluation: &Evaluation) -> String {
    let angles = |name: &str, angles: Angles, rmse: Option<f64>| {
        let rmse = rmse.map_or_else(String::new, |rmse| format!("{rmse:.3}"));
        vec![name.to_owned(), format!("{:.2}", angles.mean), format!("{:.2}", angles.median), rmse]
    };
    let errors = &evaluation.normal_error_deg;
    let mut rows = vec![row(["normals from", "mean error, degrees", "median", "depth rmse, mm"])];
    rows.push(angles("photos before separation", errors.raw, evaluation.depth_rmse_raw_mm));
    if let Some(global) = errors.global_ratio {
        rows.push(angles("one colour ratio a light", global, None));
    }
    let title = Method::from_name(evaluation.method).map_or(evaluation.method, Method::title);
    let iterations = evaluation.nayar.iter().flat_map(|nayar| nayar.iterations.iter().enumerate().skip(1));
    rows.extend(iterations.map(|(k, step)| angles(&format!("{title}, iteration {k}"), step.error_deg, None)));
    let detail = match &evaluation.nayar {
        Some(nayar) => format!(", {}", nayar.ending),
        None if evaluation.method == Method::Colours.name() => format!(", bounce 1 of {}", evaluation.bounces),
        None => String::new(),
    };
    rows.push(angles(&format!("{title}{detail}"), errors.separated, evaluation.depth_rmse_mm));
    if let Some(oracle) = errors.oracle {
        rows.push(angles("true direct light, noise of the photos", oracle, None));
    }
    if let Some(ideal) = errors.true_direct {
        rows.push(angles("true direct light", ideal, None));
    }
    if let Some(rmse) = evaluation.depth_rmse_true_normals_mm {
        rows.push(row(["true normals", "", "", &format!("{rmse:.3}")]));
    }
    let bounces = (1..).zip(&evaluation.bounce_relative_error);
    let bounces: Vec<_> = bounces.map(|(k, error)| format!("bounce {k}: {:.1} %", 100.0 * error)).collect();
    let mut lines = vec![table(&rows)];
    if !bounces.is_empty() {
        lines.push(format!("relative error of {}", bounces.join(", ")));
    }
    if let Some(nayar) = &evaluation.nayar {
        let steps: Vec<_> = nayar.iterations.iter().map(|step| format!("{:.3}", step.mean_albedo)).collect();
        let (white, source) = (nayar.white_light, &nayar.white_light_source);
        lines.push(format!("Nayar's method: mean albedo {}; light of white {white:.4} ({source})", steps.join(" ")));
    }
    lines.push(format!("{} of {} pixels with truth compared", evaluation.pixels, evaluation.pixels_with_truth));
    lines.join("\n")
}
