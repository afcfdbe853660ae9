//! The direction to each light: from the mirror ball, from the grey ball's shading, from both.

use firstbounce_core::calibrate::{
    CalibrateError, DirectionEstimate, DirectionSource, HighlightOptions, HighlightReport, ShadingOptions,
    ShadingReport, SourcedDirection, combine_directions, direction_from_shading, find_highlights,
};

use nalgebra::Vector3;

use super::super::PipelineError;
use super::balls::BallShots;
use super::{DirectionDoubt, Known, Source};
use crate::set::{Light, SphereKind};

/// Directions that differ by less than this never raise a warning: balls are not perfect.
const AGREEMENT_FLOOR_DEG: f64 = 1.0;
/// Highlights of lamps closer together may lie on one another on a mirror ball.
const BESIDE_DEG: f64 = 15.0;

/// What the balls say of one light's direction.
#[derive(Default)]
pub(super) struct MeasuredDirection {
    pub known: Option<Known<[f64; 3]>>,
    /// Half angle of the 95 % cone.
    pub half_angle_deg: f64,
    pub highlights: Option<HighlightReport>,
    pub doubts: Vec<DirectionDoubt>,
    /// What the grey ball's shading says.
    pub shading: Option<ShadingReport>,
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
    let shading = grey.map_or(Ok(None), |ball| shade(light, l, ball));
    let expected = shading.as_ref().ok().and_then(Option::as_ref).map(|report| report.direction.direction_to_light);
    let highlights = mirror.map_or(Ok(None), |ball| highlights(light, l, lights, ball, expected));
    let mut doubts = Vec::new();
    // One ball is enough.
    let (shading, highlights) = match (shading, highlights) {
        (Ok(Some(shading)), Err(reason)) => {
            doubts.push(DirectionDoubt::Unusable { ball: SphereKind::Mirror, reason });
            (Some(shading), None)
        }
        (Err(reason), Ok(Some(highlights))) => {
            doubts.push(DirectionDoubt::Unusable { ball: SphereKind::Grey, reason });
            (None, Some(highlights))
        }
        (shading, highlights) => {
            let failed = |ball: SphereKind| move |reason| PipelineError::calibrate(&light.name, ball, reason);
            (shading.map_err(failed(SphereKind::Grey))?, highlights.map_err(failed(SphereKind::Mirror))?)
        }
    };
    let chosen = highlights.as_ref().and_then(HighlightReport::chosen);
    let of_mirror = chosen.map(|chosen| sourced(DirectionSource::Mirror, &chosen.direction));
    let of_shading = shading.as_ref().map(|report| sourced(DirectionSource::Shading, &report.direction));
    // A highlight is sharper than shading, but where none lies near it, none is the lamp's.
    let by_trust = match chosen {
        Some(chosen) if !chosen.near_expected => [of_shading, of_mirror],
        _ => [of_mirror, of_shading],
    };
    let sources: Vec<_> = by_trust.into_iter().flatten().collect();
    if sources.is_empty() {
        return Ok(MeasuredDirection::default());
    }
    let combined = combine_directions(&sources, AGREEMENT_FLOOR_DEG)
        .map_err(|reason| PipelineError::calibrate(&light.name, SphereKind::Mirror, reason))?;
    let confirmed = sources.len() > 1 && combined.disagreements.is_empty();
    doubts.extend(highlights.iter().flat_map(highlight_doubts).filter(|_| !confirmed));
    doubts.extend(combined.disagreements.iter().copied().map(DirectionDoubt::Balls));
    doubts.extend(given_doubt(light, typed, &combined.direction));
    let direction = combined.direction.direction_to_light;
    let source = match (confirmed, sources[0].source) {
        (true, _) => Source::MirrorAndShading,
        (_, DirectionSource::Shading) => Source::Shading,
        _ => Source::MirrorBall,
    };
    let known = Known {
        interval: Some([combined.direction.interval.map(|i| i.low), combined.direction.interval.map(|i| i.high)]),
        pixels: shading.as_ref().map(|report| report.pixels.clone()),
        ..Known::new([direction.x, direction.y, direction.z], source)
    };
    let half_angle_deg = combined.direction.half_angle_deg;
    Ok(MeasuredDirection { known: Some(known), half_angle_deg, highlights, doubts, shading })
}

/// The bright spots on the mirror ball under light `l`; `None` without a photo.
fn highlights(
    light: &Light,
    l: usize,
    lights: usize,
    ball: &BallShots,
    expected: Option<Vector3<f64>>,
) -> Result<Option<HighlightReport>, CalibrateError> {
    let Some(photo) = ball.any_photo(l) else { return Ok(None) };
    let options = HighlightOptions {
        circle_sd_px: ball.circle_sd_px,
        lamp_distance_radii: light.position_mm.and_then(|position| ball.lamp_distance_radii(position)),
        expected,
        ..HighlightOptions::default()
    };
    find_highlights(photo, &ball.under_other_lights(l, lights), &ball.ball, &options).map(Some)
}

/// The shading of the grey ball under light `l`; `None` without a photo.
fn shade(light: &Light, l: usize, ball: &BallShots) -> Result<Option<ShadingReport>, CalibrateError> {
    let Some(photo) = ball.photo(l, 0) else { return Ok(None) };
    let options = ShadingOptions {
        circle_sd_px: ball.circle_sd_px,
        lamp_distance_radii: light.position_mm.and_then(|position| ball.lamp_distance_radii(position)),
        ..ShadingOptions::default()
    };
    direction_from_shading(photo, &ball.ball, &options).map(Some)
}

fn highlight_doubts(report: &HighlightReport) -> Vec<DirectionDoubt> {
    let Some(chosen) = report.chosen() else { return Vec::new() };
    let doubts = [
        (chosen.lasting, DirectionDoubt::Lasting),
        (chosen.beside_lasting && !chosen.lasting, DirectionDoubt::BesideLasting),
        (report.is_outshone(), DirectionDoubt::Outshone),
        (report.is_ambiguous(), DirectionDoubt::TwoHighlights),
    ];
    doubts.into_iter().filter_map(|(holds, doubt)| holds.then_some(doubt)).collect()
}

/// Adds what only all lights together show: two with one direction, and highlights that are seen under another lamp which
/// no lamp beside theirs explains.
pub(super) fn add_common_doubts(
    set: &[Light],
    in_force: &[Option<Known<[f64; 3]>>],
    measured: &mut [MeasuredDirection],
) {
    let angle_deg = |a: usize, b: usize| Some(angle_between(in_force[a].as_ref()?, in_force[b].as_ref()?));
    for l in 0..measured.len() {
        let nearest =
            (0..set.len()).filter(|&other| other != l).filter_map(|other| Some((other, angle_deg(l, other)?)));
        let nearest = nearest.min_by(|a, b| a.1.total_cmp(&b.1));
        let Some(MeasuredDirection { highlights, doubts, known, .. }) = measured.get_mut(l) else { continue };
        let chosen = highlights.as_ref().and_then(HighlightReport::chosen);
        let by_mirror_alone = known.as_ref().is_some_and(|known| known.source == Source::MirrorBall);
        let seen = chosen.map_or(0, |chosen| chosen.seen_under_other_lamps);
        let is_explained = nearest.is_none_or(|(_, angle_deg)| angle_deg < BESIDE_DEG);
        if seen > 0 && by_mirror_alone && !is_explained && !doubts.iter().any(DirectionDoubt::is_of_highlight) {
            doubts.push(DirectionDoubt::Lasting);
        }
        if let Some((other, angle_deg)) = nearest.filter(|&(_, angle_deg)| angle_deg < AGREEMENT_FLOOR_DEG) {
            doubts.push(DirectionDoubt::SameAs { light: set[other].name.clone(), angle_deg });
        }
    }
}

fn angle_between(a: &Known<[f64; 3]>, b: &Known<[f64; 3]>) -> f64 {
    Vector3::from(a.value).angle(&Vector3::from(b.value)).to_degrees()
}

fn sourced(source: DirectionSource, direction: &DirectionEstimate) -> SourcedDirection {
    SourcedDirection { source, direction: direction.clone() }
}

/// A doubt where the file's direction or position contradicts what the balls say.
fn given_doubt(light: &Light, typed: Option<[f64; 3]>, measured: &DirectionEstimate) -> Option<DirectionDoubt> {
    let (given, source) = match (typed, light.position_mm) {
        (Some(typed), _) => (typed, DirectionSource::Typed),
        (None, Some(position)) => (position, DirectionSource::Position),
        (None, None) => return None,
    };
    let angle_deg = Vector3::from(given).angle(&measured.direction_to_light).to_degrees();
    contradicts(source, angle_deg, measured.half_angle_deg)
}

/// The same of a typed direction that knows what the balls say.
pub(super) fn contradiction(known: &Known<[f64; 3]>) -> Option<DirectionDoubt> {
    let measured = known.measured.as_ref()?;
    let [low, high] = measured.interval;
    let widest = low.iter().zip(high).map(|(low, high)| (high - low) / 2.0).fold(0.0, f64::max);
    let angle_deg = Vector3::from(known.value).angle(&Vector3::from(measured.value)).to_degrees();
    // The half angle of a cone is 1.25 times the half width of its widest interval.
    contradicts(DirectionSource::Typed, angle_deg, 1.25 * widest.to_degrees())
}

fn contradicts(source: DirectionSource, angle_deg: f64, half_angle_deg: f64) -> Option<DirectionDoubt> {
    let allowed_deg = half_angle_deg.max(AGREEMENT_FLOOR_DEG);
    (angle_deg > allowed_deg).then_some(DirectionDoubt::Given { source, angle_deg, allowed_deg })
}
