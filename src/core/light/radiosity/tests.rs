//! Form factors and bounces of shapes whose light is known in closed form.

use proptest::{prelude::*, test_runner::RngSeed};

use super::*;
use crate::light::scene::Shape;
use crate::{Mesh, Unwatched};

fn factors_of(mesh: &Mesh) -> (FormFactors, FormFactorReport) {
    form_factors(Patches::from_mesh(mesh).unwrap(), &FormFactorOptions::default(), &Unwatched).unwrap()
}

fn row_sums(factors: &FormFactors) -> Vec<f64> {
    let ones = vec![1.0; factors.patches().len()];
    factors.irradiance(&[ones], &Unwatched).unwrap().remove(0)
}

/// A closed sphere seen from inside: two bowls, mouth to mouth.
fn sphere(patches: usize) -> Mesh {
    let half = Shape::Bowl { radius_mm: 1.0, half_angle_deg: 90.0, rim_mm: 0.0 }.mesh(patches / 2).unwrap();
    let mut mesh = half.clone();
    let offset = half.positions.len() as u32;
    mesh.positions.extend(half.positions.iter().map(|p| nalgebra::Point3::new(p.x, -p.y, -p.z)));
    mesh.normals.extend(half.normals.iter().map(|n| nalgebra::Vector3::new(n.x, -n.y, -n.z)));
    mesh.triangles.extend(half.triangles.iter().map(|t| t.map(|vertex| vertex + offset)));
    mesh
}

#[test]
fn every_patch_of_a_hemisphere_sees_half_its_light_again() {
    let bowl = Shape::Bowl { radius_mm: 40.0, half_angle_deg: 90.0, rim_mm: 0.0 };
    let (factors, report) = factors_of(&bowl.mesh(6500).unwrap());
    assert!(report.unoccluded);
    for sum in row_sums(&factors) {
        assert!((sum - 0.5).abs() < 0.005 * 0.5, "{sum}");
    }
}

#[test]
fn every_patch_of_a_closed_sphere_keeps_all_its_light() {
    let (factors, report) = factors_of(&sphere(1500));
    assert!(report.unoccluded);
    for sum in row_sums(&factors) {
        assert!((sum - 1.0).abs() < 0.005, "{sum}");
    }
}

#[test]
fn a_long_right_angled_groove_sends_itself_1_minus_sin_45_of_its_light() {
    let groove = Shape::Groove { wall_mm: 1.0, length_mm: 200.0, angle_deg: 90.0 };
    let (_, report) = factors_of(&groove.mesh(1600).unwrap());
    let expected = 1.0 - 45f64.to_radians().sin();
    assert!((report.row_sum_mean - expected).abs() < 0.01 * expected, "{}", report.row_sum_mean);
}
proptest! {
    #![proptest_config(ProptestConfig { cases: 8, rng_seed: RngSeed::Fixed(5), ..ProptestConfig::default() })]

    #[test]
    fn a_long_groove_of_any_angle_sends_itself_1_minus_the_sine_of_half_of_it(angle_deg in 20.0..160.0) {
        let groove = Shape::Groove { wall_mm: 1.0, length_mm: 200.0, angle_deg };
        let (_, report) = factors_of(&groove.mesh(800).unwrap());
        let expected = 1.0 - (angle_deg / 2.0).to_radians().sin();
        prop_assert!((report.row_sum_mean - expected).abs() < 0.01 * expected, "{} {}", report.row_sum_mean, expected);
        prop_assert!(report.reciprocity_residual < 1e-3, "{}", report.reciprocity_residual);
    }
}

#[test]
fn light_goes_both_ways_alike() {
    // From either side, by an independent rule: the point form factor integrated over 256 points of the sender.
    let groove = Shape::Groove { wall_mm: 1.0, length_mm: 1.0, angle_deg: 70.0 };
    let (factors, report) = factors_of(&groove.mesh(100).unwrap());
    assert!(report.reciprocity_residual < 1e-3, "{report:?}");
    let patches = factors.patches().as_slice();
    let numeric = |from: &Patch, to: &Patch| {
        let points = (0..16).flat_map(|i| (0..16).map(move |j| ((i as f64 + 0.5) / 16.0, (j as f64 + 0.5) / 16.0)));
        let sum: f64 = points
            // Turns the square into the triangle without folding it.
            .map(|(s, t)| from.point(s.sqrt() * (1.0 - t), s.sqrt() * t))
            .map(|point| polygon::point_to_triangle(&point, &from.normal, &to.corners))
            .sum();
        sum / 256.0
    };
    let mut compared = 0;
    for (i, a) in patches.iter().enumerate() {
        for (j, b) in patches.iter().enumerate().filter(|(_, b)| a.normal.dot(&b.normal) < 0.9) {
            let (there, back) = (factors.form_factor(i, j), factors.form_factor(j, i));
            assert!((a.area_mm2 * there - b.area_mm2 * back).abs() <= 1e-6 * a.area_mm2 * there);
            let expected = numeric(a, b);
            assert!((there - expected).abs() < 0.01 * expected + 1e-5, "{i} {j}: {there} {expected}");
            compared += 1;
        }
    }
    assert!(compared > 1000);
}

#[test]
fn a_spherical_cap_obeys_its_closed_form() {
    // L = rho E + rho^2 f Emean / (1 - rho f), f the cap's fraction of the sphere (Moon 1940).
    let cap = Shape::Bowl { radius_mm: 30.0, half_angle_deg: 70.0, rim_mm: 0.0 };
    let (factors, _) = factors_of(&cap.mesh(3500).unwrap());
    let patches = factors.patches().as_slice();
    let slanting = nalgebra::Vector3::new(0.6, 0.0, 0.8);
    let irradiance: Vec<f64> = patches.iter().map(|patch| patch.normal.dot(&slanting).max(0.0)).collect();
    let area: f64 = patches.iter().map(|patch| patch.area_mm2).sum();
    let mean = patches.iter().zip(&irradiance).map(|(patch, e)| patch.area_mm2 * e).sum::<f64>() / area;
    let f = (1.0 - 70f64.to_radians().cos()) / 2.0;
    let options = BounceOptions { albedos: vec![0.75, 0.38], ..Default::default() };
    let (lit, report) = bounces(&factors, std::slice::from_ref(&irradiance), &options, &Unwatched).unwrap();
    assert!(report.residual <= options.relative_residual);
    for (rho, all) in options.albedos.iter().zip(&lit[0].all) {
        let mut mean_error = 0.0;
        for ((found, direct), patch) in all.iter().zip(&irradiance).zip(patches) {
            let expected = rho * direct + rho * rho * f * mean / (1.0 - rho * f);
            let error = (found - expected).abs() / expected;
            // A facet at the edge of the opening sees it a little otherwise than the sphere does; the picture, gathered
            // at points of the sphere, obeys the law to 0.5 % in every pixel (see the tests of `scene`).
            assert!(error < 0.01, "{found} {expected}");
            mean_error += error * patch.area_mm2 / area;
        }
        assert!(mean_error < 0.002, "{mean_error}");
    }
}

#[test]
fn the_bounces_add_up_to_the_sum_of_all() {
    let corner = Shape::Corner { wall_mm: 60.0, roll_deg: 0.0 };
    let (factors, _) = factors_of(&corner.mesh(300).unwrap());
    let irradiance: Vec<f64> = factors.patches().as_slice().iter().map(|patch| patch.normal.x.max(0.0)).collect();
    let options = BounceOptions { bounces: 40, relative_residual: 1e-9, ..Default::default() };
    let (lit, _) = bounces(&factors, &[irradiance], &options, &Unwatched).unwrap();
    for (patch, all) in lit[0].all[0].iter().enumerate() {
        let sum: f64 = lit[0].bounces.iter().map(|bounce| bounce[patch]).sum();
        assert!((sum - all).abs() < 1e-6 * all);
    }
}

#[test]
fn without_memory_the_factors_are_the_same() {
    let mesh = Shape::Tray { side_mm: 80.0 }.mesh(300).unwrap();
    let (stored, stored_report) = factors_of(&mesh);
    let options = FormFactorOptions { memory_limit_bytes: 0, ..Default::default() };
    let (computed, computed_report) = form_factors(Patches::from_mesh(&mesh).unwrap(), &options, &Unwatched).unwrap();
    assert!(stored_report.stored && !computed_report.stored && computed_report.bytes == 0);
    for (a, b) in row_sums(&stored).iter().zip(row_sums(&computed)) {
        assert!((a - b).abs() < 1e-5);
    }
}

/// Keeps what is reported.
#[derive(Default)]
struct Heard(std::sync::Mutex<Vec<f32>>);

impl crate::Watch for Heard {
    fn progress(&self, fraction: f32) {
        self.0.lock().unwrap().push(fraction);
    }
    fn cancelled(&self) -> bool {
        false
    }
}

impl Heard {
    /// Often, evenly and forward, but for threads that overtake each other.
    fn check(self) {
        let heard = self.0.into_inner().unwrap();
        assert!((20..2000).contains(&heard.len()), "{heard:?}");
        assert!(heard.iter().all(|fraction| (0.0..=1.0).contains(fraction)));
        assert!(heard.windows(2).all(|pair| pair[1] > pair[0] - 0.05 && pair[1] < pair[0] + 0.3), "{heard:?}");
    }
}

#[test]
fn factors_that_are_not_kept_tell_how_far_they_are() {
    let patches = Patches::from_mesh(&Shape::Tray { side_mm: 80.0 }.mesh(300).unwrap()).unwrap();
    let irradiance: Vec<f64> = patches.as_slice().iter().map(|patch| patch.normal.z.max(0.0)).collect();
    let options = FormFactorOptions { memory_limit_bytes: 0, ..Default::default() };
    let heard = Heard::default();
    let (factors, _) = form_factors(patches, &options, &heard).unwrap();
    assert_eq!(heard.0.lock().unwrap().iter().copied().fold(0.0, f32::max), 1.0);
    heard.check();
    let heard = Heard::default();
    bounces(&factors, &[irradiance], &BounceOptions::default(), &heard).unwrap();
    heard.check();
}

/// Two facing unit squares at distance 1, and one between them that may hide them from each other.
fn squares(between: bool) -> Mesh {
    let mut mesh = Shape::Groove { wall_mm: 1.0, length_mm: 1.0, angle_deg: 180.0 }.mesh(2).unwrap();
    mesh.positions.clear();
    mesh.normals.clear();
    mesh.triangles.clear();
    let mut add = |z: f32, half: f32, up: bool| {
        let first = mesh.positions.len() as u32;
        let corners = [(-half, -half), (half, -half), (half, half), (-half, half)];
        mesh.positions.extend(corners.map(|(x, y)| nalgebra::Point3::new(x, y, z)));
        let triangles = if up { [[0, 1, 2], [0, 2, 3]] } else { [[0, 2, 1], [0, 3, 2]] };
        mesh.triangles.extend(triangles.map(|triangle| triangle.map(|vertex: u32| first + vertex)));
    };
    add(0.0, 0.5, true);
    add(1.0, 0.5, false);
    if between {
        add(0.5, 2.0, true);
    }
    mesh
}

#[test]
fn a_screen_hides_what_is_behind_it() {
    let (open, _) = factors_of(&squares(false));
    let (hidden, report) = factors_of(&squares(true));
    let to_ceiling = |factors: &FormFactors| factors.form_factor(0, 2) + factors.form_factor(0, 3);
    assert!((to_ceiling(&open) - 0.199_825).abs() < 1e-3);
    assert_eq!(to_ceiling(&hidden), 0.0);
    assert!(!report.unoccluded && report.visible_fraction < 0.9);
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
    let patches = Patches::from_mesh(&squares(true)).unwrap();
    let stopped = form_factors(patches, &FormFactorOptions::default(), &Impatient);
    assert_eq!(stopped.unwrap_err(), RadiosityError::Cancelled);
}

#[test]
fn a_mesh_without_sense_is_refused() {
    let mut mesh = squares(false);
    mesh.triangles[1][2] = 99;
    assert_eq!(Patches::from_mesh(&mesh).unwrap_err(), RadiosityError::BadTriangle { triangle: 1 });
    mesh.triangles.clear();
    assert_eq!(Patches::from_mesh(&mesh).unwrap_err(), RadiosityError::NoTriangles);
}

/// Whatever its size and its place, a surface exchanges light or is refused.
#[test]
fn surfaces_of_every_size_are_traced_or_refused() {
    let shape = Shape::Corner { wall_mm: 1.0, roll_deg: 0.0 };
    for power in (-45..39).step_by(3) {
        for shift in [0.0, 1e-20, 1.0, 1e8, 1e20, 1e38] {
            let scale = 10f32.powi(power);
            let mut mesh = shape.mesh(24).unwrap();
            mesh.positions
                .iter_mut()
                .for_each(|position| *position = *position * scale + nalgebra::Vector3::repeat(shift));
            let Ok(patches) = Patches::from_mesh(&mesh) else { continue };
            let (factors, _) = form_factors(patches, &FormFactorOptions::default(), &Unwatched).unwrap();
            let light = vec![1.0; factors.patches().len()];
            let _ = bounces(&factors, &[light], &BounceOptions::default(), &Unwatched);
        }
    }
}
