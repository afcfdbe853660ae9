//! Circles and calibration on balls rendered here, with noise and quantisation, against what they were rendered with.

#![allow(clippy::unwrap_used)]

use firstbounce_core::calibrate::*;
use firstbounce_core::image::photo::{CLIPPED, DARK};
use firstbounce_core::sphere::{Ball, BallError, Circle, CircleOptions, Refusal, View, find_circle, refine_circle};
use firstbounce_core::{Marks, Photo, Plane};
use nalgebra::Vector3;
use std::cell::Cell;

const SIZE: usize = 160;
const CIRCLE: Circle = Circle { centre_px: (81.3, 77.8), radius_px: 62.4 };

/// Seeded normal noise: the sum of twelve uniform numbers of a linear congruential generator.
struct Noise(Cell<u64>);

impl Noise {
    fn new(seed: u64) -> Self {
        Self(Cell::new(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1))
    }

    fn uniform(&self) -> f64 {
        self.0.set(self.0.get().wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407));
        (self.0.get() >> 33) as f64 / (1u64 << 31) as f64
    }

    fn normal(&self) -> f64 {
        (0..12).map(|_| self.uniform()).sum::<f64>() - 6.0
    }
}

/// A photo of what `light` says of each point: 4 x 4 samples a pixel, photon and read noise, 14 bits.
fn photograph(noise: &Noise, light: impl Fn(f64, f64) -> f64) -> Photo {
    let mut marks = Vec::new();
    let linear = Plane::from_fn(SIZE, SIZE, |x, y| {
        let samples = (0..16)
            .map(|i| light(x as f64 + (f64::from(i % 4) + 0.5) / 4.0, y as f64 + (f64::from(i / 4) + 0.5) / 4.0));
        let mean = samples.sum::<f64>() / 16.0;
        let noisy = mean + noise.normal() * (mean.max(0.0) / 20_000.0 + 1e-8).sqrt();
        let stored = ((noisy * 16383.0).round() / 16383.0).min(1.0);
        marks.push(u8::from(stored >= 1.0) * CLIPPED + u8::from(stored < 0.001) * DARK);
        stored as f32
    });
    Photo { marks: Marks::from_vec(linear.width(), linear.height(), marks).unwrap(), linear }
}

fn ball() -> Ball {
    Ball::new(CIRCLE, View::Orthographic)
}

fn matt(strength: f64, direction: Vector3<f64>) -> impl Fn(f64, f64) -> f64 {
    move |x, y| ball().surface_at(x, y).map_or(0.0, |p| strength * p.normal.dot(&direction).max(0.0))
}

fn lamps() -> [Vector3<f64>; 3] {
    [(-0.3, 0.1, 1.0), (0.1, 0.35, 1.0), (0.3, -0.25, 1.0)].map(|(x, y, z)| Vector3::new(x, y, z).normalize())
}

#[test]
fn the_circle_of_a_noisy_ball_is_found_and_lies_in_its_interval() {
    let (mut inside, mut all) = (0, 0);
    for seed in 0..6 {
        let noise = Noise::new(seed);
        let photos = lamps().map(|direction| photograph(&noise, matt(0.5, direction)));
        let planes = photos.each_ref().map(|photo| &photo.linear);
        let found = find_circle(&planes, None, &CircleOptions::default()).unwrap();
        let truth = [CIRCLE.centre_px.0, CIRCLE.centre_px.1, CIRCLE.radius_px];
        let intervals = [found.centre_interval_px.0, found.centre_interval_px.1, found.radius_interval_px];
        assert!((found.circle.radius_px - CIRCLE.radius_px).abs() < 0.15);
        assert!(
            (found.circle.centre_px.0 - CIRCLE.centre_px.0).hypot(found.circle.centre_px.1 - CIRCLE.centre_px.1) < 0.15
        );
        inside += intervals.iter().zip(truth).filter(|(interval, truth)| interval.contains(*truth)).count();
        all += 3;
    }
    assert!(10 * inside >= 9 * all, "{inside} of {all}");
}

#[test]
fn one_lamp_from_the_side_and_a_click_or_a_rough_circle_are_enough() {
    let photo = photograph(&Noise::new(7), matt(0.6, Vector3::new(0.6, 0.3, 0.74).normalize()));
    let rough = Circle { centre_px: (88.0, 84.0), radius_px: 55.0 };
    let clicked = find_circle(&[&photo.linear], Some((100.0, 60.0)), &CircleOptions::default()).unwrap();
    let snapped = refine_circle(&[&photo.linear], &rough, &CircleOptions::default()).unwrap();
    for found in [clicked.circle, snapped.circle] {
        assert!((found.radius_px - CIRCLE.radius_px).abs() < 0.5, "{found:?}");
        assert!((found.centre_px.0 - CIRCLE.centre_px.0).abs() < 0.5, "{found:?}");
    }
}

#[test]
fn where_no_ball_shows_the_error_says_so() {
    let noise = Noise::new(3);
    let empty = photograph(&noise, |_, _| 0.01);
    let highlight = photograph(&noise, |x, y| if (x - 60.0).hypot(y - 70.0) < 1.2 { 2.0 } else { 0.002 });
    for photo in [empty, highlight] {
        let error = find_circle(&[&photo.linear], None, &CircleOptions::default()).unwrap_err();
        assert!(matches!(error, BallError::NotFound { .. }), "{error}");
    }
    assert_eq!(find_circle(&[], None, &CircleOptions::default()), Err(BallError::NoImage));
}

#[test]
fn a_circle_that_is_no_balls_is_refused_with_the_reason() {
    let noise = Noise::new(21);
    let refused = |photo: &Photo| match find_circle(&[&photo.linear], None, &CircleOptions::default()) {
        Err(BallError::NotFound { refused }) => refused.map(|refused| refused.refusal),
        other => panic!("{other:?}"),
    };
    // A ball far from the optical axis of a short lens.
    let ellipse = |x: f64, y: f64| ((x - 80.0) / 62.0).hypot((y - 80.0) / 54.0) < 1.0;
    let photo = photograph(&noise, |x, y| if ellipse(x, y) { 0.5 } else { 0.01 });
    let refusal = refused(&photo);
    assert!(matches!(refusal, Some(Refusal::Elliptic { axes }) if (1.1..1.2).contains(&axes)), "{refusal:?}");
    // A quarter of a rim, the rest out of the light.
    let quarter =
        |x: f64, y: f64| ball().surface_at(x, y).map_or(0.0, |p| f64::from(p.normal.x > 0.1 && p.normal.y > 0.1));
    let refusal = refused(&photograph(&noise, |x, y| 0.5 * quarter(x, y)));
    assert!(refusal.is_some(), "{refusal:?}");
    let error = find_circle(&[&photo.linear], None, &CircleOptions::default()).unwrap_err().to_string();
    assert!(error.contains("ellipse") && error.contains("three points of its rim"), "{error}");
}

#[test]
fn at_least_nine_in_ten_values_lie_in_their_intervals() {
    let (mut inside, mut all) = (0, 0);
    let mut meet = |hit: bool| {
        inside += usize::from(hit);
        all += 1;
    };
    for seed in 0..12 {
        let noise = Noise::new(100 + seed);
        let strengths = [0.4, 0.5, 0.36];
        let photos: Vec<Photo> =
            lamps().iter().zip(strengths).map(|(&lamp, strength)| photograph(&noise, matt(strength, lamp))).collect();
        let mut reports = Vec::new();
        for (photo, truth) in photos.iter().zip(lamps()) {
            let found = direction_from_shading(photo, &ball(), &ShadingOptions::default()).unwrap().direction;
            assert!(found.direction_to_light.angle(&truth).to_degrees() < 0.1);
            (0..3).for_each(|axis| meet(found.interval[axis].contains(truth[axis])));
            let lamp =
                Lamp::Distant { direction_to_light: found.direction_to_light, half_angle_deg: found.half_angle_deg };
            reports.push(measure_strength(photo, &ball(), &lamp, &IntensityOptions::default()).unwrap());
        }
        let intensities = relative_intensities(&reports.iter().collect::<Vec<_>>());
        intensities.iter().zip(strengths).skip(1).for_each(|(i, s)| meet(i.interval.contains(s / strengths[0])));

        // alpha is 1.7, beta 0.6.
        let of_lights: Vec<_> = lamps()
            .map(|lamp| {
                let shoot = |strength| photograph(&noise, matt(strength, lamp));
                let grey = measure_ratio(&shoot(0.4), &shoot(0.68), &ball(), &RatioOptions::default()).unwrap();
                let paint = measure_ratio(&shoot(0.7), &shoot(0.714), &ball(), &RatioOptions::default()).unwrap();
                meet(grey.ratio.interval.contains(1.7));
                (paint.ratio, grey.ratio)
            })
            .to_vec();
        let beta = pool_beta(&of_lights).unwrap();
        assert!((beta.value / 0.6 - 1.0).abs() < 0.005);
        meet(beta.interval.contains(0.6));
    }
    assert!(10 * inside >= 9 * all, "{inside} of {all}");
}

#[test]
fn gloss_on_the_grey_ball_is_refused_and_leaves_alpha_alone() {
    let noise = Noise::new(11);
    let lamp = lamps()[0];
    let half_way = (lamp + Vector3::z()).normalize();
    let glossy = |strength: f64| {
        move |x: f64, y: f64| {
            let gloss = ball().surface_at(x, y).map_or(0.0, |p| p.normal.dot(&half_way).max(0.0).powi(500));
            matt(strength, lamp)(x, y) + 0.3 * gloss
        }
    };
    let (reference, photo) = (photograph(&noise, glossy(0.3)), photograph(&noise, glossy(0.6)));
    let found = measure_ratio(&reference, &photo, &ball(), &RatioOptions::default()).unwrap();
    assert!(found.pixels.counts().highlight > 50);
    assert!((found.ratio.value / 2.0 - 1.0).abs() < 0.003, "{:?}", found.ratio);
}

#[test]
fn near_lamps_are_measured_as_seen_from_the_origin() {
    let position_mm = Vector3::new(120.0, -80.0, 500.0);
    let lamp = Lamp::Near { position_mm, ball_centre_mm: Vector3::zeros(), ball_radius_mm: 30.0 };
    let light = |x: f64, y: f64| ball().surface_at(x, y).map_or(0.0, |p| 0.5 * lamp.shading(&p.normal));
    let photo = photograph(&Noise::new(5), light);
    let strength = measure_strength(&photo, &ball(), &lamp, &IntensityOptions::default()).unwrap().strength;
    assert!((strength / 0.5 - 1.0).abs() < 0.001, "{strength}");
    let options = ShadingOptions { lamp_distance_radii: Some(position_mm.norm() / 30.0), ..Default::default() };
    let direction = direction_from_shading(&photo, &ball(), &options).unwrap().direction.direction_to_light;
    assert!(direction.angle(&position_mm).to_degrees() < 0.1);
}

#[test]
fn the_lamp_is_chosen_among_reflections_and_gives_twice_the_normals_angle() {
    let noise = Noise::new(9);
    let spot = |direction: Vector3<f64>, radius: f64| {
        let n = (direction + Vector3::z()).normalize();
        let at = (CIRCLE.centre_px.0 + CIRCLE.radius_px * n.x, CIRCLE.centre_px.1 - CIRCLE.radius_px * n.y);
        move |x: f64, y: f64| f64::from(u8::from((x - at.0).hypot(y - at.1) < radius))
    };
    let room = spot(Vector3::new(0.8, 0.2, 0.5).normalize(), 4.5);
    let photos = lamps().map(|lamp| {
        let lamp = spot(lamp, 3.0);
        photograph(&noise, |x, y| 0.002 + 2.0 * lamp(x, y) + 2.0 * room(x, y))
    });
    for (light, truth) in lamps().iter().enumerate() {
        let others: Vec<&Photo> = (0..3).filter(|&other| other != light).map(|other| &photos[other]).collect();
        let report = find_highlights(&photos[light], &others, &ball(), &HighlightOptions::default()).unwrap();
        let chosen = report.chosen().unwrap();
        assert!(chosen.clipped && chosen.seen_under_other_lamps == 0);
        let off = chosen.direction.direction_to_light.angle(truth).to_degrees();
        assert!(off < 0.3 && off < chosen.direction.half_angle_deg, "{off}");
        assert_eq!(report.candidates.last().unwrap().seen_under_other_lamps, 2);
    }
}

#[test]
fn balls_that_cannot_be_measured_are_refused_with_the_reason() {
    let noise = Noise::new(2);
    let options = ShadingOptions::default();
    let shade =
        |strength, ball: &Ball| direction_from_shading(&photograph(&noise, matt(strength, lamps()[0])), ball, &options);
    assert!(matches!(shade(3.0, &ball()), Err(CalibrateError::Clipped { clipped, .. }) if clipped > 0.5));
    let dark = shade(0.0005, &ball()).unwrap_err();
    assert!(matches!(dark, CalibrateError::TooFewPixels { counts, .. } if counts.dark > counts.used));
    assert!(dark.to_string().contains("lengthen the exposure"));
    let outside = Circle { centre_px: (20.0, 80.0), radius_px: 60.0 };
    let cut_off = shade(0.5, &Ball::new(outside, View::Orthographic));
    assert!(matches!(cut_off, Err(CalibrateError::LeavesImage { .. })));
    let black = photograph(&noise, |_, _| 0.0);
    let mirror = find_highlights(&black, &[], &ball(), &HighlightOptions::default());
    assert!(matches!(mirror, Err(CalibrateError::NoHighlight { .. })));
}

#[test]
fn sources_that_disagree_are_named() {
    let photo = photograph(&Noise::new(4), matt(0.5, lamps()[0]));
    let shading = direction_from_shading(&photo, &ball(), &ShadingOptions::default()).unwrap().direction;
    let wrong = photograph(&Noise::new(4), matt(0.5, lamps()[1]));
    let other = direction_from_shading(&wrong, &ball(), &ShadingOptions::default()).unwrap().direction;
    let sources = [
        SourcedDirection { source: DirectionSource::Mirror, direction: other },
        SourcedDirection { source: DirectionSource::Shading, direction: shading.clone() },
    ];
    let combined = combine_directions(&sources, 1.0).unwrap();
    let warning = combined.disagreements[0];
    assert_eq!((warning.first, warning.second), (DirectionSource::Mirror, DirectionSource::Shading));
    assert!(warning.angle_deg > 20.0);
    assert!(combined.direction.half_angle_deg > warning.angle_deg, "the region holds both sources");
    let agreed = [sources[1].clone(), SourcedDirection { source: DirectionSource::Typed, direction: shading }];
    assert!(combine_directions(&agreed, 1.0).unwrap().disagreements.is_empty());
}

#[test]
fn crosstalk_lies_in_its_interval_also_where_the_other_channel_is_all_but_dark() {
    let options = CrosstalkOptions::default();
    let (mut inside, mut all) = (0, 0);
    for (seed, share) in [(31, 0.0), (32, 0.0005), (33, 0.04), (34, 0.2)] {
        for direction in lamps() {
            let noise = Noise::new(seed);
            let own = photograph(&noise, matt(0.6, direction));
            let other = photograph(&noise, matt(0.6 * share, direction));
            let found = measure_crosstalk(&[&other, &own], 1, &ball(), &options).unwrap();
            assert_eq!(found.shares[1].value, 1.0);
            assert!((found.shares[0].value - share).abs() < 2e-4, "{:?} for {share}", found.shares[0]);
            inside += usize::from(found.shares[0].interval.contains(share));
            all += 1;
        }
    }
    assert!(inside + 1 >= all, "{inside} of {all}");
}

#[test]
fn crosstalk_in_room_light_has_an_interval_that_holds_the_truth() {
    let noise = Noise::new(41);
    for direction in lamps() {
        let own = photograph(&noise, matt(0.5, direction));
        let other = photograph(&noise, |x, y| 0.02 * matt(1.0, direction)(x, y) + 0.01);
        let found = measure_crosstalk(&[&own, &other], 0, &ball(), &CrosstalkOptions::default()).unwrap();
        assert!(found.shares[1].value > 0.05 && found.shares[1].interval.contains(0.04), "{:?}", found.shares[1]);
    }
}

#[test]
fn crosstalk_shots_of_several_sizes_or_of_too_few_pixels_are_refused() {
    let photo = photograph(&Noise::new(51), matt(0.5, lamps()[0]));
    let small = Photo::unmarked(Plane::filled(10, 10, 0.1));
    let measured =
        |channels: &[&Photo], ball: &Ball| measure_crosstalk(channels, 0, ball, &CrosstalkOptions::default());
    assert!(matches!(measured(&[&photo, &small], &ball()), Err(CalibrateError::SizesDiffer { .. })));
    let tiny = Ball::new(Circle { radius_px: 5.0, ..CIRCLE }, View::Orthographic);
    assert!(matches!(measured(&[&photo, &photo], &tiny), Err(CalibrateError::TooFewPixels { .. })));
    assert!(matches!(measured(&[], &ball()), Err(CalibrateError::NothingMeasured { .. })));
}
