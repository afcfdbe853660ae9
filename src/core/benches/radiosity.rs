//! Cost of form factors with visibility against the number of patches, on a scene where things stand in the way: time, the
//! memory they take, and the most memory that the process has held so far.
//!
//! `cargo bench -p firstbounce-core --bench radiosity`

use std::time::Instant;

use firstbounce_core::Unwatched;
use firstbounce_core::light::radiosity::{FormFactorOptions, Patches, form_factors};
use firstbounce_core::light::scene::Shape;

fn main() {
    println!(
        "{:>8} {:>10} {:>22} {:>12} {:>10}",
        "patches", "seconds", "ns per pair of patches", "factors MiB", "peak MiB"
    );
    for wanted in [2_500, 5_000, 10_000] {
        let mesh = Shape::Tray { side_mm: 80.0 }.mesh(wanted).expect("a tray has patches");
        let patches = Patches::from_mesh(&mesh).expect("its mesh is whole");
        let count = patches.len();
        let start = Instant::now();
        let (_, report) =
            form_factors(patches, &FormFactorOptions::default(), &Unwatched).expect("a tray exchanges light");
        let seconds = start.elapsed().as_secs_f64();
        let peak = peak_mebibytes().map_or_else(|| "?".to_owned(), |peak| peak.to_string());
        println!(
            "{count:>8} {seconds:>10.2} {:>22.0} {:>12} {peak:>10}",
            2e9 * seconds / (count * count) as f64,
            report.bytes >> 20
        );
    }
}

/// The most memory that this process has held, where the system tells (Linux does).
fn peak_mebibytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    Some(line.trim().strip_suffix("kB")?.trim().parse::<u64>().ok()? / 1024)
}
