//! A small capture set with a known truth, written as a person's files would be: a dome with two bounces of light, and
//! the three balls, under three lamps of unequal strength in two colours.

use std::fs;
use std::path::{Path, PathBuf};

use image::{ImageBuffer, Luma};

/// Width and height of all pictures in pixels.
pub const SIZE: u32 = 96;
pub const LIGHTS: [(&str, [f64; 3], f64); 3] =
    [("left", [-0.29, 0.06, 0.95], 1.0), ("top", [0.04, 0.27, 0.96], 1.2), ("right", [0.25, -0.2, 0.94], 0.9)];
pub const COLOURS: [&str; 2] = ["blue", "green"];
pub const BETA: [f64; 2] = [1.0, 0.5];
const MM_PER_PIXEL: f64 = 0.5;
const BALL: (f64, f64) = (48.0, 40.0);

/// alpha of green, a different one for each lamp.
pub fn alpha(light: usize) -> [f64; 2] {
    [1.0, [1.6, 1.4, 1.8][light]]
}

/// The set's folder inside `parent`.
pub fn write(parent: &Path) -> PathBuf {
    let folder = parent.join("tiny");
    for subject in ["object", "grey-sphere", "material-sphere", "mirror-sphere"] {
        fs::create_dir_all(folder.join(subject)).unwrap();
    }
    for (l, (light, direction, intensity)) in LIGHTS.iter().enumerate() {
        let lamp = unit(*direction);
        for (c, colour) in COLOURS.iter().enumerate() {
            let (alpha, beta) = (alpha(l)[c], BETA[c]);
            // A dome of one paint; its indirect light is slow.
            let object = |x: f64, y: f64| {
                let direct = 0.35 * intensity * dot(dome_normal(x, y), lamp).max(0.0);
                alpha * (beta * direct + beta * beta * indirect(x, y))
            };
            let grey = |x: f64, y: f64| 0.4 * alpha * intensity * ball_shade(x, y, lamp);
            save(&folder, "object", &format!("{light}-{colour}"), object);
            save(&folder, "grey-sphere", &format!("{light}-{colour}"), grey);
            save(&folder, "material-sphere", &format!("{light}-{colour}"), |x, y| beta * grey(x, y));
        }
        save(&folder, "mirror-sphere", light, |x, y| mirror(x, y, lamp));
    }
    fs::write(folder.join("capture.toml"), capture_toml()).unwrap();
    folder
}

/// Linear light of bounce 2 at a pixel.
fn indirect(x: f64, y: f64) -> f64 {
    0.05 + 0.02 * (x / 40.0).sin() * (y / 30.0).cos()
}

/// Unit normal of the dome: part of a sphere of 120 pixels radius.
pub fn dome_normal(x: f64, y: f64) -> [f64; 3] {
    let (x, y) = ((x - 48.0) / 120.0, (48.0 - y) / 120.0);
    [x, y, (1.0 - x * x - y * y).sqrt()]
}

fn ball_normal(x: f64, y: f64) -> Option<[f64; 3]> {
    let (x, y) = ((x - BALL.0) / BALL.1, (BALL.0 - y) / BALL.1);
    let z2 = 1.0 - x * x - y * y;
    (z2 > 0.0).then(|| [x, y, z2.sqrt()])
}

/// A matt ball, its edge smoothed over a pixel as a lens would.
fn ball_shade(x: f64, y: f64, lamp: [f64; 3]) -> f64 {
    let samples = (0..16).map(|i| (x + (i % 4) as f64 / 4.0 - 0.375, y + (i / 4) as f64 / 4.0 - 0.375));
    samples.filter_map(|(x, y)| ball_normal(x, y)).map(|n| dot(n, lamp).max(0.0)).sum::<f64>() / 16.0
}

/// A dark ball with the lamp's highlight where it mirrors it into the camera.
fn mirror(x: f64, y: f64, lamp: [f64; 3]) -> f64 {
    let Some(n) = ball_normal(x, y) else { return 0.02 };
    let mirrored = [2.0 * n[2] * n[0], 2.0 * n[2] * n[1], 2.0 * n[2] * n[2] - 1.0];
    0.01 + if dot(mirrored, lamp) > 0.998 { 2.0 } else { 0.0 }
}

fn save(folder: &Path, subject: &str, name: &str, light: impl Fn(f64, f64) -> f64) {
    save_png(&folder.join(subject).join(format!("{name}.png")), light);
}

/// A 16-bit grey PNG of linear light by pixel position.
pub fn save_png(path: &Path, light: impl Fn(f64, f64) -> f64) {
    let pixel = |x: u32, y: u32| {
        let light = light(f64::from(x) + 0.5, f64::from(y) + 0.5);
        Luma([(light * 65535.0).round().clamp(0.0, 65535.0) as u16])
    };
    ImageBuffer::from_fn(SIZE, SIZE, pixel).save(path).unwrap();
}

fn capture_toml() -> String {
    let mut text = format!(
        "# A dome for tests.\nschema = 1\nname = \"Tiny dome\"\n\n[camera]\nprojection = \"orthographic\"\n\
         mm_per_pixel = {MM_PER_PIXEL}\nencoding = \"linear\"\n"
    );
    for colour in COLOURS {
        text += &format!("\n[[colour]]\nname = \"{colour}\"\nchannel = \"grey\"\n");
    }
    for (light, ..) in LIGHTS {
        text += &format!("\n[[light]]\nname = \"{light}\"\n");
    }
    for subject in ["object", "grey-sphere", "material-sphere"] {
        for (light, ..) in LIGHTS {
            for colour in COLOURS {
                text += &format!(
                    "\n[[shot]]\nsubject = \"{subject}\"\nlight = \"{light}\"\ncolour = \"{colour}\"\n\
                     files = [\"{subject}/{light}-{colour}.png\"]\n"
                );
            }
        }
    }
    for (light, ..) in LIGHTS {
        text += &format!(
            "\n[[shot]]\nsubject = \"mirror-sphere\"\nlight = \"{light}\"\nfiles = [\"mirror-sphere/{light}.png\"]\n"
        );
    }
    for subject in ["grey-sphere", "material-sphere", "mirror-sphere"] {
        text += &format!("\n[[sphere]]\nsubject = \"{subject}\"\ncentre = [{0}, {0}]\nradius = {1}\n", BALL.0, BALL.1);
    }
    text
}

/// Scaled to length 1.
pub fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = dot(v, v).sqrt();
    v.map(|x| x / length)
}

pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
