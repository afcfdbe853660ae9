//! How long a comparison of two scans of a million triangles takes.

use firstbounce_core::mesh::LengthUnit;
use firstbounce_core::mesh::compare::{AlignOptions, DistanceOptions, align, distances};
use firstbounce_core::{Mesh, Unwatched};
use nalgebra::{Isometry3, Point3, Vector3};

/// Squares along a side: two triangles each make a million.
const CELLS: u32 = 708;
const PITCH_MM: f64 = 0.15;

fn main() {
    divan::main();
}

/// A bumpy relief of about 106 mm, its vertices shifted by `phase` of a square.
fn relief(phase: f64) -> Mesh {
    let side = CELLS + 1;
    let positions = (0..side * side).map(|index| {
        let [x, y] = [index % side, index / side].map(|k| (f64::from(k) + phase - f64::from(CELLS) / 2.0) * PITCH_MM);
        let z = 4.0 * (x / 9.0 + 0.3).sin() * (y / 11.0).cos() + 2.0 * (x / 4.1 - y / 5.3).sin() + 0.002 * x * (x + y);
        Point3::new(x, y, z).cast()
    });
    let triangles = (0..CELLS * CELLS).flat_map(|cell| {
        let corner = cell / CELLS * side + cell % CELLS;
        [[corner, corner + 1, corner + side + 1], [corner, corner + side + 1, corner + side]]
    });
    Mesh {
        positions: positions.collect(),
        normals: vec![],
        colours: vec![],
        triangles: triangles.collect(),
        unit: LengthUnit::Millimetre,
    }
}

/// Ten degrees and five millimetres.
fn motion() -> Isometry3<f64> {
    Isometry3::new(Vector3::new(3.0, -2.6, 3.04), Vector3::new(1.0, 2.0, -0.7).normalize() * 10f64.to_radians())
}

#[divan::bench(sample_count = 5)]
fn align_a_million_to_a_million(bencher: divan::Bencher) {
    let fixed = relief(0.0);
    let moving = relief(0.4).moved(&motion());
    bencher.bench(|| align(&moving, &fixed, &AlignOptions::default(), &Unwatched));
}

#[divan::bench(sample_count = 5)]
fn distances_of_a_million_to_a_million(bencher: divan::Bencher) {
    let (a, b) = (relief(0.4), relief(0.0));
    bencher.bench(|| distances(&a, &b, &Isometry3::identity(), &DistanceOptions::default(), &Unwatched));
}
