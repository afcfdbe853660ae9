//! Circles and calibration on the rendered sets and the real photos in ../shared/data, against what the render used.

#![allow(clippy::unwrap_used)]

mod shared_sets;

use firstbounce_core::Photo;
use firstbounce_core::calibrate::*;
use firstbounce_core::interval::{Estimate, Interval};
use firstbounce_core::sphere::{
    Ball, BallError, Circle, CircleOptions, CircleReport, View, find_circle, refine_circle,
};
use firstbounce_testing::shared_set;
use nalgebra::Vector3;
use shared_sets::{CAT_LAMPS, SETS, Set, Truth, cat_directions, cat_mirror};
use std::path::Path;

/// True values met and missed by the 95 % intervals.
#[derive(Default)]
struct Coverage {
    inside: usize,
    all: usize,
}

impl Coverage {
    fn meet(&mut self, what: &str, interval: &Interval, truth: f64) {
        self.all += 1;
        self.inside += usize::from(interval.contains(truth));
        if !interval.contains(truth) {
            println!("  outside: {what} {interval:?} {truth}");
        }
    }

    fn check(&self) {
        println!("{} of {} true values lie inside their intervals", self.inside, self.all);
        assert!(10 * self.inside >= 9 * self.all);
    }
}

/// One set with its photos and the circles found in them.
struct Rig<'a> {
    set: &'a Set,
    truth: Truth,
    /// By light, then by colour.
    grey: Vec<Vec<Photo>>,
    material: Vec<Vec<Photo>>,
    mirror: Vec<Photo>,
    grey_circle: CircleReport,
    material_circle: CircleReport,
}

impl<'a> Rig<'a> {
    fn new(set: &'a Set, data: &Path) -> Self {
        let of_colours = |subject: &str, light: &str| {
            (0..set.colours.len()).map(|colour| set.photo(data, subject, light, colour)).collect::<Vec<_>>()
        };
        let of_lights = |subject| set.lights.iter().map(|light| of_colours(subject, light)).collect::<Vec<_>>();
        let (grey, material) = (of_lights("grey-sphere"), of_lights("material-sphere"));
        let circle = |photos: &[Vec<Photo>]| {
            let planes: Vec<_> = photos.iter().map(|colours| &colours[0].linear).collect();
            find_circle(&planes, None, &CircleOptions::default()).unwrap()
        };
        let (grey_circle, material_circle) = (circle(&grey), circle(&material));
        let mirror = set.lights.iter().map(|light| set.mirror(data, light)).collect();
        Self { set, truth: set.truth(data), grey, material, mirror, grey_circle, material_circle }
    }

    fn grey_ball(&self) -> Ball {
        Ball::new(self.grey_circle.circle, View::Orthographic)
    }

    /// The mirror ball is nothing but a highlight on black: its circle is the one in the capture file.
    fn mirror_ball(&self) -> Ball {
        let centre_px = (self.set.centre_px, self.set.centre_px);
        Ball::new(Circle { centre_px, radius_px: self.set.radius_px }, View::Orthographic)
    }

    fn alpha(&self, light: usize, colour: usize) -> Estimate {
        let photos = &self.grey[light];
        measure_ratio(&photos[0], &photos[colour], &self.grey_ball(), &RatioOptions::default()).unwrap().ratio
    }

    fn direction(&self, light: usize) -> CombinedDirection {
        let lamp_distance_radii = self.set.lamp_distance_radii;
        let highlight = HighlightOptions { lamp_distance_radii, ..Default::default() };
        let others: Vec<_> = (0..self.mirror.len()).filter(|&other| other != light).map(|i| &self.mirror[i]).collect();
        let mirror = find_highlights(&self.mirror[light], &others, &self.mirror_ball(), &highlight).unwrap();
        let options =
            ShadingOptions { circle_sd_px: self.grey_circle.sd_px, lamp_distance_radii, ..Default::default() };
        let shading = direction_from_shading(&self.grey[light][0], &self.grey_ball(), &options).unwrap();
        let truth = self.truth.direction[light];
        let off = |d: &DirectionEstimate| d.direction_to_light.angle(&truth).to_degrees();
        let chosen = mirror.chosen().unwrap().direction.clone();
        println!(
            "  {} mirror {:.3} of {:.3}, shading {:.4} of {:.4} deg, ambient {:.4}, residual {:.4}",
            self.set.lights[light],
            off(&chosen),
            chosen.half_angle_deg,
            off(&shading.direction),
            shading.direction.half_angle_deg,
            shading.ambient,
            shading.residual
        );
        let sources = [
            SourcedDirection { source: DirectionSource::Mirror, direction: chosen },
            SourcedDirection { source: DirectionSource::Shading, direction: shading.direction },
        ];
        combine_directions(&sources, 1.0).unwrap()
    }
}

#[test]
fn rendered_sets_are_calibrated_to_the_values_they_were_rendered_with() {
    let Some(data) = shared_set("") else { return };
    let mut coverage = Coverage::default();
    for set in &SETS {
        println!("{}", set.name);
        let rig = Rig::new(set, &data);
        check_directions(&rig, &mut coverage);
        check_alpha_and_beta(&rig, &mut coverage);
        check_intensities(&rig, &mut coverage);
    }
    coverage.check();
}

fn check_directions(rig: &Rig, coverage: &mut Coverage) {
    for (light, truth) in rig.truth.direction.iter().enumerate() {
        let found = rig.direction(light);
        assert_eq!(found.disagreements, []);
        let off = found.direction.direction_to_light.angle(truth).to_degrees();
        println!("  combined {off:.4} of {:.4} deg", found.direction.half_angle_deg);
        assert!(off < 0.3, "{} {}: {off} degrees", rig.set.name, rig.set.lights[light]);
        for axis in 0..3 {
            coverage.meet("direction", &found.direction.interval[axis], truth[axis]);
        }
    }
}

fn check_alpha_and_beta(rig: &Rig, coverage: &mut Coverage) {
    let paint_ball = Ball::new(rig.material_circle.circle, View::Orthographic);
    for colour in 1..rig.set.colours.len() {
        let mut of_lights = Vec::new();
        for (light, photos) in rig.material.iter().enumerate() {
            let alpha = rig.alpha(light, colour);
            let truth = rig.truth.alpha[light][colour];
            println!("  alpha off {:+.6}, half width {:.6}", alpha.value / truth - 1.0, alpha.relative_half_width());
            assert!((alpha.value / truth - 1.0).abs() < 0.003);
            coverage.meet("alpha", &alpha.interval, truth);
            let paint = measure_ratio(&photos[0], &photos[colour], &paint_ball, &RatioOptions::default()).unwrap();
            of_lights.push((paint.ratio, alpha));
        }
        let beta = pool_beta(&of_lights).unwrap();
        let truth = rig.truth.beta[colour];
        println!("  beta off {:+.6}, half width {:.6}", beta.value / truth - 1.0, beta.relative_half_width());
        assert!((beta.value / truth - 1.0).abs() < 0.005);
        coverage.meet("beta", &beta.interval, truth);
    }
}

fn check_intensities(rig: &Rig, coverage: &mut Coverage) {
    let options = IntensityOptions { circle_sd_px: rig.grey_circle.sd_px, ..Default::default() };
    let strengths: Vec<StrengthReport> = (0..rig.set.lights.len())
        .map(|light| {
            let found = rig.direction(light).direction;
            let lamp = match rig.truth.position_mm.get(light) {
                Some(&position_mm) => {
                    Lamp::Near { position_mm, ball_centre_mm: Vector3::zeros(), ball_radius_mm: rig.set.ball_radius_mm }
                }
                None => {
                    Lamp::Distant { direction_to_light: found.direction_to_light, half_angle_deg: found.half_angle_deg }
                }
            };
            measure_strength(&rig.grey[light][0], &rig.grey_ball(), &lamp, &options).unwrap()
        })
        .collect();
    let found = relative_intensities(&strengths.iter().collect::<Vec<_>>());
    for (intensity, truth) in found.iter().zip(&rig.truth.intensity).skip(1) {
        println!(
            "  intensity off {:+.6}, half width {:.6}",
            intensity.value / truth - 1.0,
            intensity.relative_half_width()
        );
        assert!((intensity.value / truth - 1.0).abs() < 0.005);
        coverage.meet("intensity", &intensity.interval, *truth);
    }
}

#[test]
fn balls_are_found_without_a_click() {
    let Some(data) = shared_set("") else { return };
    for set in &SETS {
        for subject in ["grey-sphere", "material-sphere"] {
            for colour in 0..set.colours.len() {
                let photos: Vec<_> = set.lights.iter().map(|light| set.photo(&data, subject, light, colour)).collect();
                let planes: Vec<_> = photos.iter().map(|photo| &photo.linear).collect();
                let found = find_circle(&planes, None, &CircleOptions::default()).unwrap();
                assert_near(&found.circle, (set.centre_px, set.centre_px), set.radius_px, 0.5);
                // One lamp shows less than half of the rim, and the end of its light must not pass for the rest.
                for plane in &planes {
                    let found = find_circle(&[plane], None, &CircleOptions::default()).unwrap();
                    assert_near(&found.circle, (set.centre_px, set.centre_px), set.radius_px, 1.0);
                }
            }
        }
    }
}

#[test]
fn a_mirror_ball_of_which_only_the_highlight_shows_is_not_made_up() {
    let Some(data) = shared_set("") else { return };
    for set in &SETS {
        let photos: Vec<Photo> = set.lights.iter().map(|light| set.mirror(&data, light)).collect();
        let planes: Vec<_> = photos.iter().map(|photo| &photo.linear).collect();
        let error = find_circle(&planes, None, &CircleOptions::default()).unwrap_err();
        assert!(matches!(error, BallError::NotFound { .. }), "{}: {error}", set.name);
    }
}

fn assert_near(circle: &Circle, centre_px: (f64, f64), radius_px: f64, tolerance_px: f64) {
    let off = (circle.centre_px.0 - centre_px.0).hypot(circle.centre_px.1 - centre_px.1);
    assert!(off < tolerance_px && (circle.radius_px - radius_px).abs() < tolerance_px, "{circle:?}");
}

#[test]
fn the_photographed_mirror_ball_gives_its_circle_and_all_twelve_directions() {
    let Some(data) = shared_set("") else { return };
    let photos: Vec<Photo> = (1..=CAT_LAMPS).map(|lamp| cat_mirror(&data, lamp)).collect();
    let planes: Vec<_> = photos.iter().map(|photo| &photo.linear).collect();
    let found = find_circle(&planes, None, &CircleOptions::default()).unwrap();
    println!("{:?} of {:.2} px", found.circle, found.sd_px);
    assert_near(&found.circle, (536.4, 478.5), 421.1, 4.21);
    let drawn = Circle { centre_px: (560.0, 460.0), radius_px: 390.0 };
    let snapped = refine_circle(&planes, &drawn, &CircleOptions::default()).unwrap();

    let ball = Ball::new(found.circle, View::Orthographic);
    let options = HighlightOptions { circle_sd_px: found.sd_px, ..Default::default() };
    for (lamp, reference) in cat_directions(&data).iter().enumerate() {
        let others: Vec<&Photo> = (0..CAT_LAMPS).filter(|&other| other != lamp).map(|other| &photos[other]).collect();
        let report = find_highlights(&photos[lamp], &others, &ball, &options).unwrap();
        let chosen = report.chosen().unwrap();
        let off = chosen.direction.direction_to_light.angle(reference).to_degrees();
        println!("lamp {} off {off:.2} of {:.2} deg", lamp + 1, chosen.direction.half_angle_deg);
        assert!(off < 1.0, "lamp {}: {off} degrees", lamp + 1);
        let doubtful = report.is_ambiguous() || report.is_outshone() || chosen.lasting || chosen.beside_lasting;
        assert!(!doubtful, "lamp {}: {:?}", lamp + 1, report.candidates);
    }
    assert_near(&snapped.circle, (536.4, 478.5), 421.1, 4.21);
}
