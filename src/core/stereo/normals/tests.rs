use rand::rngs::StdRng;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;

use super::*;
use crate::{AngularError, Projection, Unwatched};

const SIZE: (usize, usize) = (120, 90);

fn camera(mm_per_pixel: Option<f64>) -> Camera {
    Camera { projection: Projection::Orthographic { mm_per_pixel }, size: SIZE }
}

/// The upper part of a ball, radius 100 px: normals up to 48 degrees from the camera.
fn ball() -> NormalMap {
    let component = |axis: usize| {
        Plane::from_fn(SIZE.0, SIZE.1, |x, y| {
            let (x, y) = ((x as f32 + 0.5 - 60.0) / 100.0, (45.0 - y as f32 - 0.5) / 100.0);
            [x, y, (1.0 - x * x - y * y).sqrt()][axis]
        })
    };
    NormalMap::from_planes(component(0), component(1), component(2)).unwrap()
}

/// Lamps evenly around the axis at 30 degrees, of unequal strength.
fn ring(count: usize) -> Vec<(Lamp, f64)> {
    let lamp = |l: usize| {
        let turn = std::f64::consts::TAU * l as f64 / count as f64;
        (Lamp::Distant(Vector3::new(0.5 * turn.cos(), 0.5 * turn.sin(), 0.87)), 1.0 + 0.2 * l as f64)
    };
    (0..count).map(lamp).collect()
}

/// The light of a surface of albedo 0.6 under these lamps; attached shadows are black.
fn render(truth: &NormalMap, lamps: &[(Lamp, f64)], point_mm: impl Fn(usize, usize) -> Point3<f64>) -> Vec<Plane> {
    let light = |(lamp, intensity): &(Lamp, f64)| {
        Plane::from_fn(SIZE.0, SIZE.1, |x, y| {
            let normal = truth.at(x, y).unwrap().cast::<f64>();
            (0.6 * intensity * normal.dot(&lamp.irradiance_vector(point_mm(x, y))).max(0.0)) as f32
        })
    };
    lamps.iter().map(light).collect()
}

fn solve(planes: &[Plane], lamps: &[(Lamp, f64)], marks: &[Marks], noise: Option<&Plane>) -> (Normals, NormalsReport) {
    let lights: Vec<_> = planes
        .iter()
        .zip(lamps)
        .zip(marks)
        .map(|((direct, &(lamp, intensity)), marks)| DirectLight { direct, noise, marks, lamp, intensity })
        .collect();
    let mask = Mask::filled(SIZE.0, SIZE.1, true);
    let surface = Surface { camera: &camera(Some(1.0)), depth_mm: None };
    normals(&lights, &mask, surface, &NormalsOptions::default(), &Unwatched).unwrap()
}

fn unmarked(lights: usize) -> Vec<Marks> {
    vec![Marks::filled(SIZE.0, SIZE.1, 0); lights]
}

fn error(normals: &Normals, truth: &NormalMap) -> AngularError {
    normals.map.angular_error(truth, &Mask::filled(SIZE.0, SIZE.1, true)).unwrap()
}

#[test]
fn unequal_lamps_give_the_true_normals_and_albedo() {
    let truth = ball();
    for count in [3, 4, 7] {
        let lamps = ring(count);
        let planes = render(&truth, &lamps, |_, _| Point3::origin());
        let (normals, report) = solve(&planes, &lamps, &unmarked(count), None);
        assert!(error(&normals, &truth).mean_deg < 0.01, "{count} lamps");
        assert!((report.mean_albedo - 0.6).abs() < 1e-4);
        assert_eq!(report.solved_pixels, SIZE.0 * SIZE.1);
    }
}

#[test]
fn cast_shadows_and_highlights_are_left_out_where_enough_lights_remain() {
    let truth = ball();
    let lamps = ring(8);
    let mut planes = render(&truth, &lamps, |_, _| Point3::origin());
    for y in 20..50 {
        for x in 30..70 {
            planes[1].set(x, y, 0.1); // a cast shadow that indirect light fills
            planes[4].set(x, y, 0.0); // a black one
            planes[6].set(x, y, 1.8); // a highlight
        }
    }
    let (normals, report) = solve(&planes, &lamps, &unmarked(8), None);
    assert!(error(&normals, &truth).mean_deg < 0.01);
    assert_eq!(report.shadowed_pixels, 30 * 40);
}

#[test]
fn a_shadow_under_three_lamps_is_used_and_marked() {
    let truth = ball();
    let lamps = ring(3);
    let mut planes = render(&truth, &lamps, |_, _| Point3::origin());
    planes[0].set(10, 10, 0.0);
    let (normals, report) = solve(&planes, &lamps, &unmarked(3), None);
    assert_eq!((normals.marks.data()[10 * SIZE.0 + 10], report.shadow_used_pixels), (SHADOW_USED, 1));
}

#[test]
fn unsolved_lights_are_never_used() {
    let truth = ball();
    let lamps = ring(4);
    let mut planes = render(&truth, &lamps, |_, _| Point3::origin());
    let mut marks = unmarked(4);
    let bad = 33 * SIZE.0 + 50;
    planes[2].data_mut()[bad] = 50.0;
    marks[2].data_mut()[bad] = UNSOLVED | CLIPPED;
    let (normals, _) = solve(&planes, &lamps, &marks, None);
    assert!(error(&normals, &truth).mean_deg < 0.01);
    assert_eq!(normals.marks.data()[bad], CLIPPED);

    marks[0].data_mut()[bad] = UNSOLVED | DARK;
    let (normals, report) = solve(&planes, &lamps, &marks, None);
    assert_eq!(normals.marks.data()[bad], UNSOLVED | CLIPPED | DARK);
    assert_eq!((error(&normals, &truth).pixels, report.unsolved_pixels), (SIZE.0 * SIZE.1 - 1, 1));
}

#[test]
fn predicted_angles_are_the_angles_that_noise_makes() {
    let truth = ball();
    let lamps = ring(4);
    let sigma = 0.004;
    let mut random = StdRng::seed_from_u64(11);
    let planes: Vec<_> = render(&truth, &lamps, |_, _| Point3::origin())
        .into_iter()
        .map(|mut plane| {
            plane.data_mut().iter_mut().for_each(|light| *light += sigma * random.sample::<f32, _>(StandardNormal));
            plane
        })
        .collect();
    let (normals, _) = solve(&planes, &lamps, &unmarked(4), Some(&Plane::filled(SIZE.0, SIZE.1, sigma)));
    let (mut found, mut predicted) = (0.0, 0.0);
    for pixel in 0..SIZE.0 * SIZE.1 {
        let (a, b) = (normals.map.at_index(pixel).unwrap(), truth.at_index(pixel).unwrap());
        found += f64::from(a.cross(&b).norm().asin().to_degrees()).powi(2);
        predicted += f64::from(normals.noise_deg.data()[pixel]).powi(2);
    }
    let ratio = (found / predicted).sqrt();
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");
}

#[test]
fn near_lamps_light_each_pixel_from_their_own_place() {
    let truth = ball();
    let place = |x: f64, y: f64| Lamp::Near(Point3::new(x, y, 300.0));
    let lamps = [(place(150.0, 0.0), 1.0), (place(-80.0, 130.0), 1.2), (place(-80.0, -130.0), 0.9)];
    let camera = camera(Some(1.0));
    let planes = render(&truth, &lamps, |x, y| camera.point_mm(x as f64 + 0.5, y as f64 + 0.5, 0.0));
    let (normals, report) = solve(&planes, &lamps, &unmarked(3), None);
    assert!(error(&normals, &truth).mean_deg < 0.01);
    assert!((report.mean_albedo - 0.6).abs() < 1e-4);
}

#[test]
fn too_few_lights_or_lights_in_a_plane_are_refused() {
    let truth = ball();
    let mask = Mask::filled(SIZE.0, SIZE.1, true);
    let refused = |lamps: &[(Lamp, f64)]| {
        let planes = render(&truth, lamps, |_, _| Point3::origin());
        let marks = Marks::filled(SIZE.0, SIZE.1, 0);
        let light = |(direct, &(lamp, intensity))| DirectLight { direct, noise: None, marks: &marks, lamp, intensity };
        let lights: Vec<_> = planes.iter().zip(lamps).map(light).collect();
        let surface = Surface { camera: &camera(None), depth_mm: None };
        normals(&lights, &mask, surface, &NormalsOptions::default(), &Unwatched).unwrap_err()
    };
    assert_eq!(refused(&ring(3)[..2]), NormalsError::TooFewLights { lights: 2 });
    let row = [-0.4, 0.0, 0.4].map(|x| (Lamp::Distant(Vector3::new(x, 0.0, 1.0)), 1.0));
    assert!(matches!(refused(&row), NormalsError::LightsInPlane { lights: 3, .. }));
    let near = [(Lamp::Near(Point3::new(0.0, 0.0, 300.0)), 1.0), ring(3)[0], ring(3)[1]];
    assert_eq!(refused(&near), NormalsError::NoScale);
}
