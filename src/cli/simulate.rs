//! `firstbounce simulate SCENE`

use std::path::{Path, PathBuf};

use clap::Args;
use firstbounce_lab::simulate::{
    BallOptions, SimulateOptions, SimulateReport, Simulated, check_folder, simulate, write_simulated,
};
use serde::Serialize;

use super::progress::Terminal;
use super::scene::{Numbers, SceneArgs, crosstalk, numbers};
use super::{PrintArgs, print, print_json, print_warnings};

#[derive(Args, Debug)]
pub struct SimulateArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// The folder of the new capture set
    #[arg(long, value_name = "SET")]
    out: PathBuf,
    /// What the set is called [default: after the scene]
    #[arg(long)]
    name: Option<String>,
    /// Side of the object's pictures
    #[arg(long, default_value_t = SimulateOptions::default().size_px)]
    pixels: usize,
    /// Samples along each side of a pixel
    #[arg(long, value_name = "COUNT", default_value_t = SimulateOptions::default().samples_per_pixel_side)]
    samples: usize,
    /// Number of bounces in the truth
    #[arg(long, value_name = "COUNT", default_value_t = SimulateOptions::default().truth_bounces)]
    bounces: usize,
    /// Photos of one seed have the same noise
    #[arg(long, default_value_t = SimulateOptions::default().sensor.seed)]
    seed: u64,
    /// What each colour's photo sees of every other colour's lamp, or a row of numbers for each photo by ;
    #[arg(long, value_name = "SHARE", value_delimiter = ';', value_parser = numbers)]
    crosstalk: Vec<Numbers>,
    /// Colours as channels of RGB photos, and the grey ball under each lamp colour alone, too: what `calibrate` measures crosstalk on
    #[arg(long)]
    crosstalk_shots: bool,
    /// Albedo of the grey ball [default: 0.18, or the paint's darkest]
    #[arg(long, value_name = "ALBEDO")]
    grey: Option<f64>,
    /// Side of the balls' pictures
    #[arg(long, value_name = "PIXELS", default_value_t = 200)]
    ball_pixels: usize,
    /// Leave out the calibration balls
    #[arg(long)]
    no_balls: bool,
    #[command(flatten)]
    print: PrintArgs,
}

/// What was simulated, for programs.
#[derive(Debug, Serialize)]
struct SimulateRecord<'a> {
    set: &'a Path,
    scene: &'a str,
    patches: usize,
    form_factors_stored: bool,
    form_factor_bytes: u64,
    reciprocity_residual: f64,
    visible_fraction: f64,
    mask_pixels: usize,
    all_bounces_residual: f64,
    indirect_share: f64,
    clipped_pixels: usize,
    warnings: &'a [String],
}

/// Runs the command.
pub fn run(args: &SimulateArgs) -> anyhow::Result<()> {
    let terminal = Terminal::attend();
    let (mut options, mut warnings) = args.scene.options()?;
    options.size_px = args.pixels;
    options.samples_per_pixel_side = args.samples;
    options.truth_bounces = args.bounces;
    options.sensor.seed = args.seed;
    options.crosstalk = crosstalk(&args.crosstalk, options.albedos.len())?;
    options.crosstalk_shots = args.crosstalk_shots;
    let balls = BallOptions { size_px: args.ball_pixels, ..BallOptions::for_paint(&options.albedos) };
    let balls = BallOptions { grey_albedo: args.grey.unwrap_or(balls.grey_albedo), ..balls };
    options.balls = (!args.no_balls).then_some(balls);
    if let Some(name) = &args.name {
        options.name.clone_from(name);
    }
    check_folder(&args.out)?;
    let simulated = simulate(&options, &terminal.job("simulate"));
    terminal.finish();
    let simulated = simulated?;
    write_simulated(&simulated, &args.out)?;
    warnings.extend(simulated.report.warnings.iter().cloned());
    print_warnings(&warnings);
    if args.print.json {
        print_json(&record(&simulated.report, &args.out, &warnings))
    } else {
        print(&text(&simulated, &args.out))
    }
}

fn record<'a>(report: &'a SimulateReport, set: &'a Path, warnings: &'a [String]) -> SimulateRecord<'a> {
    SimulateRecord {
        set,
        scene: &report.scene,
        patches: report.factors.patches,
        form_factors_stored: report.factors.stored,
        form_factor_bytes: report.factors.bytes,
        reciprocity_residual: report.factors.reciprocity_residual,
        visible_fraction: report.factors.visible_fraction,
        mask_pixels: report.render.mask_pixels,
        all_bounces_residual: report.render.all_bounces.residual,
        indirect_share: report.indirect_share,
        clipped_pixels: report.clipped_pixels,
        warnings,
    }
}

fn text(simulated: &Simulated, folder: &Path) -> String {
    let Simulated { set, report, photos, .. } = simulated;
    let folder = folder.display();
    format!(
        "{}: {} lights, {} colours, {} photos in {folder}\n{} patches; {:.0} % of the light bounced twice or more\n\
         next: firstbounce evaluate {folder}, or firstbounce open {folder}",
        set.name,
        set.lights.len(),
        set.colours.len(),
        photos.len(),
        report.factors.patches,
        100.0 * report.indirect_share,
    )
}
