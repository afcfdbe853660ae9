//! Cost of form factors with visibility against the number of patches, on a scene where things stand in the way.
//!
//! `cargo bench -p firstbounce-core --bench radiosity`

use std::time::Instant;

use firstbounce_core::Unwatched;
use firstbounce_core::radiosity::{FormFactorOptions, Patches, form_factors};
use firstbounce_core::scene::Shape;

fn main() {
    println!("{:>8} {:>10} {:>22}", "patches", "seconds", "ns per pair of patches");
    for wanted in [2_500, 5_000, 10_000] {
        let mesh = Shape::Tray { side_mm: 80.0 }.mesh(wanted).expect("a tray has patches");
        let patches = Patches::from_mesh(&mesh).expect("its mesh is whole");
        let count = patches.len();
        let start = Instant::now();
        form_factors(patches, &FormFactorOptions::default(), &Unwatched).expect("a tray fits into the memory limit");
        let seconds = start.elapsed().as_secs_f64();
        println!("{count:>8} {seconds:>10.2} {:>22.0}", 2e9 * seconds / (count * count) as f64);
    }
}
