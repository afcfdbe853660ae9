use std::f32::consts::TAU;

use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::*;
use crate::Unwatched;
use crate::options::OptionError;

fn orthographic(size: (usize, usize)) -> Camera {
    Camera { projection: Projection::Orthographic { mm_per_pixel: None }, size }
}

/// Normals of a height (pixels, y up) from its slopes at pixel centres: `slopes(x, y) = (z_x, z_y)`.
fn normals_of(size: (usize, usize), slopes: impl Fn(f64, f64) -> (f64, f64)) -> NormalMap {
    let mut planes = [(); 3].map(|()| Plane::filled(size.0, size.1, 0.0));
    for y in 0..size.1 {
        for x in 0..size.0 {
            let (p, q) = slopes(x as f64 + 0.5, -(y as f64 + 0.5));
            let length = (p * p + q * q + 1.0).sqrt();
            let normal = [-p / length, -q / length, 1.0 / length];
            planes.iter_mut().zip(normal).for_each(|(plane, component)| plane.set(x, y, component as f32));
        }
    }
    let [x, y, z] = planes;
    NormalMap::from_planes(x, y, z).unwrap()
}

/// The connected parts of a mask by flood fill.
fn islands(mask: &Mask) -> Vec<Vec<usize>> {
    let (width, mut left) = (mask.width(), mask.data().to_vec());
    let mut islands = Vec::new();
    for seed in 0..left.len() {
        let (mut island, mut open) = (Vec::new(), vec![seed]);
        while let Some(i) = open.pop() {
            if std::mem::take(&mut left[i]) {
                island.push(i);
                let (x, y) = (i % width, i / width);
                open.extend((x > 0).then(|| i - 1));
                open.extend((x + 1 < width).then_some(i + 1));
                open.extend((y > 0).then(|| i - width));
                open.extend((y + 1 < mask.height()).then_some(i + width));
            }
        }
        islands.extend((!island.is_empty()).then_some(island));
    }
    islands
}

/// The largest difference to `truth` after its mean over each island is taken off.
fn worst_error(depth: &Depth, truth: impl Fn(f64, f64) -> f64) -> f64 {
    let width = depth.mask.width();
    let truth = |i: usize| truth((i % width) as f64 + 0.5, -((i / width) as f64 + 0.5));
    let error = |island: &Vec<usize>| {
        let mean = island.iter().map(|&i| truth(i)).sum::<f64>() / island.len() as f64;
        let errors = island.iter().map(|&i| (f64::from(depth.depth_mm.data()[i]) - (truth(i) - mean)).abs());
        errors.fold(0.0, f64::max)
    };
    islands(&depth.mask).iter().map(error).fold(0.0, f64::max)
}

fn tight() -> DepthOptions {
    DepthOptions { tolerance: 1e-8, ..DepthOptions::default() }
}

/// Masks of every kind that the user may draw.
fn masks() -> Vec<Mask> {
    let spiral = |x: i32, y: i32| {
        let ring = (x - 20).abs().max((y - 20).abs());
        ring % 2 == 0 || (x - 20 == ring && y == 20) && ring % 4 == 1 || (20 - x == ring && y == 20) && ring % 4 == 3
    };
    vec![
        Mask::filled(1, 1, true),
        Mask::filled(37, 1, true),
        Mask::filled(1, 20, true),
        Mask::filled(2, 3, true),
        Mask::filled(64, 64, true),
        Mask::filled(61, 33, true),
        Mask::from_fn(50, 40, |x, y| !(20..30).contains(&x) || !(15..25).contains(&y)),
        Mask::from_fn(60, 30, |x, _| x % 20 != 7),
        Mask::from_fn(60, 30, |x, y| !(20..40).contains(&x) || y == 13),
        Mask::from_fn(41, 41, |x, y| spiral(x as i32, y as i32)),
        Mask::from_fn(33, 33, |x, y| x.abs_diff(y) <= 1 && x + y > 3),
        Mask::from_fn(20, 20, |x, y| (x + y) % 2 == 0),
        Mask::from_fn(90, 90, |x, y| (x as f32 - 60.0).hypot(y as f32 - 50.0) < 25.0),
    ]
}

#[test]
fn a_quadratic_surface_comes_back_exactly_on_any_mask() {
    for mask in masks() {
        for (a, b, c) in [(0.0, 0.0, 0.0), (0.01, -0.02, 0.015)] {
            let height = |x: f64, y: f64| 0.3 * x - 0.7 * y + a * x * x + b * y * y + c * x * y;
            let slopes = |x: f64, y: f64| (0.3 + 2.0 * a * x + c * y, -0.7 + 2.0 * b * y + c * x);
            let normals = normals_of(mask.size(), slopes);
            let depth = integrate(&normals, &mask, None, &orthographic(mask.size()), &tight(), &Unwatched).unwrap();
            assert_eq!(depth.mask, mask);
            assert_eq!(depth.report.islands, islands(&mask).len());
            assert!(worst_error(&depth, height) < 2e-4, "{:?}: {}", mask.size(), worst_error(&depth, height));
            assert!(depth.report.rms_slope_residual < 1e-5);
            assert!(depth.report.iterations <= 40, "{:?}", depth.report);
        }
    }
}

#[test]
fn a_sphere_and_waves_come_back_to_the_error_of_the_sampling() {
    let mask = Mask::from_fn(101, 90, |x, y| (x as f64 - 50.0).hypot(y as f64 - 45.0) < 42.0);
    let radius = 60.0_f64;
    let sphere = |x: f64, y: f64| (radius * radius - (x - 50.5).powi(2) - (y + 45.5).powi(2)).max(1.0).sqrt();
    let slopes = |x: f64, y: f64| ((50.5 - x) / sphere(x, y), (-45.5 - y) / sphere(x, y));
    let depth =
        integrate(&normals_of(mask.size(), slopes), &mask, None, &orthographic(mask.size()), &tight(), &Unwatched);
    assert!(worst_error(&depth.unwrap(), sphere) < 0.02);

    let wave = f64::from(TAU) / 40.0;
    let waves = |x: f64, y: f64| 5.0 * (wave * x).sin() * (wave * y).cos();
    let slopes = |x: f64, y: f64| {
        (5.0 * wave * (wave * x).cos() * (wave * y).cos(), -5.0 * wave * (wave * x).sin() * (wave * y).sin())
    };
    let depth =
        integrate(&normals_of(mask.size(), slopes), &mask, None, &orthographic(mask.size()), &tight(), &Unwatched);
    // The trapezoid rule is off by (wave length in radians per pixel)^2 / 12 of the amplitude.
    assert!(worst_error(&depth.unwrap(), waves) < 3.0 * 5.0 * wave * wave / 12.0);
}

#[test]
fn millimetres_follow_the_pitch() {
    let mask = Mask::filled(30, 20, true);
    let camera = Camera { projection: Projection::Orthographic { mm_per_pixel: Some(0.2) }, size: (30, 20) };
    let normals = normals_of((30, 20), |_, _| (0.5, 0.0));
    let depth = integrate(&normals, &mask, None, &camera, &tight(), &Unwatched).unwrap();
    assert!((depth.depth_mm.at(29, 7) - depth.depth_mm.at(0, 7) - 0.5 * 29.0 * 0.2).abs() < 1e-5);
}

/// The depth of a surface given by the distance along each ray (u, v, -1) and its normal, against the truth.
fn perspective_error(distance: impl Fn(f64, f64) -> f64, normal: impl Fn(f64, f64) -> [f64; 3]) -> f64 {
    let (focal_length_px, size, working_distance_mm) = (400.0, (120, 100), 500.0);
    let projection = Projection::Perspective { focal_length_px, principal_point_px: (70.0, 40.0), working_distance_mm };
    let ray = |x: usize, y: usize| ((x as f64 - 69.5) / focal_length_px, (39.5 - y as f64) / focal_length_px);
    let component = |c: usize| {
        Plane::from_fn(size.0, size.1, |x, y| {
            let (u, v) = ray(x, y);
            normal(u, v)[c] as f32
        })
    };
    let normals = NormalMap::from_planes(component(0), component(1), component(2)).unwrap();
    let mask = Mask::from_fn(size.0, size.1, |x, y| (x as f64 - 60.0).hypot(y as f64 - 50.0) < 45.0);
    let camera = Camera { projection, size };
    let depth = integrate(&normals, &mask, None, &camera, &tight(), &Unwatched).unwrap();

    // The scale is free: the geometric mean distance is the working distance.
    let pixels: Vec<(usize, usize)> =
        (0..size.0 * size.1).map(|i| (i % size.0, i / size.0)).filter(|&(x, y)| mask.at(x, y)).collect();
    let truth = |&(x, y): &(usize, usize)| {
        let (u, v) = ray(x, y);
        distance(u, v)
    };
    let scale = working_distance_mm / (pixels.iter().map(|p| truth(p).ln()).sum::<f64>() / pixels.len() as f64).exp();
    let error =
        |p: &(usize, usize)| (f64::from(depth.depth_mm.at(p.0, p.1)) - (working_distance_mm - scale * truth(p))).abs();
    pixels.iter().map(error).fold(0.0, f64::max)
}

#[test]
fn perspective_gives_back_a_plane_and_a_sphere() {
    // n . X = n . (0, 0, -500)
    let n = [0.3, -0.4, 0.75_f64.sqrt()];
    let plane = |u: f64, v: f64| 500.0 * n[2] / (n[2] - u * n[0] - v * n[1]);
    assert!(perspective_error(plane, |_, _| n) < 2e-3);

    // The near side of a sphere of 150 mm about (0, 0, -600) from the pinhole.
    let near = |u: f64, v: f64| {
        let (a, b, c) = (u * u + v * v + 1.0, 600.0, 600.0 * 600.0 - 150.0 * 150.0);
        (b - (b * b - a * c).sqrt()) / a
    };
    let normal = |u: f64, v: f64| {
        let d = near(u, v);
        [u * d / 150.0, v * d / 150.0, (600.0 - d) / 150.0]
    };
    assert!(perspective_error(near, normal) < 0.05);
}

#[test]
fn a_line_of_pixels_without_normals_does_not_cut_the_surface() {
    let slopes = |x: f64, _: f64| if x < 20.0 { (1.0, 0.0) } else { (-0.5, 0.0) };
    let [mut nx, mut ny, mut nz] = normals_of((40, 30), slopes).into_planes();
    for y in 0..30 {
        [&mut nx, &mut ny].into_iter().for_each(|plane| plane.set(20, y, 0.0));
        nz.set(20, y, if y % 2 == 0 { 0.0 } else { f32::NAN });
    }
    let normals = NormalMap::from_planes(nx, ny, nz).unwrap();
    let mask = Mask::filled(40, 30, true);
    let depth = integrate(&normals, &mask, None, &orthographic((40, 30)), &tight(), &Unwatched).unwrap();
    assert_eq!((depth.report.islands, depth.report.pixels_without_normal), (1, 30));
    let ridge = |x: f64, _: f64| if x < 20.5 { x } else { 20.5 - 0.5 * (x - 20.5) };
    assert!(worst_error(&depth, ridge) < 1e-3);
}

#[test]
fn a_wide_hole_in_the_normals_is_bridged() {
    let [nx, mut ny, mut nz] = normals_of((130, 120), |_, _| (0.4, -0.3)).into_planes();
    for (x, y) in (10..110).flat_map(|x| (20..100).map(move |y| (x, y))) {
        ny.set(x, y, f32::NAN);
        nz.set(x, y, 0.0);
    }
    let normals = NormalMap::from_planes(nx, ny, nz).unwrap();
    let mask = Mask::filled(130, 120, true);
    let depth = integrate(&normals, &mask, None, &orthographic((130, 120)), &tight(), &Unwatched).unwrap();
    assert_eq!((depth.report.pixels, depth.report.pixels_without_normal), (130 * 120, 100 * 80));
    assert!(worst_error(&depth, |x, y| 0.4 * x - 0.3 * y) < 1e-3);
}

#[test]
fn pixels_without_confidence_do_not_bend_the_rest() {
    let spoilt = |x: f64, y: f64| (10.0..14.0).contains(&x) && (-14.0..-10.0).contains(&y);
    let normals = normals_of((32, 32), |x, y| if spoilt(x, y) { (5.0, -5.0) } else { (0.2, 0.1) });
    let confidence = Plane::from_fn(32, 32, |x, y| if spoilt(x as f64 + 0.5, -(y as f64 + 0.5)) { 0.0 } else { 3.0 });
    let mask = Mask::filled(32, 32, true);
    let camera = orthographic((32, 32));
    let depth = integrate(&normals, &mask, Some(&confidence), &camera, &tight(), &Unwatched).unwrap();
    assert!(worst_error(&depth, |x, y| 0.2 * x + 0.1 * y) < 1e-4);
}

#[test]
fn normals_at_grazing_angles_are_clamped_and_counted() {
    let normals = NormalMap::from_planes(
        Plane::from_fn(10, 1, |x, _| if x < 3 { -1.0 } else { 0.0 }),
        Plane::filled(10, 1, 0.0),
        Plane::from_fn(10, 1, |x, _| [-0.1, 0.0, 1e-9].get(x).copied().unwrap_or(1.0)),
    )
    .unwrap();
    let options = DepthOptions { max_slope: 4.0, ..tight() };
    let depth =
        integrate(&normals, &Mask::filled(10, 1, true), None, &orthographic((10, 1)), &options, &Unwatched).unwrap();
    assert_eq!(depth.report.clamped_pixels, 3);
    assert!((depth.depth_mm.at(1, 0) - depth.depth_mm.at(0, 0) - 4.0).abs() < 1e-4);
    assert!((depth.depth_mm.at(9, 0) - depth.depth_mm.at(4, 0)).abs() < 1e-4);
}

/// A wavy surface of `size` x `size` pixels and normals with noise of `noise` in slope, from a fixed seed.
fn noisy(size: usize, noise: f64) -> NormalMap {
    normals_of((size, size), move |x, y| {
        let random = |k: f64| ((x * 12.9898 + y * 78.233 + k).sin() * 43758.5453).fract();
        ((x / 30.0).cos() + noise * random(0.0), (y / 50.0).sin() + noise * random(7.0))
    })
}

#[test]
fn the_default_tolerance_is_far_below_the_noise() {
    let (size, camera) = (300, orthographic((300, 300)));
    let mask = Mask::from_fn(size, size, |x, y| (x as f32 - 150.0).hypot(y as f32 - 150.0) > 40.0);
    let solve = |normals: &NormalMap, options| integrate(normals, &mask, None, &camera, &options, &Unwatched).unwrap();
    let rms = |a: &Depth, b: &Depth| {
        let squares = a.depth_mm.data().iter().zip(b.depth_mm.data()).map(|(a, b)| f64::from(a - b).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let normals = noisy(size, 0.01);
    let (exact, clean) = (solve(&normals, tight()), solve(&noisy(size, 0.0), tight()));
    let default = solve(&normals, DepthOptions::default());
    assert!(rms(&default, &exact) < 0.02 * rms(&clean, &exact));
}

#[test]
fn the_iterations_do_not_grow_with_the_picture() {
    let iterations = |size: usize| {
        let mask = Mask::filled(size, size, true);
        let camera = orthographic((size, size));
        let options = DepthOptions { tolerance: 1e-6, ..DepthOptions::default() };
        integrate(&noisy(size, 0.02), &mask, None, &camera, &options, &Unwatched).unwrap().report.iterations
    };
    assert!(iterations(700) <= iterations(50) + 4);
}

#[test]
fn the_result_does_not_depend_on_the_number_of_threads() {
    let normals = noisy(200, 0.02);
    let mask = Mask::from_fn(200, 200, |x, y| (x * y) % 37 != 5);
    let with_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let options = DepthOptions::default();
        pool.install(|| integrate(&normals, &mask, None, &orthographic((200, 200)), &options, &Unwatched).unwrap())
    };
    assert_eq!(with_threads(1), with_threads(3));
}

#[test]
fn what_cannot_be_integrated_is_refused() {
    let normals = normals_of((8, 8), |_, _| (0.0, 0.1));
    let full = Mask::filled(8, 8, true);
    let camera = orthographic((8, 8));
    let solve = |normals: &NormalMap, mask: &Mask, camera: &Camera, options: DepthOptions| {
        integrate(normals, mask, None, camera, &options, &Unwatched).map(|depth| depth.report)
    };
    let options = DepthOptions::default();
    let none = Mask::filled(8, 8, false);
    assert_eq!(solve(&normals, &none, &camera, options), Err(DepthError::NoNormal { pixels: 0 }));
    let zero = || Plane::filled(8, 8, 0.0);
    let black = NormalMap::from_planes(zero(), zero(), zero()).unwrap();
    assert_eq!(solve(&black, &full, &camera, options), Err(DepthError::NoNormal { pixels: 64 }));
    let small = Mask::filled(8, 7, true);
    assert_eq!(
        solve(&normals, &small, &camera, options),
        Err(DepthError::Size { what: "mask", found: (8, 7), normals: (8, 8) })
    );
    let flat = Camera { projection: Projection::Orthographic { mm_per_pixel: Some(0.0) }, size: (8, 8) };
    assert!(matches!(solve(&normals, &full, &flat, options), Err(DepthError::Camera { .. })));
    let hasty = DepthOptions { max_iterations: 1, tolerance: 1e-8, ..options };
    assert!(matches!(solve(&normals, &full, &camera, hasty), Err(DepthError::NotConverged { iterations: 1, .. })));
    let wrong = DepthOptions { tolerance: f64::NAN, ..options };
    assert!(matches!(wrong.check(), Err(DepthError::Option(OptionError { option: "tolerance", .. }))));
}

#[test]
fn a_cancelled_job_ends_at_once() {
    struct Impatient;
    impl Watch for Impatient {
        fn progress(&self, _fraction: f32) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    let normals = normals_of((8, 8), |_, _| (0.0, 0.1));
    let mask = Mask::filled(8, 8, true);
    let refused = integrate(&normals, &mask, None, &orthographic((8, 8)), &DepthOptions::default(), &Impatient);
    assert_eq!(refused, Err(DepthError::Cancelled));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, rng_seed: RngSeed::Fixed(7), failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_quadratic_comes_back_on_any_mask(
        (width, height, inside) in (1..40_usize, 1..40_usize).prop_flat_map(|(width, height)| {
            (Just(width), Just(height), prop::collection::vec(prop::bool::weighted(0.7), width * height))
        }),
        k in prop::array::uniform5(-1.0..1.0_f64),
    ) {
        let mask = Mask::from_vec(width, height, inside).unwrap();
        prop_assume!(mask.count() > 0);
        let z = |x: f64, y: f64| k[0] * x + k[1] * y + 0.02 * (k[2] * x * x + k[3] * y * y + k[4] * x * y);
        let slopes = |x: f64, y: f64| {
            (k[0] + 0.02 * (2.0 * k[2] * x + k[4] * y), k[1] + 0.02 * (2.0 * k[3] * y + k[4] * x))
        };
        let normals = normals_of((width, height), slopes);
        let depth = integrate(&normals, &mask, None, &orthographic((width, height)), &tight(), &Unwatched).unwrap();
        prop_assert_eq!(depth.report.islands, islands(&mask).len());
        prop_assert!(worst_error(&depth, z) < 5e-4);
    }
}
