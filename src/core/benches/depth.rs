//! Integration of noisy normals on a disc with a hole: megapixels per second, iterations, peak memory.
//!
//! `cargo bench -p firstbounce-core --bench depth [-- MEGAPIXELS..]`

use std::time::Instant;

use firstbounce_core::stereo::depth::{DepthOptions, integrate};
use firstbounce_core::{Camera, Mask, NormalMap, Plane, Projection, Unwatched};

/// Radians of noise on each component of the normals.
const NOISE: f32 = 0.02;

fn main() {
    let mut sizes: Vec<f64> = std::env::args().filter_map(|argument| argument.parse().ok()).collect();
    if sizes.is_empty() {
        sizes = vec![0.25, 1.0, 4.0, 16.0];
    }
    println!("{} threads; pixels are those of the image, 73 % of them in the mask", rayon::current_num_threads());
    println!("    Mpx  tolerance  seconds   Mpx/s  iterations  residual  peak bytes/px");
    for megapixels in sizes {
        for tolerance in [1e-4, DepthOptions::default().tolerance] {
            measure(megapixels, tolerance);
        }
    }
}

/// Integrates one image and prints its row of the table.
fn measure(megapixels: f64, tolerance: f64) {
    let size = (megapixels * f64::from(1 << 20)).sqrt().round() as usize;
    let (normals, mask) = scene(size);
    let camera = Camera { projection: Projection::Orthographic { mm_per_pixel: None }, size: (size, size) };
    let options = DepthOptions { tolerance, ..DepthOptions::default() };
    reset_peak();
    let before = memory_bytes("VmRSS:");
    let start = Instant::now();
    let depth = integrate(&normals, &mask, None, &camera, &options, &Unwatched).expect("the scene can be integrated");
    let seconds = start.elapsed().as_secs_f64();
    let pixels = (size * size) as f64;
    let peak = match (before, memory_bytes("VmHWM:")) {
        (Some(before), Some(peak)) => format!("{:.0}", (peak - before) / pixels),
        _ => "unknown".to_owned(),
    };
    let speed = pixels / 1e6 / seconds;
    let report = depth.report;
    println!(
        "{megapixels:7.2}  {tolerance:9.0e} {seconds:8.3} {speed:7.2} {:11} {:9.1e}  {peak:>13}",
        report.iterations, report.relative_residual
    );
}

/// Hills with noisy normals on a disc with a hole off its centre.
fn scene(size: usize) -> (NormalMap, Mask) {
    let at = |pixel: usize| 2.0 * (pixel as f32 + 0.5) / size as f32 - 1.0;
    let mask = Mask::from_fn(size, size, |x, y| at(x).hypot(at(y)) < 0.98 && (at(x) - 0.3).hypot(at(y)) > 0.15);
    let mut seed = 1_u32;
    let mut noise = move || {
        // Sum of uniform numbers of a linear congruential generator: near enough to a normal distribution.
        let mut uniform = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / (1 << 24) as f32 - 0.5
        };
        NOISE * (uniform() + uniform() + uniform()) * 2.0
    };
    let mut planes = [(); 3].map(|()| Plane::filled(size, size, 0.0));
    for y in 0..size {
        for x in 0..size {
            let (p, q) = ((7.0 * at(x)).cos() - 0.5 * at(x), 0.8 * (5.0 * at(y) + at(x)).sin());
            let length = (p * p + q * q + 1.0).sqrt();
            let normal = [-p / length + noise(), -q / length + noise(), 1.0 / length + noise()];
            let length = normal.iter().map(|c| c * c).sum::<f32>().sqrt();
            planes.iter_mut().zip(normal).for_each(|(plane, component)| plane.set(x, y, component / length));
        }
    }
    let [x, y, z] = planes;
    (NormalMap::from_planes(x, y, z).expect("planes of one size"), mask)
}

/// Forgets the peak so far; where that is not possible (not Linux), the peak is that of the whole run.
fn reset_peak() {
    let _ = std::fs::write("/proc/self/clear_refs", "5");
}

/// A line of this process's status; `None` where there is no such file.
fn memory_bytes(name: &str) -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(name))?;
    line.trim().strip_suffix("kB")?.trim().parse::<f64>().ok().map(|kilobytes| kilobytes * 1024.0)
}
