//! The direction to a lamp from the shading of a grey ball.

use super::{
    BallPixels, CalibrateError, PixelOptions,
    pixels::{REGIONS, ShadingSums, choose_pixels},
};
use crate::Photo;
use crate::interval::{Interval, coverage_factor, jackknife};
use crate::linear_algebra;
use crate::options::check_range;
use crate::sphere::Ball;
use nalgebra::{Matrix3, Vector3, Vector4};

/// A direction to a light with its 95 % region.
#[derive(Clone, Debug, PartialEq)]
pub struct DirectionEstimate {
    /// Unit vector from the object to the light.
    pub direction_to_light: Vector3<f64>,
    /// The true direction lies within this angle in 95 of 100 cases.
    pub half_angle_deg: f64,
    /// 95 % intervals of x, y and z.
    pub interval: [Interval; 3],
}

impl DirectionEstimate {
    /// A direction whose error has this covariance, found from `groups` independent parts. Only the part of the error
    /// across the direction counts: its length is one.
    pub(super) fn new(direction_to_light: Vector3<f64>, covariance: &Matrix3<f64>, groups: usize) -> Self {
        let across = Matrix3::identity() - direction_to_light * direction_to_light.transpose();
        let covariance = across * covariance * across;
        let factor = coverage_factor(groups);
        // In two dimensions the 95 % circle is 2.45 standard deviations wide where the interval is 1.96; the widest
        // axis bounds it.
        // A covariance that cannot be decomposed is one of errors beyond all numbers.
        let widest = linear_algebra::symmetric_eigen(covariance)
            .map_or(f64::INFINITY, |eigen| eigen.eigenvalues.max().max(0.0).sqrt());
        let component = |i: usize| {
            let half_width = (factor * covariance[(i, i)].max(0.0).sqrt()).max(factor * widest * widest / 2.0);
            Interval::around(direction_to_light[i], half_width)
        };
        Self {
            direction_to_light,
            half_angle_deg: (1.25 * factor * widest).to_degrees(),
            interval: [component(0), component(1), component(2)],
        }
    }
}

/// How to measure a direction from shading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadingOptions {
    /// Which pixels are good enough.
    pub pixels: PixelOptions,
    /// Standard deviation of the circle's centre (each axis) and radius in pixels;
    /// [`crate::sphere::CircleReport::sd_px`].
    pub circle_sd_px: f64,
    /// Distance from the ball's centre to the lamp in ball radii, for a near lamp; absent for a distant one.
    pub lamp_distance_radii: Option<f64>,
    /// Light that reaches every side alike counts as that of the room where it is more than this share of the lamp's.
    pub max_ambient: f64,
}

impl Default for ShadingOptions {
    fn default() -> Self {
        Self { pixels: PixelOptions::default(), circle_sd_px: 0.1, lamp_distance_radii: None, max_ambient: 0.005 }
    }
}

impl ShadingOptions {
    /// Whether every option is in its range.
    pub fn check(&self) -> Result<(), CalibrateError> {
        check_circle_sd(self.circle_sd_px)?;
        check_lamp_distance(self.lamp_distance_radii)?;
        check_range("max_ambient", self.max_ambient, (0.0..1.0).contains(&self.max_ambient), "from 0 to below 1")?;
        self.pixels.check()
    }

    /// The ambient that is no sign of room light. The nearer a lamp, the more its light bends over the ball, which the fit
    /// makes out by the ball's place and size; where these are off by a ball's radius, it errs by as much.
    fn allowed_ambient(&self) -> f64 {
        self.max_ambient + self.lamp_distance_radii.map_or(0.0, f64::recip)
    }
}

pub(super) fn check_circle_sd(value: f64) -> Result<(), CalibrateError> {
    Ok(check_range("circle_sd_px", value, (0.0..1e3).contains(&value), "from 0 to below 1000")?)
}

pub(super) fn check_lamp_distance(distance: Option<f64>) -> Result<(), CalibrateError> {
    let value = distance.unwrap_or(f64::MAX);
    Ok(check_range("lamp_distance_radii", value, (1.5..f64::INFINITY).contains(&value), "at least 1.5")?)
}

/// A direction from shading and what it was measured on.
#[derive(Clone, Debug, PartialEq)]
pub struct ShadingReport {
    /// Direction from the ball's centre to the light.
    pub direction: DirectionEstimate,
    /// Linear light that reaches every side alike, over the light of a spot that faces the lamp.
    pub ambient: f64,
    /// Linear light of a spot that faces the lamp, ambient light left out.
    pub strength: f64,
    /// Whether the ambient light is that of a room: the region of the direction then holds what such light does to it.
    pub room_light: bool,
    /// Root mean square residual of the fit, over the light of a spot that faces the lamp.
    pub residual: f64,
    /// The pixels used and refused.
    pub pixels: BallPixels,
}

/// Fits I = a max(n.d, 0) + ambient to the lit part of a grey ball (least squares; n from the circle). A near lamp's
/// light falls with the inverse square of the distance and comes from another direction at every spot; the direction
/// returned is then that from the ball's centre.
pub fn direction_from_shading(
    photo: &Photo,
    ball: &Ball,
    options: &ShadingOptions,
) -> Result<ShadingReport, CalibrateError> {
    options.check()?;
    let pixels = choose_pixels(&[photo], ball, &options.pixels)?;
    let too_few = || CalibrateError::TooFewPixels { counts: pixels.counts(), needed: options.pixels.min_pixels };
    let fit = |ball: &Ball| fit_ball(photo, ball, &pixels, options.lamp_distance_radii);

    let (light, regions) = fit(ball).ok_or_else(too_few)?;
    let strength = light.xyz().norm();
    if !(strength.is_finite() && strength > 0.0) {
        return Err(CalibrateError::Impossible { quantity: "the strength of a light", value: strength });
    }
    let direction_to_light = light.xyz() / strength;
    let scatter = jackknife(&regions.counts, |left_out| Some(regions.without(left_out)?.xyz().normalize()))
        .ok_or_else(too_few)?;

    let sd = options.circle_sd_px;
    let moves = [ball.perturbed((sd, 0.0), 0.0), ball.perturbed((0.0, sd), 0.0), ball.perturbed((0.0, 0.0), sd)];
    let mut covariance = scatter.covariance;
    for (moved, _) in moves.iter().filter_map(fit) {
        let shift = moved.xyz().normalize() - direction_to_light;
        covariance += shift * shift.transpose();
    }
    // Light from one half of a room is stronger on one side by as much as it is on all: it draws the direction to itself.
    let ambient = light.w / strength;
    let room_light = ambient > options.allowed_ambient();
    if room_light {
        covariance += Matrix3::identity() * ambient.powi(2);
    }
    let used = pixels.used();
    let squares = used.iter().filter_map(|pixel| {
        let row = row_of(pixel.normal(ball)?, direction_to_light, options.lamp_distance_radii);
        Some((pixel.value(photo) - row.dot(&light)).powi(2))
    });
    let residual = (squares.sum::<f64>() / used.len() as f64).sqrt() / strength;
    let direction = DirectionEstimate::new(direction_to_light, &covariance, scatter.groups);
    Ok(ShadingReport { direction, ambient, strength, room_light, residual, pixels })
}

/// Normal equations of each region of the ball.
struct Regions {
    counts: [usize; REGIONS],
    sums: [ShadingSums; REGIONS],
}

impl Regions {
    fn without(&self, left_out: Option<usize>) -> Option<Vector4<f64>> {
        let mut total = ShadingSums::default();
        let kept = self.sums.iter().enumerate().filter(|&(region, _)| Some(region) != left_out);
        kept.for_each(|(_, sums)| total.merge(sums));
        total.solve()
    }
}

/// Light vector and ambient. A near lamp needs its direction to weigh the pixels, so the fit is repeated.
fn fit_ball(
    photo: &Photo,
    ball: &Ball,
    pixels: &BallPixels,
    lamp_distance_radii: Option<f64>,
) -> Option<(Vector4<f64>, Regions)> {
    let samples: Vec<_> = pixels
        .used()
        .into_iter()
        .filter_map(|pixel| Some((pixel.region, pixel.normal(ball)?, pixel.value(photo))))
        .collect();
    let fit = |direction: Vector3<f64>, distance: Option<f64>| {
        let mut regions = Regions { counts: [0; REGIONS], sums: [ShadingSums::default(); REGIONS] };
        for &(region, normal, value) in &samples {
            regions.counts[region] += 1;
            regions.sums[region].add(row_of(normal, direction, distance), value);
        }
        Some((regions.without(None)?, regions))
    };
    let mut found = fit(Vector3::z(), None)?;
    if lamp_distance_radii.is_some() {
        for _ in 0..4 {
            found = fit(found.0.xyz().normalize(), lamp_distance_radii)?;
        }
    }
    Some(found)
}

/// What a light vector b, as long as the light at the ball's centre is strong, and the ambient are multiplied with to
/// give the light of a spot. The spot n of a unit ball sees a lamp at D d under n.(D d - n) / |D d - n| and lit by (D /
/// |D d - n|)^2; in b that is (D n - d) D^2 / |D d - n|^3, because d.b = |b|.
fn row_of(normal: Vector3<f64>, direction: Vector3<f64>, lamp_distance_radii: Option<f64>) -> Vector4<f64> {
    match lamp_distance_radii {
        None => normal.push(1.0),
        Some(distance) => {
            let to_lamp = direction * distance - normal;
            let nearness = distance.powi(2) / to_lamp.norm().powi(3);
            ((normal * distance - direction) * nearness).push(1.0)
        }
    }
}
