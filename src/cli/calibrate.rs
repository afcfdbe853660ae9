//! `firstbounce calibrate SET`

use anyhow::Context;
use clap::Args;
use firstbounce_capture::CaptureSet;
use firstbounce_capture::atomic::write_file;
use firstbounce_capture::pipeline::{Calibrated, Preference, calibrate};
use firstbounce_capture::report::{CalibrationWords, Row};
use firstbounce_capture::set::{Calibration, write_calibration};

use super::progress::Terminal;
use super::table::{row, table};
use super::{PrintArgs, SetArgs, print, print_json, print_warnings};

#[derive(Args, Debug)]
pub struct CalibrateArgs {
    #[command(flatten)]
    set: SetArgs,
    /// Put the values into capture.toml; its comments stay
    #[arg(long)]
    write: bool,
    #[command(flatten)]
    print: PrintArgs,
}

/// Runs the command.
pub fn run(args: &CalibrateArgs) -> anyhow::Result<()> {
    let set = CaptureSet::open(&args.set.path)?;
    let terminal = Terminal::attend();
    let calibrated = calibrate(&set, Preference::Balls, &terminal);
    terminal.finish();
    let calibrated = calibrated?;
    let words = CalibrationWords::of(&set, &calibrated);
    if args.write {
        write(&set, &calibrated)?;
    }
    print_warnings(&words.warnings);
    if args.print.json { print_json(&words) } else { print(&text(&words)) }
}

/// Puts values and circles into the set's file.
fn write(set: &CaptureSet, calibrated: &Calibrated) -> anyhow::Result<()> {
    let path = set.file_path();
    let old = std::fs::read_to_string(&path).with_context(|| path.display().to_string())?;
    let circles: Vec<_> = calibrated.circles.iter().map(|ball| ball.sphere).collect();
    let new = write_calibration(&old, &values(set, calibrated), &circles)?;
    Ok(write_file(&path, new.as_bytes())?)
}

/// The values in force, by the words of the file. A light whose position or direction the file gives keeps that alone.
fn values(set: &CaptureSet, calibrated: &Calibrated) -> Calibration {
    let lights = || set.lights.iter();
    let values =
        |known: &Vec<firstbounce_capture::pipeline::Known<f64>>| known.iter().map(|known| known.value).collect();
    let by_light = lights().zip(&calibrated.alpha);
    Calibration {
        beta: calibrated.beta.as_ref().map(values),
        alpha: by_light.filter_map(|(l, known)| Some((l.name.clone(), values(known.as_ref()?)))).collect(),
        direction: lights()
            .zip(&calibrated.direction)
            .filter(|(light, _)| light.direction.is_none() && light.position_mm.is_none())
            .filter_map(|(light, known)| Some((light.name.clone(), known.as_ref()?.value)))
            .collect(),
        intensity: lights().zip(&calibrated.intensity).map(|(l, known)| (l.name.clone(), known.value)).collect(),
    }
}

fn text(words: &CalibrationWords) -> String {
    let mut rows = vec![row(["quantity", "value", "95 % interval", "source", "pixels used", "pixels refused"])];
    rows.extend(words.rows().iter().map(|Row { quantity, value, interval, source, used, refused }| {
        row([quantity, value, interval, source, used, refused])
    }));
    let mut circles = vec![row(["ball", "centre, px", "radius, px", "found"])];
    circles.extend(words.circle.iter().map(|(ball, circle)| {
        let found = circle.sd.map_or("given".into(), |sd| format!("by its edge, to {sd:.2} px"));
        let centre = format!("{:.2}, {:.2}", circle.centre[0], circle.centre[1]);
        vec![ball.clone(), centre, format!("{:.2}", circle.radius), found]
    }));
    format!("{}\n\n{}", table(&rows), table(&circles))
}
