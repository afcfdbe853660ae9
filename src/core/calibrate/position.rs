//! The position of a near lamp, from its highlights on mirror balls that lie apart.

use super::{CalibrateError, Highlight};
use crate::camera::Camera;
use crate::interval::Interval;
use crate::linear_algebra;
use crate::sphere::Ball;
use nalgebra::{Matrix3, Vector3};

/// A lamp's highlight on a mirror ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sighting {
    /// The ball; its centre lies at the object's z = 0.
    pub ball: Ball,
    /// Standard deviation of the circle's centre (each axis) and radius in pixels.
    pub circle_sd_px: f64,
    /// Centre of the highlight in pixels, and its standard deviation in each axis.
    pub highlight_px: (f64, f64),
    /// Standard deviation of the highlight's centre, each axis, in pixels.
    pub highlight_sd_px: f64,
}

impl Sighting {
    /// Of a highlight that was found.
    pub fn of(highlight: &Highlight, ball: Ball, circle_sd_px: f64) -> Self {
        let (highlight_px, highlight_sd_px) = (highlight.position_px, highlight.position_sd_px);
        Self { ball, circle_sd_px, highlight_px, highlight_sd_px }
    }

    /// The point of the ball that mirrors the lamp, in mm, and the unit vector from there to the lamp.
    fn ray(&self, camera: &Camera) -> Option<(Vector3<f64>, Vector3<f64>)> {
        let surface = self.ball.surface_at(self.highlight_px.0, self.highlight_px.1)?;
        let ((x, y), radius_px) = (self.ball.circle().centre_px, self.ball.circle().radius_px);
        let centre = camera.point_mm(x, y, 0.0).coords;
        let radius = (camera.point_mm(x + radius_px, y, 0.0).coords - centre).norm();
        Some((centre + surface.normal * radius, surface.direction_mirrored()))
    }

    /// The same with one of its measured numbers off by a standard deviation, for each of them.
    fn perturbed(&self) -> [Self; 5] {
        let ((x, y), sd, circle) = (self.highlight_px, self.highlight_sd_px, self.circle_sd_px);
        let ball = |shift: (f64, f64), growth: f64| Self { ball: self.ball.perturbed(shift, growth), ..*self };
        [
            Self { highlight_px: (x + sd, y), ..*self },
            Self { highlight_px: (x, y + sd), ..*self },
            ball((circle, 0.0), 0.0),
            ball((0.0, circle), 0.0),
            ball((0.0, 0.0), circle),
        ]
    }
}

/// Where a lamp is, with its 95 % interval.
#[derive(Clone, Debug, PartialEq)]
pub struct PositionEstimate {
    /// In mm, in the object frame.
    pub position_mm: Vector3<f64>,
    /// 95 % intervals of x, y and z in mm.
    pub interval_mm: [Interval; 3],
    /// Root mean square distance of the position from the rays that make it, in mm.
    pub residual_mm: f64,
}

/// The point nearest to the rays from all balls to the lamp (least squares).
///
/// Errors: fewer than two sightings, and rays that are parallel.
pub fn lamp_position(sightings: &[Sighting], camera: &Camera) -> Result<PositionEstimate, CalibrateError> {
    let none = CalibrateError::NothingMeasured { quantity: "the position of a lamp on two mirror balls" };
    let Some(position_mm) = meeting_point(sightings, camera).filter(|_| sightings.len() > 1) else { return Err(none) };
    let mut covariance = Matrix3::zeros();
    for index in 0..sightings.len() {
        for perturbed in sightings[index].perturbed() {
            let mut moved = sightings.to_vec();
            moved[index] = perturbed;
            // A highlight at the rim can be moved to one side only.
            let shift = meeting_point(&moved, camera).map_or_else(Vector3::zeros, |moved| moved - position_mm);
            covariance += shift * shift.transpose();
        }
    }
    let distances = sightings.iter().filter_map(|sighting| sighting.ray(camera)).map(|(origin, direction)| {
        let to_lamp = position_mm - origin;
        (to_lamp - direction * to_lamp.dot(&direction)).norm_squared()
    });
    let residual_mm = (distances.sum::<f64>() / sightings.len() as f64).sqrt();
    // Two balls leave one degree of freedom; what they miss one another by is no less than the error of either.
    let interval = |axis: usize| {
        let sd = covariance[(axis, axis)].sqrt().hypot(residual_mm);
        Interval::around(position_mm[axis], 1.96 * sd)
    };
    Ok(PositionEstimate { position_mm, interval_mm: [interval(0), interval(1), interval(2)], residual_mm })
}

fn meeting_point(sightings: &[Sighting], camera: &Camera) -> Option<Vector3<f64>> {
    let mut normal = Matrix3::zeros();
    let mut right = Vector3::zeros();
    for sighting in sightings {
        let (origin, direction) = sighting.ray(camera)?;
        let across = Matrix3::identity() - direction * direction.transpose();
        normal += across;
        right += across * origin;
    }
    linear_algebra::solve_positive_definite(normal, &right)
}
