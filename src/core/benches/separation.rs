//! Separation and normals of two colours under three lights, as a share of the memory bandwidth of this machine.
//!
//! `cargo bench -p firstbounce-core --bench separation`

use std::time::{Duration, Instant};

use firstbounce_core::image::noise::{NoiseModel, NoiseSource};
use firstbounce_core::separate::{LightPhotos, SeparateOptions, Separation, separate_into};
use firstbounce_core::stereo::normals::{DirectLight, Lamp, Normals, NormalsOptions, Surface, normals_into};
use firstbounce_core::{Camera, Mask, Photo, Plane, Projection, Unwatched};
use nalgebra::Vector3;
use rayon::prelude::*;

const COLOURS: usize = 2;
const LIGHTS: usize = 3;
const ALPHA: [f64; COLOURS] = [1.0, 3.2];
const BETA: [f64; COLOURS] = [1.0, 0.5];
const NOISE: NoiseModel = NoiseModel { floor: 1e-8, per_signal: 1e-6, source: NoiseSource::Camera };

/// What separation reads of a light (photos, their marks, the mask) and writes (two bounces, noise, marks).
const SEPARATION_BYTES: usize = LIGHTS * (COLOURS * 5 + 1 + 2 * 4 + 4 + 1);
/// What photometric stereo reads (direct light, noise and marks of each light, the mask) and writes.
const NORMALS_BYTES: usize = LIGHTS * 9 + 1 + 5 * 4 + 1;

fn main() {
    println!("{:>6} {:>12} {:>12} {:>12} {:>8}", "Mpx", "ms", "GB/s", "copy GB/s", "share");
    for (width, height) in [(3000, 2000), (6000, 4000)] {
        let bandwidth = copy_bandwidth(width * height);
        let seconds = separation_and_normals(width, height).as_secs_f64();
        let rate = (width * height * (SEPARATION_BYTES + NORMALS_BYTES)) as f64 / seconds;
        let mpx = (width * height) as f64 / 1e6;
        println!(
            "{mpx:>6.0} {:>12.1} {:>12.2} {:>12.2} {:>7.0} %",
            seconds * 1e3,
            rate / 1e9,
            bandwidth / 1e9,
            100.0 * rate / bandwidth
        );
    }
}

/// Bytes read and written per second by a copy on all cores, of as many floats as the picture has pixels.
fn copy_bandwidth(pixels: usize) -> f64 {
    let from = vec![1.0_f32; 6 * pixels];
    let mut to = vec![0.0_f32; 6 * pixels];
    let copy =
        || to.par_chunks_mut(1 << 15).zip(from.par_chunks(1 << 15)).for_each(|(to, from)| to.copy_from_slice(from));
    let seconds = best_of(7, copy).as_secs_f64();
    (2 * 4 * from.len()) as f64 / seconds
}

fn separation_and_normals(width: usize, height: usize) -> Duration {
    let light = |x: usize, y: usize| 0.2 + 0.5 * ((x * 7 + y * 13) % 1000) as f32 / 1000.0;
    let photos: Vec<Vec<Photo>> = (0..LIGHTS)
        .map(|_| (0..COLOURS).map(|_| Photo::unmarked(Plane::from_fn(width, height, light))).collect())
        .collect();
    let mask = Mask::filled(width, height, true);
    let camera = Camera { projection: Projection::Orthographic { mm_per_pixel: None }, size: (width, height) };
    let directions = [(0.27, 0.06), (0.04, 0.26), (-0.25, -0.19)];
    let mut separations = vec![Separation::default(); LIGHTS];
    let mut normals = Normals::empty(width, height);

    best_of(7, || {
        for (separation, photos) in separations.iter_mut().zip(&photos) {
            let photos: Vec<_> = photos.iter().collect();
            let light =
                LightPhotos { photos: &photos, noise: &[NOISE; COLOURS], alpha: &ALPHA, beta: &BETA, mask: &mask };
            separate_into(separation, &light, &SeparateOptions::default(), &Unwatched).expect("a separable scene");
        }
        let lights: Vec<_> = separations
            .iter()
            .zip(directions)
            .map(|(separation, (x, y))| DirectLight {
                direct: &separation.bounces[0],
                noise: separation.direct_noise.as_ref(),
                marks: &separation.marks,
                lamp: Lamp::Distant(Vector3::new(x, y, 0.96)),
                intensity: 1.0,
            })
            .collect();
        let surface = Surface { camera: &camera, depth_mm: None };
        normals_into(&mut normals, &lights, &mask, surface, &NormalsOptions::default(), &Unwatched)
            .expect("three lamps out of a plane");
    })
}

/// The shortest of several runs: the one that the rest of the machine disturbed least.
fn best_of(runs: usize, mut work: impl FnMut()) -> Duration {
    let time = |_| {
        let start = Instant::now();
        work();
        start.elapsed()
    };
    (0..runs).map(time).min().unwrap_or_default()
}
