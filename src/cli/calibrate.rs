//! `firstbounce calibrate SET`

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use firstbounce_capture::CaptureSet;
use firstbounce_capture::atomic::write_kept_file;
use firstbounce_capture::camera_file::CameraFile;
use firstbounce_capture::light_file::{CarriedLights, LightFile};
use firstbounce_capture::open::read_text;
use firstbounce_capture::pipeline::{
    Calibrated, CheckOptions, PhotoStore, Preference, Source, Work, calibrate_also_on_object, check_captures,
};
use firstbounce_capture::report::{CalibrationRecord, CaptureWarningRecord, Row};
use firstbounce_capture::set::{write_calibration, write_crosstalk, write_lens, write_positions};
use serde::Serialize;

use super::circle::GivenCircle;
use super::memory::MemoryArgs;
use super::progress::Terminal;
use super::table::{row, table};
use super::{PrintArgs, SetArgs, print, print_json, print_warnings};

#[derive(Args, Debug)]
pub struct CalibrateArgs {
    #[command(flatten)]
    set: SetArgs,
    /// Take the directions from a light file of RTI tools, by the names of photos or else in order; the balls give the rest
    #[arg(long, value_name = "FILE.lp")]
    lights_from: Option<PathBuf>,
    /// Take focal length, principal point and distortion from a camera calibration of OpenCV (YAML, JSON or XML of its FileStorage);
    /// with --write they are kept
    #[arg(long, value_name = "FILE")]
    camera: Option<PathBuf>,
    /// Where a ball is that is not found, or not where it is: grey, material or mirror=X,Y,RADIUS in pixels, =X,Y,X,Y,X,Y for
    /// three points of its rim, or =grey for the circle of that ball
    #[arg(long, value_name = "BALL=CIRCLE")]
    circle: Vec<GivenCircle>,
    /// Put the values into capture.toml; its comments stay
    #[arg(long)]
    write: bool,
    #[command(flatten)]
    memory: MemoryArgs,
    #[command(flatten)]
    print: PrintArgs,
}

/// What `--json` prints.
#[derive(Serialize)]
struct Printed<'a> {
    #[serde(flatten)]
    words: &'a CalibrationRecord,
    /// The worst first.
    capture_warnings: Vec<CaptureWarningRecord>,
}

/// Runs the command.
pub fn run(args: &CalibrateArgs) -> anyhow::Result<()> {
    let terminal = Terminal::attend();
    let mut set = CaptureSet::open(&args.set.path)?;
    args.memory.check(&set, Work::Calibrate)?;
    if let Some(path) = &args.camera {
        CameraFile::read(path)?.put_into(&mut set, path)?;
    }
    for circle in &args.circle {
        circle.put_into(&mut set, &terminal)?;
    }
    let carried = args.lights_from.as_deref().map(|path| take_lights(&mut set, path)).transpose()?;
    let preference = if carried.is_some() { Preference::BallsUnderGivenLights } else { Preference::Balls };
    let store = PhotoStore::default();
    let calibrated = calibrate_also_on_object(&set, preference, &store, &terminal);
    let options = CheckOptions::default();
    let captures = calibrated.and_then(|calibrated| {
        let photos = check_captures(&set, |_| true, &store, &options, &terminal)?;
        // As `solve` takes it: what the file gives goes before what the balls say.
        let in_force = calibrated.clone().with_given(&set);
        Ok((photos.with_rig(&set, &in_force, &options, &terminal), calibrated))
    });
    terminal.finish();
    let (captures, mut calibrated) = captures?;
    if let Some(carried) = &carried {
        mark_source(&set, carried, &mut calibrated);
    }
    let words = CalibrationRecord::of(&set, &calibrated);
    if args.write {
        write(&set, &calibrated)?;
    }
    print_warnings(&captures.lines());
    print_warnings(&captures.others(&words.warnings));
    if args.print.json {
        print_json(&Printed { words: &words, capture_warnings: CaptureWarningRecord::all(&captures) })
    } else {
        print(&text(&words))
    }
}

/// Puts the directions of a light file in force.
fn take_lights(set: &mut CaptureSet, path: &Path) -> anyhow::Result<CarriedLights> {
    Ok(LightFile::read(path)?.put_into(set, path)?)
}

/// Marks directions of the light file apart from those that capture.toml gives.
fn mark_source(set: &CaptureSet, carried: &CarriedLights, calibrated: &mut Calibrated) {
    for (light, known) in set.lights.iter().zip(&mut calibrated.direction) {
        if let Some(known) = known.as_mut().filter(|_| carried.lights.contains(&light.name)) {
            known.source = Source::LightFile;
        }
    }
    calibrated.warnings.extend(carried.warnings());
    if carried.by_order {
        calibrated
            .warnings
            .push("no file name of the light file is a photo of the set: taken in the order of its lines".into());
    }
}

/// Puts values and circles into the set's file.
fn write(set: &CaptureSet, calibrated: &Calibrated) -> anyhow::Result<()> {
    let path = set.file_path();
    let old = read_text(&path).with_context(|| path.display().to_string())?;
    let circles: Vec<_> = calibrated.circles.iter().map(|ball| ball.sphere).collect();
    let mut values = calibrated.values(set);
    let positions: Vec<_> = calibrated.positions_mm(set).map(|(light, known)| (light, known.value)).collect();
    values.direction.retain(|light, _| !positions.iter().any(|(name, _)| name == light));
    let old = write_lens(&old, &set.camera)?;
    let measured = calibrated.crosstalk.iter().flatten().any(|known| known.source == Source::GreyBall);
    let rows = calibrated.crosstalk_rows().filter(|_| measured);
    // Before what was measured after it was undone.
    let old = rows.map_or(Ok(old.clone()), |rows| write_crosstalk(&old, &rows))?;
    let new = write_positions(&write_calibration(&old, &values, &circles)?, positions)?;
    Ok(write_kept_file(&path, new.as_bytes())?)
}

fn text(words: &CalibrationRecord) -> String {
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
