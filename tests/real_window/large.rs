//! How long frames take while a set of 24 megapixels is opened and beta is dragged. By hand, on a machine at rest:
//!
//! `cargo test --test real_window frames_at_24_mpx -- --ignored --nocapture`

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use image::{ImageBuffer, Luma};

use crate::desktop::Desktop;
use crate::screen_reader::steps_with_results;

const SIZE: (u32, u32) = (6000, 4000);
const LIGHTS: [(&str, [f64; 3]); 3] =
    [("left", [-0.3, 0.0, 0.954]), ("top", [0.0, 0.3, 0.954]), ("right", [0.3, -0.1, 0.949])];
const BETA: [f64; 2] = [1.0, 0.5];
const COLOURS: [&str; 2] = ["blue", "green"];
const DRAGGED_FRAMES: usize = 150;
const FRAME: Duration = Duration::from_millis(40);

#[test]
#[ignore = "measures, for minutes; run it by the command above"]
fn frames_at_24_mpx() {
    let test = "frames_at_24_mpx";
    let Some(desktop) = Desktop::new(test) else { return };
    let set = write_set(desktop.folder());
    let Some(program) = desktop.start(test, &["open", set.to_str().unwrap()]) else { return };
    let reader = &program.reader;
    reader.press("3  Separate");
    // The surface goes on being computed, and anew after the drag: the drag is what is measured.
    reader.wait_for("the bounces to be there", |widgets| (steps_with_results(widgets) >= 3).then_some(()));
    println!("opening:\n{}", report(&desktop, &program));

    // The inspector has a section of the same name as the menu's group.
    let inspector = || {
        reader.press("View");
        reader.press("Toggle inspector");
    };
    inspector();
    reader.press("Picture: Photo, left, blue");
    reader.press("Light left");
    reader.press("Bounce 1, left");
    inspector();
    reader.press("Help");
    reader.press("Frame times");
    reader.find("Count again");
    std::thread::sleep(Duration::from_secs(5));
    reader.press("Count again");
    drag(&desktop, reader.place(&reader.find("beta of green")), "1");
    println!("drag of beta:\n{}", report(&desktop, &program));

    reader.press("4  Shape");
    reader.wait_for("the surface to be there", |widgets| (steps_with_results(widgets) >= 5).then_some(()));
    reader.find("Surface in 3D, After");
    std::thread::sleep(Duration::from_secs(5));
    reader.press("Count again");
    drag(&desktop, reader.place(&reader.find("Surface in 3D, After")), "4");
    println!("turning the surface:\n{}", report(&desktop, &program));
}

/// Drags back and forth, sideways, from the middle of a widget.
fn drag(desktop: &Desktop, [left, top, width, height]: [i32; 4], step: &str) {
    let xdotool = |args: &[&str]| {
        let done = desktop.command("xdotool").args(args).status().expect("xdotool is installed");
        assert!(done.success());
    };
    let middle = (left + width / 2, top + height / 2);
    xdotool(&["mousemove", &middle.0.to_string(), &middle.1.to_string(), "mousedown", "1"]);
    for frame in 0..DRAGGED_FRAMES {
        let step = if frame % 60 < 30 { step.to_owned() } else { format!("-{step}") };
        xdotool(&["mousemove_relative", "--", &step, "0"]);
        std::thread::sleep(FRAME);
    }
    xdotool(&["mouseup", "1"]);
}

/// Has the frame times written, and sums them up by phase.
fn report(desktop: &Desktop, program: &crate::desktop::Program) -> String {
    let place = desktop.config().join("frame-times.csv");
    let _ = fs::remove_file(&place);
    program.reader.press("Help");
    program.reader.press("Write frame times to a file");
    program.reader.read("Wrote ");
    let table = fs::read_to_string(&place).unwrap();
    let rows: Vec<(&str, Vec<f64>)> = table
        .lines()
        .skip(1)
        .map(|line| {
            let (phase, numbers) = line.split_once(',').unwrap();
            (phase, numbers.split(',').map(|number| number.parse().unwrap_or(f64::NAN)).collect())
        })
        .collect();
    let mut text = String::new();
    for phase in ["opening", "steady"] {
        let of_phase: Vec<_> = rows.iter().filter(|(of, _)| *of == phase).map(|(_, numbers)| numbers).collect();
        for (column, name) in ["whole", "work", "logic", "widgets"].into_iter().enumerate() {
            let values: Vec<f64> = of_phase.iter().map(|numbers| numbers[column]).collect();
            let longest = values.iter().copied().fold(0.0, f64::max);
            let over = values.iter().filter(|value| **value > 50.0).count();
            let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
            let count = values.len();
            text += &format!(
                "  {phase} {name}: {count} frames, mean {mean:.1} ms, longest {longest:.1} ms, {over} over 50 ms\n"
            );
        }
    }
    let mut longest: Vec<_> = rows.iter().collect();
    longest.sort_by(|a, b| b.1[0].total_cmp(&a.1[0]));
    longest.iter().take(8).for_each(|(phase, numbers)| text += &format!("  {phase} {numbers:?}\n"));
    text
}

/// A bump of one paint in the middle, its light and one bounce.
fn write_set(parent: &Path) -> PathBuf {
    let folder = parent.join("large");
    fs::create_dir_all(&folder).unwrap();
    let (width, height) = (f64::from(SIZE.0), f64::from(SIZE.1));
    let place = |x: u32, y: u32| (2.0 * f64::from(x) / width - 1.0, 1.0 - 2.0 * f64::from(y) / height);
    let inside = |x: f64, y: f64| x * x + y * y < 0.5;
    let mut text = "schema = 1\nname = \"Large\"\nmask = \"mask.png\"\n\n[camera]\nprojection = \"orthographic\"\n\
                    mm_per_pixel = 0.01\nencoding = \"linear\"\n\n[separation]\nbounces = 2\n\n[calibration]\nbeta = [1.0, 0.5]\n"
        .to_owned();
    for (light, direction) in LIGHTS {
        text += &format!("alpha.{light} = [1.0, 1.5]\ndirection.{light} = {direction:?}\nintensity.{light} = 1.0\n");
    }
    for colour in COLOURS {
        text += &format!("\n[[colour]]\nname = \"{colour}\"\nchannel = \"grey\"\n");
    }
    for (light, direction) in LIGHTS {
        text += &format!("\n[[light]]\nname = \"{light}\"\n");
        for (c, colour) in COLOURS.iter().enumerate() {
            let file = format!("{light}-{colour}.png");
            let alpha = [1.0, 1.5][c];
            let picture = ImageBuffer::from_fn(SIZE.0, SIZE.1, |x, y| {
                let (x, y) = place(x, y);
                let normal = [0.4 * x, 0.4 * y, (1.0 - 0.16 * (x * x + y * y)).sqrt()];
                let shade: f64 = normal.iter().zip(direction).map(|(n, d)| n * d).sum();
                let direct = 0.5 * shade.max(0.0);
                let light = alpha * BETA[c] * (direct + BETA[c] * (0.05 + 0.02 * (9.0 * x).sin()));
                Luma([(65535.0 * light.min(1.0)) as u16])
            });
            picture.save(folder.join(&file)).unwrap();
            text += &format!(
                "\n[[shot]]\nsubject = \"object\"\nlight = \"{light}\"\ncolour = \"{colour}\"\nfiles = [\"{file}\"]\n"
            );
        }
    }
    let mask = ImageBuffer::from_fn(SIZE.0, SIZE.1, |x, y| {
        let (x, y) = place(x, y);
        Luma([if inside(x, y) { 255_u8 } else { 0 }])
    });
    mask.save(folder.join("mask.png")).unwrap();
    fs::write(folder.join("capture.toml"), text).unwrap();
    folder
}
