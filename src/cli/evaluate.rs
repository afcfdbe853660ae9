//! `firstbounce evaluate SET`

use clap::Args;
use firstbounce_capture::CaptureSet;
use firstbounce_capture::pipeline::{Angles, Evaluation, evaluate};

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
    print: PrintArgs,
}

/// Runs the command.
pub fn run(args: &EvaluateArgs) -> anyhow::Result<()> {
    let set = CaptureSet::open(&args.set.path)?;
    let terminal = Terminal::attend();
    let evaluation = evaluate(&set, &args.solve.options(), &terminal);
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
    rows.push(angles("photos as they are", errors.raw, evaluation.depth_rmse_raw_mm));
    let separated = format!("bounce 1 of {}", evaluation.bounces);
    rows.push(angles(&separated, errors.separated, evaluation.depth_rmse_mm));
    if let Some(ideal) = errors.true_direct {
        rows.push(angles("true direct light", ideal, None));
    }
    if let Some(rmse) = evaluation.depth_rmse_true_normals_mm {
        rows.push(row(["true normals", "", "", &format!("{rmse:.3}")]));
    }
    let bounces = (1..).zip(&evaluation.bounce_relative_error);
    let bounces: Vec<_> = bounces.map(|(k, error)| format!("bounce {k}: {:.1} %", 100.0 * error)).collect();
    format!(
        "{}\nrelative error of {}\n{} of {} pixels with truth compared",
        table(&rows),
        bounces.join(", "),
        evaluation.pixels,
        evaluation.pixels_with_truth
    )
}
