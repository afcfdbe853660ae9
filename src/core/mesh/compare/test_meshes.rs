//! Surfaces with a known shape, for tests.

use nalgebra::Point3;

use crate::Mesh;
use crate::mesh::LengthUnit;

/// A height field of `cells` x `cells` squares of `pitch_mm`, centred on the z axis, facing +z.
pub fn relief(cells: u32, pitch_mm: f64, height_mm: impl Fn(f64, f64) -> f64) -> Mesh {
    let (positions, triangles) = firstbounce_testing::relief(cells, pitch_mm, 0.0, height_mm);
    let positions = positions.into_iter().map(Point3::from).collect();
    Mesh { positions, normals: vec![], colours: vec![], triangles, unit: LengthUnit::Millimetre }
}

/// Bumps of several widths that do not repeat within 100 mm.
pub fn bumps(x: f64, y: f64) -> f64 {
    4.0 * (x / 9.0 + 0.3).sin() * (y / 11.0).cos() + 2.0 * (x / 4.1 - y / 5.3).sin() + 0.002 * (x * x + 0.7 * y * x)
}

/// A fixed sequence of numbers between -1 and 1 (Steele and Vigna's splitmix64).
pub fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut bits = state;
        bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        bits ^= bits >> 31;
        (bits >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// Every vertex moved by normal noise in each coordinate.
pub fn with_noise(mut mesh: Mesh, sigma_mm: f64, seed: u64) -> Mesh {
    let mut uniform = noise(seed);
    // The sum of twelve uniform numbers in -1..1 has variance 4.
    let mut normal = || (0..12).map(|_| uniform()).sum::<f64>() / 2.0 * sigma_mm;
    mesh.positions.iter_mut().flat_map(|p| p.iter_mut()).for_each(|x| *x += normal() as f32);
    mesh
}

/// Only the triangles whose corners all satisfy `keep`.
pub fn cut(mut mesh: Mesh, keep: impl Fn(&Point3<f32>) -> bool) -> Mesh {
    let positions = &mesh.positions;
    mesh.triangles.retain(|corners| corners.iter().all(|&corner| keep(&positions[corner as usize])));
    mesh.welded().0
}
