//! The direction to each light: from the mirror ball, from the grey ball's shading, from both.

use firstbounce_core::calibrate::{
    DirectionEstimate, DirectionSource, HighlightOptions, HighlightReport, ShadingOptions, SourcedDirection,
    combine_directions, direction_from_shading, find_highlights,
};

use super::super::PipelineError;
use super::balls::BallShots;
use super::{DirectionDoubt, Known, Source};
use crate::set::{Light, SphereKind};

/// Directions that differ by less than this never raise a warning: balls are not perfect.
const AGREEMENT_FLOOR_DEG: f64 = 1.0;

/// What the balls say of one light's direction.
#[derive(Default)]
pub(super) struct MeasuredDirection {
    pub known: Option<Known<[f64; 3]>>,
    /// Half angle of the 95 % cone.
    pub half_angle_deg: f64,
    pub highlights: Option<HighlightReport>,
    pub doubts: Vec<DirectionDoubt>,
}

/// Measures the direction to light `l` of `lights` on the balls there are. `typed` is what the file says, to compare.
pub(super) fn measure_direction(
    light: &Light,
    l: usize,
    lights: usize,
    mirror: Option<&BallShots>,
    grey: Option<&BallShots>,
    typed: Option<[f64; 3]>,
) -> Result<MeasuredDirection, PipelineError> {
    let mut measured = MeasuredDirection::default();
    let mut sources = Vec::new();
    let mut pixels = None;
    if let Some((ball, photo)) = mirror.and_then(|ball| Some((ball, ball.any_photo(l)?))) {
        let options = HighlightOptions {
            circle_sd_px: ball.circle_sd_px,
            lamp_distance_radii: light.position_mm.and_then(|position| ball.lamp_distance_radii(position)),
            ..HighlightOptions::default()
        };
        let others = ball.under_other_lights(l, lights);
        let report = find_highlights(photo, &others, &ball.ball, &options)
            .map_err(|reason| PipelineError::calibrate(&light.name, SphereKind::Mirror, reason))?;
        if let Some(chosen) = report.chosen() {
            sources.push(sourced(DirectionSource::Mirror, chosen.direction.clone()));
        }
        if report.is_ambiguous() {
            measured.doubts.push(DirectionDoubt::TwoHighlights);
        }
        measured.highlights = Some(report);
    }
    if let Some((ball, photo)) = grey.and_then(|ball| Some((ball, ball.photo(l, 0)?))) {
        let options = ShadingOptions {
            circle_sd_px: ball.circle_sd_px,
            lamp_distance_radii: light.position_mm.and_then(|position| ball.lamp_distance_radii(position)),
            ..ShadingOptions::default()
        };
        let report = direction_from_shading(photo, &ball.ball, &options)
            .map_err(|reason| PipelineError::calibrate(&light.name, SphereKind::Grey, reason))?;
        sources.push(sourced(DirectionSource::Shading, report.direction));
        pixels = Some(report.pixels);
    }
    if sources.is_empty() {
        return Ok(measured);
    }
    let combined = combine_directions(&sources, AGREEMENT_FLOOR_DEG)
        .map_err(|reason| PipelineError::calibrate(&light.name, SphereKind::Mirror, reason))?;
    let agree = combined.disagreements.is_empty();
    measured.doubts.extend(combined.disagreements.iter().copied().map(DirectionDoubt::Balls));
    measured.doubts.extend(contradiction(light, typed, &combined.direction));
    let direction = combined.direction.direction_to_light;
    measured.half_angle_deg = combined.direction.half_angle_deg;
    measured.known = Some(Known {
        value: [direction.x, direction.y, direction.z],
        interval: Some([combined.direction.interval.map(|i| i.low), combined.direction.interval.map(|i| i.high)]),
        source: match (sources.len(), sources[0].source) {
            (2.., _) if agree => Source::MirrorAndShading,
            (_, DirectionSource::Shading) => Source::Shading,
            _ => Source::MirrorBall,
        },
        pixels,
    });
    Ok(measured)
}

fn sourced(source: DirectionSource, direction: DirectionEstimate) -> SourcedDirection {
    SourcedDirection { source, direction }
}

/// A doubt where the file's direction or position contradicts what the balls say.
fn contradiction(light: &Light, typed: Option<[f64; 3]>, measured: &DirectionEstimate) -> Option<DirectionDoubt> {
    let (given, source) = match (typed, light.position_mm) {
        (Some(typed), _) => (typed, DirectionSource::Typed),
        (None, Some(position)) => (position, DirectionSource::Position),
        (None, None) => return None,
    };
    let angle_deg = nalgebra::Vector3::from(given).angle(&measured.direction_to_light).to_degrees();
    let allowed_deg = measured.half_angle_deg.max(AGREEMENT_FLOOR_DEG);
    (angle_deg > allowed_deg).then_some(DirectionDoubt::Given { source, angle_deg, allowed_deg })
}
