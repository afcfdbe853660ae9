//! The strength of the lamps, from the light of a grey ball.

use super::{
    BallPixels, CalibrateError, PixelOptions,
    direction::check_circle_sd,
    pixels::{REGIONS, choose_pixels},
};
use crate::Photo;
use crate::interval::{Estimate, jackknife};
use crate::sphere::Ball;
use nalgebra::{Vector1, Vector3};

/// Where a lamp is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lamp {
    /// So far away that its light is the same everywhere.
    Distant {
        /// Unit vector from the object to the light.
        direction_to_light: Vector3<f64>,
        /// 95 % of the true directions lie within this angle.
        half_angle_deg: f64,
    },
    /// At a known place; its light falls with the inverse square of the distance.
    Near {
        /// The lamp, in mm; the origin is the object's z = 0 on the optical axis.
        position_mm: Vector3<f64>,
        /// The ball's centre in the same frame; zero where the ball stood in the object's place.
        ball_centre_mm: Vector3<f64>,
        /// The ball's radius.
        ball_radius_mm: f64,
    },
}

impl Lamp {
    /// Light on a spot of the ball for a lamp whose light is 1 at the frame's origin, square to it: max(n.d, 0), and
    /// for a near lamp times (distance of the origin / distance of the spot)^2.
    pub fn shading(&self, normal: &Vector3<f64>) -> f64 {
        match *self {
            Self::Distant { direction_to_light, .. } => normal.dot(&direction_to_light).max(0.0),
            Self::Near { position_mm, ball_centre_mm, ball_radius_mm } => {
                let to_lamp = position_mm - ball_centre_mm - normal * ball_radius_mm;
                let distance = to_lamp.norm();
                normal.dot(&to_lamp).max(0.0) / distance * position_mm.norm_squared() / (distance * distance)
            }
        }
    }

    /// The same lamp turned by one standard deviation of its direction, about two axes.
    fn turned(&self) -> Vec<Self> {
        let Self::Distant { direction_to_light, half_angle_deg } = *self else { return Vec::new() };
        let sd = (half_angle_deg / 2.45).to_radians();
        let aside = if direction_to_light.x.abs() < 0.7 { Vector3::x() } else { Vector3::y() };
        let first = direction_to_light.cross(&aside).normalize();
        [first, direction_to_light.cross(&first)]
            .map(|across| Self::Distant {
                direction_to_light: (direction_to_light + across * sd).normalize(),
                half_angle_deg,
            })
            .to_vec()
    }

    fn check(&self) -> Result<(), CalibrateError> {
        let value = match self {
            Self::Distant { direction_to_light, .. } => direction_to_light.norm(),
            Self::Near { position_mm, ball_centre_mm, ball_radius_mm } => {
                (position_mm - ball_centre_mm).norm() / ball_radius_mm
            }
        };
        let (good, quantity) = match self {
            Self::Distant { .. } => ((value - 1.0).abs() < 1e-3, "the length of a light direction"),
            Self::Near { .. } => (value > 1.5, "the distance of a lamp in ball radii"),
        };
        if good { Ok(()) } else { Err(CalibrateError::Impossible { quantity, value }) }
    }
}

/// How to measure a lamp's strength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntensityOptions {
    /// Which pixels are good enough.
    pub pixels: PixelOptions,
    /// Standard deviation of the circle's centre (each axis) and radius in pixels;
    /// [`crate::sphere::CircleReport::sd_px`].
    pub circle_sd_px: f64,
}

impl Default for IntensityOptions {
    fn default() -> Self {
        Self { pixels: PixelOptions::default(), circle_sd_px: 0.1 }
    }
}

impl IntensityOptions {
    /// Whether every option is in its range.
    pub fn check(&self) -> Result<(), CalibrateError> {
        check_circle_sd(self.circle_sd_px)?;
        self.pixels.check()
    }
}

/// The strength of one lamp on the grey ball: linear light of a spot that faces it.
#[derive(Clone, Debug, PartialEq)]
pub struct StrengthReport {
    /// Linear light of the grey paint square to the lamp, at the frame's origin.
    pub strength: f64,
    /// Root mean square residual of I = strength s, over the strength.
    pub residual: f64,
    /// The pixels used and refused.
    pub pixels: BallPixels,
    /// Relative standard deviation from the scatter of the ball's regions and from the lamp's direction.
    own_sd: f64,
    groups: usize,
    /// Relative change by one standard deviation of the circle's x, y and radius: common to all lamps of one ball.
    circle_shifts: [f64; 3],
}

/// Measures the strength of a lamp: sum(I s) / sum(s^2) over the lit part of a grey ball, s being [`Lamp::shading`].
pub fn measure_strength(
    photo: &Photo,
    ball: &Ball,
    lamp: &Lamp,
    options: &IntensityOptions,
) -> Result<StrengthReport, CalibrateError> {
    options.check()?;
    lamp.check()?;
    let pixels = choose_pixels(&[photo], ball, &options.pixels)?;
    let used = pixels.used();
    let sums_of = |ball: &Ball, lamp: &Lamp| {
        let mut sums = [(0usize, 0.0, 0.0); REGIONS];
        for pixel in &used {
            let Some(normal) = pixel.normal(ball) else { continue };
            let shading = lamp.shading(&normal);
            let (count, product, square) = &mut sums[pixel.region];
            *count += 1;
            *product += shading * pixel.value(photo);
            *square += shading * shading;
        }
        sums
    };
    let strength_of = |ball: &Ball, lamp: &Lamp| {
        let (product, square) = sums_of(ball, lamp).iter().fold((0.0, 0.0), |(p, s), sum| (p + sum.1, s + sum.2));
        product / square
    };
    let sums = sums_of(ball, lamp);
    let found = jackknife(&sums.map(|sum| sum.0), |left_out| {
        let kept = sums.iter().enumerate().filter(|&(region, _)| Some(region) != left_out);
        let (product, square) = kept.fold((0.0, 0.0), |(p, s), (_, sum)| (p + sum.1, s + sum.2));
        (square > 0.0).then(|| Vector1::new(product / square))
    })
    .ok_or_else(|| CalibrateError::TooFewPixels { counts: pixels.counts(), needed: options.pixels.min_pixels })?;
    let strength = found.value[0];
    if !(strength.is_finite() && strength > 0.0) {
        return Err(CalibrateError::Impossible { quantity: "the strength of a light", value: strength });
    }

    let sd = options.circle_sd_px;
    let moves = [ball.perturbed((sd, 0.0), 0.0), ball.perturbed((0.0, sd), 0.0), ball.perturbed((0.0, 0.0), sd)];
    let circle_shifts = moves.map(|moved| strength_of(&moved, lamp) / strength - 1.0);
    let turns: f64 = lamp.turned().iter().map(|turned| (strength_of(ball, turned) / strength - 1.0).powi(2)).sum();
    let squares =
        used.iter().filter_map(|p| Some((p.value(photo) - strength * lamp.shading(&p.normal(ball)?)).powi(2)));
    let residual = (squares.sum::<f64>() / used.len() as f64).sqrt() / strength;
    let own_sd = (found.covariance[0] / strength.powi(2) + turns).sqrt();
    Ok(StrengthReport { strength, residual, pixels, own_sd, groups: found.groups, circle_shifts })
}

/// Intensities relative to the first lamp, all measured on one ball in the reference colour. An error of the circle
/// that changes all strengths alike cancels.
pub fn relative_intensities(lamps: &[&StrengthReport]) -> Vec<Estimate> {
    let Some(first) = lamps.first() else { return Vec::new() };
    let relative = |lamp: &&StrengthReport| {
        let value = lamp.strength / first.strength;
        let circle = lamp.circle_shifts.iter().zip(&first.circle_shifts).map(|(a, b)| (a - b).powi(2)).sum::<f64>();
        let sd = (circle + lamp.own_sd.powi(2) + first.own_sd.powi(2)).sqrt();
        Estimate::with_sd(value, value * sd, lamp.groups.min(first.groups))
    };
    std::iter::once(Estimate::exact(1.0)).chain(lamps[1..].iter().map(relative)).collect()
}
