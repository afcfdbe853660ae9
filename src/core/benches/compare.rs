//! How long a comparison of two scans of a million triangles takes.

use firstbounce_core::mesh::LengthUnit;
use firstbounce_core::mesh::compare::{AlignOptions, DistanceOptions, align, distances};
use firstbounce_core::{Mesh, Unwatched};
use firstbounce_testing::bumps;
use nalgebra::{Isometry3, Point3, Vector3};

/// Squares along a side: two triangles each make a million.
const CELLS: u32 = 708;
const PITCH_MM: f64 = 0.15;

fn main() {
    divan::main();
}

/// A bumpy relief of about 106 mm, its vertices shifted by `phase` of a square.
fn relief(phase: f64) -> Mesh {
    let (positions, triangles) = firstbounce_testing::relief(CELLS, PITCH_MM, phase, bumps);
    Mesh {
        positions: positions.into_iter().map(Point3::from).collect(),
        normals: vec![],
        colours: vec![],
        triangles,
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
