//! The camera's errors have the sizes that its numbers say, and balls the shading that the calibration expects.

use nalgebra::{DMatrix, Point3, Unit, Vector3};
use proptest::prelude::*;

use super::*;
use firstbounce_core::calibrate::{HighlightOptions, find_highlights};
use firstbounce_core::image::noise::NoiseModel;
use firstbounce_core::image::photo::{CLIPPED, Photo};
use firstbounce_core::light::radiosity::{FormFactorOptions, Patches, form_factors};
use firstbounce_core::light::scene::{self, Shape, directions_on_ring, framed};
use firstbounce_core::sphere::{Ball, Circle, View};
use firstbounce_core::stereo::normals::Lamp;
use firstbounce_core::{Plane, Unwatched};

fn mean_and_variance(plane: &Plane) -> (f64, f64) {
    let count = plane.data().len() as f64;
    let mean = plane.data().iter().map(|&v| f64::from(v)).sum::<f64>() / count;
    (mean, plane.data().iter().map(|&v| (f64::from(v) - mean).powi(2)).sum::<f64>() / (count - 1.0))
}

#[test]
fn noise_has_the_variance_of_the_camera_model() {
    let sensor = Sensor { full_well_electrons: 9_000.0, read_noise_electrons: 40.0, frames: 3, ..Sensor::default() };
    let model = NoiseModel::of_camera(9_000.0, 40.0, 3, 1.0);
    for (stream, light) in [0.02_f32, 0.3, 0.7].into_iter().enumerate() {
        let photo = sensor.photograph(&Plane::filled(150, 150, light), stream as u64).unwrap();
        let (mean, variance) = mean_and_variance(&photo.linear);
        let sigma = model.sigma(f64::from(light));
        // Four standard errors of the mean and of the variance.
        assert!((mean - f64::from(light)).abs() < 4.0 * sigma / 150.0, "{mean} at {light}");
        assert!((variance / sigma.powi(2) - 1.0).abs() < 4.0 * 2f64.sqrt() / 150.0, "{variance} at {light}");
    }
}

#[test]
fn photos_differ_by_stream_and_seed_alone() {
    let light = Plane::filled(40, 5, 0.5);
    let sensor = Sensor::default();
    let stored = sensor.expose(&light, 3).unwrap();
    assert_eq!(stored, sensor.expose(&light, 3).unwrap());
    assert_ne!(stored, sensor.expose(&light, 4).unwrap());
    assert_ne!(stored, Sensor { seed: 2, ..sensor }.expose(&light, 3).unwrap());
    assert_ne!(stored.row(0), stored.row(1), "rows have noise of their own");
}

#[test]
fn too_much_light_clips_and_is_marked() {
    let light = Plane::from_fn(4, 1, |x, _| [0.2, 0.4, 0.55, 3.0][x]);
    let sensor = Sensor { exposure: 2.0, ..Sensor::noiseless(8) };
    assert_eq!(sensor.expose(&light, 0).unwrap().data(), [102.0, 204.0, 255.0, 255.0]);
    assert_eq!(sensor.photograph(&light, 0).unwrap().marks.data(), [0, 0, CLIPPED, CLIPPED]);
}

#[test]
fn a_full_well_however_large_is_no_black_photo() {
    for (full_well_electrons, exposure) in [(1e15, 1.0), (1e15, 1e6), (f64::INFINITY, 1.0)] {
        let sensor = Sensor { full_well_electrons, exposure, ..Sensor::default() };
        let stored = sensor.expose(&Plane::filled(1, 1, 0.5), 0).unwrap().at(0, 0);
        let expected = (512.0 + 0.5 * exposure as f32 * (65535.0 - 512.0)).round().min(65535.0);
        assert_eq!(stored, expected, "{full_well_electrons} electrons, exposure {exposure}");
    }
}

proptest! {
    #[test]
    fn without_noise_light_survives_to_half_a_step(
        bits in 6_u32..=16, black in 0.0_f64..0.2, exposure in 0.1_f64..4.0, light in 0.0_f64..0.99,
    ) {
        let white = f64::from(2_u32.pow(bits) - 1);
        let sensor = Sensor { black_level: (black * white).round(), exposure, ..Sensor::noiseless(bits) };
        let light = light / exposure;
        let photo = sensor.photograph(&Plane::filled(1, 1, light as f32), 0).unwrap();
        prop_assume!(photo.marks.data()[0] == 0);
        let step = 1.0 / (white - sensor.black_level) / exposure;
        prop_assert!((f64::from(photo.linear.at(0, 0)) - light).abs() <= 0.5 * step + 1e-5);
    }
}

#[test]
fn crosstalk_is_its_matrix() {
    let colours = [Plane::filled(2, 1, 1.0), Plane::filled(2, 1, 10.0)];
    let mixed = Crosstalk::even(2, 0.1).unwrap().mix(&colours).unwrap();
    assert_eq!([mixed[0].at(0, 0), mixed[1].at(1, 0)], [2.0, 10.1]);
    assert!(matches!(Crosstalk::even(3, 0.1).unwrap().mix(&colours), Err(LabError::CrosstalkShape { .. })));
    assert!(Crosstalk::new(DMatrix::zeros(2, 3)).is_err());
}

#[test]
fn a_ratio_that_cannot_be_separated_is_left_out_of_the_plan() {
    let (mesh, camera) = framed(Shape::Corner { wall_mm: 60.0, roll_deg: 0.0 }.mesh(60).unwrap(), 24).unwrap();
    let (factors, _) =
        form_factors(Patches::from_mesh(&mesh).unwrap(), &FormFactorOptions::default(), &Unwatched).unwrap();
    let lamps = directions_on_ring(3, 20.0).into_iter();
    let lamps = lamps.map(|direction_to_light| scene::Lamp::Directional { direction_to_light, intensity: 1.0 });
    let options = PlanOptions { lamps: lamps.collect(), ratios: vec![0.5, 0.99, 1.0], ..PlanOptions::default() };
    let by_bounces = |bounces: usize| PlanOptions { method: PlanMethod::Colours { bounces }, ..options.clone() };
    let ratios = |options: &PlanOptions| -> Vec<f64> {
        let found = plan(&factors, &camera, options, &Unwatched).unwrap();
        found.by_ratio.iter().map(|point| point.ratio).collect()
    };
    assert_eq!(ratios(&options), [0.5]);
    // Four colours between 1 and 0.95 are closer to one another than two.
    let four = PlanOptions { albedos: vec![0.75, 0.6, 0.4, 0.2], ratios: vec![0.2, 0.95], ..by_bounces(2) };
    assert_eq!(ratios(&four), [0.2]);
    let together = PlanOptions { method: PlanMethod::ColoursAndShape, ..four };
    assert_eq!(ratios(&together), [0.2, 0.95], "one colour that differs is enough");
    assert_eq!(ratios(&by_bounces(1)), [0.5, 0.99, 1.0], "one bounce needs no ratio");
    let alike = PlanOptions { albedos: vec![0.75, 0.745], ..options };
    assert!(matches!(plan(&factors, &camera, &alike, &Unwatched), Err(LabError::Separate(_))));
}

fn ball(radius_px: f64) -> BallPicture {
    let circle = Circle { centre_px: (50.3, 49.6), radius_px };
    BallPicture {
        ball: Ball::new(circle, View::Orthographic),
        radius_mm: 10.0,
        size: (100, 100),
        samples_per_pixel_side: 4,
    }
}

#[test]
fn a_matt_ball_is_brightest_where_it_faces_the_lamp_and_sums_to_its_closed_form() {
    let lamp = Unit::new_normalize(Vector3::new(0.3, 0.4, 1.0));
    let picture = ball(40.0).matt(&Lamp::Distant(lamp.into_inner()), 0.8);
    let (x, y) = (50.3 + 40.0 * lamp.x, 49.6 - 40.0 * lamp.y);
    assert!((picture.sample(x, y) - 0.8).abs() < 1e-3);
    // The Lambertian phase law: 2/3 ((pi - a) cos a + sin a) r^2 of the light of a facet that faces the lamp.
    let angle = lamp.z.acos();
    let expected = 0.8 * 2.0 / 3.0 * ((std::f64::consts::PI - angle) * angle.cos() + angle.sin()) * 1600.0;
    let sum: f64 = picture.data().iter().map(|&v| f64::from(v)).sum();
    assert!((sum / expected - 1.0).abs() < 2e-3, "{sum} for {expected}");
}

#[test]
fn the_highlight_on_a_mirror_ball_points_to_the_lamp() {
    for direction in directions_on_ring(4, 25.0) {
        let picture = ball(45.0);
        let spot = LampSpot { half_angle_deg: 2.5, light: 0.8, room: 0.01 };
        let photo = Photo::unmarked(picture.mirror(&Lamp::Distant(direction.into_inner()), &spot));
        let found = find_highlights(&photo, &[], &picture.ball, &HighlightOptions::default()).unwrap();
        let angle = found.chosen().unwrap().direction.direction_to_light.angle(&direction).to_degrees();
        assert!(angle < 0.3, "{angle} degrees");
    }
}

#[test]
fn a_near_lamp_lights_the_side_it_is_on() {
    // The top of the ball, of 10 mm, is 10 mm nearer to a lamp 40 mm above its centre: (40 / 30)^2 brighter than the origin.
    let picture = ball(40.0).matt(&Lamp::Near(Point3::new(0.0, 0.0, 40.0)), 0.3);
    assert!((picture.sample(50.3, 49.6) - 0.3 * (4.0_f64 / 3.0).powi(2)).abs() < 1e-3);
}

#[test]
fn what_is_out_of_range_is_refused() {
    for sensor in [
        Sensor { bits: 17, ..Sensor::default() },
        Sensor { black_level: 256.0, ..Sensor::noiseless(8) },
        Sensor { frames: 0, ..Sensor::default() },
        Sensor { full_well_electrons: f64::NAN, ..Sensor::default() },
        Sensor { exposure: 0.0, ..Sensor::default() },
        Sensor { full_well_electrons: 1e20, ..Sensor::default() },
    ] {
        assert!(matches!(sensor.photograph(&Plane::filled(1, 1, 0.5), 0), Err(LabError::Option(_))));
    }
}
