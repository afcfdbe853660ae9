//! Several sources of one direction: whether they agree, and what they say together.

use super::{CalibrateError, DirectionEstimate};
use nalgebra::{Matrix3, Vector3};

/// Where a direction comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DirectionSource {
    /// The highlight on the mirror ball.
    Mirror,
    /// The shading of the grey ball.
    Shading,
    /// The user or a file.
    Typed,
    /// The lamp's position in the capture set.
    Position,
}

impl std::fmt::Display for DirectionSource {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Mirror => "the highlight on the mirror ball",
            Self::Shading => "the shading of the grey ball",
            Self::Typed => "the typed direction",
            Self::Position => "the lamp's position",
        })
    }
}

/// A direction and where it comes from.
#[derive(Clone, Debug, PartialEq)]
pub struct SourcedDirection {
    /// Where it comes from.
    pub source: DirectionSource,
    /// The direction.
    pub direction: DirectionEstimate,
}

/// Two sources that differ by more than their intervals allow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disagreement {
    /// The source that is trusted more.
    pub first: DirectionSource,
    /// The other source.
    pub second: DirectionSource,
    /// Angle between their directions.
    pub angle_deg: f64,
    /// The angle that would have passed.
    pub allowed_deg: f64,
}

impl std::fmt::Display for Disagreement {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{} and {} differ by {:.1} degrees ({:.1} would pass): check the highlight that was picked, the circles, and that the ball did not move",
            self.first, self.second, self.angle_deg, self.allowed_deg
        )
    }
}

/// What several sources say together.
#[derive(Clone, Debug, PartialEq)]
pub struct CombinedDirection {
    /// The direction.
    pub direction: DirectionEstimate,
    /// Pairs that disagree.
    pub disagreements: Vec<Disagreement>,
}

/// Combines the sources of one light's direction, the most trusted first.
///
/// Sources that agree with the first are averaged, weighted by the inverse square of their half angles. Two sources
/// disagree where they differ by more than their half angles together allow, and by more than `floor_deg` (1 degree is
/// usual: balls are not perfect); the first source then disagrees with that one alone, and its region is widened to
/// hold both.
pub fn combine_directions(sources: &[SourcedDirection], floor_deg: f64) -> Result<CombinedDirection, CalibrateError> {
    let Some(first) = sources.first() else {
        return Err(CalibrateError::NothingMeasured { quantity: "a direction" });
    };
    let mut disagreements = Vec::new();
    let mut information = Vec::new();
    for source in sources {
        match disagreement(first, source, floor_deg) {
            Some(found) => disagreements.push(found),
            None => information.push((source.direction.direction_to_light, sd_of(&source.direction))),
        }
    }
    let weight: f64 = information.iter().map(|(_, sd)| sd.powi(-2)).sum();
    let mean: Vector3<f64> = information.iter().map(|(direction, sd)| direction / sd.powi(2)).sum();
    // Sources that pass may still differ by more than their intervals: the floor lets them, the interval must not.
    let excess = information.iter().map(|(d, sd)| ((d - mean / weight).norm() / sd).powi(2)).sum::<f64>();
    let birge = (excess / (2 * information.len() - 2).max(1) as f64).max(1.0);
    let widest = disagreements.iter().map(|d| d.angle_deg.to_radians() / 2.0).fold(0.0, f64::max);
    let covariance = Matrix3::identity() * (birge / weight + widest.powi(2));
    Ok(CombinedDirection {
        direction: DirectionEstimate::new(mean.normalize(), &covariance, usize::MAX),
        disagreements,
    })
}

fn disagreement(first: &SourcedDirection, second: &SourcedDirection, floor_deg: f64) -> Option<Disagreement> {
    let (a, b) = (&first.direction, &second.direction);
    let angle_deg = a.direction_to_light.angle(&b.direction_to_light).to_degrees();
    let allowed_deg = a.half_angle_deg.hypot(b.half_angle_deg).max(floor_deg);
    (angle_deg > allowed_deg).then_some(Disagreement {
        first: first.source,
        second: second.source,
        angle_deg,
        allowed_deg,
    })
}

/// Standard deviation across the direction, radians; a typed direction may claim to be exact.
fn sd_of(direction: &DirectionEstimate) -> f64 {
    (direction.half_angle_deg / 2.45).to_radians().max(1e-6)
}
