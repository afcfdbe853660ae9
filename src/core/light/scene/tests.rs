//! Scenes whose pictures are known in closed form, and pictures that must not show what the surface was cut into.

use nalgebra::{Point3, Unit, Vector3};

use super::*;
use crate::light::radiosity::{BounceOptions, FormFactors, Patches, form_factors};
use crate::mesh::LengthUnit;
use crate::options::OptionError;
use crate::{Mesh, Plane, Projection, Unwatched};

fn factors_of(mesh: &Mesh) -> FormFactors {
    form_factors(Patches::from_mesh(mesh).unwrap(), &Default::default(), &Unwatched).unwrap().0
}

fn orthographic(mm_per_pixel: f64, width: usize, height: usize) -> Camera {
    Camera { projection: Projection::Orthographic { mm_per_pixel: Some(mm_per_pixel) }, size: (width, height) }
}

fn directional(x: f64, y: f64, z: f64) -> Lamp {
    Lamp::Directional { direction_to_light: Unit::new_normalize(Vector3::new(x, y, z)), intensity: 1.0 }
}

/// A square at height `z_mm` that faces +z, as two triangles.
fn square(mesh: &mut Mesh, half_mm: f32, z_mm: f32) {
    let first = mesh.positions.len() as u32;
    let corners = [(-half_mm, -half_mm), (half_mm, -half_mm), (half_mm, half_mm), (-half_mm, half_mm)];
    mesh.positions.extend(corners.map(|(x, y)| Point3::new(x, y, z_mm)));
    mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
}

fn empty() -> Mesh {
    let unit = LengthUnit::Millimetre;
    Mesh { positions: vec![], normals: vec![], colours: vec![], triangles: vec![], unit }
}

#[test]
fn the_picture_of_a_cap_obeys_its_closed_form() {
    // L = rho E + rho^2 f Emean / (1 - rho f), and bounce 2 is rho^2 f Emean everywhere. Under light along the axis Emean is
    // the opening's area over the cap's.
    let (half_angle, radius_mm) = (60f64.to_radians(), 30.0);
    let cap = Shape::Bowl { radius_mm, half_angle_deg: 60.0, rim_mm: 0.0 };
    let factors = factors_of(&cap.mesh(1500).unwrap());
    let albedos = vec![0.78, 0.2];
    let bounces = BounceOptions { albedos: albedos.clone(), ..Default::default() };
    let options = RenderOptions { bounces, ..Default::default() };
    let lamp = directional(0.0, 0.0, 1.0);
    let camera = orthographic(2.0, 30, 30);
    let (picture, report) = render(&factors, &[lamp], &camera, &options, &Unwatched).unwrap();
    let f = (1.0 - half_angle.cos()) / 2.0;
    let mean = half_angle.sin().powi(2) / (2.0 * (1.0 - half_angle.cos()));
    assert!(report.mask_pixels > 400);
    for (x, y) in (0..900).map(|k| (k % 30, k / 30)).filter(|&(x, y)| picture.mask.at(x, y)) {
        let normal = picture.normals.at(x, y).unwrap();
        let (dx, dy) = (2.0 * (x as f64 + 0.5) - 30.0, 30.0 - 2.0 * (y as f64 + 0.5));
        assert!(
            (f64::from(normal.x) + dx / radius_mm).abs() < 3e-3 && (f64::from(normal.y) + dy / radius_mm).abs() < 3e-3
        );
        let direct = f64::from(picture.lights[0].bounces[0].at(x, y)) / albedos[0];
        assert!((direct - f64::from(normal.z)).abs() < 1e-2);
        let second = f64::from(picture.lights[0].bounces[1].at(x, y));
        let expected = albedos[0].powi(2) * f * mean;
        assert!((second - expected).abs() < 0.01 * expected, "{x} {y}: {second} {expected}");
        for (rho, all) in albedos.iter().zip(&picture.lights[0].all) {
            let expected = rho * direct + rho * rho * f * mean / (1.0 - rho * f);
            assert!((f64::from(all.at(x, y)) - expected).abs() < 0.005 * expected, "{x} {y}");
        }
    }
}

/// The largest second difference along rows, relative to the plane's mean: steps at patch borders show up in it.
fn roughness(plane: &Plane, rows: std::ops::Range<usize>, columns: std::ops::Range<usize>) -> f64 {
    let mut largest = 0.0_f32;
    let mut sum = 0.0;
    for y in rows.clone() {
        for x in columns.start + 1..columns.end - 1 {
            largest = largest.max((plane.at(x - 1, y) - 2.0 * plane.at(x, y) + plane.at(x + 1, y)).abs());
            sum += plane.at(x, y);
        }
    }
    f64::from(largest) / f64::from(sum) * (rows.len() * (columns.len() - 2)) as f64
}

#[test]
fn no_patch_shows_along_a_crease() {
    // Patches of 5 mm under pixels of 0.25 mm, along the crease and one pixel beside it.
    let groove = Shape::Groove { wall_mm: 40.0, length_mm: 40.0, angle_deg: 90.0 };
    let camera = orthographic(0.25, 80, 4);
    // Turned, so that rows run along the crease.
    let mut mesh = groove.mesh(256).unwrap();
    for position in &mut mesh.positions {
        (position.x, position.y) = (-position.y, position.x);
    }
    mesh.normals.clear();
    let factors = factors_of(&mesh);
    let lamp = directional(0.3, 0.3, 1.0);
    let (picture, _) = render(&factors, &[lamp], &camera, &RenderOptions::default(), &Unwatched).unwrap();
    for bounce in &picture.lights[0].bounces[1..] {
        let rough = roughness(bounce, 0..4, 0..80);
        assert!(rough < 0.01, "{rough}");
    }
}

#[test]
fn walls_of_a_tray_do_not_shade_the_crease_they_meet_in() {
    // Samples fall exactly on the tray's diagonals.
    let factors = factors_of(&Shape::Tray { side_mm: 80.0 }.mesh(400).unwrap());
    let options = RenderOptions { samples_per_pixel_side: 1, gather_spacing_px: 1, ..Default::default() };
    let camera = orthographic(1.0, 79, 79);
    let (picture, _) = render(&factors, &[directional(0.0, 0.0, 1.0)], &camera, &options, &Unwatched).unwrap();
    let second = &picture.lights[0].bounces[1];
    for k in 3..13 {
        let beside = second.at(k - 2, k).min(second.at(k + 2, k));
        assert!(second.at(k, k) > 0.8 * beside, "{k}: {} {beside}", second.at(k, k));
    }
}

#[test]
fn interpolated_light_is_the_gathered_light() {
    let factors = factors_of(&Shape::Tray { side_mm: 80.0 }.mesh(400).unwrap());
    let lamp = [directional(0.3, 0.1, 1.0)];
    let camera = orthographic(0.2, 100, 60);
    let picture = |gather_spacing_px| {
        let options = RenderOptions { samples_per_pixel_side: 1, gather_spacing_px, ..Default::default() };
        render(&factors, &lamp, &camera, &options, &Unwatched).unwrap()
    };
    let ((everywhere, all), (between, some)) = (picture(1), picture(4));
    assert_eq!(all.gathers, 6000);
    assert!(some.gathers < 5000, "{}", some.gathers);
    for (exact, found) in everywhere.lights[0].bounces.iter().zip(&between.lights[0].bounces) {
        let difference: f32 = exact.data().iter().zip(found.data()).map(|(a, b)| (a - b).abs()).sum();
        assert!(difference < 0.003 * exact.data().iter().sum::<f32>());
    }
}

#[test]
fn a_square_overhead_casts_its_shadow() {
    let mut mesh = empty();
    square(&mut mesh, 10.0, 0.0);
    square(&mut mesh, 2.0, 5.0);
    let factors = factors_of(&mesh);
    let camera = orthographic(1.0, 20, 20);
    // The light comes from x = z: the shadow of the square at x -2..2, 5 higher, lies at x -7..-3.
    let (picture, _) =
        render(&factors, &[directional(1.0, 0.0, 1.0)], &camera, &Default::default(), &Unwatched).unwrap();
    let row = picture.lights[0].bounces[0].row(10);
    let lit = 0.75 * std::f32::consts::FRAC_1_SQRT_2;
    for (column, value) in row.iter().enumerate() {
        let expected = if (3..7).contains(&column) { 0.0 } else { lit };
        assert!((value - expected).abs() < 1e-5, "{column}: {value}");
    }
    assert!((picture.depth_mm.at(10, 10) - 5.0).abs() < 1e-5 && picture.depth_mm.at(2, 10).abs() < 1e-5);
}

#[test]
fn half_an_area_lamp_gives_half_the_light_behind_a_wall_of_half_its_height() {
    // A screen hides from the origin the lamp's half x < 0.
    let mut mesh = empty();
    square(&mut mesh, 0.5, 0.0);
    mesh.positions.extend([(-100.0, -100.0), (0.0, -100.0), (0.0, 100.0)].map(|(x, y)| Point3::new(x, y, 50.0)));
    mesh.positions.push(Point3::new(-100.0, 100.0, 50.0));
    mesh.triangles.extend([[4, 5, 6], [4, 6, 7]]);
    let factors = factors_of(&mesh);
    let lamp = Lamp::Area {
        centre_mm: Point3::new(0.0, 0.0, 100.0),
        half_width_mm: Vector3::y() * 10.0,
        half_height_mm: Vector3::x() * 10.0,
        intensity: 2.0,
        points_per_side: 8,
    };
    let direct = irradiances(factors.patches(), &[lamp], 1).unwrap();
    for value in &direct[0][..2] {
        assert!((value - 1.0).abs() < 0.01, "{value}");
    }
}

#[test]
fn a_point_lamp_falls_off_with_the_square_of_the_distance() {
    let mut mesh = empty();
    square(&mut mesh, 0.01, 50.0);
    let lamp = Lamp::Point { position_mm: Point3::new(0.0, 0.0, 100.0), intensity: 1.0 };
    let direct = irradiances(&Patches::from_mesh(&mesh).unwrap(), &[lamp], 1).unwrap();
    assert!((direct[0][0] - 4.0).abs() < 1e-5);
}

#[test]
fn a_perspective_picture_shows_points_where_the_camera_puts_them() {
    let factors = factors_of(&Shape::Corner { wall_mm: 60.0, roll_deg: 0.0 }.mesh(150).unwrap());
    let projection = Projection::Perspective {
        focal_length_px: 200.0,
        principal_point_px: (20.0, 20.0),
        working_distance_mm: 300.0,
    };
    let camera = Camera { projection, size: (40, 40) };
    let options = RenderOptions { samples_per_pixel_side: 1, ..Default::default() };
    let (picture, _) = render(&factors, &[directional(0.1, 0.1, 1.0)], &camera, &options, &Unwatched).unwrap();
    for (x, y) in (0..1600).map(|k| (k % 40, k / 40)).filter(|&(x, y)| picture.mask.at(x, y)) {
        let point = camera.point_mm(x as f64 + 0.5, y as f64 + 0.5, f64::from(picture.depth_mm.at(x, y)));
        // All three walls run through the origin.
        let normal: Vector3<f64> = picture.normals.at(x, y).unwrap().cast();
        assert!(normal.dot(&point.coords).abs() < 1e-3, "{x} {y}");
    }
}

#[test]
fn a_cancelled_run_stops() {
    struct Impatient;
    impl crate::Watch for Impatient {
        fn progress(&self, _: f32) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    let factors = factors_of(&Shape::Corner { wall_mm: 60.0, roll_deg: 0.0 }.mesh(6).unwrap());
    let lamps = [directional(0.0, 0.0, 1.0)];
    let stopped = render(&factors, &lamps, &orthographic(1.0, 4, 4), &RenderOptions::default(), &Impatient);
    assert_eq!(stopped.unwrap_err(), SceneError::Cancelled);
}

#[test]
fn what_is_out_of_range_is_refused() {
    let cone = Shape::Bowl { radius_mm: 1.0, half_angle_deg: 120.0, rim_mm: 0.0 };
    assert!(matches!(cone.mesh(100), Err(SceneError::Option(OptionError { option: "half_angle_deg", .. }))));
    let factors = factors_of(&Shape::Corner { wall_mm: 60.0, roll_deg: 0.0 }.mesh(6).unwrap());
    let camera = orthographic(1.0, 4, 4);
    assert_eq!(render(&factors, &[], &camera, &Default::default(), &Unwatched).unwrap_err(), SceneError::NoLamp);
    let lamp = Lamp::Point { position_mm: Point3::origin(), intensity: 1.0 };
    assert!(matches!(lamp.check(), Err(SceneError::Option(OptionError { .. }))));
}
